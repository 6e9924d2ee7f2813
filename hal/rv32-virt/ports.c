/* ports.c - the serial ports of hal.h on QEMU's virt board. It has one UART: ROVER receives on it, OUT sends. The other ports are silent;
 * neither PPS nor event input. */
#include "ring.h"
#include "virt.h"

#define ROVER_RING 8192u
#define OUT_RING   8192u

static uint8_t rover_bytes[ROVER_RING], out_bytes[OUT_RING];
static ring_t received = {rover_bytes, ROVER_RING, 0, 0, 0}, sent = {out_bytes, OUT_RING, 0, 0, 0};

/* Send what the transmitter takes; it interrupts when it takes more. With interrupts off, or from the interrupt. */
static void transmit(void)
{
    uint8_t byte;
    while ((UART_STATUS & UART_TX_EMPTY) != 0 && ring_get(&sent, &byte)) { UART_DATA = byte; }
    UART_INT = (sent.tail == sent.head) ? UART_INT_RX : (UART_INT_RX | UART_INT_TX);
}

void uart_irq(void)
{
    uint8_t status = UART_STATUS;
    while ((status & UART_RX_READY) != 0) {
        if ((status & UART_RX_OVERRUN) != 0) { received.lost++; }
        if (!ring_put(&received, UART_DATA)) { received.lost++; }
        status = UART_STATUS;
    }
    transmit();
}

static void interrupts_off(void)
{
    __asm volatile("csrci mstatus, 8" ::: "memory");
}

static void interrupts_on(void)
{
    __asm volatile("csrsi mstatus, 8" ::: "memory");
}

bool hal_init(void)
{
    board_clock_start();
    UART_LINE = UART_8N1 | UART_DIVISOR;
    UART_REGISTER(0) = 1; /* the fastest: 230400 baud */
    UART_REGISTER(1) = 0;
    UART_LINE = UART_8N1;
    UART_FIFO = 0x07; /* on, emptied */
    UART_INT = UART_INT_RX;
    PLIC_PRIORITY(UART_IRQ) = 1;
    PLIC_THRESHOLD = 0;
    PLIC_ENABLE = 1u << UART_IRQ;
    virt_wake();
    __asm volatile("csrs mie, %0" ::"r"(MIE_TIMER | MIE_EXTERN));
    interrupts_on();
    return true;
}

bool hal_running(void)
{
    return true;
}

size_t hal_read(hal_port_t port, uint8_t *buf, size_t cap)
{
    return (port == HAL_PORT_ROVER) ? ring_read(&received, buf, cap) : 0;
}

uint32_t hal_overruns(hal_port_t port)
{
    return (port == HAL_PORT_ROVER) ? received.lost : 0;
}

size_t hal_write(hal_port_t port, const uint8_t *buf, size_t n)
{
    if (port != HAL_PORT_OUT) { return 0; }
    const size_t taken = ring_write(&sent, buf, n);
    interrupts_off();
    transmit();
    interrupts_on();
    return taken;
}

void hal_idle(void)
{
    __asm volatile("wfi" ::: "memory");
}
