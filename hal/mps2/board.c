/* board.c - hal.h on the MPS2 boards AN386 (Cortex-M4F) and AN500 (Cortex-M7).
 *
 * Ports: OUT = UART0 sending, IMU = UART1, ROVER = UART2, BASE = UART3, AUX1 = UART4 receiving; 921600 baud. Interrupts move
 * bytes between the UARTs and one ring a port. The boards have no PPS, no event input and no non-volatile store. */
#include "cmsdk.h"
#include "mps2.h"
#include "ring.h"

#define BAUD 921600u

/* Bytes each port can hold while the main loop is busy with an epoch: at 921600 baud 92 bytes arrive each millisecond. */
#define IMU_RING   8192u
#define ROVER_RING 8192u
#define BASE_RING  8192u
#define AUX1_RING  512u
#define OUT_RING   8192u

typedef struct {
    cmsdk_uart_t *uart;
    uint32_t irq;
    ring_t ring;
} port_t;

static uint8_t imu_bytes[IMU_RING], rover_bytes[ROVER_RING], base_bytes[BASE_RING], aux1_bytes[AUX1_RING],
    out_bytes[OUT_RING];

static port_t ports[HAL_N_PORTS] = {
    [HAL_PORT_IMU] = {UART1, UART1_RX_IRQ, {imu_bytes, IMU_RING, 0, 0, 0}},
    [HAL_PORT_ROVER] = {UART2, UART2_RX_IRQ, {rover_bytes, ROVER_RING, 0, 0, 0}},
    [HAL_PORT_BASE] = {UART3, UART3_RX_IRQ, {base_bytes, BASE_RING, 0, 0, 0}},
    [HAL_PORT_AUX1] = {UART4, UART4_RX_IRQ, {aux1_bytes, AUX1_RING, 0, 0, 0}},
    [HAL_PORT_OUT] = {UART0, UART0_RX_IRQ + 1, {out_bytes, OUT_RING, 0, 0, 0}},
};

static void receive(port_t *p)
{
    cmsdk_uart_t *u = p->uart;
    u->INT = UART_INT_RX;
    while ((u->STATE & UART_RX_FULL) != 0) {
        if (!ring_put(&p->ring, (uint8_t)u->DATA)) { p->ring.lost++; }
    }
    if ((u->STATE & UART_RX_OVERRUN) != 0) {
        u->STATE = UART_RX_OVERRUN;
        p->ring.lost++;
    }
}

/* Send what fits into the transmitter. With interrupts off, or from the interrupt. */
static void transmit(port_t *p)
{
    cmsdk_uart_t *u = p->uart;
    uint8_t byte;
    u->INT = UART_INT_TX;
    while ((u->STATE & UART_TX_FULL) == 0 && ring_get(&p->ring, &byte)) { u->DATA = byte; }
}

void uart_imu_irq(void)
{
    receive(&ports[HAL_PORT_IMU]);
}
void uart_rover_irq(void)
{
    receive(&ports[HAL_PORT_ROVER]);
}
void uart_base_irq(void)
{
    receive(&ports[HAL_PORT_BASE]);
}
void uart_aux1_irq(void)
{
    receive(&ports[HAL_PORT_AUX1]);
}
void uart_out_irq(void)
{
    transmit(&ports[HAL_PORT_OUT]);
}

bool hal_init(void)
{
    for (int i = 0; i < HAL_N_PORTS; i++) {
        port_t *p = &ports[i];
        p->uart->BAUDDIV = (PCLK_HZ + BAUD / 2) / BAUD;
        p->uart->CTRL = (i == HAL_PORT_OUT) ? (UART_CTRL_TX | UART_CTRL_TX_INT) : (UART_CTRL_RX | UART_CTRL_RX_INT);
        NVIC_ENABLE = 1u << p->irq;
    }
    board_clock_start();
    mps2_watchdog_start();
    mps2_wake_start();
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
    __asm volatile("cpsid i" ::: "memory"); /* an idle transmitter raises no interrupt by itself */
    transmit(&ports[port]);
    __asm volatile("cpsie i" ::: "memory");
    return taken;
}

void hal_idle(void)
{
    __asm volatile("wfi" ::: "memory");
}
