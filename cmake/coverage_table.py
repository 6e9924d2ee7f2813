"""The table of `make coverage`: by room, and the files that are not whole. Input: llvm-cov export -summary-only."""
import json
import sys
from collections import defaultdict

KINDS = ("lines", "branches", "mcdc")


def percent(covered, count):
    return 100.0 * covered / count if count else 100.0


def row(name, sums):
    cells = "".join(f"{percent(*sums[k]):9.1f} ({sums[k][1] - sums[k][0]})".ljust(20) for k in KINDS)
    print(f"{name:<34}{cells.rstrip()}")


def main():
    files = json.load(open(sys.argv[1]))["data"][0]["files"]
    rooms = defaultdict(lambda: {k: [0, 0] for k in KINDS})
    short = []
    for f in files:
        name = f["filename"].split("firmware/src/")[-1]
        sums = {k: (f["summary"].get(k, {}).get("covered", 0), f["summary"].get(k, {}).get("count", 0)) for k in KINDS}
        for room in (name.split("/")[0], "all of firmware/"):
            for k in KINDS:
                rooms[room][k][0] += sums[k][0]
                rooms[room][k][1] += sums[k][1]
        if any(c < n for c, n in sums.values()):
            short.append((name, sums))
    print(f"{'':<34}{'% lines (missing)':<20}{'% branches':<20}{'% conditions (MC/DC)'}")
    for room in sorted(rooms, key=lambda r: (r.startswith("all"), r)):
        row(room, rooms[room])
    print("\nfiles with something missing")
    for name, sums in sorted(short, key=lambda s: sum(s[1][k][0] - s[1][k][1] for k in KINDS)):
        row(name, sums)


if __name__ == "__main__":
    main()
