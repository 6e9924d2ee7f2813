"""pelorus-report: one run of the firmware as one offline HTML page, its figures as CSV, its limits as exit code."""

import argparse
import sys
from pathlib import Path

import jinja2
import numpy as np

from pelorus_tools import __version__, cli, frames, outlog, plots, stats, truth
from pelorus_tools.gpstime import text

GOOD, FAIR, BAD = "good", "fair", "bad"


def verdict(s, limits, refused):
    """(level, headline, sentences): what somebody wants to know who reads nothing else."""
    level, says = GOOD, []

    def worse(to):
        nonlocal level
        level = max(level, to, key=(GOOD, FAIR, BAD).index)

    head = f"{s.fixed} of {s.epochs} epochs fixed" if s.fixed else _without_fix(s)
    if s.wrong is not None:
        if s.compared_fixed:
            head += ", no wrong integer" if s.wrong == 0 else f", {s.wrong} wrong fixes"
            if s.wrong:
                worse(BAD)
        p = [s.table.get(("pos", a)) for a in "ned"]
        if all(p):
            says.append("Position error " + _three([c["rms"] for c in p], (("mm", 1e3, 1.0), ("m", 1.0, 1e9))) + " rms north, east, down"
                        + f", {_three([max(c['max'] for c in p)], (('mm', 1e3, 1.0), ('m', 1.0, 1e9)))} at most.")
        v = [s.table.get(("vel", a)) for a in "ned"]
        if all(v):
            says.append("Velocity error " + _three([c["rms"] for c in v], (("mm/s", 1e3, 1.0), ("m/s", 1.0, 1e9))) + " rms.")
        a = [s.table.get(("att", x)) for x in "ned"]
        if all(a):
            factor, unit = (stats.ARCSEC, "arcsec") if a[2]["rms"] * stats.ARCSEC < 600 else (np.degrees(1.0), "deg")
            says.append(f"Tilt {a[0]['rms'] * factor:.2f} and {a[1]['rms'] * factor:.2f}, heading {a[2]['rms'] * factor:.2f} {unit} rms.")
        ratios = {k: c["ratio"] for k, c in s.table.items() if np.isfinite(c["ratio"])}
        if ratios:
            low, high = min(ratios.values()), max(ratios.values())
            says.append(f"Errors are {low:.2f} to {high:.2f} times what the filter claims.")
            if low < 0.5 or high > 1.5:
                worse(FAIR)
                says[-1] += " A ratio far from one is a defect in either direction."
    else:
        says.append("No truth: consistency is judged by the innovations alone.")
    if np.isfinite(s.nis_ratio):
        says.append(f"Innovations are {np.sqrt(s.nis_ratio):.2f} times as large as predicted.")
        if not 0.5 < s.nis_ratio < 2.0:
            worse(FAIR)
    missed = [limit for limit, (met, _) in limits if not met]
    if limits:
        says.append(("All limits met" if not missed else f"{len(missed)} of {len(limits)} limits missed") + ("." if not missed else ": " + ", ".join(limit.words() for limit in missed) + "."))
        if missed:
            worse(BAD)
    if refused:
        says.append(f"Parts of the input were refused ({sum(refused.values())}, by cause below).")
        worse(FAIR)
    return level, head[0].upper() + head[1:], says


def _without_fix(s):
    best = max(s.status_share, key=s.status_share.get)
    return f"{100 * s.status_share[best]:.1f} % of the solutions are {best}"


def _three(values, units):
    for unit, factor, below in units:
        if max(values) < below:
            return " / ".join(f"{v * factor:.3g}" for v in values) + f" {unit}"
    return ""


def statistics_rows(s):
    """Rows of the table of errors, each in the unit in which it reads well."""
    rows = []
    for name, axes, _, _, words in stats.GROUPS:
        parts = [s.table.get((name, a)) for a in axes]
        if not all(parts):
            continue
        biggest = max(c["rms"] for c in parts)
        if name == "att":
            factor, unit = (stats.ARCSEC, "arcsec") if biggest * stats.ARCSEC < 600 else (float(np.degrees(1.0)), "deg")
        else:
            factor, unit = (1e3, "mm") if biggest < 1.0 else (1.0, "m")
            unit += "/s" if name == "vel" else ""
        label = {"n": "north", "e": "east", "d": "down"} if name != "att" else {"n": "tilt about north", "e": "tilt about east", "d": "heading"}
        for axis, c in zip(axes, parts):
            rows.append({"group": words, "axis": label[axis], "unit": unit, "odd": not 0.7 <= c["ratio"] <= 1.3,
                         **{k: f"{c[k] * factor:.3g}" for k in ("rms", "p95", "max", "sigma", "mean")}, "ratio": f"{c['ratio']:.2f}"})
    return rows


