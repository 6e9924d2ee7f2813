/* ports.c - the serial ports of hal.h on the STM32F405.
 *
 * OUT = USART1 sending (PA9), IMU = USART2 (PA3), ROVER = USART3 (PB11), BASE = UART4 (PA1), AUX1 = UART5 (PD2) receiving; 921600 baud.
 * PPS on PA15, event input on PB3. Interrupts move bytes between the USARTs and one ring a port. */
#include "ring.h"
#include "stm32.h"

#define BAUD    921600u
#define WAKE_HZ 10u

/* Bytes each port can hold while the main loop is busy with an epoch: at 921600 baud 92 bytes arrive each millisecond. The rings lie in
 * core-coupled memory (stm32f405.ld). */
#define IMU_RING   4096u
#define ROVER_RING 8192u
#define BASE_RING  8192u
#define AUX1_RING  512u
#define OUT_RING   8192u

typedef struct {
    usart_t *usart;
    uint32_t irq;
    ring_t ring;
} port_t;

static uint8_t imu_bytes[IMU_RING], rover_bytes[ROVER_RING], base_bytes[BASE_RING], aux1_bytes[AUX1_RING],
    out_bytes[OUT_RING];

static port_t ports[HAL_N_PORTS] = {
    [HAL_PORT_IMU] = {USART2, USART2_IRQ, {imu_bytes, IMU_RING, 0, 0, 0}},
    [HAL_PORT_ROVER] = {USART3, USART3_IRQ, {rover_bytes, ROVER_RING, 0, 0, 0}},
    [HAL_PORT_BASE] = {UART4, UART4_IRQ, {base_bytes, BASE_RING, 0, 0, 0}},
    [HAL_PORT_AUX1] = {UART5, UART5_IRQ, {aux1_bytes, AUX1_RING, 0, 0, 0}},
    [HAL_PORT_OUT] = {USART1, USART1_IRQ, {out_bytes, OUT_RING, 0, 0, 0}},
};

/* Reading the data register after the status clears an overrun as well. */
static void receive(port_t *p)
{
    const uint32_t status = p->usart->SR;
    if ((status & (USART_SR_RXNE | USART_SR_ORE)) == 0) { return; }
    const uint8_t byte = (uint8_t)p->usart->DR;
    if ((status & USART_SR_ORE) != 0) { p->ring.lost++; }
    if ((status & USART_SR_RXNE) != 0 && !ring_put(&p->ring, byte)) { p->ring.lost++; }
}

/* Send what the transmitter takes; it interrupts when it takes more. With interrupts off, or from the interrupt. */
static void transmit(port_t *p)
{
    usart_t *u = p->usart;
    uint8_t byte;
    while ((u->SR & USART_SR_TXE) != 0 && ring_get(&p->ring, &byte)) { u->DR = byte; }
    if (p->ring.tail == p->ring.head) {
        u->CR1 &= ~USART_CR1_TXEIE;
    } else {
        u->CR1 |= USART_CR1_TXEIE;
    }
}

void usart1_irq(void)
{
    transmit(&ports[HAL_PORT_OUT]);
}
void usart2_irq(void)
{
    receive(&ports[HAL_PORT_IMU]);
}
void usart3_irq(void)
{
    receive(&ports[HAL_PORT_ROVER]);
}
void uart4_irq(void)
{
    receive(&ports[HAL_PORT_BASE]);
}
void uart5_irq(void)
{
    receive(&ports[HAL_PORT_AUX1]);
}

void stm32_pin(char port, uint32_t pin, uint32_t af)
{
    gpio_t *g = GPIO(port);
    g->AFR[pin / 8] = (g->AFR[pin / 8] & ~(0xFu << 4 * (pin % 8))) | af << 4 * (pin % 8);
    g->PUPDR = (g->PUPDR & ~(3u << 2 * pin)) | 1u << 2 * pin;
    g->OSPEEDR |= 2u << 2 * pin;
    g->MODER = (g->MODER & ~(3u << 2 * pin)) | 2u << 2 * pin;
}

static void start_pins(void)
{
    RCC_AHB1ENR |= RCC_AHB1_GPIO_A_TO_D;
    stm32_pin('A', 9, 7);
    stm32_pin('A', 3, 7);
    stm32_pin('B', 11, 7);
    stm32_pin('A', 1, 8);
    stm32_pin('D', 2, 8);
    stm32_pin('A', 15, 1);
    stm32_pin('B', 3, 1);
}

bool hal_init(void)
{
    stm32_clocks_start();
    board_clock_start();
    start_pins();
    RCC_APB1ENR |= RCC_APB1_UARTS;
    RCC_APB2ENR |= RCC_APB2_USART1;
    for (int i = 0; i < HAL_N_PORTS; i++) {
        usart_t *u = ports[i].usart;
        const uint32_t hz = (u == USART1) ? stm32_clocks()->apb2_hz : stm32_clocks()->apb1_hz;
        u->BRR = (hz + BAUD / 2) / BAUD;
        u->CR1 = USART_CR1_UE | ((i == HAL_PORT_OUT) ? USART_CR1_TE : USART_CR1_RE | USART_CR1_RXNEIE);
        NVIC_ENABLE(ports[i].irq);
    }
    stm32_watchdog_start();
    SYSTICK_LOAD = stm32_clocks()->core_hz / WAKE_HZ - 1;
    SYSTICK_CTRL =
        7; /* count the core's clock, interrupt: the main loop keeps the watchdog quiet while no bytes arrive */
    return true;
}

bool hal_running(void)
{
    return true;
}

size_t hal_read(hal_port_t port, uint8_t *buf, size_t cap)
{
    return ring_read(&ports[port].ring, buf, cap);
}

uint32_t hal_overruns(hal_port_t port)
{
    return ports[port].ring.lost;
}

size_t hal_write(hal_port_t port, const uint8_t *buf, size_t n)
{
    const size_t taken = ring_write(&ports[port].ring, buf, n);
    __asm volatile("cpsid i" ::: "memory");
    transmit(&ports[port]);
    __asm volatile("cpsie i" ::: "memory");
    return taken;
}

void hal_idle(void)
{
    __asm volatile("wfi" ::: "memory");
}
