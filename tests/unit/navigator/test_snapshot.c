/* A power cut at any byte of a snapshot's way into the store leaves the old one or the new one; what is not ours is refused. */
#include <math.h>
#include <string.h>

#include "pelorus/bits.h"
#include "pelorus/math.h"
#include "pelorus/navigator.h"
#include "unity.h"

#include "../../../hal/store.c" /* the slots' protocol as the firmware has it */

#define T0         (INT64_C(1300000000) * PEL_NS_PER_S)
#define SLOT_BYTES 1100 /* the state and four ephemerides */

/* ---- a store whose power can be cut ------------------------------------------------------------------------------------ */

static uint8_t slot_bytes[2][SLOT_BYTES];
static size_t cut_after;  /* bytes that still get through */
static bool erases_first; /* as flash does; else bytes are written over the old ones */
static int last_slot_written;

size_t hal_store_read(int slot, uint8_t *buf, size_t cap)
{
    const size_t n = (cap < SLOT_BYTES) ? cap : SLOT_BYTES;
    memcpy(buf, slot_bytes[slot], n);
    return n;
}

size_t hal_store_write(int slot, const uint8_t *buf, size_t n)
{
    last_slot_written = slot;
    if (erases_first) { memset(slot_bytes[slot], 0xFF, SLOT_BYTES); }
    for (size_t i = 0; i < n; i++) {
        if (i == cut_after) { return i; }
        slot_bytes[slot][i] = buf[i];
    }
    return n;
}

bool hal_store_void(int slot)
{
    memset(slot_bytes[slot], 0xFF, SLOT_BYTES);
    return true;
}

/* ---- a navigator worth keeping ------------------------------------------------------------------------------------------- */

static pel_navigator_t nav, next_life;
static pel_nav_config_t cfg;
static uint8_t buf[SLOT_BYTES], whole[SLOT_BYTES];

static void at_rest(pel_time_t t_ns, double heading_rad)
{
    pel_real sd[PEL_MAX_STATES];
    pel_navigator_init(&nav, &cfg);
    pel_model_ins_ecef(&nav.model, &cfg.imu);
    for (int i = 0; i < nav.model.n; i++) { sd[i] = PEL_R(0.01) * (pel_real)(i + 1); }
    TEST_ASSERT_EQUAL_INT(PEL_OK, pel_ud_init(&nav.ud, nav.model.n, sd));
    nav.ins = nav.have_state = true;
    nav.at_horizon = (pel_strapdown_t){.t_ns = t_ns, .r_eb_e = {4.1e6, 8.4e5, 4.8e6}};
    const double turn[3] = {0.1, -0.2, heading_rad};
    pel_rotvec_to_dcm(turn, nav.at_horizon.C_b_e);
    nav.last_epoch_ns = t_ns;
    nav.warm.still_since_ns = t_ns - 20 * PEL_NS_PER_S;
    nav.errors.gyro_constant[1] = 1e-3;
    nav.errors.accel_markov[2] = -0.02;
    const pel_station_t station = {.id = 77, .r_ea_e = {4.1e6, 8.5e5, 4.8e6}};
    pel_navigator_push_station(&nav, &station);
    for (uint8_t prn = 1; prn <= 6; prn++) {
        const pel_ephemeris_t e = {.sys = PEL_SYS_GPS,
                                   .prn = prn,
                                   .toe_ns = t_ns,
                                   .toc_ns = t_ns,
                                   .sqrt_a = 5153.6,
                                   .e = 0.01,
                                   .i0 = 0.96,
                                   .M0 = 0.1 * prn,
                                   .af0 = 1e-5};
        pel_navigator_push_ephemeris(&nav, &e);
    }
}

static pel_snap_t restored(const uint8_t *bytes, size_t n)
{
    pel_navigator_init(&next_life, &cfg);
    return pel_snapshot_restore(&next_life, bytes, n);
}

void setUp(void)
{
    pel_nav_config_default(&cfg);
    cfg.lever_ba_b[0] = 0.5;
    memset(slot_bytes, 0xFF, sizeof slot_bytes);
    cut_after = SIZE_MAX;
    erases_first = false;
    at_rest(T0, 1.0);
}

void tearDown(void) {}

/* ---- claims ------------------------------------------------------------------------------------------------------------------ */

