/* cost.c - the linker sends every call of the functions below through a count (-Wl,--wrap=NAME), so neither they nor their callers
 * know. Time is the board's clock: in an emulator that advances it by the instruction, it counts instructions.
 *
 * Work inside work (a row inside an epoch) belongs to both; what counting it costs is taken off the outer one. */
#include "cost.h"

#include "internal.h" /* of the navigator: to apply an epoch is no public call */
#include "pelorus/wire.h"
#include "semihost.h"

#define SAMPLED_KINDS 4
#define PAINT         0xA5u
#define PAINT_MARGIN  256 /* bytes below this frame that painting itself may use */

static struct {
    int32_t file;
    bool counting;
    int64_t foreign;           /* ns spent on counting so far */
    int64_t inside;            /* ns that an empty piece of work seems to cost */
    int64_t outside;           /* ns of counting that a piece of work inside leaves in the outer one */
    uint32_t epochs;           /* applied */
    uint8_t depth[COST_KINDS]; /* work of a kind inside work of the same kind is counted once */
    uint32_t n_waiting;
    uint64_t waiting[512]; /* samples not yet in the file */
    uint64_t sum[COST_KINDS], count[COST_KINDS];
} cost;

typedef struct {
    int64_t start, foreign;
} mark_t;

static void put(const void *bytes, size_t n)
{
    const uint32_t block[3] = {(uint32_t)cost.file, (uint32_t)(uintptr_t)bytes, (uint32_t)n};
    (void)semihost(SEMIHOST_WRITE, block);
}

static inline mark_t enter(cost_kind_t kind)
{
    cost.depth[kind]++;
    const int64_t foreign = cost.foreign;
    return (mark_t){hal_clock_ns(), foreign};
}

static void note(cost_kind_t kind, int64_t ns)
{
    cost.sum[kind] += (uint64_t)ns;
    cost.count[kind]++;
    if (kind >= SAMPLED_KINDS) { return; }
    cost.waiting[cost.n_waiting++] = ((uint64_t)kind << 56) | (uint64_t)ns;
    if (cost.n_waiting == sizeof cost.waiting / sizeof cost.waiting[0]) {
        put(cost.waiting, sizeof cost.waiting);
        cost.n_waiting = 0;
    }
}

/* Work begun as one kind may end as another. */
static void leave(mark_t m, cost_kind_t begun, cost_kind_t kind)
{
    const int64_t now = hal_clock_ns();
    const bool outermost = --cost.depth[begun] == 0;
    if (cost.counting && outermost) {
        const int64_t ns = now - m.start - (cost.foreign - m.foreign) - cost.inside;
        note(kind, (ns > 0) ? ns : 0);
    }
    cost.foreign += hal_clock_ns() - now + cost.outside;
}

/* What counting an empty piece of work costs, seen from inside and from outside. Not static: as far away as what is counted. */
void cost_nothing(void);
void cost_nothing(void)
{
    const mark_t m = enter(COST_OTHER);
    leave(m, COST_OTHER, COST_OTHER);
}

static void calibrate(void)
{
    cost.counting = true;
    cost_nothing();
    cost.inside = (int64_t)cost.sum[COST_OTHER];
    const mark_t m = enter(COST_REPORT);
    cost_nothing();
    leave(m, COST_REPORT, COST_REPORT);
    cost.outside = (int64_t)cost.sum[COST_REPORT];
    for (int k = 0; k < COST_KINDS; k++) { cost.sum[k] = cost.count[k] = 0; }
}

static uint8_t *stack_floor(void)
{
    return (uint8_t *)&_estack - (size_t)(uintptr_t)_stack_size;
}

bool cost_start(int32_t file)
{
    uint8_t here;
    if (file < 0) { return false; }
    const uintptr_t top = (uintptr_t)&here - PAINT_MARGIN;
    for (volatile uint8_t *p = stack_floor(); (uintptr_t)p < top; p++) { *p = PAINT; }
    cost.file = file;
    calibrate();
    return true;
}

void cost_finish(void)
{
    const volatile uint8_t *p = stack_floor();
    while (*p == PAINT) { p++; }
    const uint64_t tail[2] = {(uint64_t)((uint8_t *)&_estack - p), COST_KINDS};
    put(cost.waiting, cost.n_waiting * sizeof cost.waiting[0]);
    put(cost.sum, sizeof cost.sum);
    put(cost.count, sizeof cost.count);
    put(tail, sizeof tail);
    cost.counting = false;
}

/* ---- what is counted ------------------------------------------------------------------------------------------------ */

/* The compiler holds each against the function's own declaration. */
#define DECLARE(name)                                                                                                  \
    __typeof__(name) __real_##name;                                                                                    \
    __typeof__(name) __wrap_##name;

#define COUNTED(kind, type, name, parameters, arguments)                                                               \
    DECLARE(name)                                                                                                      \
    type __wrap_##name parameters                                                                                      \
    {                                                                                                                  \
        const mark_t m = enter(kind);                                                                                  \
        const type result = __real_##name arguments;                                                                   \
        leave(m, kind, kind);                                                                                          \
        return result;                                                                                                 \
    }

#define COUNTED_VOID(kind, name, parameters, arguments)                                                                \
    DECLARE(name)                                                                                                      \
    void __wrap_##name parameters                                                                                      \
    {                                                                                                                  \
        const mark_t m = enter(kind);                                                                                  \
        __real_##name arguments;                                                                                       \
        leave(m, kind, kind);                                                                                          \
    }

