/* store.c - two slots in the last two sectors of flash, 128 KB each (RM0090 chapter 3). The linker script keeps code out of them.
 *
 * A slot is its payload, then length, check and a word that is written last: cut short, it does not count. Flash clears bits without an
 * erase: a slot is void when that word is zero. Erasing takes one to two
 * seconds in which the core stands still: write while the product does, never in motion. */
#include <stddef.h>
#include <string.h>

#include "pelorus/bits.h"
#include "stm32.h"

#define SLOTS      2
#define SECTOR     10u /* of slot 0 */
#define SLOT_BYTES 0x20000u
#define SLOT_BASE  0x080C0000u
#define COMPLETE   0x50454C21u
#define PATIENCE   40000000u /* turns: well above the two seconds of an erase, below the watchdog's four */

#define FLASH_BUSY  (1u << 16)
#define FLASH_BAD   0xF2u /* every error flag */
#define FLASH_PG    (1u << 0)
#define FLASH_SER   (1u << 1)
#define FLASH_X32   (2u << 8)
#define FLASH_START (1u << 16)
#define FLASH_LOCK  (1u << 31)

typedef struct {
    uint32_t length, check, complete;
} trailer_t;

#define TRAILER(slot) (SLOT_BASE + SLOT_BYTES * ((uint32_t)(slot) + 1u) - (uint32_t)sizeof(trailer_t))

static bool finished(void)
{
    for (uint32_t i = 0; i < PATIENCE; i++) {
        if ((FLASH_SR & FLASH_BUSY) == 0) { return (FLASH_SR & FLASH_BAD) == 0; }
    }
    return false;
}

static bool erase(int slot)
{
    FLASH_CR = FLASH_SER | FLASH_X32 | (SECTOR + (uint32_t)slot) << 3;
    FLASH_CR |= FLASH_START;
    return finished();
}

static bool program(uint32_t address, const void *from, size_t n)
{
    const uint8_t *bytes = from;
    FLASH_CR = FLASH_PG | FLASH_X32;
    for (size_t i = 0; i < n; i += 4) {
        uint32_t word = UINT32_MAX;
        memcpy(&word, bytes + i, (n - i < 4) ? n - i : 4);
        REGISTER(address + (uint32_t)i) = word;
        if (!finished() || REGISTER(address + (uint32_t)i) != word) { return false; }
    }
    return true;
}

static void unlock(void)
{
    FLASH_KEYR = 0x45670123u;
    FLASH_KEYR = 0xCDEF89ABu;
    FLASH_SR = FLASH_BAD;
}

size_t hal_store_read(int slot, uint8_t *buf, size_t cap)
{
    trailer_t t;
    if (slot < 0 || slot >= SLOTS) { return 0; }
    const uint8_t *payload = (const uint8_t *)(uintptr_t)(SLOT_BASE + SLOT_BYTES * (uint32_t)slot);
    memcpy(&t, (const void *)(uintptr_t)TRAILER(slot), sizeof t);
    if (t.complete != COMPLETE || t.length > cap || t.length > SLOT_BYTES - sizeof t) { return 0; }
    if (pel_fnv1a(payload, t.length, PEL_FNV_START) != t.check) { return 0; }
    memcpy(buf, payload, t.length);
    return t.length;
}

size_t hal_store_write(int slot, const uint8_t *buf, size_t n)
{
    if (slot < 0 || slot >= SLOTS || n == 0 || n > SLOT_BYTES - sizeof(trailer_t)) { return 0; }
    const trailer_t t = {(uint32_t)n, pel_fnv1a(buf, n, PEL_FNV_START), COMPLETE};
    unlock();
    const bool ok =
        erase(slot) && program(SLOT_BASE + SLOT_BYTES * (uint32_t)slot, buf, n) && program(TRAILER(slot), &t, sizeof t);
    FLASH_CR = FLASH_LOCK;
    return ok ? n : 0;
}

bool hal_store_void(int slot)
{
    const uint32_t no = 0;
    if (slot < 0 || slot >= SLOTS) { return false; }
    unlock();
    const bool ok = program(TRAILER(slot) + (uint32_t)offsetof(trailer_t, complete), &no, sizeof no);
    FLASH_CR = FLASH_LOCK;
    return ok;
}