static void what_was_kept_comes_back(void)
{
    const size_t n = pel_snapshot_encode(&nav, 9, buf, sizeof buf);
    TEST_ASSERT_EQUAL_UINT(PEL_SNAPSHOT_BYTES + 4 * PEL_SNAPSHOT_EPH_BYTES, n);
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_WAITING, restored(buf, sizeof buf));
    const pel_snapshot_t *s = &next_life.warm.kept;
    double C_b_e[3][3];
    pel_rotvec_to_dcm(s->theta_b_e, C_b_e);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) { TEST_ASSERT_DOUBLE_WITHIN(1e-14, nav.at_horizon.C_b_e[i][j], C_b_e[i][j]); }
    }
    TEST_ASSERT_EQUAL_UINT32(9, s->sequence);
    TEST_ASSERT_EQUAL_INT64(T0, s->t_ns);
    TEST_ASSERT_EQUAL_FLOAT(20.0f, s->still_s);
    TEST_ASSERT_EQUAL_DOUBLE(1e-3, s->error[1]);
    TEST_ASSERT_EQUAL_DOUBLE(-0.02, s->error[8]);
    TEST_ASSERT_EQUAL_FLOAT(0.02f, s->sd_error[1]);
    TEST_ASSERT_TRUE(next_life.have_station);
    TEST_ASSERT_EQUAL_UINT16(77, next_life.station.id);
    TEST_ASSERT_EQUAL_INT(4, next_life.orbits.n);
    TEST_ASSERT_NOT_NULL(pel_orbits_find(&next_life.orbits, PEL_SYS_GPS, 6, T0)); /* the newest have the room */
    TEST_ASSERT_NULL(pel_orbits_find(&next_life.orbits, PEL_SYS_GPS, 1, T0));
}

static void a_glonass_orbit_comes_back(void)
{
    const pel_ephemeris_t e = {
        .sys = PEL_SYS_GLO,
        .prn = 3,
        .toe_ns = T0,
        .toc_ns = T0,
        .glo = {.r_e = {2.0e7, 1.0e7, 1.2e7}, .v_e = {100.0, 2000.0, 2500.0}, .a_e = {1e-6, 0, 0}, .k = -5}};
    cfg.systems |= 1u << PEL_SYS_GLO;
    at_rest(T0, 1.0);
    pel_navigator_push_ephemeris(&nav, &e);
    TEST_ASSERT_GREATER_THAN(0, pel_snapshot_encode(&nav, 1, buf, sizeof buf));
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_WAITING, restored(buf, sizeof buf));
    const pel_ephemeris_t *back = pel_orbits_find(&next_life.orbits, PEL_SYS_GLO, 3, T0);
    TEST_ASSERT_NOT_NULL(back);
    TEST_ASSERT_EQUAL_INT(-5, back->glo.k);
    TEST_ASSERT_EQUAL_DOUBLE(2500.0, back->glo.v_e[2]);
}

static void any_flipped_bit_is_damage(void)
{
    const size_t n = pel_snapshot_encode(&nav, 1, buf, sizeof buf);
    uint32_t sequence = 0;
    for (size_t bit = 0; bit < 8 * n; bit++) {
        buf[bit / 8] ^= (uint8_t)(1u << (bit % 8));
        TEST_ASSERT_EQUAL_INT(PEL_SNAP_DAMAGED, pel_snapshot_check(buf, sizeof buf, &sequence));
        buf[bit / 8] ^= (uint8_t)(1u << (bit % 8));
    }
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_WAITING, pel_snapshot_check(buf, sizeof buf, &sequence));
}

static void any_shorter_length_is_damage_or_nothing(void)
{
    const size_t n = pel_snapshot_encode(&nav, 1, buf, sizeof buf);
    uint32_t sequence = 0;
    for (size_t cut = 1; cut < n; cut++) {
        TEST_ASSERT_EQUAL_INT(PEL_SNAP_DAMAGED, pel_snapshot_check(buf, cut, &sequence));
    }
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_NONE, pel_snapshot_check(buf, 0, &sequence));
}

static void save(pel_time_t t_ns, double heading_rad)
{
    at_rest(t_ns, heading_rad);
    store_keep(&nav, buf, sizeof buf);
}

