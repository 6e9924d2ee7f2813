"""make replay: recordings of real receivers through the firmware, one table, RTKLIB on the same epochs beside it."""

import json
import os
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from pelorus_tools import cli, eventlog
from replay import car, pillars, recordings, rtklib, tracks

ROOT = Path(__file__).resolve().parents[2]


class Failed(Exception):
    """One of our programs failed on a recording; str() says which and how."""


def data_folder(given):
    for folder in (given, os.environ.get("PELORUS_DATA"), ROOT.parent / "shared" / "data"):
        if folder and Path(folder).is_dir():
            return Path(folder)
    return None


def call(command, allowed, verbose):
    command = [str(c) for c in command]
    if verbose:
        print("> " + shlex.join(command), file=sys.stderr)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if verbose and done.stderr:
        print(done.stderr.rstrip(), file=sys.stderr)
    if done.returncode not in allowed:
        raise Failed(f"{command[0]} ended with {done.returncode}: {(done.stderr or done.stdout).strip().splitlines()[-1:] or ['no words']}")
    return done


def replay(entry, data, work, verbose=False):
    """Run our programs on one recording; returns its track, its figures and the epochs of the artificial outage."""
    work.mkdir(parents=True, exist_ok=True)
    capture = [a.format(data=data) for a in entry.capture]
    # Real recordings hold bytes that are rightly refused (truncated last frames, absurd ionospheres): 4 is no failure.
    call(["pelorus-capture", "-o", work / "capture.log", *capture], (0, 4), verbose)
    config = []
    if entry.config:
        (work / "config.toml").write_text(entry.config)
        config = ["--config", work / "config.toml"]
    def run(name, *more):
        call(["pelorus-sil", work / "capture.log", "-o", work / name, *config, *more], (0, 4), verbose)
        # Where the recording is about a gap, what is said between epochs is the point.
        return tracks.ours(work / name, at_epochs=not (entry.sil or entry.gaps))

    start = time.monotonic()
    if entry.gaps:
        runs = [(run(f"gaps{i}.out", *car.gap_options(batch)), batch) for i, batch in enumerate(entry.gaps)]
        figures = entry.known(runs, data)
        figures["seconds"] = round(time.monotonic() - start, 2)
        return None, figures, ()
    track = run("run.out", *entry.sil)
    spent = time.monotonic() - start
    figures = entry.known(track, data)
    figures["seconds"] = round(spent, 2)
    removed_ns = ()
    if entry.refix and track.fixed.any():
        gap = run("gap.out", "--outage", middle_of(work / "capture.log"))
        removed_ns = track.t_ns[np.abs(track.t_ns[:, None] - gap.t_ns[None, :]).min(1) > 100_000_000]
        figures["refix_s"] = tracks.refix_s(gap, removed_ns)
    return track, figures, removed_ns


PILLARS = "valencia-pillars-2016"


def pillars_row(folder):
    """Three epochs of two calibration pillars: satellites are given, so only the integer engine takes part, without a navigator."""
    row = {"name": PILLARS, "mode": "L1 code and phase, each epoch alone", "ours": None, "peer": None, "failed": ""}
    try:
        f = pillars.figures(folder)
        row["ours"] = {"epochs": f["epochs"], "expected": 3, "fixed": f["fixed_promised"], "wrong": f["wrong"], "pillar_mm": max(f["off_mm"])}
    except OSError as why:
        row["failed"] = f"peer_integers: {why.strerror} (make replay builds it)"
    return row


def folder_of(name):
    return name.replace(" ", "-").replace(",", "")


def middle_of(capture):
    """START,LENGTH of the 10 s that begin just before the middle of the rover's events."""
    seen = [t_us for t_us, channel, _ in eventlog.events(eventlog.open_bytes(str(capture))) if channel == b"UART_ROVER"]
    first = next(t_us for t_us, channel, _ in eventlog.events(eventlog.open_bytes(str(capture))) if channel in (b"UART_ROVER", b"UART_BASE"))
    middle_us = seen[np.searchsorted(seen, (seen[0] + seen[-1]) / 2)]
    return f"{(middle_us - first) * 1e-6 - 0.4:.3f},10"


def numbers(values, digits, scale=1.0):
    return " ".join(f"{v * scale:.{digits}f}" for v in values)


