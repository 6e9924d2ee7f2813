/* peer_wire - wire/ as text, for tests/peers/test_wire_*.py.
 *
 *   peer_wire decode FILE [approximate GPS time, s]     receiver stream -> lines
 *     E t_ns n dropped reset | O sys prn carrier code P L D cn0 lock flags glo_k
 *     N sys prn source health iode iodc ura fit toe_ns toc_ns af0 af1 af2 sqrt_a e i0 Omega0 omega M0 dn Omega_dot idot
 *       cuc cus crc crs cic cis tgd0 tgd1
 *     R prn health iode ura toe_ns toc_ns af0 af1 tgd0 k x vx ax y vy ay z vz az (GLONASS)
 *     K a0..a3 b0..b3 | S id x y z | V t_ns fix carrier n lat lon h vn ve vd sdh sdv | C the ten counters
 *   peer_wire imu FILE [gyro accel dt]                  IMU stream -> I t_ns dt a0 a1 a2 u0 u1 u2 seq flags | M t_ns id | C
 *   peer_wire recode FILE FORMAT OUT [approximate time] receiver stream -> the same through our encoders:
 *     FORMAT ubx, ubxgeo (every BeiDou satellite renamed C03), msm4, msm5, msm6, msm7 or 1004; ephemerides, station and Klobuchar in the format's own messages
 *   peer_wire rawimusx OUT                              a minute of known RAWIMUSX frames
 *   peer_wire nmea                                      known solutions -> sentences */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "pelorus/wire.h"

static pel_receiver_t rx;
static pel_imu_stream_t imu_stream;

static void print_counters(const pel_wire_counters_t *c)
{
    printf("C %u %u %u %u %u %u %u %u %u %u\n", c->frames, c->noise_bytes, c->bad_checksum, c->bad_length, c->bad_value,
           c->unknown, c->duplicate, c->time_back, c->gap, c->overflow);
}

static void print_epoch(const pel_epoch_t *e)
{
    printf("E %" PRId64 " %u %u %d\n", e->t_ns, e->n, e->dropped, e->clock_reset);
    for (int i = 0; i < (int)e->n; i++) {
        const pel_obs_t *o = &e->obs[i];
        printf("O %u %u %u %c %.17g %.17g %.9g %.6g %u %u %d\n", o->sys, o->prn, o->carrier, o->code, o->P_m, o->L_cyc,
               (double)o->D_hz, (double)o->cn0_dbhz, o->lock_ms, o->flags, o->glo_k);
    }
}

static void print_glonass(const pel_ephemeris_t *e)
{
    printf("R %u %u %u %.3f %" PRId64 " %" PRId64 " %.17g %.17g %.17g %d", e->prn, e->health, e->iode,
           (double)e->sd_ura_m, e->toe_ns, e->toc_ns, e->af0, e->af1, e->tgd_s[0], e->glo.k);
    for (int i = 0; i < 3; i++) { printf(" %.17g %.17g %.17g", e->glo.r_e[i], e->glo.v_e[i], e->glo.a_e[i]); }
    printf("\n");
}

static void print_ephemeris(const pel_ephemeris_t *e)
{
    if (e->sys == PEL_SYS_GLO) {
        print_glonass(e);
        return;
    }
    const double v[] = {e->af0,   e->af1, e->af2, e->sqrt_a,    e->e,        e->i0,      e->Omega0,
                        e->omega, e->M0,  e->dn,  e->Omega_dot, e->idot,     e->cuc,     e->cus,
                        e->crc,   e->crs, e->cic, e->cis,       e->tgd_s[0], e->tgd_s[1]};
    printf("N %u %u %u %u %u %u %.3f %.0f %" PRId64 " %" PRId64, e->sys, e->prn, e->source, e->health, e->iode, e->iodc,
           (double)e->sd_ura_m, (double)e->fit_s, e->toe_ns, e->toc_ns);
    for (size_t i = 0; i < sizeof v / sizeof v[0]; i++) { printf(" %.17g", v[i]); }
    printf("\n");
}

static void print_event(pel_rx_event_t event)
{
    const pel_pvt_t *p = &rx.pvt;
    switch (event) {
    case PEL_RX_NONE: break;
    case PEL_RX_EPOCH: print_epoch(&rx.epoch); break;
    case PEL_RX_EPHEMERIS: print_ephemeris(&rx.ephemeris); break;
    case PEL_RX_KLOBUCHAR:
        printf("K");
        for (int i = 0; i < 8; i++) {
            printf(" %.9g", (double)((i < 4) ? rx.klobuchar.alpha[i] : rx.klobuchar.beta[i - 4]));
        }
        printf("\n");
        break;
    case PEL_RX_STATION:
        printf("S %u %.4f %.4f %.4f\n", rx.station.id, rx.station.r_ea_e[0], rx.station.r_ea_e[1],
               rx.station.r_ea_e[2]);
        break;
    case PEL_RX_PVT:
        printf("V %" PRId64 " %u %u %u %.10f %.10f %.4f %.4f %.4f %.4f %.4f %.4f\n", p->t_ns, p->fix, p->carrier_soln,
               p->n_sat, p->lat_rad, p->lon_rad, p->height_m, p->v_ned[0], p->v_ned[1], p->v_ned[2], (double)p->sd_h_m,
               (double)p->sd_v_m);
        break;
    }
}

