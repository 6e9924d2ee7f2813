"""pelorus-decode: output frames of the firmware -> CSV, NMEA, KML or JSON on standard output."""

import json
import math
import sys
from xml.sax.saxutils import escape

import numpy as np

from pelorus_tools import cli, frames, nmea, outlog
from pelorus_tools.gpstime import seconds_text

CSV_HEADER = ("gpst_s,status,lat_deg,lon_deg,height_m,vel_n_mps,vel_e_mps,vel_d_mps,roll_deg,pitch_deg,heading_deg,"
              "sd_n_m,sd_e_m,sd_d_m,sd_vn_mps,sd_ve_mps,sd_vd_mps,sd_roll_deg,sd_pitch_deg,sd_heading_deg,"
              "hpl_m,vpl_m,n_sat,n_fixed,ratio,base_age_s,int_reason,success_rate,nis,nis_dof,at_epoch")
COLUMNS = CSV_HEADER.split(",")


def columns(sol):
    """The columns of CSV_HEADER as lists: numbers or None where there is nothing meaningful to say, words for words."""
    flags = sol["flags"]
    position = sol["fix"] != 0
    attitude = position & ((flags & frames.SOL_ATTITUDE) != 0)
    heading = attitude & ((flags & frames.SOL_HEADING) != 0)
    epoch = (flags & frames.SOL_AT_EPOCH) != 0

    def numbers(values, where, digits):
        values = np.asarray(values, float)
        where = where & np.isfinite(values)
        return [f"{v:.{digits}f}" if ok else "" for v, ok in zip(values.tolist(), where.tolist())]

    def sd(cov, i, digits, where):
        c = sol[cov][:, (0, 3, 5)[i]].astype(float)
        return numbers(np.sqrt(np.maximum(c, 0.0)), where & (c > 0), digits)

    deg = np.degrees
    out = [[seconds_text(t) for t in sol["t_ns"].tolist()], outlog.status_words(sol).tolist(),
           numbers(deg(sol["lat_rad"]), position, 11), numbers(deg(sol["lon_rad"]), position, 11),
           numbers(sol["height_m"], position, 4)]
    out += [numbers(sol["v_ned"][:, i], position, 5) for i in range(3)]
    out += [numbers(deg(sol["roll_rad"].astype(float)), attitude, 6), numbers(deg(sol["pitch_rad"].astype(float)), attitude, 6),
            numbers(np.mod(deg(sol["heading_rad"].astype(float)), 360.0), heading, 6)]
    out += [sd("cov_r_ned", i, 5, position) for i in range(3)]
    out += [sd("cov_v_ned", i, 6, position) for i in range(3)]
    out += [numbers(deg(sol[n].astype(float)), where, 7) for n, where in
            (("sd_roll_rad", attitude), ("sd_pitch_rad", attitude), ("sd_heading_rad", heading))]
    out += [numbers(sol[n], position & (sol[n] > 0), 4) for n in ("hpl_m", "vpl_m")]
    out += [sol["n_sat"].tolist(), sol["n_fixed"].tolist(), numbers(sol["ratio"], sol["ratio"] > 0, 2),
            numbers(sol["base_age_s"], sol["base_age_s"] >= 0, 3),
            [outlog.word(frames.INT_REASON, r) for r in sol["int_reason"].tolist()],
            numbers(sol["success_rate"], sol["success_rate"] > 0, 6), numbers(sol["nis"], sol["nis_dof"] > 0, 3),
            sol["nis_dof"].tolist(), epoch.astype(int).tolist()]
    return out


def write_csv(run, out):
    out.write(CSV_HEADER + "\n")
    for row in zip(*columns(run.sol)):
        out.write(",".join(map(str, row)) + "\n")


def write_nmea(run, out):
    """As the firmware sent them; made from the solutions if it sent none."""
    lines = run.frames.nmea or (line for s in run.sol if s["fix"] != 0 for line in nmea.sentences(s))
    for line in lines:
        out.write(line + "\r\n")


def write_json(run, out):
    """One object a line: first what was used, then the solutions, then the events."""
    first = {"type": "run", "source": run.name, "solutions": int(run.sol.size),
             "used": [dict(zip(("what", "offered", "used", "why"), row)) for row in outlog.summary(run)],
             "refused": dict(run.refused), "run": run.run}
    out.write(json.dumps(first) + "\n")
    words = {"status", "int_reason"}
    for row in zip(*columns(run.sol)):
        values = (v if name in words else (None if v == "" else _number(v)) for name, v in zip(COLUMNS, row))
        out.write(json.dumps({"type": "solution", **dict(zip(COLUMNS, values))}) + "\n")
    for e in run.frames.event:
        out.write(json.dumps(event_object(e)) + "\n")