def words(f):
    """The figures of one side of a row."""
    if f is None:
        return ["", "", "", "", "", ""]
    share = f"{f['fixed']} ({100 * f['fixed'] / f['epochs']:.1f} %)" if f.get("fixed") else ("0" if f["epochs"] else "")
    judged = f.get("compared", f.get("fixed"))  # a fix that nothing can be held against is neither right nor wrong
    wrong = f"{f['wrong']} ({100 * f['wrong'] / judged:.1f} %)" if judged and "wrong" in f else ""
    parts = []
    if "mean_enu_m" in f:
        parts.append(f"mean {numbers(f['mean_off_mm'], 1)} mm off, std {numbers(f['std_enu_m'], 1, 1e3)} mm ENU")
    if "up_m" in f:
        parts.append("up {:.2f} to {:.2f} m".format(f["up_m"][0], f["up_m"][2]))
    if "pillar_mm" in f:
        parts.append(f"within {f['pillar_mm']:.1f} mm of the pillar; 1 % of failures promised")
    if "gap_h_max_m" in f:
        how = "" if f["gap_said"] else " (silent: its last position and velocity carried on)"
        parts.append(f"in the gap {f['gap_h_rms_m']:.2f} m rms, {f['gap_h_max_m']:.2f} m at most{how}")
    if "h_rms_m" in f:
        same = f" ({f['h_rms_same_m']:.2f} m on our epochs)" if f.get("h_rms_same_m") else ""
        parts.append(f"{f['h_rms_m']:.2f} m rms horizontal{same}")
    if "v_rms_mps" in f:
        parts.append(f"velocity {numbers(f['v_rms_mps'], 3)} m/s rms NED")
    for span_s, d in f.get("moved", {}).items():
        parts.append(f"moved in {span_s} s: {numbers(d['ned_m'], 1, 100.0)} cm rms NED off")
    if "heading_rms_deg" in f:
        parts.append(f"heading {f['heading_rms_deg']:.2f} deg rms")
    if "growth_max_m" in f:
        parts.append(f"{f['gaps']} gaps: error grows {f['growth_median_m']:.1f} m median, {f['growth_max_m']:.1f} m at most "
                     f"(true velocity carried on: {f['carried_median_m']:.0f} m, {f['carried_max_m']:.0f} m)")
    if "compared" in f and "h_median_m" in f:
        parts.append(f"{100 * f['h_median_m']:.1f} cm median to {f['compared']} fixes of the receiver, {f['far']} beyond 0.5 m")
    if "step_max_m" in f:
        parts.append(f"longest step {f['step_max_m']:.2f} m")
    expected = f"/{f['expected']}" if f.get("expected") else ""
    first, again = (f"{f[k]:.0f} s" if k in f else "" for k in ("first_fix_s", "refix_s"))
    return [f"{f['epochs']}{expected}", share, wrong, first, again, "; ".join(parts)]


HEAD = ["recording", "who", "epochs", "fixed", "wrong fixes", "first", "again", "figures"]


def table(results):
    rows = [HEAD]
    for r in results:
        rows.append([r["name"], "Pelorus", *(words(r["ours"]) if r["ours"] else [""] * 5 + [r["failed"]])])
        if r["peer"]:
            rows.append(["  " + r["mode"], "RTKLIB", *words(r["peer"])])
        else:
            rows.append(["  " + r["mode"]] + [""] * (len(HEAD) - 1))
    width = [max(len(row[i]) for row in rows) for i in range(len(HEAD))]
    lines = ["  ".join(cell.ljust(w) for cell, w in zip(row, width)).rstrip() for row in rows]
    return "\n".join([lines[0], "-" * len(lines[0]), *lines[1:]])


def body(argv):
    p = cli.Parser(prog="replay", description=__doc__)
    p.add_argument("names", nargs="*", metavar="RECORDING", help="rows whose name contains one of these words (default: all)")
    p.add_argument("--data", metavar="DIR", help="folder of the recordings (default: $PELORUS_DATA, ../shared/data)")
    p.add_argument("--keep", metavar="DIR", help="keep captures and outputs here")
    p.add_argument("--json", metavar="FILE", help="write all figures here")
    p.add_argument("--no-peer", action="store_true", help="do not run RTKLIB")
    args = p.parse_args(argv)
    data = data_folder(args.data)
    if data is None:
        if os.environ.get("PELORUS_REQUIRE_DATA") == "1":
            raise cli.UnreadableError("no recordings: give --data DIR or set PELORUS_DATA")
        print("no recordings here (give --data DIR or set PELORUS_DATA): nothing replayed")
        return cli.DONE
    chosen = [e for e in recordings.ALL if not args.names or any(n in e.name for n in args.names)]
    if not chosen:
        known = [e.name for e in recordings.ALL]
        raise cli.UsageError(f"no recording named '{args.names[0]}'{cli.nearest(args.names[0], known)}")
    peer = rtklib.available() and not args.no_peer
    if not rtklib.available():
        print("RTKLIB is not installed (Debian package rtklib): its rows stay empty", file=sys.stderr)
    results = []
    with tempfile.TemporaryDirectory() as scratch:
        keep = Path(args.keep or scratch)
        for e in chosen:
            if not (data / e.folder).is_dir():
                results.append({"name": e.name, "mode": e.mode, "ours": None, "peer": None, "failed": "recording absent"})
                continue
            work = keep / folder_of(e.name)
            r = {"name": e.name, "mode": e.mode, "ours": None, "peer": None, "failed": ""}
            ours, removed_ns = None, ()
            try:
                ours, r["ours"], removed_ns = replay(e, data / e.folder, work, args.verbose)
            except Failed as why:
                r["failed"] = str(why)
            if peer and e.peer:
                work.mkdir(parents=True, exist_ok=True)
                theirs = e.peer(data / e.folder, work)
                r["peer"] = e.known(theirs, data / e.folder)
                if len(removed_ns):
                    r["peer"]["refix_s"] = tracks.refix_s(e.peer(data / e.folder, work, removed_ns), removed_ns)
                if ours is not None and "h_rms_m" in r["peer"]:
                    r["peer"]["h_rms_same_m"] = e.known(tracks.common(theirs, ours), data / e.folder).get("h_rms_m")
            results.append(r)
    if (data / PILLARS).is_dir() and (not args.names or any(n in PILLARS for n in args.names)):
        results.append(pillars_row(data / PILLARS))
    print(table(results))
    print("fixed: share of the epochs solved; wrong: beyond 8 cm horizontally, of those that can be compared; first: seconds to the first fix; again: after 10 s removed in the middle")
    if args.json:
        Path(args.json).write_text(json.dumps(results, indent=1))
    return cli.MISSED if any(r["failed"] for r in results) else cli.DONE


if __name__ == "__main__":
    sys.exit(cli.run("replay", body, None))
