"""A sequence of positions, whoever computed it, and the figures by which two computations of it are compared."""

import csv
import subprocess
from dataclasses import dataclass

import numpy as np

from pelorus_tools import earth, gpstime, truth

WRONG_FIX_M = 0.08


@dataclass
class Track:
    t_ns: np.ndarray
    r_e: np.ndarray
    v_n: np.ndarray      # north, east, down, m/s; NaN if not given
    fixed: np.ndarray    # integers fixed
    n_sat: np.ndarray
    heading: np.ndarray  # rad; NaN if not given
    ins: np.ndarray      # an IMU takes part


def ours(out_log, at_epochs=True):
    """Solutions of pelorus-decode --csv, those at GNSS epochs or all of them. The program is run, not its code imported."""
    text = subprocess.run(["pelorus-decode", out_log, "--csv", "-q"], capture_output=True, text=True, check=False).stdout
    rows = [r for r in csv.DictReader(text.splitlines()) if r["lat_deg"] and (r["at_epoch"] == "1" or not at_epochs)]
    col = lambda name: np.array([float(r[name] or "nan") for r in rows])
    t = [r["gpst_s"].split(".") for r in rows]
    return Track(np.array([int(a) * gpstime.NS + int(b) for a, b in t], np.int64),
                 earth.llh_to_ecef(np.radians(col("lat_deg")), np.radians(col("lon_deg")), col("height_m")),
                 np.stack([col(f"vel_{a}_mps") for a in "ned"], -1), np.array([r["status"].startswith("fixed") for r in rows], bool),
                 col("n_sat"), np.radians(col("heading_deg")), np.array([r["status"].endswith("+ins") for r in rows], bool))


def peers(pos_file):
    """Solutions of RTKLIB."""
    t = truth.load(str(pos_file))
    v_n = np.full_like(t.r_e, np.nan)
    if t.v_e is not None:
        v_n = earth.rotate(earth.C_e_n(*earth.ecef_to_llh(t.r_e)[:2]), t.v_e)
    nothing = np.full(t.t_ns.size, np.nan)
    return Track(t.t_ns, t.r_e, v_n, t.quality == 1, nothing, nothing, np.zeros(t.t_ns.size, bool))


def common(track, other, within_ns=50_000_000):
    """The epochs of a track that the other one has as well (clocks of receivers may be off by milliseconds)."""
    if not other.t_ns.size:
        return Track(*(x[:0] for x in vars(track).values()))
    k = np.clip(np.searchsorted(other.t_ns, track.t_ns), 1, max(other.t_ns.size - 1, 1))
    near = np.minimum(np.abs(other.t_ns[k - 1] - track.t_ns), np.abs(other.t_ns[np.minimum(k, other.t_ns.size - 1)] - track.t_ns)) < within_ns
    return Track(*(x[near] for x in vars(track).values()))


def enu(r_e, origin):
    """East, north, up of positions about an ECEF origin."""
    lat, lon, _ = earth.ecef_to_llh(np.asarray(origin, float))
    ned = (r_e - origin) @ earth.C_e_n(lat, lon).T
    return ned[:, [1, 0, 2]] * [1, 1, -1]


def rms(x, axis=0):
    return np.sqrt(np.mean(np.square(x), axis=axis))


def shares(track, expected):
    """Epochs solved of those expected, how many are fixed, and when the first is."""
    f = {"epochs": int(track.t_ns.size), "expected": expected, "fixed": int(track.fixed.sum())}
    if track.fixed.any():
        f["first_fix_s"] = float(track.t_ns[np.argmax(track.fixed)] - track.t_ns[0]) * 1e-9
    return f


def refix_s(track, removed_ns):
    """From the first epoch after those removed to the first fixed one; NaN if there is none."""
    after = track.t_ns > np.max(removed_ns) + 100_000_000
    fixed = after & track.fixed
    return float(track.t_ns[np.argmax(fixed)] - track.t_ns[np.argmax(after)]) * 1e-9 if fixed.any() else float("nan")


def apart(track, other):
    """Two fixed tracks of one antenna: largest distance, and largest change of their difference from epoch to epoch, m."""
    a, b = common(track, other), common(other, track)
    both = a.fixed & b.fixed
    d = a.r_e - b.r_e
    change = np.linalg.norm(np.diff(d, axis=0), axis=1)[both[1:] & both[:-1]]
    return float(np.linalg.norm(d[both], axis=1).max()), float(change.max()), int(both.sum())


