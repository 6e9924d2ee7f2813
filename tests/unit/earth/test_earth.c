/* WGS-84, gravity and attitude angles against long-double iteration, differences of a potential, and closed forms. */
#include <math.h>
#include <stdio.h>

#include "pelorus/earth.h"
#include "pelorus/math.h"
#include "unity.h"

void setUp(void) {}
void tearDown(void) {}

static uint64_t seed = 7;

static double uniform(double lo, double hi)
{
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return lo + (hi - lo) * (double)(seed >> 11) * 0x1p-53;
}

/* lat, lon, h -> ECEF in long double */
static void reference_ecef(double lat, double lon, double h, long double r[3])
{
    const long double f = 1.0L / 298.257223563L;
    const long double e2 = f * (2.0L - f);
    const long double s = sinl((long double)lat);
    const long double c = cosl((long double)lat);
    const long double R_N = 6378137.0L / sqrtl(1.0L - e2 * s * s);
    r[0] = (R_N + h) * c * cosl((long double)lon);
    r[1] = (R_N + h) * c * sinl((long double)lon);
    r[2] = (R_N * (1.0L - e2) + h) * s;
}

static void coordinates_there_and_back(void)
{
    double worst_h = 0.0;
    double worst_lat = 0.0;
    double worst_forward = 0.0;
    for (int k = 0; k < 300000; k++) {
        double lat = uniform(-0.5 * PEL_PI, 0.5 * PEL_PI);
        if (k % 5 == 0) { lat = copysign(0.5 * PEL_PI - pow(10.0, uniform(-12.0, -1.0)), lat); } /* towards a pole */
        if (k % 5 == 1) { lat = pow(10.0, uniform(-12.0, -1.0)); } /* towards the equator */
        const double lon = uniform(-PEL_PI, PEL_PI);
        const double h = (k % 3 == 0) ? uniform(-10e3, 10e3) : uniform(-10e3, 3e7);
        long double ref[3];
        double r[3];
        double lat2;
        double lon2;
        double h2;
        reference_ecef(lat, lon, h, ref);
        pel_earth_llh_to_ecef(lat, lon, h, r);
        for (int i = 0; i < 3; i++) {
            worst_forward = fmax(worst_forward, (double)fabsl(r[i] - ref[i]));
            r[i] = (double)ref[i];
        }
        pel_earth_ecef_to_llh(r, &lat2, &lon2, &h2);
        worst_h = fmax(worst_h, fabs(h2 - h));
        worst_lat = fmax(worst_lat, fabs(lat2 - lat) * (6.4e6 + h));
        TEST_ASSERT_TRUE(fabs(lon2 - lon) * cos(lat) < 1e-15 * 4.0);
    }
    printf("  llh -> ecef %.1e m; back: height %.1e m, latitude %.1e m\n", worst_forward, worst_h, worst_lat);
    TEST_ASSERT_TRUE(worst_forward < 2e-8);
    TEST_ASSERT_TRUE(worst_h < 3e-8);
    TEST_ASSERT_TRUE(worst_lat < 3e-8);
}

static void poles_axis_and_centre_are_bounded(void)
{
    double lat;
    double lon;
    double h;
    const double pole[3] = {0.0, 0.0, PEL_WGS84_B + 100.0};
    pel_earth_ecef_to_llh(pole, &lat, &lon, &h);
    TEST_ASSERT_TRUE(lat == 0.5 * PEL_PI && lon == 0.0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-8, 100.0, h);
    const double south[3] = {0.0, 0.0, -PEL_WGS84_B};
    pel_earth_ecef_to_llh(south, &lat, &lon, &h);
    TEST_ASSERT_TRUE(lat == -0.5 * PEL_PI && fabs(h) < 1e-8);
    const double centre[3] = {0.0, 0.0, 0.0};
    pel_earth_ecef_to_llh(centre, &lat, &lon, &h);
    TEST_ASSERT_TRUE(lat == 0.0 && lon == 0.0 && pel_isfinite(h));
    const double equator[3] = {-PEL_WGS84_A, 0.0, 0.0};
    pel_earth_ecef_to_llh(equator, &lat, &lon, &h);
    TEST_ASSERT_TRUE(lat == 0.0 && lon == PEL_PI && h == 0.0);
}

