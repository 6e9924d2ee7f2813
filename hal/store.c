/* store.c - snapshots in the board's two store slots: the newer one is never written over, so that a write cut anywhere leaves a whole
 * one. */
#include "store.h"

#define N_SLOTS 2

static struct {
    int next_slot;
    uint32_t next_sequence;
    pel_time_t saved_ns;
    bool holds_one; /* a whole one may be in a slot */
} store;

/* The slot with the newest whole snapshot, or, if there is none, one that holds something else; -1: both are empty. */
static int find_newest(uint8_t *buf, size_t cap)
{
    int newest = -1, damaged = -1;
    uint32_t newest_sequence = 0;
    for (int slot = 0; slot < N_SLOTS; slot++) {
        uint32_t sequence = 0;
        const pel_snap_t what = pel_snapshot_check(buf, hal_store_read(slot, buf, cap), &sequence);
        if (what == PEL_SNAP_WAITING && (newest < 0 || (int32_t)(sequence - newest_sequence) > 0)) {
            newest = slot;
            newest_sequence = sequence;
        } else if (what != PEL_SNAP_NONE && what != PEL_SNAP_WAITING) {
            damaged = slot;
        }
    }
    store.next_slot = (newest == 0) ? 1 : 0;
    store.next_sequence = newest_sequence + 1;
    return (newest >= 0) ? newest : damaged;
}

void store_restore(pel_navigator_t *nav, uint8_t *buf, size_t cap)
{
    store.saved_ns = 0;
    const int slot = find_newest(buf, cap);
    store.holds_one = slot >= 0;
    if (slot >= 0) { (void)pel_snapshot_restore(nav, buf, hal_store_read(slot, buf, cap)); }
}

/* An attitude of before must not be found after a power cut under way. */
static void forget(void)
{
    bool all = true;
    for (int slot = 0; slot < N_SLOTS; slot++) { all = hal_store_void(slot) && all; }
    store.holds_one = !all;
}

void store_keep(const pel_navigator_t *nav, uint8_t *buf, size_t cap)
{
    if (store.holds_one && pel_snapshot_is_outlived(nav)) { forget(); }
    if (!pel_snapshot_is_due(nav, store.saved_ns)) { return; }
    const size_t n = pel_snapshot_encode(nav, store.next_sequence, buf, cap);
    if (n == 0) { return; }
    store.saved_ns = nav->at_horizon.t_ns; /* also after a failure: a worn store is not tried at each epoch */
    store.holds_one = true;
    if (hal_store_write(store.next_slot, buf, n) != n) { return; } /* the same slot again: it holds nothing whole now */
    store.next_slot = 1 - store.next_slot;
    store.next_sequence++;
}
