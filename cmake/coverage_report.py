"""The report of `make coverage`, from llvm-cov export: a table by room, and the files that are not whole.

coverage_report.py EXPORT.json [--page PAGE.md]       the table; it also replaces what stands between the page's markers
coverage_report.py EXPORT.json --missing ROOM...      of these rooms, each line, branch and condition that is missing
"""
import argparse
import json
from collections import defaultdict

KINDS = ("lines", "branches", "mcdc")
MARKERS = ("<!-- begin: figures of make coverage -->\n", "<!-- end -->\n")


def row(name, sums):
    def percent(covered, count):
        return 100.0 * covered / count if count else 100.0

    cells = "".join(f"{percent(*sums[k]):9.1f} ({sums[k][1] - sums[k][0]})".ljust(20) for k in KINDS)
    return f"{name:<34}{cells.rstrip()}"


def sums_of(file):
    return {k: (file["summary"].get(k, {}).get("covered", 0), file["summary"].get(k, {}).get("count", 0)) for k in KINDS}


def short_name(file):
    return file["filename"].split("firmware/src/")[-1]


def table(files, whole="all of firmware/"):
    rooms = defaultdict(lambda: {k: [0, 0] for k in KINDS})
    for file in files:
        for room in (short_name(file).split("/")[0], whole):
            for k, (covered, count) in sums_of(file).items():
                rooms[room][k][0] += covered
                rooms[room][k][1] += count
    head = f"{'':<34}{'% lines (missing)':<20}{'% branches':<20}{'% conditions (MC/DC)'}"
    return [head] + [row(room, rooms[room]) for room in sorted(rooms, key=lambda r: (r == whole, r))]


def not_whole(files):
    short = [(short_name(f), sums_of(f)) for f in files if any(c < n for c, n in sums_of(f).values())]
    return [row(*s) for s in sorted(short, key=lambda s: sum(s[1][k][0] - s[1][k][1] for k in KINDS))]


def put_into(page, lines):
    text = open(page).read()
    before, rest = text.split(MARKERS[0])
    after = rest.split(MARKERS[1])[1]
    figures = "".join(f"    {line}\n" for line in lines)
    open(page, "w").write(f"{before}{MARKERS[0]}\n{figures}\n{MARKERS[1]}{after}")


def gaps(file):
    """(line, what) of all that is missing in a file; what several objects compile is counted together."""
    source = open(file["filename"]).read().split("\n")

    def text(at):
        line, column, end_line, end_column = at
        return source[line - 1][column - 1:end_column - 1] if line == end_line else source[line - 1][column - 1:] + " ..."

    for line, _, count, has_count, is_entry, *_ in file["segments"]:
        if has_count and is_entry and count == 0:
            yield line, f"never runs: {source[line - 1].strip()}"
    branches = defaultdict(lambda: [0, 0])
    for *at, true, false in (b[:6] for b in file["branches"]):
        branches[tuple(at)][0] += true
        branches[tuple(at)][1] += false
    for at, taken in branches.items():
        for outcome, count in zip(("true", "false"), taken):
            if count == 0:
                yield at[0], f"never {outcome}: {text(at)}"
    for record in file.get("mcdc_records", []):
        covered = next(x for x in record if isinstance(x, list))
        which = ", ".join(str(i + 1) for i, c in enumerate(covered) if not c)
        if which:
            yield record[0], f"condition {which} of {len(covered)} never decides: {text(record[:4])}"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("export")
    parser.add_argument("--page")
    parser.add_argument("--missing", nargs="+", metavar="ROOM")
    args = parser.parse_args()
    files = json.load(open(args.export))["data"][0]["files"]
    if args.missing:
        files = [f for f in files if short_name(f).split("/")[0] in args.missing]
        for file in files:
            for line, what in sorted(gaps(file)):
                print(f"{short_name(file)}:{line}: {what}")
        print("\n".join(table(files, "together")))
        return
    lines = table(files)
    print("\n".join(lines + ["", "files with something missing"] + not_whole(files)))
    if args.page:
        put_into(args.page, lines)


if __name__ == "__main__":
    main()