def counter_groups(run):
    """Counters by who counted: (title, [(words, number, is it trouble)])."""
    c = run.counters
    groups = []
    good = {"frames", "unknown", "epochs_used", "imu_used", "rows_used", "sats_low", "fix_tried", "fix_ok", "events"}
    if c is not None:
        groups.append(("Navigator", [(n.replace("_", " "), int(c["nav"][n]), n not in good) for n in frames.NAV_COUNTERS]))
        for port in ("imu", "rover", "base"):
            if not any(c[port].tolist()):
                continue      # nothing is connected there
            groups.append((f"Decoder, {port} port", [(n.replace("_", " "), int(c[port][n]), n not in good) for n in frames.WIRE_COUNTERS]))
    if run.refused:
        groups.append(("This output log", [(k, n, True) for k, n in sorted(run.refused.items())]))
    return groups


def how_to_repeat(run):
    """Command lines that lead to this output, and what else the logs tell of themselves."""
    lines = [source["command"] for source in (run.scenario, run.run) if isinstance(source.get("command"), str)]
    facts = [(key, value) for source in (run.scenario, run.run) for key, value in source.items()
             if key not in ("command", "program") and isinstance(value, str | int | float)]
    return lines, facts


def event_rows(run, limit=12):
    rows = []
    for e in run.frames.event[:limit]:
        rows.append([int(e["id"]), text(int(e["t_ns"]), 6), outlog.word(frames.FIX, e["fix"]), f"{np.degrees(e['lat_rad']):.9f}",
                     f"{np.degrees(e['lon_rad']):.9f}", f"{e['height_m']:.3f}",
                     *(f"{np.degrees(float(e[f'{a}_rad'])):.5f}" for a in ("omega", "phi", "kappa")),
                     f"{1e3 * float(np.max(e['sd_r_m'])):.1f}", f"{stats.ARCSEC * float(np.max(e['sd_att_rad'])):.1f}"])
    return rows


def render(run, s, errors, limits, picture, title):
    """The page as text."""
    figures = {"map": picture.map(), "timeline": picture.timeline(), "innovations": picture.innovations(), "sky": picture.sky()}
    if errors is not None:
        for group in ("pos", "vel", "att"):
            if group in errors.err and np.isfinite(errors.err[group]).any():
                figures[group] = picture.error_figure(group)
    if ((run.sol["flags"] & frames.SOL_INS) != 0).any():
        figures["biases"] = picture.biases()
    level, headline, says = verdict(s, limits, run.refused)
    lines, facts = how_to_repeat(run)
    env = jinja2.Environment(loader=jinja2.FileSystemLoader(Path(__file__).parent), autoescape=True, trim_blocks=True, lstrip_blocks=True)
    return env.get_template("report.html.j2").render(
        title=title, version=__version__, level=level, headline=headline, says=says, run=run, s=s, limits=limits,
        begin=text(run.sol["t_ns"][0]), end=text(run.sol["t_ns"][-1]), used=outlog.summary(run), rows=statistics_rows(s),
        truth=errors.source if errors is not None else None, offset=errors.mean_offset if errors is not None else None,
        groups=counter_groups(run), lines=lines, facts=facts, setup=run.setup_text, events=event_rows(run), n_events=run.frames.event.size,
        fig={name: jinja2.utils.markupsafe.Markup(plots.svg(f)) for name, f in figures.items()})


def find_truth(args, run, progress):
    if args.truth:
        return truth.load(args.truth, progress)
    return truth.from_events(run.truth_events, run.name)


def window(words):
    try:
        a, b = (float(x) for x in words.split(","))
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{words}' is not START,END in seconds") from None
    return a, b


def limit(words):
    try:
        return stats.Limit(words)
    except ValueError as e:
        raise argparse.ArgumentTypeError(str(e)) from None