static FILE *must_open(const char *name, const char *mode)
{
    FILE *f = fopen(name, mode);
    if (f == NULL) {
        fprintf(stderr, "cannot open %s\n", name);
        exit(3);
    }
    return f;
}

static void each_event(const char *name, void (*use)(pel_rx_event_t))
{
    FILE *f = must_open(name, "rb");
    pel_rx_event_t event;
    for (int c = getc(f); c != EOF; c = getc(f)) { use(pel_receiver_push(&rx, (uint8_t)c)); }
    do {
        event = pel_receiver_flush(&rx);
        use(event);
    } while (event != PEL_RX_NONE);
    fclose(f);
}

/* ---- recode -------------------------------------------------------------------------------------------------------------- */

static FILE *out_file;
static int out_msm; /* 0 UBX, 4..7 MSM, 1004 */
static bool out_geo;

static void emit(const uint8_t *p, size_t n, const char *what)
{
    if (n == 0) { printf("refused %s\n", what); }
    fwrite(p, 1, n, out_file);
}

static void recode_epoch(const pel_epoch_t *e)
{
    static const pel_sys_t MSM_SYS[] = {PEL_SYS_GPS, PEL_SYS_GLO, PEL_SYS_GAL, PEL_SYS_QZS, PEL_SYS_BDS};
    static uint8_t buf[PEL_MAX_FRAME_BYTES];
    if (out_msm == 0) {
        emit(buf, pel_ubx_encode_rawx(e, 18, buf, sizeof buf), "rawx");
    } else if (out_msm == 1004) {
        emit(buf, pel_rtcm3_encode_1004(e, 7, false, buf, sizeof buf), "1004");
    } else {
        for (int i = 0; i < 5; i++) {
            emit(buf, pel_rtcm3_encode_msm(e, MSM_SYS[i], out_msm, 7, i < 4, buf, sizeof buf), "msm");
        }
    }
}

static void recode_ephemeris(pel_ephemeris_t *e)
{
    uint8_t buf[128];
    if (out_geo && e->sys == PEL_SYS_BDS) { e->prn = 3; }
    if (out_msm != 0) {
        emit(buf, pel_rtcm3_encode_ephemeris(e, buf, sizeof buf), "ephemeris");
        return;
    }
    for (int part = 1; part <= pel_ubx_sfrbx_parts(e); part++) {
        emit(buf, pel_ubx_encode_sfrbx_eph(e, part, e->toe_ns - 3600 * PEL_NS_PER_S, buf, sizeof buf), "sfrbx");
    }
}

static void recode_event(pel_rx_event_t event)
{
    uint8_t buf[128];
    if (event == PEL_RX_EPOCH) { recode_epoch(&rx.epoch); }
    if (event == PEL_RX_EPHEMERIS) { recode_ephemeris(&rx.ephemeris); }
    if (event == PEL_RX_STATION && out_msm != 0) {
        emit(buf, pel_rtcm3_encode_station(&rx.station, 1006, buf, sizeof buf), "station");
    }
    if (event == PEL_RX_KLOBUCHAR && out_msm == 0) {
        emit(buf, pel_ubx_encode_sfrbx_klobuchar(&rx.klobuchar, 1, rx.t_approx_ns, buf, sizeof buf), "klobuchar");
    }
    if (event == PEL_RX_PVT && out_msm == 0) { emit(buf, pel_ubx_encode_pvt(&rx.pvt, buf, sizeof buf), "pvt"); }
}

/* ---- IMU, NMEA ------------------------------------------------------------------------------------------------------------ */

static void decode_imu(const char *name)
{
    FILE *f = must_open(name, "rb");
    const pel_imu_t *m = &imu_stream.imu;
    for (int c = getc(f); c != EOF; c = getc(f)) {
        const pel_imu_event_t event = pel_imu_stream_push(&imu_stream, (uint8_t)c);
        if (event == PEL_IMU_SAMPLE) {
            printf("I %" PRId64 " %.9f %.17g %.17g %.17g %.17g %.17g %.17g %u %u\n", m->t_ns, m->dt_s, m->alpha_ib_b[0],
                   m->alpha_ib_b[1], m->alpha_ib_b[2], m->upsilon_ib_b[0], m->upsilon_ib_b[1], m->upsilon_ib_b[2],
                   m->seq, m->flags);
        }
        if (event == PEL_IMU_EVENT_MARK) { printf("M %" PRId64 " %u\n", imu_stream.mark_t_ns, imu_stream.mark_id); }
    }
    print_counters(&imu_stream.counters);
    fclose(f);
}