/* Two saves that went well, then one that is cut, then a start: what comes back is the second or the third, whole. */
static void cut_at_every_byte(int saves_before)
{
    pel_snapshot_t old, new;
    size_t n = SLOT_BYTES;
    for (size_t cut = 0; cut <= n; cut++) {
        memset(slot_bytes, 0xFF, sizeof slot_bytes);
        cut_after = SIZE_MAX;
        store_restore(&nav, buf, sizeof buf);
        for (int i = 1; i <= saves_before; i++) { save(T0 + i * 61 * PEL_NS_PER_S, 0.1 * i); }
        pel_navigator_init(&next_life, &cfg);
        store_restore(&next_life, buf, sizeof buf); /* another life, which begins with them */
        old = next_life.warm.kept;

        at_rest(T0 + 3600 * PEL_NS_PER_S, 2.0);
        n = pel_snapshot_encode(&nav, old.sequence + 1, whole, sizeof whole);
        TEST_ASSERT_EQUAL_INT(PEL_SNAP_WAITING, restored(whole, n));
        new = next_life.warm.kept;

        cut_after = cut;
        store_keep(&nav, buf, sizeof buf);
        cut_after = SIZE_MAX;
        pel_navigator_init(&next_life, &cfg);
        store_restore(&next_life, buf, sizeof buf);
        const bool is_new = memcmp(&next_life.warm.kept, &new, sizeof new) == 0;
        const bool is_old = memcmp(&next_life.warm.kept, &old, sizeof old) == 0;
        TEST_ASSERT_TRUE(is_new || is_old);
        TEST_ASSERT_EQUAL_INT(cut >= n, is_new);
        /* and the life after that writes where nothing whole is */
        save(T0 + 7200 * PEL_NS_PER_S, 3.0);
        pel_navigator_init(&next_life, &cfg);
        store_restore(&next_life, buf, sizeof buf);
        TEST_ASSERT_EQUAL_INT64(T0 + 7200 * PEL_NS_PER_S, next_life.warm.kept.t_ns);
    }
    TEST_ASSERT_GREATER_THAN(PEL_SNAPSHOT_BYTES, n);
}

static void a_power_cut_at_any_byte_written_over_leaves_old_or_new(void)
{
    cut_at_every_byte(1);
    TEST_ASSERT_EQUAL_INT(0, last_slot_written);
    cut_at_every_byte(2);
    cut_at_every_byte(3);
}

static void a_power_cut_at_any_byte_after_an_erase_leaves_old_or_new(void)
{
    erases_first = true;
    cut_at_every_byte(1);
    cut_at_every_byte(2);
    cut_at_every_byte(3);
}

static void a_failed_write_does_not_move_on_to_the_good_slot(void)
{
    store_restore(&nav, buf, sizeof buf);
    save(T0, 1.0);
    const int good = last_slot_written;
    cut_after = 50;
    save(T0 + 61 * PEL_NS_PER_S, 1.0);
    save(T0 + 122 * PEL_NS_PER_S, 1.0);
    TEST_ASSERT_NOT_EQUAL(good, last_slot_written);
}

static int kept(void)
{
    int n = 0;
    for (int slot = 0; slot < 2; slot++) {
        uint32_t sequence;
        n += pel_snapshot_check(slot_bytes[slot], SLOT_BYTES, &sequence) == PEL_SNAP_WAITING;
    }
    return n;
}

static void stand(double since_s, double now_s)
{
    at_rest(T0 + (pel_time_t)(now_s * 1e9), 1.0);
    nav.warm.still_since_ns = T0 + (pel_time_t)(since_s * 1e9);
    store_keep(&nav, buf, sizeof buf);
}

static void a_standstill_is_kept_once_and_again_after_an_hour(void)
{
    memset(slot_bytes, 0xFF, sizeof slot_bytes);
    store_restore(&nav, buf, sizeof buf);
    stand(0.0, 2.9);
    TEST_ASSERT_EQUAL_INT(0, kept());
    stand(0.0, 3.0);
    TEST_ASSERT_EQUAL_INT(1, kept());
    stand(0.0, 3602.9);
    TEST_ASSERT_EQUAL_INT(1, kept());
    stand(0.0, 3603.0);
    TEST_ASSERT_EQUAL_INT(2, kept());
}