/* A push is an epoch if it applied one, or a slice of one. */
#define COUNTED_PUSH(kind, name, type, arrived)                                                                        \
    DECLARE(name)                                                                                                      \
    void __wrap_##name(pel_navigator_t *nav, const type *arrived)                                                      \
    {                                                                                                                  \
        const uint32_t epochs = cost.epochs;                                                                           \
        const mark_t m = enter(kind);                                                                                  \
        __real_##name(nav, arrived);                                                                                   \
        leave(m, kind, (cost.epochs != epochs) ? COST_EPOCH : (kind));                                                 \
    }

DECLARE(pel_nav_begin_epoch)
void __wrap_pel_nav_begin_epoch(pel_navigator_t *nav, pel_epoch_t *rover, pel_epoch_t *base)
{
    cost.epochs++;
    __real_pel_nav_begin_epoch(nav, rover, base);
}

DECLARE(pel_nav_go_on)
void __wrap_pel_nav_go_on(pel_navigator_t *nav, int32_t max_nodes)
{
    cost.epochs++;
    __real_pel_nav_go_on(nav, max_nodes);
}

COUNTED_PUSH(COST_IMU_STEP, pel_navigator_push_imu, pel_imu_t, imu)
COUNTED_PUSH(COST_OTHER, pel_navigator_push_rover, pel_epoch_t, epoch)
COUNTED_PUSH(COST_OTHER, pel_navigator_push_base, pel_epoch_t, epoch)
COUNTED_PUSH(COST_OTHER, pel_navigator_push_ephemeris, pel_ephemeris_t, ephemeris)
COUNTED(COST_OTHER, pel_nav_output_t, pel_navigator_poll, (pel_navigator_t * nav), (nav))

COUNTED(COST_ROW, pel_status_t, pel_ud_update,
        (pel_ud_t * ud, const pel_real h[], int first, pel_real z, pel_real var, pel_real gate, pel_real *nis),
        (ud, h, first, z, var, gate, nis))

/* A slice is part of the integers' work, inside pel_amb_resolve_step() or alone. */
DECLARE(pel_ils_run)
pel_status_t __wrap_pel_ils_run(pel_ils_t *s, int32_t max_nodes)
{
    const mark_t integers = enter(COST_INTEGERS);
    const mark_t slice = enter(COST_SLICE);
    const pel_status_t status = __real_pel_ils_run(s, max_nodes);
    leave(slice, COST_SLICE, COST_SLICE);
    leave(integers, COST_INTEGERS, COST_INTEGERS);
    return status;
}
COUNTED(COST_INTEGERS, pel_status_t, pel_ils_init,
        (pel_ils_t * s, int n, const double *a, const double *Q, int n_best, int32_t budget),
        (s, n, a, Q, n_best, budget))
COUNTED(COST_INTEGERS, pel_status_t, pel_amb_resolve_step,
        (pel_amb_resolver_t * r, pel_amb_problem_t *p, pel_ils_t *s, int32_t max_nodes, int64_t *N,
         pel_int_verdict_t *v),
        (r, p, s, max_nodes, N, v))

COUNTED(COST_ORBITS, pel_status_t, pel_spp_solve,
        (const pel_epoch_t *e, const pel_orbits_t *o, const pel_spp_config_t *cfg, const pel_spp_t *start,
         pel_nav_counters_t *count, pel_view_t *view, pel_spp_t *spp),
        (e, o, cfg, start, count, view, spp))
COUNTED(COST_ORBITS, pel_status_t, pel_view_compute,
        (const pel_epoch_t *e, const pel_orbits_t *o, pel_time_t t_orbit_ns, const double r_ea_e[3],
         const double v_ea_e[3], double mask_rad, pel_nav_counters_t *count, pel_view_t *view),
        (e, o, t_orbit_ns, r_ea_e, v_ea_e, mask_rad, count, view))

COUNTED(COST_RECEIVE, pel_rx_event_t, pel_receiver_push, (pel_receiver_t * rx, uint8_t byte), (rx, byte))
COUNTED(COST_IMU_BYTE, pel_imu_event_t, pel_imu_stream_push, (pel_imu_stream_t * s, uint8_t byte), (s, byte))

#define COUNTED_REPORT(name, type)                                                                                     \
    COUNTED(COST_REPORT, size_t, name, (const type *s, uint8_t *out, size_t cap), (s, out, cap))
#define COUNTED_SENTENCE(name)                                                                                         \
    COUNTED(COST_REPORT, size_t, name, (const pel_solution_t *s, char *out, size_t cap), (s, out, cap))

COUNTED_REPORT(pel_out_encode_solution, pel_solution_t)
COUNTED_REPORT(pel_out_encode_used, pel_used_t)
COUNTED_REPORT(pel_out_encode_event, pel_event_t)
COUNTED(COST_REPORT, size_t, pel_out_encode_sats,
        (pel_time_t t, const pel_sat_report_t *s, int n, uint8_t *out, size_t cap), (t, s, n, out, cap))
COUNTED_SENTENCE(pel_nmea_gga)
COUNTED_SENTENCE(pel_nmea_rmc)
COUNTED_SENTENCE(pel_nmea_hdt)
