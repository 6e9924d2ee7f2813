"""The S2 flight in the navigator's preset ins-float: float against double, satellites lost, an arm, the date line, a pole (S2 sections 8, 12 and 13)."""

import numpy as np
import pytest
import runs
from pelorus_tools import eventlog

LOST_S, BACK_S = 255.5, 265.5       # in cruise
GROUPS = ("pos", "vel", "att")


@pytest.fixture(scope="module")
def capture(tmp_path_factory):
    return runs.simulate(tmp_path_factory.mktemp("s2"), "s2_flight")


def is_sound(r):
    sol = r.sol
    assert all(np.isfinite(sol[f]).all() for f in ("r_eb_e", "v_ned", "roll_rad", "pitch_rad", "heading_rad", "cov_r_ned", "cov_v_ned", "cov_att"))
    assert (r.run.counters["nav"]["numeric_faults"], r.run.counters["nav"]["restarts"]) == (0, 0)


def test_float_factors_do_what_double_factors_do(capture):
    a, b = (runs.Result(runs.firmware(capture, program=p)[0]) for p in ("pelorus-sil", "pelorus-sil-f64"))
    assert np.array_equal(a.sol["t_ns"], b.sol["t_ns"])
    is_sound(a)
    for g in GROUPS:
        d = (a.errors.err[g] - b.errors.err[g]) / b.errors.sd[g]
        d = d[np.isfinite(d).all(1)]
        ratio = a.errors.sd[g] / b.errors.sd[g]
        print(f"float minus double, {g}: rms {np.sqrt(np.mean(d**2)):.4f} sigma, at most {np.abs(d).max():.4f}, sigma by {np.nanmax(np.abs(ratio - 1)):.5f}")
        assert np.abs(d).max() < 0.02 and np.nanmax(np.abs(ratio - 1)) < 0.02


def test_ten_seconds_without_satellites(capture):
    """The receiver tracks on; its line is silent. Position grows by what the INS drifts and is back with the first phases."""
    rows = [(t, c.decode(), bytes(d)) for t, c, d in eventlog.events(eventlog.open_bytes(str(capture)))]
    first = min(t for t, c, _ in rows if c == "UART_ROVER")
    edited = capture.with_name("lost.log")
    eventlog.write(edited, [r for r in rows if not (r[1] == "UART_ROVER" and LOST_S <= (r[0] - first) * 1e-6 < BACK_S)])
    r = runs.Result(runs.firmware(edited)[0])
    is_sound(r)
    t, err, sd = r.seconds(r.sol["t_ns"][0]), r.errors.err["pos"], r.errors.sd["pos"]
    before = np.flatnonzero(r.epoch & (t < LOST_S))[-1]
    back = np.flatnonzero(r.epoch & (t > LOST_S))[:2]
    inside = np.flatnonzero((t > t[before] + 2) & (t < t[back[0]] - 0.05) & np.isfinite(err).all(1))
    assert (r.sol["fix"][inside] == 4).all(), "the status does not say that it coasts"
    growth = np.linalg.norm(err[inside[-1]] - err[before])
    moved = np.linalg.norm(err[back[1]] - err[before])
    learnt = np.sqrt(np.sum(sd[before] ** 2 - sd[back[1]] ** 2))     # what two epochs may move an estimate by, 1 sigma
    print(f"grown by {growth:.3f} m in {t[inside[-1]] - t[before]:.0f} s; second epoch back {moved:.3f} m from the last before, of which {learnt:.3f} m is learnt")
    assert growth < 0.15
    assert (sd[back[1]] < sd[before]).all() and moved < 0.15 + 3 * learnt


def is_honest(r):
    for g in GROUPS:
        z = (np.abs(r.errors.err[g]) / r.errors.sd[g]).max(axis=1)
        z = z[np.isfinite(z)]
        print(f"  {g}: worst {z.max():.1f} sigma, 95 % below {np.percentile(z, 95):.1f}")
        assert np.percentile(z, 95) < 3.0 and z.max() < 6.0


def test_an_antenna_three_metres_from_the_imu(tmp_path):
    arm = "[0.6, 1.0, 2.764]"
    edits = [("antenna", "lever_arm_m", arm), ("navigator.mount", "lever_arm_m", arm), ("navigator.integers", "enable", "true")]
    edits += [(table, "phase_m", "0.005") for table in ("rover", "base", "navigator.gnss")] + [("navigator.gnss", "float_code", "true")]
    r = runs.Result(runs.firmware(runs.simulate(tmp_path, "s2_flight", seed=2, edits=edits))[0])
    is_sound(r)
    is_honest(r)
    fixed = r.epoch & (r.sol["fix"] == 3)
    assert fixed.sum() > 900 and r.errors.horizontal[fixed].max() < 0.08


# Base and start moved together; the flight goes half a degree north and a quarter east.
PLACES = {"date line": {"lat_deg": ("-20", "-20"), "lon_deg": ("179.99", "-179.98"), "heading_deg": "0"},
          "89 degrees": {"lat_deg": ("88.4", "88.4"), "lon_deg": ("-118", "-116"), "heading_deg": "-90"}}


@pytest.mark.parametrize("place", PLACES)
def test_places_where_local_axes_are_awkward(tmp_path, place):
    p = PLACES[place]
    edits = [(table, key, p[key][i]) for i, table in enumerate(("start", "base")) for key in ("lat_deg", "lon_deg")]
    edits += [("start", "heading_deg", p["heading_deg"]), ("navigator.gnss", "float_code", "true")]
    r = runs.Result(runs.firmware(runs.simulate(tmp_path, "s2_flight", seed=3, duration=990.5, edits=edits))[0])
    is_sound(r)
    lat, lon = np.degrees(r.sol["lat_rad"]), np.degrees(r.sol["lon_rad"])
    print(f"{place}: latitude {lat.min():.2f} to {lat.max():.2f}, longitude {lon.min():.2f} to {lon.max():.2f}")
    assert lat.max() > 89.0 if place == "89 degrees" else np.abs(np.diff(lon)).max() > 359.0
    is_honest(r)