def baseline(track, base, want_enu, expected):
    """Static pair: mean and scatter of the fixed baselines, those more than 8 cm from the known one are wrong."""
    f = shares(track, expected)
    e = enu(track.r_e, np.asarray(base, float))[track.fixed]
    if len(e):
        f["wrong"] = int(np.sum(np.hypot(*(e - want_enu)[:, :2].T) > WRONG_FIX_M))
        f["mean_enu_m"], f["std_enu_m"] = e.mean(0).tolist(), e.std(0).tolist()
        f["mean_off_mm"] = ((e.mean(0) - want_enu) * 1e3).tolist()
    return f


def against(track, reference, expected, remove_mean):
    """Errors against a reference track at the track's times: position with its mean removed if asked, velocity as it is."""
    f = shares(track, expected)
    at, covered = reference.at(track.t_ns)
    if not covered.any():
        return f
    lat, lon, _ = earth.ecef_to_llh(at.r_e[covered])
    to_n = earth.C_e_n(lat, lon)
    ned = earth.rotate(to_n, track.r_e[covered] - at.r_e[covered])
    f["mean_ned_m"] = ned.mean(0).tolist()
    if remove_mean:
        ned = ned - ned.mean(0)
    f["h_rms_m"] = float(rms(np.hypot(ned[:, 0], ned[:, 1])))
    f["d_rms_m"] = float(rms(ned[:, 2]))
    fixed = track.fixed[covered]
    if fixed.any():
        f["wrong"] = int(np.sum(np.hypot(*ned[fixed, :2].T) > WRONG_FIX_M))
    if at.v_e is not None and np.isfinite(track.v_n[covered]).all():
        dv = track.v_n[covered] - earth.rotate(to_n, at.v_e[covered])
        f["v_rms_mps"] = rms(dv).tolist()
        f["vh_rms_mps"] = float(rms(np.hypot(dv[:, 0], dv[:, 1])))
    return f


def against_displacements(track, reference, longest_s=0.6):
    """Velocity (Simpson's mean over two epochs' span) against the displacement of the reference over it: rms NED, m/s."""
    at, covered = reference.at(track.t_ns)
    span_s = (track.t_ns[2:] - track.t_ns[:-2]) * 1e-9
    good = covered[2:] & covered[1:-1] & covered[:-2] & (span_s < longest_s)
    lat, lon, _ = earth.ecef_to_llh(at.r_e[1:-1])
    moved = earth.rotate(earth.C_e_n(lat, lon), at.r_e[2:] - at.r_e[:-2]) / span_s[:, None]
    v = (track.v_n[2:] + 4 * track.v_n[1:-1] + track.v_n[:-2]) / 6
    return rms((v - moved)[good]).tolist()


def moved(track, reference, span_s):
    """Displacement over a span, less that of the reference where it is fixed at both ends: n, rms north, east, down, m. From a second
    after the INS began: phases begin with it."""
    at, covered = reference.at(track.t_ns)
    k = np.clip(np.searchsorted(reference.t_ns, track.t_ns), 1, reference.t_ns.size - 1)
    began_ns = track.t_ns[np.argmax(track.ins)] + gpstime.NS
    good = covered & track.ins & (track.t_ns > began_ns) & (reference.quality[k] == 1) & (reference.quality[k - 1] == 1)
    off = earth.rotate(earth.C_e_n(*earth.ecef_to_llh(at.r_e)[:2]), track.r_e - at.r_e)
    j = np.clip(np.searchsorted(track.t_ns, track.t_ns + span_s * gpstime.NS - 50_000_000), 0, track.t_ns.size - 1)
    both = good & good[j] & (np.abs(track.t_ns[j] - track.t_ns - span_s * gpstime.NS) < 50_000_000)
    return {"n": int(both.sum()), "ned_m": rms((off[j] - off)[both]).tolist()}


def point(track, r_e, expected):
    """A receiver that stands still at a known place."""
    f = shares(track, expected)
    if track.t_ns.size:
        e = enu(track.r_e, np.asarray(r_e, float))
        f["mean_off_m"], f["std_enu_m"] = e.mean(0).tolist(), e.std(0).tolist()
        f["h_rms_m"], f["u_rms_m"] = float(rms(np.hypot(e[:, 0], e[:, 1]))), float(rms(e[:, 2]))
    return f