static void write_rawimusx(const char *name)
{
    FILE *f = must_open(name, "wb");
    for (int i = 0; i < 6000; i++) {
        uint8_t buf[64];
        pel_imu_t m = {.t_ns = pel_time_from_week(2300, 1000.0) + i * 10 * PEL_NS_PER_MS, .dt_s = 0.01};
        for (int k = 0; k < 3; k++) {
            m.alpha_ib_b[k] = 1e-4 * (k + 1) + 1e-7 * i;
            m.upsilon_ib_b[k] = -1e-2 * (k + 1) + 1e-6 * i;
        }
        fwrite(buf, 1, pel_rawimusx_encode(&m, 58, 1.0 / 8589934592.0, 1.0 / 536870912.0, buf, sizeof buf), f);
    }
    fclose(f);
}

static void print_sentences(const pel_solution_t *s)
{
    char text[160];
    printf("%s", (pel_nmea_gga(s, text, sizeof text) > 0) ? text : "none\n");
    printf("%s", (pel_nmea_rmc(s, text, sizeof text) > 0) ? text : "none\n");
    printf("%s", (pel_nmea_hdt(s, text, sizeof text) > 0) ? text : "none\n");
}

/* One of each kind of fix, forty days apart; then 20 epochs of a fixed rover at 10 Hz. */
static void write_nmea(void)
{
    const double deg = 3.14159265358979323846 / 180.0;
    for (int i = 0; i < 5; i++) {
        pel_solution_t s = {.t_ns = pel_time_from_week(2388, 345600.25) + i * 86400 * 40 * PEL_NS_PER_S,
                            .fix = (uint8_t)i,
                            .flags = (i > 1) ? PEL_SOL_HEADING : 0,
                            .lat_rad = (47.123456789 - 30 * i) * deg,
                            .lon_rad = (-8.987654321 + 40 * i) * deg,
                            .height_m = 432.1234 - 200.0 * i,
                            .v_ned = {3.0f, -4.0f, 0.5f},
                            .heading_rad = (float)(359.999 * deg * (i == 4)),
                            .base_age_s = 1.5f,
                            .n_sat = 17};
        print_sentences(&s);
    }
    for (int i = 0; i < 20; i++) {
        pel_solution_t s = {.t_ns = pel_time_from_week(2388, 345600.0) + i * 100 * PEL_NS_PER_MS,
                            .fix = PEL_FIX_FIXED,
                            .flags = PEL_SOL_HEADING,
                            .lat_rad = (47.123456789 + 1e-7 * i) * deg,
                            .lon_rad = -8.987654321 * deg,
                            .height_m = 432.1234,
                            .v_ned = {3.0f, -4.0f, 0.5f},
                            .heading_rad = (float)(123.45 * deg),
                            .base_age_s = 0.5f,
                            .n_sat = 17};
        print_sentences(&s);
    }
}

int main(int argc, char **argv)
{
    pel_receiver_init(&rx);
    pel_imu_stream_init(&imu_stream);
    if (argc >= 3 && strcmp(argv[1], "decode") == 0) {
        if (argc > 3) { pel_receiver_set_time(&rx, (pel_time_t)atoll(argv[3]) * PEL_NS_PER_S); }
        each_event(argv[2], print_event);
        print_counters(&rx.counters);
    } else if (argc >= 5 && strcmp(argv[1], "recode") == 0) {
        if (argc > 5) { pel_receiver_set_time(&rx, (pel_time_t)atoll(argv[5]) * PEL_NS_PER_S); }
        out_file = must_open(argv[4], "wb");
        out_msm = (strncmp(argv[3], "msm", 3) == 0) ? atoi(argv[3] + 3) : atoi(argv[3]);
        out_geo = strcmp(argv[3], "ubxgeo") == 0;
        each_event(argv[2], recode_event);
        fclose(out_file);
    } else if (argc >= 3 && strcmp(argv[1], "imu") == 0) {
        if (argc > 5) { pel_imu_stream_set_rawimu(&imu_stream, atof(argv[3]), atof(argv[4]), atof(argv[5])); }
        decode_imu(argv[2]);
    } else if (argc == 3 && strcmp(argv[1], "rawimusx") == 0) {
        write_rawimusx(argv[2]);
    } else if (argc == 2 && strcmp(argv[1], "nmea") == 0) {
        write_nmea();
    } else {
        fprintf(stderr, "usage: peer_wire decode|imu|recode|rawimusx|nmea ...\n");
        return 2;
    }
    return 0;
}
