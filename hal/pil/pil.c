/* pil.c - processor in the loop: hal.h of a board in an emulator, with the ports on files of the machine that runs it.
 *
 * Reads the tape "in.tape" (tape.h) and writes the OUT port to "out.bin", both in the emulator's working directory. Start-up, clock,
 * watchdog and memory are the board's own. */
#include "cost.h"
#include "semihost.h"
#include "tape.h"

static struct {
    int32_t in, out;
    tape_header_t header;
    pel_nav_config_t config;
    hal_port_t port; /* of the record being served, HAL_N_PORTS before the first */
    uint32_t left;   /* its bytes not yet served */
    bool ended;
} pil;

static int32_t open_file(const char *path, size_t length, uint32_t mode)
{
    const uint32_t block[3] = {(uint32_t)(uintptr_t)path, mode, (uint32_t)length};
    return semihost(SEMIHOST_OPEN, block);
}

static uint32_t read_file(void *to, uint32_t n)
{
    const uint32_t block[3] = {(uint32_t)pil.in, (uint32_t)(uintptr_t)to, n};
    return n - (uint32_t)semihost(SEMIHOST_READ, block);
}

/* From a buffer: one call to the emulator fetches many records. */
static size_t take(uint8_t *to, size_t n)
{
    static uint8_t buffer[4096];
    static uint32_t filled, used;
    size_t got = 0;
    while (got < n) {
        if (used == filled) {
            filled = read_file(buffer, sizeof buffer);
            used = 0;
            if (filled == 0) { break; }
        }
        to[got++] = buffer[used++];
    }
    return got;
}

bool hal_init(void)
{
    pil.in = open_file("in.tape", sizeof "in.tape" - 1, SEMIHOST_MODE_READ);
    pil.out = open_file("out.bin", sizeof "out.bin" - 1, SEMIHOST_MODE_WRITE);
    pil.port = HAL_N_PORTS;
    if (pil.in < 0 || pil.out < 0 || take((uint8_t *)&pil.header, sizeof pil.header) != sizeof pil.header) {
        return false;
    }
    const uint32_t n = pil.header.config_bytes;
    if (pil.header.magic != TAPE_MAGIC || pil.header.layout != tape_layout() || n > sizeof pil.config) { return false; }
    if (take((uint8_t *)&pil.config, n) != n) { return false; }
    board_clock_start();
    return cost_start(open_file("cost.bin", sizeof "cost.bin" - 1, SEMIHOST_MODE_WRITE));
}

bool hal_running(void)
{
    if (pil.ended) { cost_finish(); }
    return !pil.ended;
}

size_t hal_read(hal_port_t port, uint8_t *buf, size_t cap)
{
    if (port != pil.port || pil.left == 0) { return 0; }
    const size_t n = take(buf, (pil.left < cap) ? pil.left : cap);
    pil.left -= (uint32_t)n;
    return n;
}

uint32_t hal_overruns(hal_port_t port)
{
    (void)port;
    return 0;
}

size_t hal_write(hal_port_t port, const uint8_t *buf, size_t n)
{
    (void)port;
    const uint32_t block[3] = {(uint32_t)pil.out, (uint32_t)(uintptr_t)buf, (uint32_t)n};
    return n - (size_t)semihost(SEMIHOST_WRITE, block);
}

pel_time_t hal_gps_time(void)
{
    return pil.header.gps_time_ns;
}

bool hal_load_config(pel_nav_config_t *cfg)
{
    if (pil.header.config_bytes == 0) { return false; }
    *cfg = pil.config;
    return true;
}

/* Nothing waits: the next record. A tape cut short ends where its last whole word is. */
void hal_idle(void)
{
    uint32_t word;
    if (take((uint8_t *)&word, sizeof word) != sizeof word) {
        pil.ended = true;
        return;
    }
    pil.port = (hal_port_t)(word >> 24);
    pil.left = word & TAPE_MAX_RUN;
}