/* Potential of gravitation (J2) and of the centrifugal force, in long double */
static long double potential(const long double r[3])
{
    const long double rr = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
    const long double n = sqrtl(rr);
    const long double s2 = r[2] * r[2] / rr;
    const long double a2 = 6378137.0L * 6378137.0L;
    const long double w = 7.292115e-5L;
    return 3.986004418e14L / n * (1.0L - 1.082627e-3L * a2 / rr * 0.5L * (3.0L * s2 - 1.0L)) +
           0.5L * w * w * (r[0] * r[0] + r[1] * r[1]);
}

static void gravity_is_the_gradient_of_its_potential(void)
{
    double worst = 0.0;
    double worst_gradient = 0.0;
    for (int k = 0; k < 2000; k++) {
        double r[3];
        double g[3];
        double G[3][3];
        pel_earth_llh_to_ecef(uniform(-1.57, 1.57), uniform(-3.1, 3.1), uniform(-1e3, 1e5), r);
        pel_earth_gravity_e(r, g);
        pel_earth_gravity_gradient_e(r, G);
        for (int j = 0; j < 3; j++) {
            long double p[3] = {r[0], r[1], r[2]};
            long double m[3] = {r[0], r[1], r[2]};
            p[j] += 10.0L;
            m[j] -= 10.0L;
            worst = fmax(worst, fabs((double)((potential(p) - potential(m)) / 20.0L) - g[j]));
            double rp[3] = {r[0], r[1], r[2]};
            double rm[3] = {r[0], r[1], r[2]};
            double gp[3];
            double gm[3];
            rp[j] += 1000.0;
            rm[j] -= 1000.0;
            pel_earth_gravity_e(rp, gp);
            pel_earth_gravity_e(rm, gm);
            for (int i = 0; i < 3; i++) {
                worst_gradient = fmax(worst_gradient, fabs((gp[i] - gm[i]) / 2000.0 - G[i][j]));
            }
        }
    }
    printf("  gravity against differences of the potential %.1e m/s^2; gradient %.1e of 3e-6 1/s^2 (J2 left out)\n",
           worst, worst_gradient);
    TEST_ASSERT_TRUE(worst < 1e-10);
    TEST_ASSERT_TRUE(worst_gradient < 2.1e-8);
}

static void gravity_is_near_normal_gravity_on_the_ellipsoid(void)
{
    double worst = 0.0;
    for (double lat = -1.57; lat < 1.58; lat += 0.01) {
        double r[3];
        double g[3];
        pel_earth_llh_to_ecef(lat, 0.7, 0.0, r);
        pel_earth_gravity_e(r, g);
        const double s2 = sin(lat) * sin(lat);
        const double normal =
            9.7803253359 * (1.0 + 0.001931853 * s2) / sqrt(1.0 - PEL_WGS84_E2 * s2); /* Groves 2.134 */
        worst = fmax(worst, fabs(pel_norm3(g) - normal));
    }
    printf("  |g| against Somigliana's formula: %.1e m/s^2\n", worst);
    TEST_ASSERT_TRUE(worst < 1.3e-4);
}

