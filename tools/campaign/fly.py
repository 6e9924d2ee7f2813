"""One flight: simulator, firmware, figures."""

import re
import subprocess
from pathlib import Path

import numpy as np

from campaign import scenario
from pelorus_tools import frames, outlog, stats, truth

ROOT = Path(__file__).resolve().parents[2]
GROUPS = {"attitude": "att", "velocity": "vel", "position": "pos"}
FACTOR = {"attitude": stats.ARCSEC, "velocity": 1.0, "position": 1.0}
ENU = [1, 0, 2]         # of north, east, down: signs do not matter here


def call(*command):
    subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True)


def fly(case, seed, folder):
    """Figures of one seed: mean squares of error and sigma, NEES at the window's end, fixes. The files are removed."""
    name = Path(folder) / re.sub(r"\W+", "_", f"{case['system']} {case['name']} {seed}")
    text = (ROOT / "scenarios" / f"{case['scenario']}.toml").read_text()
    source, capture, out = (name.with_suffix(s) for s in (".toml", ".log", ".out"))
    source.write_text(scenario.edited(text, {k: scenario.literal(v) for k, v in case.get("set", {}).items()}))
    call("pelorus-sim", source, "-o", capture, "--seed", seed, "-q")
    call("pelorus-sil", capture, "-o", out, "-q")
    figures = measure(outlog.load(str(out)), case)
    for path in (source, capture, out):
        path.unlink()
    return figures


def measure(run, case):
    reference = truth.from_events(run.truth_events, run.name)
    errors = stats.Errors(run.sol, reference, lever_ba_b=run.lever_ba_b)
    t = (run.sol["t_ns"] - reference.t_ns[0]) * 1e-9
    epoch = (run.sol["flags"] & frames.SOL_AT_EPOCH) != 0
    fixed = np.flatnonzero(epoch & (run.sol["fix"] == frames.FIX.index("fixed")))
    low, high = case["window_s"]
    inside = epoch & (t > low) & (t <= high) & np.isfinite(errors.err["att"]).all(1) & errors.have
    if not inside.any():
        raise RuntimeError(f"{run.name}: nothing to compare within {low} to {high} s")
    wrong = fixed[errors.horizontal[fixed] > stats.WRONG_FIX_M]
    figures = {"epochs": int(epoch.sum()), "fixed": int(fixed.size), "wrong": int(wrong.size),
               "first_fix_s": float(t[fixed[0]]) if fixed.size else np.inf,
               "nis": float(run.sol["nis"][epoch].astype(float).sum()), "nis_dof": int(run.sol["nis_dof"][epoch].astype(int).sum())}
    last = np.flatnonzero(inside)[-1]
    figures["end_h_m"], figures["end_nees_h"] = float(errors.horizontal[last]), horizontal_nees(run.sol[last], errors.err["pos"][last])
    for name, group in GROUPS.items():
        figures[name] = (np.mean(errors.err[group][inside] ** 2, 0)[ENU], np.mean(errors.sd[group][inside] ** 2, 0)[ENU])
        figures[f"{name}_nees"] = float(stats.nees(run.sol, errors, group)[last])
    return figures


def horizontal_nees(solution, ned_m):
    """Half of it: two components, one expected."""
    c = solution["cov_r_ned"].astype(float)
    return float(ned_m[:2] @ np.linalg.solve([[c[0], c[1]], [c[1], c[3]]], ned_m[:2]) / 2.0)


def pool(flights):
    """Figures over seeds: rms and sigma of each component in the table's units, and the rest as means, sums or worst cases."""
    out = {"seeds": len(flights), "first_fix_s": max(f["first_fix_s"] for f in flights)}
    for name in ("epochs", "fixed", "wrong"):
        out[name] = sum(f[name] for f in flights)
    out["nis"] = sum(f["nis"] for f in flights) / max(1, sum(f["nis_dof"] for f in flights))
    out["end_h_m"] = float(np.sqrt(np.mean([f["end_h_m"] ** 2 for f in flights])))
    out["end_nees_h"] = float(np.mean([f["end_nees_h"] for f in flights]))
    for name, factor in FACTOR.items():
        rms, sigma = (np.sqrt(np.mean([f[name][k] for f in flights], 0)) * factor for k in (0, 1))
        out[name] = {"rms": rms, "sigma": sigma, "nees": float(np.mean([f[f"{name}_nees"] for f in flights]))}
    return out
