/* stm32.h - registers of the STM32F405 as far as start-up and drivers use them, and what those share. Source: RM0090 (reference
 * manual), DS8626 (pins). */
#ifndef HAL_STM32F405_H
#define HAL_STM32F405_H

#include "board.h"

#define REGISTER(address) (*(volatile uint32_t *)(address))

/* Of the core. */
#define SYSTICK_CTRL     REGISTER(0xE000E010u)
#define SYSTICK_LOAD     REGISTER(0xE000E014u)
#define NVIC_ENABLE(irq) (REGISTER(0xE000E100u + 4u * ((irq) / 32u)) = 1u << ((irq) % 32u))
#define SCB_CPACR        REGISTER(0xE000ED88u)

/* Reset and clock control, flash interface, independent watchdog. */
#define RCC_CR      REGISTER(0x40023800u)
#define RCC_PLLCFGR REGISTER(0x40023804u)
#define RCC_CFGR    REGISTER(0x40023808u)
#define RCC_AHB1ENR REGISTER(0x40023830u)
#define RCC_APB1ENR REGISTER(0x40023840u)
#define RCC_APB2ENR REGISTER(0x40023844u)
#define FLASH_ACR   REGISTER(0x40023C00u)
#define FLASH_KEYR  REGISTER(0x40023C04u)
#define FLASH_SR    REGISTER(0x40023C0Cu)
#define FLASH_CR    REGISTER(0x40023C10u)
#define IWDG_KR     REGISTER(0x40003000u)
#define IWDG_PR     REGISTER(0x40003004u)
#define IWDG_RLR    REGISTER(0x40003008u)

#define RCC_CR_HSEON         (1u << 16)
#define RCC_CR_HSERDY        (1u << 17)
#define RCC_CR_PLLON         (1u << 24)
#define RCC_CR_PLLRDY        (1u << 25)
#define RCC_CFGR_SW_PLL      0x2u
#define RCC_CFGR_SWS         0xCu
#define RCC_CFGR_SWS_PLL     0x8u
#define RCC_AHB1_GPIO_A_TO_D 0xFu
#define RCC_APB1_TIM2        (1u << 0)
#define RCC_APB1_UARTS       (0xFu << 17) /* USART2, USART3, UART4, UART5 */
#define RCC_APB2_USART1      (1u << 4)

typedef struct {
    volatile uint32_t MODER, OTYPER, OSPEEDR, PUPDR, IDR, ODR, BSRR, LCKR, AFR[2];
} gpio_t;
#define GPIO(port) ((gpio_t *)(0x40020000u + 0x400u * (uint32_t)((port) - 'A')))

typedef struct {
    volatile uint32_t SR, DR, BRR, CR1, CR2, CR3, GTPR;
} usart_t;
#define USART1 ((usart_t *)0x40011000u)
#define USART2 ((usart_t *)0x40004400u)
#define USART3 ((usart_t *)0x40004800u)
#define UART4  ((usart_t *)0x40004C00u)
#define UART5  ((usart_t *)0x40005000u)

#define USART_SR_ORE     (1u << 3)
#define USART_SR_RXNE    (1u << 5)
#define USART_SR_TXE     (1u << 7)
#define USART_CR1_RE     (1u << 2)
#define USART_CR1_TE     (1u << 3)
#define USART_CR1_RXNEIE (1u << 5)
#define USART_CR1_TXEIE  (1u << 7)
#define USART_CR1_UE     (1u << 13)

/* TIM2: 32 bits, counts up; channels 1 and 2 capture edges. */
typedef struct {
    volatile uint32_t CR1, CR2, SMCR, DIER, SR, EGR, CCMR1, CCMR2, CCER, CNT, PSC, ARR, unused, CCR1, CCR2, CCR3, CCR4;
} timer_t;
#define TIM2              ((timer_t *)0x40000000u)
#define STM32_TICK_HZ     4000000u /* both timer clocks are multiples of it */
#define STM32_NS_PER_TICK (1000000000u / STM32_TICK_HZ)

/* Interrupt numbers. */
#define USART1_IRQ 37u
#define USART2_IRQ 38u
#define USART3_IRQ 39u
#define UART4_IRQ  52u
#define UART5_IRQ  53u
#define N_IRQS     82u

/* Clocks as stm32_clocks_start() left them. */
typedef struct {
    uint32_t core_hz, apb1_hz, apb2_hz, timer_hz;
} stm32_clocks_t;

/* 168 MHz from the 8 MHz crystal; 16 MHz from the internal oscillator if the crystal does not start. */
void stm32_clocks_start(void);
const stm32_clocks_t *stm32_clocks(void);

/* When TIM2 stood at this count, at most half a turn ago. */
int64_t stm32_clock_at_ns(uint32_t count);

void stm32_watchdog_start(void);

/* Pin of GPIO port 'A'.. as alternate function af, pulled up. */
void stm32_pin(char port, uint32_t pin, uint32_t af);

/* Interrupt handlers. */
void usart1_irq(void);
void usart2_irq(void);
void usart3_irq(void);
void uart4_irq(void);
void uart5_irq(void);

#endif
