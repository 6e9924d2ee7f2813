/* store.c - two slots in the board's second flash: common flash interface, Intel's command set, two 16-bit chips side by side, blocks
 * of 256 KB (JEDEC JESD68.01; Intel 28F640J3 data sheet).
 *
 * A slot is length, check, payload, then a word that is written last: cut short, it does not count. Flash clears bits without an erase: a
 * slot is void when that word is zero. */
#include <string.h>

#include "pelorus/bits.h"
#include "virt.h"

#define SLOTS       2
#define BLOCK_WORDS 0x10000u
#define SLOT_CAP    (4u * (BLOCK_WORDS - 4u))
#define COMPLETE    0x50454C21u
#define PATIENCE    10000000u

/* Each command goes to both chips. */
#define BOTH(command)    ((command)*0x00010001u)
#define CFI_ERASE        BOTH(0x20u)
#define CFI_CONFIRM      BOTH(0xD0u)
#define CFI_PROGRAM      BOTH(0x40u)
#define CFI_CLEAR_STATUS BOTH(0x50u)
#define CFI_READ         BOTH(0xFFu)
#define CFI_READY        BOTH(0x80u)
#define CFI_BAD          BOTH(0x3Au)

enum { LENGTH = 0, CHECK = 1, PAYLOAD = 2, LAST = BLOCK_WORDS - 1 };

static volatile uint32_t *block(int slot)
{
    return (volatile uint32_t *)0x22000000u + BLOCK_WORDS * (uint32_t)slot;
}

static bool finished(volatile uint32_t *at)
{
    uint32_t status = 0;
    for (uint32_t i = 0; i < PATIENCE && (status & CFI_READY) != CFI_READY; i++) { status = *at; }
    return (status & (CFI_READY | CFI_BAD)) == CFI_READY;
}

static bool erase(volatile uint32_t *b)
{
    *b = CFI_CLEAR_STATUS;
    *b = CFI_ERASE;
    *b = CFI_CONFIRM;
    return finished(b);
}

static bool program(volatile uint32_t *at, uint32_t word)
{
    *at = CFI_PROGRAM;
    *at = word;
    return finished(at);
}

size_t hal_store_read(int slot, uint8_t *buf, size_t cap)
{
    if (slot < 0 || slot >= SLOTS) { return 0; }
    volatile uint32_t *b = block(slot);
    *b = CFI_READ;
    const uint32_t n = b[LENGTH];
    if (b[LAST] != COMPLETE || n > cap || n > SLOT_CAP) { return 0; }
    for (uint32_t i = 0; i < n; i += 4) {
        const uint32_t word = b[PAYLOAD + i / 4];
        memcpy(buf + i, &word, (n - i < 4) ? n - i : 4);
    }
    return (pel_fnv1a(buf, n, PEL_FNV_START) == b[CHECK]) ? n : 0;
}

size_t hal_store_write(int slot, const uint8_t *buf, size_t n)
{
    if (slot < 0 || slot >= SLOTS || n == 0 || n > SLOT_CAP) { return 0; }
    volatile uint32_t *b = block(slot);
    bool ok = erase(b) && program(&b[LENGTH], (uint32_t)n) && program(&b[CHECK], pel_fnv1a(buf, n, PEL_FNV_START));
    for (size_t i = 0; ok && i < n; i += 4) {
        uint32_t word = UINT32_MAX;
        memcpy(&word, buf + i, (n - i < 4) ? n - i : 4);
        ok = program(&b[PAYLOAD + i / 4], word);
    }
    ok = ok && program(&b[LAST], COMPLETE);
    *b = CFI_READ;
    return ok ? n : 0;
}

bool hal_store_void(int slot)
{
    if (slot < 0 || slot >= SLOTS) { return false; }
    volatile uint32_t *b = block(slot);
    const bool ok = program(&b[LAST], 0);
    *b = CFI_READ;
    return ok;
}
