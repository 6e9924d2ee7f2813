"""Every fault on every line at the start, when converged and in an outage, against fault_table.toml.

A cell is a capture with one fault. Expected of it: the worst status while it lasts and until it is over, and how many seconds after its
end the status is that of the undisturbed run again. No cell may tell an error beyond the bound it reports (position within hpl_m and
vpl_m, velocity and attitude within 5.33 of their sigma), but where the table has a third number: so many seconds are allowed, for what
an IMU does silently can be told only after it has done it.

    fault_campaign.py [--docs FILE] [--only TEXT] [--new-table]     prints the table; exit 1 if a cell is not as expected
"""

import argparse
import random
import sys
import tempfile
import tomllib
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
from fault_injection import CALENDAR, FAULTS, Span, outage
from pelorus_tools import eventlog, outlog
from runs import ROOT, Result, call, simulate

TABLE = Path(__file__).with_name("fault_table.toml")
DURATION_S, STARTS_S, CONVERGED_S, OUTAGE_S = 110, 2.0, 50.0, (45.0, 60.0)
PHASES = ("start", "converged", "outage")
LINES = {"imu": "UART_IMU", "rover": "UART_ROVER", "base": "UART_BASE"}
BOUND_SIGMAS = 5.33
STEADY_S = 2.0          # as good as undisturbed for this long: recovered
FIX_RANK = {0: 0, 4: 1, 1: 2, 2: 3, 3: 4}      # none, coast, spp, float, fixed


def cells():
    for name, (_, _, lines, _) in FAULTS.items():
        for line in lines:
            for phase in PHASES:
                yield name, line, phase
    for name in CALENDAR:
        for phase in PHASES:
            yield name, "all", phase


def strike_s(line, phase, length_s):
    """When a fault begins. In an outage that of the IMU strikes within; GNSS faults strike what first comes after it."""
    if phase == "start":
        return STARTS_S
    if phase == "converged":
        return CONVERGED_S
    return OUTAGE_S[0] + 3.0 if line in ("imu", "all") else OUTAGE_S[1]


def read(path):
    return [(t, c.decode(), bytes(d)) for t, c, d in eventlog.events(eventlog.open_bytes(str(path)))]


def capture(folder, name, edits=()):
    """Rows of the scenario with these edits, made once."""
    place = Path(folder) / name.replace("-", "_")
    if not (place / "faults_1.log").exists():
        place.mkdir(exist_ok=True)
        simulate(place, "faults", duration=DURATION_S, edits=edits)
    return read(place / "faults_1.log")


# The undisturbed captures: base in RTCM 3, base in UBX (whose fields can be changed), another base.
CAPTURES = {"rtcm": (), "ubx": (("base", "format", '"ubx"'),),
            "other": (("base", "lat_deg", "48.11"), ("base", "height_m", "560"), ("base", "clock_bias_us", "300"))}


def prepare(folder):
    """Make them before processes share them."""
    for name, edits in CAPTURES.items():
        capture(folder, name, edits)


def base_changes(rows, other, start_s):
    """From an instant on another station answers on the base line."""
    s = Span(rows, "UART_BASE", start_s, np.inf, None)
    kept = [r for r in rows if not s.inside(r)]
    station = [r for r in other if r[1] == "UART_BASE" and len(r[2]) < 60][-1][2]     # 1006 alone
    return sorted(kept + [(int(s.low), "UART_BASE", station)] + [r for r in other if s.inside(r)], key=lambda r: r[0])


