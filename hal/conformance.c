/* conformance.c - does a board keep what hal.h asks? Link it with the board's files in the place of main.c and read its OUT port:
 *
 *   PASS what: detail      it does
 *   FAIL what: detail      it does not
 *   NONE what: detail      the board has none, or nothing is connected
 *   DONE
 *
 * Join OUT's transmit pin with the receive pin of each input port first. At the end the watchdog is left alone: the board restarts, and
 * the lines go on where they were. docs/PORTING.md tells more. */
#include <string.h>

#include "hal.h"
#include "pelorus/bits.h"
#include "pelorus/math.h"

#define MS       INT64_C(1000000)
#define RESTARTS 0x57444F47u

/* Outlives a restart: neither loaded nor cleared. */
static uint32_t restarts __attribute__((section(".noinit")));

/* ---- saying it ------------------------------------------------------------------------------------------------------ */

static void put(const char *text)
{
    size_t n = strlen(text);
    const int64_t give_up_ns = hal_clock_ns() + 1000 * MS;
    while (n > 0 && hal_clock_ns() < give_up_ns) {
        const size_t taken = hal_write(HAL_PORT_OUT, (const uint8_t *)text, n);
        text += taken;
        n -= taken;
        hal_watchdog_kick();
    }
}

static void put_number(int64_t value)
{
    char digits[21];
    int at = 20;
    uint64_t v = (value < 0) ? 0u - (uint64_t)value : (uint64_t)value;
    digits[at] = '\0';
    do {
        digits[--at] = (char)('0' + (char)(v % 10u));
        v /= 10u;
    } while (v > 0);
    if (value < 0) { put("-"); }
    put(&digits[at]);
}

typedef enum { PASS, FAIL, NONE } verdict_t;

/* One line: "PASS clock: 12 ns". */
static void say(verdict_t verdict, const char *what, const char *detail, int64_t value, const char *unit)
{
    static const char *const WORD[] = {"PASS ", "FAIL ", "NONE "};
    put(WORD[verdict]);
    put(what);
    put(": ");
    put(detail);
    if (unit != NULL) {
        put(" ");
        put_number(value);
        put(unit);
    }
    put("\r\n");
}

static void wait_ms(int64_t ms)
{
    const int64_t end_ns = hal_clock_ns() + ms * MS;
    while (hal_clock_ns() < end_ns) { hal_watchdog_kick(); }
}

/* ---- clock ---------------------------------------------------------------------------------------------------------- */

static void check_clock(void)
{
    int64_t before = hal_clock_ns(), smallest = INT64_MAX, back = 0;
    const int64_t start = before;
    for (int i = 0; i < 200000 && before - start < 20 * MS; i++) {
        const int64_t now = hal_clock_ns();
        if (now < before) { back++; }
        if (now > before && now - before < smallest) { smallest = now - before; }
        before = now;
    }
    if (before == start) {
        say(FAIL, "clock", "stands still", 0, NULL);
        return;
    }
    say((back == 0) ? PASS : FAIL, "clock never goes back", "steps back", back, NULL);
    say((smallest <= 100000) ? PASS : FAIL, "clock tells 100 us apart", "smallest step", smallest, " ns");

    const int64_t asleep = hal_clock_ns();
    hal_idle();
    say((hal_clock_ns() > asleep) ? PASS : FAIL, "clock goes on while idle", "ns", hal_clock_ns() - asleep, "");
}

/* ---- arithmetic ------------------------------------------------------------------------------------------------------ */

#define PAIRS           4000
#define ARITHMETIC_HASH 0x760EF15Fu