def body(argv):
    p = cli.Parser(prog="pelorus-report", description=__doc__, epilog=
                   "Limits take any name that --csv-stats prints: NAME=VALUE is at most (for shares and counts of good things at least), "
                   "NAME=LOW..HIGH a range.\nexit: 0 done, 1 a limit was missed, 2 wrong usage, 3 input unreadable, 4 parts of the input refused")
    p.add_argument("out", metavar="OUT", help="what pelorus-sil wrote; '-' is standard input")
    p.add_argument("--truth", metavar="FILE", help="capture with TRUTH, CSV of pelorus-decode, or RTKLIB .pos (default: TRUTH in OUT)")
    p.add_argument("--remove-mean", action="store_true", help="remove the mean position error first (truth whose datum is not absolute)")
    p.add_argument("-o", "--output", metavar="FILE", help="write the page here; '-' is standard output")
    p.add_argument("--png", metavar="FILE", help="write a summary picture here")
    p.add_argument("--csv-stats", action="store_true", help="print name,value of every figure on standard output")
    p.add_argument("--limit", metavar="NAME=VALUE", type=limit, action="append", default=[], help="exit 1 if this figure misses (may be repeated)")
    p.add_argument("--window", metavar="START,END", type=window, help="judge only these seconds after the first solution")
    p.add_argument("--title", help="headline of the page (default: name of the scenario or file)")
    args = p.parse_args(argv)
    if not (args.output or args.png or args.csv_stats or args.limit):
        raise cli.UsageError("nothing to do: give -o FILE, --png FILE, --csv-stats or --limit")
    if args.output == "-" and args.csv_stats:
        raise cli.UsageError("-o - and --csv-stats both want standard output")

    progress = cli.Progress("reading", args.quiet)
    run = outlog.load(args.out, progress)
    reference = find_truth(args, run, progress)
    progress.done()
    errors = None
    if reference is not None:
        errors = stats.Errors(run.sol, reference, args.remove_mean, run.lever_ba_b)
        errors.source = "TRUTH in this log" if not args.truth else Path(args.truth).name
        if not errors.have.any():
            print("pelorus-report: truth and solutions have no time in common", file=sys.stderr)
            errors = None
    s = stats.Stats(run, errors, args.window)
    flat = s.flat()
    for wanted in args.limit:
        if wanted.name not in flat and wanted.name not in every_name():
            raise cli.UsageError(f"unknown limit '{wanted.name}'{cli.nearest(wanted.name, every_name())}")
    limits = [(wanted, wanted.check(flat)) for wanted in args.limit]

    if not args.quiet:
        print("\n".join(outlog.describe(run)), file=sys.stderr)
    plots.style()
    title = args.title or run_title(run)
    station = run.used["r_station_e"] if run.used is not None and np.any(run.used["r_station_e"] != 0) else None
    if args.output or args.png:
        picture = plots.Picture(run, errors, station)
        if args.png:
            plots.png(picture.summary(title), args.png)
        if args.output:
            page = render(run, s, errors, limits, picture, title)
            if args.output == "-":
                sys.stdout.write(page)
            else:
                Path(args.output).write_text(page, encoding="utf-8")
    if args.csv_stats:
        print("name,value")
        for name, value in flat.items():
            print(f"{name},{value:.9g}")
    for wanted, (met, value) in limits:
        if not met or args.verbose:
            print(f"pelorus-report: {'met' if met else 'missed'}: {wanted.words()}, is {value:.4g}", file=sys.stderr)
    if any(not met for _, (met, _) in limits):
        return cli.MISSED
    if run.refused:
        print("\n".join(outlog.refused_lines(run)), file=sys.stderr)
        return cli.PARTLY
    return cli.DONE


def every_name():
    """All names a figure can have, whether or not this run has it."""
    names = ["duration_s", "solutions", "epochs", "fixed_epochs", "fixed_share", "nis_ratio", "wrong_fixes", "wrong_fix_share", "pos_h_rms_m", "pos_h_max_m"]
    names += [f"share_{w}" for w in frames.FIX]
    for name, axes, unit, _, _ in stats.GROUPS:
        for a in axes:
            names += [f"{name}_{a}_{k}_{unit}" for k in ("rms", "max", "sigma", "p95", "mean")] + [f"{name}_{a}_ratio"]
    return names


def run_title(run):
    return str(run.scenario.get("name") or Path(run.name).name)


def main(argv=None):
    return cli.run("pelorus-report", body, argv)


if __name__ == "__main__":
    sys.exit(main())
