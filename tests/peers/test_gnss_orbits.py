"""Satellite positions, clocks, troposphere and ionosphere against RTKLIB's library, called directly."""
import ctypes as c
import math
import os
import random

import pytest
import rinex_reader as rinex
from gnss_peer import peer, recording  # noqa: F401
from wire_peer import convbin_glonass, unpacked

NAV_FILES = {
    "attitude": ("attitude-static-099m-2024", "base.nav.gz"),
    "fujisawa": ("fujisawa-car-2021265", "SEPT2650.21P.gz"),
    "hongkong": ("hongkong-urban-2019", "hksc1180.19n.gz"),
    "geonet": ("geonet-0759-3040", "07590920.05n"),
}
RTKLIB_SYSTEM = {0: 0x01, 2: 0x08, 3: 0x20, 4: 0x10}
NAMES = {0: "GPS", 2: "Galileo", 3: "BeiDou", 4: "QZSS"}
UNIX_AT_GPS_EPOCH = 315964800


class GTime(c.Structure):
    _fields_ = [("time", c.c_long), ("sec", c.c_double)]


class Eph(c.Structure):
    """Broadcast ephemeris of RTKLIB 2.4.3; what follows f2 is not needed and only kept out of harm's way."""

    _fields_ = [(n, c.c_int) for n in "sat iode iodc sva svh week code flag".split()]
    _fields_ += [(n, GTime) for n in "toe toc ttr".split()]
    _fields_ += [(n, c.c_double) for n in "A e i0 OMG0 omg M0 deln OMGd idot crc crs cuc cus cic cis toes fit f0 f1 f2".split()]
    _fields_ += [("rest", c.c_double * 16)]


@pytest.fixture(scope="module")
def rtklib():
    try:
        lib = c.CDLL("libRTKLib.so.1", mode=os.RTLD_LAZY)  # it leaves three callbacks of its programs undefined
    except OSError:
        (pytest.fail if os.environ.get("PELORUS_REQUIRE_DATA") == "1" else pytest.skip)("librtklib is missing (apt-get install librtklib1)")
    lib.satno.argtypes = [c.c_int, c.c_int]
    lib.eph2pos.argtypes = [GTime, c.POINTER(Eph), c.POINTER(c.c_double), c.POINTER(c.c_double), c.POINTER(c.c_double)]
    lib.ionmodel.argtypes = lib.tropmodel.argtypes = lib.tropmapf.argtypes = None
    for f in (lib.ionmodel, lib.tropmodel, lib.tropmapf):
        f.restype = c.c_double
    return lib