static void motion_voids_what_is_kept_and_the_next_standstill_waits_for_its_minute(void)
{
    memset(slot_bytes, 0xFF, sizeof slot_bytes);
    store_restore(&nav, buf, sizeof buf);
    stand(0.0, 10.0);
    TEST_ASSERT_EQUAL_INT(1, kept());
    at_rest(T0 + 11 * PEL_NS_PER_S, 1.0);
    nav.warm.still_since_ns = 0;
    store_keep(&nav, buf, sizeof buf);
    TEST_ASSERT_EQUAL_INT(0, kept());
    stand(30.0, 69.9);
    TEST_ASSERT_EQUAL_INT(0, kept());
    stand(30.0, 70.0);
    TEST_ASSERT_EQUAL_INT(1, kept());

    store_restore(&nav, buf, sizeof buf); /* another life: GNSS alone sees it move */
    nav.ins = false;
    nav.at_horizon.v_eb_e[1] = 0.4;
    store_keep(&nav, buf, sizeof buf);
    TEST_ASSERT_EQUAL_INT(1, kept());
    nav.at_horizon.v_eb_e[1] = 0.6;
    store_keep(&nav, buf, sizeof buf);
    TEST_ASSERT_EQUAL_INT(0, kept());
}

static void reseal(size_t n)
{
    pel_le_put(buf + n - 4, 4, pel_crc32_novatel(buf, n - 4));
}

static void a_newer_version_is_refused_as_such(void)
{
    const size_t n = pel_snapshot_encode(&nav, 1, buf, sizeof buf);
    buf[4]++;
    reseal(n);
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_NEWER, restored(buf, n));
}

static void numbers_that_cannot_be_are_refused_whatever_the_checksum_says(void)
{
    const size_t n = pel_snapshot_encode(&nav, 1, buf, sizeof buf);
    uint8_t good[SLOT_BYTES];
    memcpy(good, buf, n);
    for (size_t at = 28; at + 8 < PEL_SNAPSHOT_BYTES; at += 4) { /* infinities and NaN over every field in turn */
        memcpy(buf, good, n);
        memset(buf + at, 0xFF, 8);
        reseal(n);
        const pel_snap_t verdict = restored(buf, n);
        const bool in_station = at >= 252; /* of which a bad place is not taken; an id may be any */
        TEST_ASSERT_TRUE(verdict == PEL_SNAP_BAD_VALUE || in_station);
        TEST_ASSERT_FALSE(next_life.ins);
    }
    memcpy(buf, good, n);
    buf[PEL_SNAPSHOT_BYTES - 5]++; /* more ephemerides than there are */
    reseal(n);
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_BAD_VALUE, restored(buf, n));
}

static void another_mounting_or_imu_is_refused(void)
{
    const size_t n = pel_snapshot_encode(&nav, 1, buf, sizeof buf);
    cfg.lever_ba_b[0] = 0.6;
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_REMOUNTED, restored(buf, n));
    TEST_ASSERT_EQUAL_UINT32(1, next_life.warm.report.count[PEL_SNAP_REMOUNTED]);
    TEST_ASSERT_EQUAL_INT(PEL_NAV_WARM, pel_navigator_poll(&next_life));
    cfg.lever_ba_b[0] = 0.5;
    cfg.imu.sd_bg_radps *= 2.0;
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_FOREIGN, restored(buf, n));
}

static void what_is_not_healthy_is_not_kept(void)
{
    nav.at_horizon.t_ns += 10 * PEL_NS_PER_S; /* coasting */
    TEST_ASSERT_EQUAL_UINT(0, pel_snapshot_encode(&nav, 1, buf, sizeof buf));
    at_rest(T0, 1.0);
    nav.ud.D[3] = PEL_R(-1.0);
    TEST_ASSERT_EQUAL_UINT(0, pel_snapshot_encode(&nav, 1, buf, sizeof buf));
    at_rest(T0, 1.0);
    nav.ins = false;
    TEST_ASSERT_EQUAL_UINT(0, pel_snapshot_encode(&nav, 1, buf, sizeof buf));
    at_rest(T0, 1.0);
    TEST_ASSERT_EQUAL_UINT(0, pel_snapshot_encode(&nav, 1, buf, PEL_SNAPSHOT_BYTES - 1));
}

/* ---- numbers at their limits --------------------------------------------------------------------------------------------- */

/* Where the fields are: docs/FORMATS.md. */
enum { T = 20, STILL = 28, R = 32, V = 56, THETA = 80, COV_R = 104, COV_PSI = 128, ERROR = 152, SD_ERROR = 224 };

