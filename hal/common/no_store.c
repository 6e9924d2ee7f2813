/* no_store.c - hal.h on a board that has no non-volatile store. */
#include "hal.h"

size_t hal_store_read(int slot, uint8_t *buf, size_t cap)
{
    (void)slot;
    (void)buf;
    (void)cap;
    return 0;
}

size_t hal_store_write(int slot, const uint8_t *buf, size_t n)
{
    (void)slot;
    (void)buf;
    (void)n;
    return 0;
}

bool hal_store_void(int slot)
{
    (void)slot;
    return true;
}