def faulty(folder, name, line, phase):
    """(rows of the cell, rows without its fault, seconds of the fault's begin and end)."""
    if name in CALENDAR:
        week, second = CALENDAR[name]
        start_s = strike_s(line, phase, 0)
        at = week * 604800.0 + second - start_s - 0.25
        edits = (("time", "week", str(int(at // 604800))), ("time", "tow_s", f"{at % 604800}"))
        rows = capture(folder, f"{name} {phase}".replace(" ", "_"), edits)
        clean = capture(folder, "rtcm", CAPTURES["rtcm"])
        if phase == "outage":
            rows, clean = outage(rows, *OUTAGE_S), outage(clean, *OUTAGE_S)
        return rows, clean, start_s, OUTAGE_S[1] if phase == "outage" else start_s
    fault, length_s, _, fields = FAULTS[name]
    clean_name = "ubx" if fields else "rtcm"
    clean = capture(folder, clean_name, CAPTURES[clean_name])
    if phase == "outage":
        clean = outage(clean, *OUTAGE_S)
    start_s = strike_s(line, phase, length_s)
    if fault is None:
        rows = base_changes(clean, capture(folder, "other", CAPTURES["other"]), start_s)
    else:
        seed = f"{name} {line} {phase}"
        rows = fault(Span(clean, LINES[line], start_s, start_s + length_s, random.Random(seed)))
    return rows, clean, start_s, start_s + length_s + (10.0 if name.startswith("delay") else 0.0)


def run(folder, rows, tag):
    path = Path(folder) / f"{tag}.log"
    eventlog.write(path, rows)
    out = path.with_suffix(".out")
    call("pelorus-sil", path, "-o", out, "-q", ok=(0, 1, 4, 5, 6))
    result = Result(out)
    path.unlink()
    out.unlink()
    return result


def ranks(sol):
    return np.array([FIX_RANK[f] for f in sol["fix"]]) * 2 + ((sol["flags"] & 1) != 0)


def rank_at(t_ns, sol, times):
    """Rank of the newest solution at each time; none while there is none for 1.5 s."""
    k = np.searchsorted(t_ns, times, side="right") - 1
    fresh = (k >= 0) & (times - t_ns[np.maximum(k, 0)] < 1.5e9)
    return np.where(fresh, ranks(sol)[np.maximum(k, 0)], 0)


def beyond_bound(result):
    """(what, its largest error over its bound, seconds in which anything was beyond). Protection levels for position, 5.33 sigma for the rest."""
    e, sol = result.errors, result.sol
    share = {"position": e.horizontal / sol["hpl_m"], "height": np.abs(e.err["pos"][:, 2]) / sol["vpl_m"]}
    for group, name in (("vel", "velocity"), ("att", "attitude")):
        share[name] = np.max(np.nan_to_num(np.abs(e.err[group]) / e.sd[group]), axis=1) / BOUND_SIGMAS
    worst = {k: float(np.nanmax(v, initial=0.0)) for k, v in share.items()}
    what = max(worst, key=worst.get)
    beyond = np.any([np.nan_to_num(v) > 1.0 for v in share.values()], axis=0)
    return what, worst[what], 0.1 * np.unique(sol["t_ns"][beyond] // 100_000_000).size


def judge(job):
    """Everything that is said of a cell."""
    folder, name, line, phase = job
    rows, clean_rows, start_s, end_s = faulty(folder, name, line, phase)
    tag = f"{name} {line} {phase}".replace(" ", "_").replace(",", "")
    result, clean = run(folder, rows, tag), run(folder, clean_rows, tag)
    begin, clean_begin = truth_begin(result), truth_begin(clean)
    at_s = np.arange(0.0, DURATION_S - 1.0, 0.1)
    mine = rank_at(result.sol["t_ns"], result.sol, begin + at_s * 1e9)
    theirs = rank_at(clean.sol["t_ns"], clean.sol, clean_begin + at_s * 1e9)
    struck = at_s >= start_s
    worse = np.flatnonzero((mine < theirs) & struck)
    recovered = max(0.0, at_s[worse[-1]] + 0.1 - end_s) if worse.size else 0.0
    if worse.size and at_s[-1] - at_s[worse[-1]] < STEADY_S:
        recovered = np.inf
    lost = mine[worse] if worse.size else mine[struck]
    what, share, beyond = beyond_bound(result)
    span = (result.sol["t_ns"] - begin) * 1e-9
    stray = int(np.sum((span < -1.0) | (span > DURATION_S + 1.0)))
    return {"fault": name, "line": line, "phase": phase, "worst": word(lost.min()) if worse.size else "as ever",
            "recovery": recovered, "what": what, "share": share, "beyond": beyond, "stray": stray, "sound": is_sound(result.sol)}


def is_sound(sol):
    """Every number told is finite and every sigma positive: a NaN would count as within its bound."""
    heading = sol[(sol["flags"] & outlog.frames.SOL_HEADING) != 0]
    numbers = [sol[f] for f in ("r_eb_e", "v_ned", "hpl_m", "vpl_m")] + [heading[f] for f in ("roll_rad", "pitch_rad", "heading_rad")]
    variances = [c[:, (0, 3, 5)] for c in (sol["cov_r_ned"], sol["cov_v_ned"], heading["cov_att"])]
    return all(np.isfinite(x).all() for x in numbers) and all((np.isfinite(v) & (v > 0)).all() for v in variances)


def truth_begin(result):
    """Time of the first truth: the scenario's second 0."""
    from pelorus_tools import truth
    return truth.from_events(result.run.truth_events, "").t_ns[0]


def word(rank):
    fix = {v: k for k, v in FIX_RANK.items()}[int(rank) // 2]
    return outlog.frames.FIX[fix] + ("+ins" if rank % 2 else "")


def rank_of(words):
    if words == "as ever":
        return 99
    return next(r for r in range(10) if word(r) == words)


def complaints(cell, expected):
    """What is not as the table says; [] if all is."""
    out = []
    allowed = expected[2] if expected is not None and len(expected) > 2 else 0.0
    if cell["beyond"] > allowed:
        out.append(f"{cell['what']} error is {cell['share']:.2f} of its bound, {cell['beyond']:.1f} s beyond")
    if cell["stray"]:
        out.append(f"{cell['stray']} solutions of another time")
    if not cell["sound"]:
        out.append("a number not finite, or a variance not positive")
    if expected is None:
        return [*out, "not in the table"]
    worst, limit_s = expected[:2]
    if rank_of(cell["worst"]) < rank_of(worst):
        out.append(f"status fell to {cell['worst']}, expected {worst}")
    if cell["recovery"] > limit_s:
        out.append(f"recovered after {cell['recovery']:.1f} s, expected {limit_s}")
    return out


def expectations():
    table = tomllib.loads(TABLE.read_text()) if TABLE.exists() else {}
    return {(name, line, phase): value for name, lines in table.items() for line, phases in lines.items() for phase, value in phases.items()}


def campaign(chosen, folder, workers=2):
    prepare(folder)
    with ProcessPoolExecutor(workers) as pool:
        yield from pool.map(judge, [(folder, *c) for c in chosen], chunksize=1)


# ---- the whole table, and the page ----------------------------------------------------------------------------------------------

def seconds(x):
    return "never" if np.isinf(x) else f"{x:.1f} s"


HEAD = """# Faults

One fault on one line of `scenarios/faults.toml` (a car, a small IMU, a base 3 km away), at the start (2 s), when converged (50 s) and at an
outage of all GNSS (45 to 60 s; faults of the IMU within it, those of receivers in what comes first after it). `make faults` runs every cell, holds it
against `tests/scenario/fault_table.toml` and writes this page; `tests/scenario/test_faults.py` runs a part of it at each test.
Faults are made by `tests/scenario/fault_injection.py`; frames whose fields are changed get a good checksum again.

A cell says: the worst status from the fault until it is over ("as ever": never below the undisturbed run); seconds from the fault's end until the status is
that of the undisturbed run; the largest error as a share of the bound reported with it (position: protection levels; velocity and attitude:
5.33 sigma). Where the share is above 1 the seconds it lasted follow: these are IMU faults that nothing in one sample tells.

"""


def page(found):
    """docs/FAULTS.md."""
    head = "| fault | line | " + " | ".join(PHASES) + " |\n|---|---|" + "---|" * len(PHASES)
    by, out = {(c["fault"], c["line"], c["phase"]): c for c in found}, [head]
    for name, line in dict.fromkeys((c["fault"], c["line"]) for c in found):
        row = []
        for c in (by[name, line, p] for p in PHASES):
            beyond = f" for {c['beyond']:.1f} s" if c["beyond"] > 0 else ""
            row.append(f"{c['worst']}, {seconds(c['recovery'])}, {c['share']:.2f}{beyond}")
        out.append(f"| {name} | {line} | " + " | ".join(row) + " |")
    inside = sum(c["beyond"] == 0 for c in found)
    return HEAD + f"{len(found)} cells, {inside} of them never beyond a bound.\n\n" + "\n".join(out) + "\n"


def new_table(found):
    """A table of what was found, for reading and correcting by hand."""
    out, steps = [], (1, 2, 3, 5, 8, 10, 15, 20, 30, 45)
    for name, line in dict.fromkeys((c["fault"], c["line"]) for c in found):
        out.append(f'["{name}".{line}]')
        for c in found:
            if (c["fault"], c["line"]) == (name, line):
                limit = next((s for s in steps if c["recovery"] <= s), "inf")
                beyond = f", {np.ceil(c['beyond'] * 10 + 1) / 10:.1f}" if c["beyond"] > 0 else ""
                out.append(f'{c["phase"]} = ["{c["worst"]}", {limit}{beyond}]')
        out.append("")
    return "\n".join(out)


def main():
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--docs", help="write the page here")
    p.add_argument("--only", default="", help="cells whose 'fault line phase' contains this")
    p.add_argument("--new-table", action="store_true", help="print a table of what was found")
    a = p.parse_args()
    expected, found, bad = expectations(), [], 0
    chosen = [c for c in cells() if a.only in " ".join(c)]
    with tempfile.TemporaryDirectory() as folder:
        for cell in campaign(chosen, folder):
            found.append(cell)
            wrong = complaints(cell, expected.get((cell["fault"], cell["line"], cell["phase"])))
            bad += bool(wrong)
            print(f"{cell['fault']:<24} {cell['line']:<6} {cell['phase']:<10} {cell['worst']:<10} {seconds(cell['recovery']):>8}  "
                  f"{cell['what']} {cell['share']:.2f}  {'; '.join(wrong)}", flush=True)
    print(f"{len(found)} cells, {bad} not as expected")
    if a.new_table:
        print(new_table(found))
    if a.docs:
        Path(a.docs).write_text(page(found))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