typedef struct {
    const char *name;
    size_t at;
    char type; /* d double, f float, t time */
    double value;
    bool good;
} field_t;

static void put_field(const field_t *f)
{
    if (f->type == 'd') { pel_le_put_f64(buf + f->at, f->value); }
    if (f->type == 'f') { pel_le_put_f32(buf + f->at, (float)f->value); }
    if (f->type == 't') { pel_le_put(buf + f->at, 8, (uint64_t)(int64_t)f->value); }
}

static void each_number_has_its_limits(void)
{
    static const field_t FIELDS[] = {
        {"t", T, 't', 0.0, false},
        {"t", T, 't', -5.0, false},
        {"t", T, 't', 1.0, true},
        {"still", STILL, 'f', INFINITY, false},
        {"still", STILL, 'f', -0.1, false},
        {"still", STILL, 'f', 0.0, true},
        {"r", R, 'd', 0.0, false}, /* too deep, then too high */
        {"r", R, 'd', 5.8e6, false},
        {"v", V, 'd', 9999.0, true},
        {"v", V + 16, 'd', -1.0001e4, false},
        {"theta", THETA + 8, 'd', 3.0, true},
        {"theta", THETA + 8, 'd', -4.01, false},
        {"cov_r", COV_R, 'f', 0.0, false},
        {"cov_r", COV_R + 12, 'f', -1.0, false},
        {"cov_r", COV_R + 20, 'f', 1.01e12, false},
        {"cov_r", COV_R + 20, 'f', 0.99e12, true},
        {"cov_psi", COV_PSI, 'f', 0.0, false},
        {"cov_psi", COV_PSI + 12, 'f', 10.0, false},
        {"cov_psi", COV_PSI + 20, 'f', 9.9, true},
        {"error", ERROR, 'd', 100.0, false},
        {"error", ERROR + 64, 'd', -100.0, false},
        {"error", ERROR + 64, 'd', -99.0, true},
        {"sd_error", SD_ERROR, 'f', 0.0, false},
        {"sd_error", SD_ERROR + 32, 'f', 100.0, false},
        {"sd_error", SD_ERROR + 32, 'f', 99.0, true},
    };
    for (size_t i = 0; i < sizeof FIELDS / sizeof FIELDS[0]; i++) {
        const size_t n = pel_snapshot_encode(&nav, 1, buf, sizeof buf);
        put_field(&FIELDS[i]);
        reseal(n);
        TEST_ASSERT_EQUAL_INT_MESSAGE(FIELDS[i].good ? PEL_SNAP_WAITING : PEL_SNAP_BAD_VALUE, restored(buf, n),
                                      FIELDS[i].name);
        TEST_ASSERT_EQUAL_INT(FIELDS[i].good, next_life.have_station);
    }
}

static void lengths_that_cannot_be_are_refused(void)
{
    (void)pel_snapshot_encode(&nav, 1, buf, sizeof buf);
    uint32_t sequence = 0;
    pel_le_put(buf + 6, 2, 15); /* shorter than its own head and checksum */
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_DAMAGED, pel_snapshot_check(buf, sizeof buf, &sequence));
    pel_le_put(buf + 6, 2, 100); /* whole, but shorter than a state */
    reseal(100);
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_WAITING, pel_snapshot_check(buf, sizeof buf, &sequence));
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_BAD_VALUE, restored(buf, sizeof buf));
}

static void what_is_not_wanted_or_not_there_changes_nothing(void)
{
    const size_t n = pel_snapshot_encode(&nav, 1, buf, sizeof buf);
    cfg.warm_max_age_s = 0.0;
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_NONE, restored(buf, n));
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_NONE, next_life.warm.report.verdict);
    TEST_ASSERT_FALSE(next_life.have_station);
    cfg.warm_max_age_s = 60.0;
    memset(buf, 0xFF, sizeof buf);
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_NONE, restored(buf, sizeof buf));
    TEST_ASSERT_EQUAL_INT(PEL_NAV_NONE, pel_navigator_poll(&next_life));
}