def gtime(t_ns):
    return GTime(t_ns // 10**9 + UNIX_AT_GPS_EPOCH, (t_ns % 10**9) * 1e-9)


def rtklib_state(lib, e, t_ns):
    prn = e["prn"] + (192 if e["sys"] == 4 else 0)
    eph = Eph(sat=lib.satno(RTKLIB_SYSTEM[e["sys"]], prn), A=e["sqrt_a"] ** 2, e=e["e"], i0=e["i0"], OMG0=e["Omega0"], omg=e["omega"],
              M0=e["M0"], deln=e["dn"], OMGd=e["Omega_dot"], idot=e["idot"], crc=e["crc"], crs=e["crs"], cuc=e["cuc"], cus=e["cus"],
              cic=e["cic"], cis=e["cis"], f0=e["af0"], f1=e["af1"], f2=e["af2"], toe=gtime(e["toe_ns"]), toc=gtime(e["toc_ns"]))
    assert eph.sat > 0
    lag = 14 * 10**9 if e["sys"] == 3 else 0
    eph.toes = ((e["toe_ns"] - lag) % (604800 * 10**9)) * 1e-9
    r, clk, var = (c.c_double * 3)(), c.c_double(), c.c_double()
    lib.eph2pos(gtime(t_ns), c.byref(eph), r, c.byref(clk), c.byref(var))
    return list(r), clk.value


def distance(a, b):
    return math.dist(a, b)


@pytest.mark.parametrize("name", NAV_FILES)
def test_positions_to_1_mm_and_clocks_to_1e_12_s(peer, rtklib, name):  # noqa: F811
    ephemerides, _ = rinex.read_nav(recording(*NAV_FILES[name]))
    rng = random.Random(7)
    worst, seen, geo = {}, {}, 0.0
    for e in ephemerides[:400]:
        if not 0 < e["sqrt_a"]:
            continue
        assert peer.ephemeris(e) == 0
        t_ns = e["toe_ns"] + round(rng.uniform(-7000, 7000) * 1e9)
        a = peer.ask(f"S {e['sys']} {e['prn']} {t_ns} 0")
        assert a[1] == "0"
        stored = nearest(ephemerides, e, t_ns)
        if stored is not e:
            continue
        r, clk = rtklib_state(rtklib, e, t_ns)
        dr, dclk = distance(r, list(map(float, a[2:5]))), abs(clk - float(a[8]))
        k = NAMES[e["sys"]]
        worst[k] = max(worst.get(k, (0, 0))[0], dr), max(worst.get(k, (0, 0))[1], dclk)
        seen[k] = seen.get(k, 0) + 1
        if e["sys"] == 3 and (e["prn"] <= 5 or e["prn"] >= 59):
            geo = max(geo, dr)
            seen["GEO"] = seen.get("GEO", 0) + 1
    print(f"\n{name}: " + "; ".join(f"{k} {seen[k]} states, {1e3 * worst[k][0]:.5f} mm, {worst[k][1]:.1e} s" for k in worst),
          f"; GEO {seen.get('GEO', 0)}, {1e3 * geo:.5f} mm" if "GEO" in seen else "")
    assert seen
    assert all(w[0] < 1e-3 and w[1] < 1e-12 for w in worst.values())
    if name == "attitude":
        assert {"GPS", "Galileo", "BeiDou", "QZSS", "GEO"} <= seen.keys()


class GEph(c.Structure):
    _fields_ = [(n, c.c_int) for n in "sat iode frq svh sva age".split()] + [("toe", GTime), ("tof", GTime)]
    _fields_ += [(n, c.c_double * 3) for n in ("pos", "vel", "acc")] + [(n, c.c_double) for n in ("taun", "gamn", "dtaun")]


@pytest.mark.parametrize("name", ["galway", "attitude"])
def test_glonass_states_are_rtklibs(peer, rtklib, name, tmp_path):  # noqa: F811
    """RTKLIB integrates with an older value of the Earth's mass (398600.44 against .4418 km^3/s^2): 1 mm in a quarter of an hour."""
    if name == "galway":
        found = convbin_glonass(unpacked(tmp_path, "galway-walk-20181009", "rover-20181009-1221.ubx.gz"), "ubx", tmp_path)
    else:
        found = rinex.read_glonass(recording(*NAV_FILES["attitude"]))
    rtklib.geph2pos.argtypes = [GTime, c.POINTER(GEph)] + 3 * [c.POINTER(c.c_double)]
    worst, clock, seen = {900: 0.0, 1800: 0.0}, 0.0, 0
    for e in found:
        if e["toe_ns"] % 900_000_000_000 != 18_000_000_000 or peer.glonass(e) != 0:
            continue
        g = GEph(sat=rtklib.satno(4, e["prn"]), toe=gtime(e["toe_ns"]), taun=-e["af0"], gamn=e["af1"])
        g.pos[:], g.vel[:], g.acc[:] = [[e[p + a] for a in "xyz"] for p in ("", "v", "a")]
        for dt in (-900, -333.3, 0, 59.9, 60, 777, 900, 1799):
            r, clk, var = (c.c_double * 3)(), c.c_double(), c.c_double()
            t = e["toe_ns"] + round(dt * 1e9)
            rtklib.geph2pos(gtime(t), c.byref(g), r, c.byref(clk), c.byref(var))
            a = peer.ask(f"S 1 {e['prn']} {e['toe_ns']} {dt}")
            if a[1] != "0":
                continue
            span = 900 if abs(dt) <= 900 else 1800
            worst[span] = max(worst[span], distance(list(r), list(map(float, a[2:5]))))
            clock = max(clock, abs(clk.value - float(a[8])))
            seen += 1
    print(f"\n{name}: {seen} states of {len(found)} sets, {1e3 * worst[900]:.3f} mm within 15 min, {1e3 * worst[1800]:.3f} mm within 30, {clock:.1e} s")
    assert seen >= 100 and worst[900] < 2e-3 and worst[1800] < 1e-2 and clock < 1e-15


def nearest(ephemerides, e, t_ns):
    """The one the store must choose of those told so far: same satellite, nearest toe; I/NAV before F/NAV."""
    told = ephemerides[: next(i for i, x in enumerate(ephemerides) if x is e) + 1]
    same = [x for x in told if (x["sys"], x["prn"]) == (e["sys"], e["prn"]) and abs(x["toe_ns"] - t_ns) < (15000 if e["sys"] == 2 else 7800) * 10**9]
    source = min(x["source"] for x in same)
    return min((x for x in reversed(same) if x["source"] == source), key=lambda x: abs(x["toe_ns"] - t_ns))


@pytest.mark.parametrize("name", ["attitude", "geonet"])
def test_velocity_and_clock_rate_are_the_derivatives(peer, name):  # noqa: F811
    ephemerides, _ = rinex.read_nav(recording(*NAV_FILES[name]))
    worst_v, worst_clk = {}, 0.0
    for e in ephemerides:
        peer.ephemeris(e)
        t, h = e["toe_ns"] + 1234 * 10**9, 8.0
        s = {k: list(map(float, peer.ask(f"S {e['sys']} {e['prn']} {t} {k * h}")[2:])) for k in (-2, -1, 0, 1, 2)}
        for i in range(3):
            slope = (8 * (s[1][i] - s[-1][i]) - (s[2][i] - s[-2][i])) / (12 * h)
            worst_v[e["sys"]] = max(worst_v.get(e["sys"], 0), abs(slope - s[0][3 + i]))
        worst_clk = max(worst_clk, abs((s[1][6] - s[-1][6]) / (2 * h) - s[0][7]))
    print(f"\n{name}: velocity", {NAMES[k]: f"{v:.1e} m/s" for k, v in worst_v.items()}, f"clock rate {worst_clk:.1e}")
    assert max(worst_v.values()) < 2e-6  # positions are printed to 1e-6 m
    assert worst_clk < 1e-15


def test_klobuchar_is_rtklibs(peer, rtklib):  # noqa: F811
    _, k = rinex.read_nav(recording(*NAV_FILES["geonet"]))
    peer.klobuchar(k)
    rng, worst, largest = random.Random(3), 0.0, 0.0
    for _ in range(300):
        t_ns = 796435200 * 10**9 + rng.randrange(0, 86400) * 10**9
        lat, lon, az, el = rng.uniform(-1.5, 1.5), rng.uniform(-math.pi, math.pi), rng.uniform(0, 2 * math.pi), rng.uniform(0.05, math.pi / 2)
        ours = float(peer.ask(f"I {t_ns} {lat!r} {lon!r} {az!r} {el!r}")[1])
        theirs = rtklib.ionmodel(gtime(t_ns), (c.c_double * 8)(*k), (c.c_double * 3)(lat, lon, 0), (c.c_double * 2)(az, el))
        worst, largest = max(worst, abs(ours - theirs)), max(largest, theirs)
    print(f"\nKlobuchar: {worst:.1e} m of up to {largest:.1f} m")
    assert worst < 1e-6 and largest > 5  # coefficients are float on our side


def test_saastamoinen_zenith_is_rtklibs_and_mapping_is_niells(peer, rtklib):  # noqa: F811
    rng, worst, slant = random.Random(4), 0.0, 0.0
    for _ in range(200):
        lat, h, el = rng.uniform(-1.2, 1.2), rng.uniform(0, 4000), rng.uniform(math.radians(10), math.pi / 2)
        t = gtime(1403252400 * 10**9)
        pos = (c.c_double * 3)(lat, 0.5, h)
        zenith = rtklib.tropmodel(t, pos, (c.c_double * 2)(0, math.pi / 2), c.c_double(0.7))
        worst = max(worst, abs(float(peer.ask(f"T {lat!r} {h!r} {math.pi / 2!r}")[1]) - zenith))
        wet = c.c_double()
        mapping = rtklib.tropmapf(t, pos, (c.c_double * 2)(0, el), c.byref(wet))
        ours = float(peer.ask(f"T {lat!r} {h!r} {el!r}")[1])
        slant = max(slant, abs(ours / (zenith * mapping) - 1))
    print(f"\nSaastamoinen: zenith {1e3 * worst:.3f} mm from RTKLIB's, slant within {1e2 * slant:.2f} % of Niell's mapping above 10 degrees")
    assert worst < 1e-3
    assert slant < 0.01


def test_whitened_rows_are_those_of_a_cholesky_factor(peer):  # noqa: F811
    np = pytest.importorskip("numpy")
    rng = np.random.default_rng(5)
    for m in (1, 3, 12, 30):
        n = 6
        r0, r, z, h = float(rng.uniform(0.5, 2)), rng.uniform(0.2, 5, m), rng.normal(size=m), rng.normal(size=(m, n))
        peer.tell(f"W {n} {m} {r0!r}")
        for i in range(m):
            peer.tell(" ".join(map(repr, [float(r[i]), float(z[i]), *h[i].tolist()])))
        peer.process.stdin.flush()
        rows = np.array([list(map(float, peer.read())) for _ in range(m)])
        L = np.linalg.cholesky(np.diag(r) + r0)
        unit = np.linalg.solve(L / np.diag(L), np.column_stack([z, h]))
        scale = np.abs(unit).max()
        error = max(np.abs(rows[:, 0] - unit[:, 0]).max() / scale, np.abs(rows[:, 2:] - unit[:, 1:]).max() / scale,
                    np.abs(rows[:, 1] / np.diag(L) ** 2 - 1).max())
        print(f"\n{m} double differences: relative {error:.1e}")
        assert error < 5e-6  # pel_real is float here