static uint64_t random_bits(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

/* Exponent within 2^-40 .. 2^40, now and then few digits. */
static double random_double(uint64_t *state)
{
    const uint64_t r = random_bits(state);
    uint64_t fraction = random_bits(state) & UINT64_C(0xFFFFFFFFFFFFF);
    if ((r & 7u) == 0) { fraction &= UINT64_C(0xFFFFFFFF00000); }
    return pel_f64_from_bits((r & (UINT64_C(1) << 63)) | (1023 - 40 + (r >> 8) % 81) << 52 | fraction);
}

static uint32_t hash_double(uint32_t h, double x)
{
    return pel_fnv1a((const uint8_t *)&x, sizeof x, h);
}

/* Additions, products, quotients, roots and conversions of both kinds, each rounded once: the promise of equal bytes rests on them. */
static void check_arithmetic(void)
{
    uint64_t state = UINT64_C(88172645463325252);
    uint32_t h = PEL_FNV_START;
    for (int i = 0; i < PAIRS; i++) {
        const double a = random_double(&state), b = random_double(&state);
        const float x = (float)a, y = (float)b;
        h = hash_double(h, a + b);
        h = hash_double(h, a - b);
        h = hash_double(h, a * b);
        h = hash_double(h, a / b);
        h = hash_double(h, pel_sqrt(pel_fabs(a)));
        h = hash_double(h, (double)(x + y));
        h = hash_double(h, (double)(x * y - x));
        h = hash_double(h, (double)(x / y));
        h = hash_double(h, (double)pel_sqrtr((x < 0.0f) ? -x : x));
        h = hash_double(h, (double)(int64_t)a);
    }
    const bool same = h == ARITHMETIC_HASH;
    say(same ? PASS : FAIL, "arithmetic rounds as IEEE 754 says",
        same ? "hash" : "docs/PORTING.md, Floating point; hash", (int64_t)h, "");
}

/* ---- ports ----------------------------------------------------------------------------------------------------------- */

#define LOOP_BYTES 400 /* what the smallest ring of the boards here holds */
#define LOOP_MS    2000

static const char *const PORT[] = {"port IMU", "port ROVER", "port BASE", "port AUX1"};
#define INPUTS 4

static uint8_t pattern(uint32_t i)
{
    return (uint8_t)(i * 31u + (i >> 8) * 7u + 1u); /* begins with 1, which is in no text */
}

static uint32_t send_pattern(void)
{
    uint8_t buf[64];
    uint32_t sent = 0;
    const int64_t give_up_ns = hal_clock_ns() + LOOP_MS * MS;
    while (sent < LOOP_BYTES && hal_clock_ns() < give_up_ns) {
        const uint32_t n = (LOOP_BYTES - sent < sizeof buf) ? LOOP_BYTES - sent : sizeof buf;
        for (uint32_t i = 0; i < n; i++) { buf[i] = pattern(sent + i); }
        sent += (uint32_t)hal_write(HAL_PORT_OUT, buf, n);
        hal_watchdog_kick();
    }
    return sent;
}

/* What OUT sends comes back on the inputs. For the first 50 ms nobody reads: the interrupts must keep what comes, as they do while an epoch
 * is worked on. */
static void check_ports(void)
{
    uint32_t came[INPUTS] = {0}, wrong[INPUTS] = {0};
    const uint32_t sent = send_pattern();
    wait_ms(50);
    int64_t end_ns = hal_clock_ns() + LOOP_MS * MS;
    while (hal_clock_ns() < end_ns) {
        for (int p = 0; p < INPUTS; p++) {
            uint8_t buf[64];
            const size_t n = hal_read((hal_port_t)p, buf, sizeof buf);
            if (n > 0) { end_ns = hal_clock_ns() + LOOP_MS * MS; }
            for (size_t i = 0; i < n; i++) {
                if (came[p] == 0 && buf[i] != pattern(0)) { continue; } /* what was said before comes back too */
                wrong[p] += (buf[i] != pattern(came[p]++)) ? 1u : 0u;
            }
        }
        hal_watchdog_kick();
    }
    put("\r\n");
    say((sent == LOOP_BYTES) ? PASS : FAIL, "port OUT", "bytes taken", sent, "");
    for (int p = 0; p < INPUTS; p++) {
        const bool whole = came[p] == LOOP_BYTES && wrong[p] == 0 && hal_overruns((hal_port_t)p) == 0;
        if (came[p] == 0) {
            say(NONE, PORT[p], "nothing came back", 0, NULL);
        } else {
            say(whole ? PASS : FAIL, PORT[p], "bytes came back", came[p], "");
            if (wrong[p] > 0) { say(FAIL, PORT[p], "bytes not those sent:", wrong[p], ""); }
        }
    }
}

/* ---- store ----------------------------------------------------------------------------------------------------------- */

#define STORE_BYTES 3000
static uint8_t stored[STORE_BYTES], read_back[STORE_BYTES];

static size_t write_slot(int slot, uint32_t seed, size_t n)
{
    for (size_t i = 0; i < n; i++) { stored[i] = pattern(seed + (uint32_t)i); }
    return hal_store_write(slot, stored, n);
}

static bool slot_holds(int slot, uint32_t seed, size_t n)
{
    memset(read_back, 0, sizeof read_back);
    if (hal_store_read(slot, read_back, sizeof read_back) != n) { return false; }
    for (size_t i = 0; i < n; i++) {
        if (read_back[i] != pattern(seed + (uint32_t)i)) { return false; }
    }
    return true;
}

static void check_store(void)
{
    const size_t first = write_slot(0, 11, 100), second = write_slot(1, 22, STORE_BYTES);
    if (first == 0 && second == 0) {
        say(NONE, "store", "nothing can be written", 0, NULL);
        return;
    }
    const bool kept = first == 100 && second == STORE_BYTES && slot_holds(0, 11, 100) && slot_holds(1, 22, STORE_BYTES);
    say(kept ? PASS : FAIL, "store keeps two slots", "bytes", (int64_t)(first + second), "");
    const bool rewritten = write_slot(0, 33, 37) == 37 && slot_holds(0, 33, 37);
    say(rewritten ? PASS : FAIL, "store slot is written again", "the old is gone", 0, NULL);
    say(slot_holds(1, 22, STORE_BYTES) ? PASS : FAIL, "store leaves the other slot alone", "slot", 1, "");

    const bool voided = write_slot(0, 44, 50) == 50 && hal_store_void(0) && !slot_holds(0, 44, 50) &&
                        slot_holds(1, 22, STORE_BYTES) && write_slot(0, 33, 37) == 37 && slot_holds(0, 33, 37);
    say(voided ? PASS : FAIL, "store slot is void when told", "and written again", 0, NULL);

    uint8_t small[8] = {0};
    const bool refused = hal_store_read(1, small, sizeof small) == 0 && hal_store_read(-1, small, sizeof small) == 0 &&
                         hal_store_write(-1, small, sizeof small) == 0 &&
                         hal_store_write(1000, small, sizeof small) == 0;
    say(refused ? PASS : FAIL, "store refuses what does not fit", "small buffer, slots -1 and 1000", 0, NULL);
}

/* ---- pulses, time, configuration --------------------------------------------------------------------------------------- */

static void check_pulses(void)
{
    int64_t at_ns = 0;
    uint32_t id = 0;
    bool pps = false, event = false;
    const int64_t start_ns = hal_clock_ns();
    while (hal_clock_ns() < start_ns + 1200 * MS && !(pps && event)) {
        pps = pps || hal_pps(&at_ns);
        event = event || hal_event(&at_ns, &id);
        hal_watchdog_kick();
    }
    say(pps ? PASS : NONE, "PPS", pps ? "came" : "no pulse in 1.2 s", 0, NULL);
    say(event ? PASS : NONE, "event", event ? "came" : "no edge in 1.2 s", 0, NULL);
    if (pps || event) {
        const int64_t age = hal_clock_ns() - at_ns;
        say((age >= 0 && age < 3000 * MS) ? PASS : FAIL, "pulses are told in the clock's time", "age", age, " ns");
    }
}

static void check_start_values(void)
{
    const pel_time_t t = hal_gps_time();
    const bool sane = t > INT64_C(1200000000) * PEL_NS_PER_S && t < INT64_C(4000000000) * PEL_NS_PER_S;
    say((t == 0) ? NONE : (sane ? PASS : FAIL), "GPS time", (t == 0) ? "not known" : "seconds", t / PEL_NS_PER_S,
        (t == 0) ? NULL : "");

    pel_nav_config_t cfg;
    pel_nav_config_default(&cfg);
    if (!hal_load_config(&cfg)) {
        say(NONE, "configuration", "nothing stored", 0, NULL);
        return;
    }
    const bool usable = cfg.preset < PEL_N_PRESETS && cfg.mask_rad >= 0.0 && cfg.mask_rad < 1.6 &&
                        pel_isfinite(cfg.lever_ba_b[0]) && pel_isfinite(cfg.lever_ba_b[1]) &&
                        pel_isfinite(cfg.lever_ba_b[2]);
    say(usable ? PASS : FAIL, "configuration", "stored", 0, NULL);
}

/* ---- watchdog -------------------------------------------------------------------------------------------------------- */

#define HANG_MS 10000

static void check_watchdog(void)
{
    put("watchdog: silent for 10 s, the board should restart\r\n");
    wait_ms(200); /* until that is sent */
    restarts = RESTARTS;
    const int64_t end_ns = hal_clock_ns() + HANG_MS * MS;
    while (hal_clock_ns() < end_ns) { hal_idle(); }
    restarts = 0;
    say(NONE, "watchdog", "did not restart the board", 0, NULL);
}

static void after_restart(void)
{
    restarts = 0;
    put("\r\n");
    say(PASS, "watchdog", "restarted the board", 0, NULL);
    const bool none =
        hal_store_read(0, read_back, sizeof read_back) == 0 && hal_store_read(1, read_back, sizeof read_back) == 0;
    if (none) { return; }
    say((slot_holds(0, 33, 37) && slot_holds(1, 22, STORE_BYTES)) ? PASS : FAIL, "store outlives a restart", "slots", 2,
        "");
}

void firmware_main(void)
{
    if (restarts == RESTARTS) {
        after_restart();
    } else {
        put("\r\nPelorus board conformance\r\n");
        check_clock();
        check_arithmetic();
        check_ports();
        check_store();
        check_pulses();
        check_start_values();
        check_watchdog();
    }
    put("DONE\r\n");
    for (;;) {
        hal_watchdog_kick();
        hal_idle();
    }
}