static void without_a_base_none_comes_back_and_room_for_all_orbits_takes_all(void)
{
    static uint8_t large[PEL_SNAPSHOT_BYTES + 8 * PEL_SNAPSHOT_EPH_BYTES];
    nav.have_station = false;
    const size_t n = pel_snapshot_encode(&nav, 1, large, sizeof large);
    TEST_ASSERT_EQUAL_UINT(PEL_SNAPSHOT_BYTES + 6 * PEL_SNAPSHOT_EPH_BYTES, n);
    TEST_ASSERT_EQUAL_INT(PEL_SNAP_WAITING, restored(large, n));
    TEST_ASSERT_FALSE(next_life.have_station);
    TEST_ASSERT_EQUAL_INT(6, next_life.orbits.n);
}

static void a_heading_hardly_known_or_a_state_that_is_none_is_not_kept(void)
{
    const int i_psi = pel_model_index(&nav.model, PEL_BLOCK_ATTITUDE);
    for (int k = 0; k < 3; k++) { nav.ud.D[i_psi + k] = PEL_R(0.4) * PEL_R(0.4); } /* 23 degrees */
    TEST_ASSERT_EQUAL_UINT(0, pel_snapshot_encode(&nav, 1, buf, sizeof buf));
    at_rest(T0, 1.0);
    nav.have_state = false;
    TEST_ASSERT_EQUAL_UINT(0, pel_snapshot_encode(&nav, 1, buf, sizeof buf));
    at_rest(T0, 1.0);
    nav.last_epoch_ns = 0;
    TEST_ASSERT_EQUAL_UINT(0, pel_snapshot_encode(&nav, 1, buf, sizeof buf));
}

static void it_is_due_when_it_has_stood_and_the_last_one_is_old_enough(void)
{
    static const struct {
        double last_s, since_s; /* before now */
        bool due;
    } of[] = {{59.9, 3.0, false},   {60.0, 3.0, true},       {60.0, 2.9, false},     /* of another standstill */
              {59.0, 100.0, false}, {3599.0, 4000.0, false}, {3600.0, 4000.0, true}, /* of this one */
              {-1.0, 3.0, true}};                                                    /* time began anew */
    for (int i = 0; i < 7; i++) {
        nav.warm.still_since_ns = T0 - (int64_t)(of[i].since_s * 1e9);
        TEST_ASSERT_EQUAL_INT(of[i].due, pel_snapshot_is_due(&nav, T0 - (int64_t)(of[i].last_s * 1e9)));
    }
    TEST_ASSERT_TRUE(pel_snapshot_is_due(&nav, 0)); /* the first */
    nav.ins = false;
    TEST_ASSERT_FALSE(pel_snapshot_is_due(&nav, 0));
    TEST_ASSERT_FALSE(pel_snapshot_is_outlived(&nav));
    nav.have_state = false;
    nav.at_horizon.v_eb_e[0] = 5.0;
    TEST_ASSERT_FALSE(pel_snapshot_is_outlived(&nav)); /* of a state that is none */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(what_was_kept_comes_back);
    RUN_TEST(a_glonass_orbit_comes_back);
    RUN_TEST(any_flipped_bit_is_damage);
    RUN_TEST(any_shorter_length_is_damage_or_nothing);
    RUN_TEST(a_power_cut_at_any_byte_written_over_leaves_old_or_new);
    RUN_TEST(a_power_cut_at_any_byte_after_an_erase_leaves_old_or_new);
    RUN_TEST(a_failed_write_does_not_move_on_to_the_good_slot);
    RUN_TEST(a_standstill_is_kept_once_and_again_after_an_hour);
    RUN_TEST(motion_voids_what_is_kept_and_the_next_standstill_waits_for_its_minute);
    RUN_TEST(a_newer_version_is_refused_as_such);
    RUN_TEST(numbers_that_cannot_be_are_refused_whatever_the_checksum_says);
    RUN_TEST(another_mounting_or_imu_is_refused);
    RUN_TEST(what_is_not_healthy_is_not_kept);
    RUN_TEST(each_number_has_its_limits);
    RUN_TEST(lengths_that_cannot_be_are_refused);
    RUN_TEST(what_is_not_wanted_or_not_there_changes_nothing);
    RUN_TEST(without_a_base_none_comes_back_and_room_for_all_orbits_takes_all);
    RUN_TEST(a_heading_hardly_known_or_a_state_that_is_none_is_not_kept);
    RUN_TEST(it_is_due_when_it_has_stood_and_the_last_one_is_old_enough);
    return UNITY_END();
}