static void local_frames_point_where_they_say(void)
{
    for (int k = 0; k < 1000; k++) {
        const double lat = uniform(-1.5, 1.5);
        const double lon = uniform(-3.1, 3.1);
        double enu[3][3];
        double ned[3][3];
        double a[3];
        double b[3];
        double d[3];
        double R_M;
        double R_N;
        pel_earth_C_e_enu(lat, lon, enu);
        pel_earth_C_e_n(lat, lon, ned);
        pel_earth_radii_at(pel_sin(lat), &R_M, &R_N);
        pel_earth_llh_to_ecef(lat, lon, 0.0, a);
        pel_earth_llh_to_ecef(lat + 1e-6, lon + 1e-6, 0.5, b);
        for (int i = 0; i < 3; i++) { d[i] = b[i] - a[i]; }
        double n[3];
        double e[3];
        pel_mat3_vec(ned, d, n);
        pel_mat3_vec(enu, d, e);
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, R_M * 1e-6, n[0]); /* curvature over 6 m */
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, R_N * 1e-6 * cos(lat), n[1]);
        TEST_ASSERT_DOUBLE_WITHIN(2e-4, -0.5, n[2]);
        TEST_ASSERT_TRUE(e[0] == n[1] && e[1] == n[0] && e[2] == -n[2]);
    }
}

/* Rz(-psi) Rx(theta) Ry(gamma) multiplied out */
static void attitude_reference(double roll, double pitch, double heading, double C[3][3])
{
    const double Rz[3][3] = {{cos(heading), sin(heading), 0}, {-sin(heading), cos(heading), 0}, {0, 0, 1}};
    const double Rx[3][3] = {{1, 0, 0}, {0, cos(pitch), -sin(pitch)}, {0, sin(pitch), cos(pitch)}};
    const double Ry[3][3] = {{cos(roll), 0, sin(roll)}, {0, 1, 0}, {-sin(roll), 0, cos(roll)}};
    double T[3][3];
    pel_mat3_mul(Rz, Rx, T);
    pel_mat3_mul(T, Ry, C);
}

static void attitude_angles_there_and_back(void)
{
    for (int k = 0; k < 20000; k++) {
        const double roll = uniform(-3.14, 3.14);
        const double pitch = uniform(-1.56, 1.56);
        const double heading = uniform(0.0, 6.283);
        const double lat = uniform(-1.5, 1.5);
        const double lon = uniform(-3.1, 3.1);
        double C[3][3];
        double ref[3][3];
        double a[3];
        pel_attitude_to_C_b_enu(roll, pitch, heading, C);
        attitude_reference(roll, pitch, heading, ref);
        for (int i = 0; i < 9; i++) { TEST_ASSERT_DOUBLE_WITHIN(1e-15, ref[i / 3][i % 3], C[i / 3][i % 3]); }
        pel_attitude_to_C_b_e(roll, pitch, heading, lat, lon, C);
        pel_attitude_from_C_b_e(C, lat, lon, &a[0], &a[1], &a[2]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, roll, a[0]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, pitch, a[1]);
        TEST_ASSERT_DOUBLE_WITHIN(1e-13, heading, a[2]);
    }
    /* nose east, right wing down: the y axis points east, the z axis leans to the right (south) */
    double C[3][3];
    pel_attitude_to_C_b_enu(0.2, 0.0, 0.5 * PEL_PI, C);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1.0, C[0][1]);
    TEST_ASSERT_TRUE(C[1][2] < -0.19 && C[2][0] < -0.19);

    double roll;
    double pitch;
    double heading;
    pel_attitude_to_C_b_enu(0.4, 0.5 * PEL_PI, 1.0, C); /* nose straight up */
    pel_attitude_from_C_b_enu(C, &roll, &pitch, &heading);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5 * PEL_PI, pitch);
    double again[3][3];
    pel_attitude_to_C_b_enu(roll, pitch, heading, again);
    for (int i = 0; i < 9; i++) { TEST_ASSERT_DOUBLE_WITHIN(1e-12, C[i / 3][i % 3], again[i / 3][i % 3]); }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(coordinates_there_and_back);
    RUN_TEST(poles_axis_and_centre_are_bounded);
    RUN_TEST(gravity_is_the_gradient_of_its_potential);
    RUN_TEST(gravity_is_near_normal_gravity_on_the_ellipsoid);
    RUN_TEST(local_frames_point_where_they_say);
    RUN_TEST(attitude_angles_there_and_back);
    return UNITY_END();
}
