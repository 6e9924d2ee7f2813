/* clock.c - clock tree, time and watchdog of the STM32F405. */
#include "stm32.h"

#define PATIENCE 100000u /* turns of a waiting loop: tens of ms */

/* What the timers count at without the crystal; an emulator has its own idea of it (board.cmake). */
#ifndef STM32_INTERNAL_TIMER_HZ
#define STM32_INTERNAL_TIMER_HZ 16000000u
#endif

static stm32_clocks_t clocks;
static int64_t ticks; /* of TIM2 since board_clock_start() */
static uint32_t last_count;

static bool wait_for(volatile uint32_t *reg, uint32_t mask, uint32_t value)
{
    for (uint32_t i = 0; i < PATIENCE; i++) {
        if ((*reg & mask) == value) { return true; }
    }
    return false;
}

/* Crystal 8 MHz / 8 x 336 / 2 = 168 MHz; APB1 a quarter, APB2 half of it; timers on APB1 run at twice its clock. */
static bool start_pll(void)
{
    RCC_CR |= RCC_CR_HSEON;
    if (!wait_for(&RCC_CR, RCC_CR_HSERDY, RCC_CR_HSERDY)) { return false; }
    FLASH_ACR = 5u | 7u << 8; /* wait states of 168 MHz; prefetch, both caches */
    RCC_PLLCFGR = 8u | 336u << 6 | 0u << 16 | 1u << 22 | 7u << 24;
    RCC_CFGR = 5u << 10 | 4u << 13;
    RCC_CR |= RCC_CR_PLLON;
    if (!wait_for(&RCC_CR, RCC_CR_PLLRDY, RCC_CR_PLLRDY)) { return false; }
    RCC_CFGR |= RCC_CFGR_SW_PLL;
    return wait_for(&RCC_CFGR, RCC_CFGR_SWS, RCC_CFGR_SWS_PLL);
}

void stm32_clocks_start(void)
{
    if (start_pll()) {
        clocks = (stm32_clocks_t){168000000u, 42000000u, 84000000u, 84000000u};
    } else {
        RCC_CFGR = 0; /* the internal oscillator, undivided */
        clocks = (stm32_clocks_t){16000000u, 16000000u, 16000000u, STM32_INTERNAL_TIMER_HZ};
    }
}

const stm32_clocks_t *stm32_clocks(void)
{
    return &clocks;
}

/* Channels 1 and 2 keep the count of their last rising edge (pulses.c). */
void board_clock_start(void)
{
    if (clocks.core_hz == 0) { stm32_clocks_start(); }
    RCC_APB1ENR |= RCC_APB1_TIM2;
    TIM2->PSC = clocks.timer_hz / STM32_TICK_HZ - 1;
    TIM2->ARR = UINT32_MAX;
    TIM2->CCMR1 = 1u | 1u << 8;
    TIM2->CCER = 1u | 1u << 4;
    TIM2->EGR = 1; /* take the prescaler over */
    TIM2->SR = 0;
    TIM2->CR1 = 1;
    last_count = TIM2->CNT;
}

/* The timer wraps every 1073 s; the main loop's watchdog kicks keep the count whole. */
int64_t hal_clock_ns(void)
{
    const uint32_t count = TIM2->CNT;
    ticks += count - last_count;
    last_count = count;
    return ticks * STM32_NS_PER_TICK;
}

/* When the timer stood at this count, at most half a turn ago. */
int64_t stm32_clock_at_ns(uint32_t count)
{
    (void)hal_clock_ns();
    return (ticks - (int64_t)(last_count - count)) * STM32_NS_PER_TICK;
}

/* 4 s of the 32 kHz oscillator; it cannot be stopped again. */
void stm32_watchdog_start(void)
{
    IWDG_KR = 0x5555u;
    IWDG_PR = 4; /* 64 */
    IWDG_RLR = 4u * 32000u / 64u;
    IWDG_KR = 0xCCCCu;
}

void hal_watchdog_kick(void)
{
    IWDG_KR = 0xAAAAu;
    (void)hal_clock_ns();
}