def _number(v):
    return v if isinstance(v, int) else float(v)


def event_object(e):
    d = {"type": "event", "gpst_s": float(seconds_text(int(e["t_ns"]))), "id": int(e["id"]), "status": outlog.word(frames.FIX, e["fix"]),
         "lat_deg": math.degrees(e["lat_rad"]), "lon_deg": math.degrees(e["lon_rad"]), "height_m": float(e["height_m"])}
    for angle in ("omega", "phi", "kappa"):
        d[f"{angle}_deg"] = math.degrees(float(e[f"{angle}_rad"]))
    for i, axis in enumerate("ned"):
        d[f"sd_{axis}_m"] = float(e["sd_r_m"][i])
        d[f"sd_att_{axis}_deg"] = math.degrees(float(e["sd_att_rad"][i]))
    return d


# aabbggrr, as KML has it; the same hues as the report
KML_COLOUR = {"none": "ffb0b0b0", "spp": "ffb08a6b", "float": "ff2f9fe0", "fixed": "ff5a8f2e", "coast": "ff4d4fc0"}


def write_kml(run, out):
    """The track, one line string for each stretch of one status, and the event marks."""
    sol = run.sol[run.sol["fix"] != 0]
    out.write('<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2">\n<Document>\n')
    out.write(f"<name>{escape(run.name)}</name>\n")
    for word, colour in KML_COLOUR.items():
        out.write(f'<Style id="{word}"><LineStyle><color>{colour}</color><width>3</width></LineStyle></Style>\n')
    out.write('<Style id="event"><IconStyle><scale>0.5</scale></IconStyle></Style>\n')
    lon, lat = np.degrees(sol["lon_rad"]), np.degrees(sol["lat_rad"])
    cut = np.flatnonzero(np.diff(sol["fix"])) + 1
    for a, b in zip([0, *cut], [*cut, sol.size]):
        if b == a:
            continue
        word = outlog.word(frames.FIX, sol["fix"][a])
        # A stretch begins where the one before it ends, so that the track has no holes.
        k = range(max(a - 1, 0), b)
        points = " ".join(f"{lon[i]:.9f},{lat[i]:.9f},{sol['height_m'][i]:.3f}" for i in k)
        out.write(f"<Placemark><name>{word}</name><styleUrl>#{word}</styleUrl><LineString><altitudeMode>absolute</altitudeMode>"
                  f"<coordinates>{points}</coordinates></LineString></Placemark>\n")
    for e in run.frames.event:
        out.write(f"<Placemark><name>event {e['id']}</name><styleUrl>#event</styleUrl><Point><altitudeMode>absolute</altitudeMode>"
                  f"<coordinates>{math.degrees(e['lon_rad']):.9f},{math.degrees(e['lat_rad']):.9f},{e['height_m']:.3f}</coordinates></Point></Placemark>\n")
    out.write("</Document>\n</kml>\n")


WRITERS = {"csv": write_csv, "nmea": write_nmea, "kml": write_kml, "json": write_json}


def body(argv):
    p = cli.Parser(prog="pelorus-decode", description=__doc__,
                   epilog="exit: 0 done, 2 wrong usage, 3 input unreadable, 4 parts of the input refused (causes on standard error)")
    p.add_argument("out", metavar="OUT", help="what pelorus-sil wrote, or the raw bytes of a board's output port; '-' is standard input")
    form = p.add_mutually_exclusive_group(required=True)
    form.add_argument("--csv", dest="form", action="store_const", const="csv", help="one row a solution, units in the header")
    form.add_argument("--nmea", dest="form", action="store_const", const="nmea", help="GGA, RMC, HDT")
    form.add_argument("--kml", dest="form", action="store_const", const="kml", help="the track, coloured by status")
    form.add_argument("--json", dest="form", action="store_const", const="json", help="one object a line")
    args = p.parse_args(argv)

    progress = cli.Progress("reading", args.quiet)
    run = outlog.load(args.out, progress, want_truth=False)
    progress.done()
    if not args.quiet and args.form != "json":
        print("\n".join(outlog.describe(run)), file=sys.stderr)
    WRITERS[args.form](run, sys.stdout)
    sys.stdout.flush()
    if run.refused:
        print("\n".join(outlog.refused_lines(run)), file=sys.stderr)
        return cli.PARTLY
    return cli.DONE


def main(argv=None):
    return cli.run("pelorus-decode", body, argv)


if __name__ == "__main__":
    sys.exit(main())
