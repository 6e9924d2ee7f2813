"""Bit flips over the whole static state: makes the short capture, runs pelorus-flips on it, writes the table into docs/SURVIVAL.md.

    survival.py [--flips N] [--seed N] [--workers N] [--program NAME] [--docs FILE]       exit 1 if a life crashed or too many were silent
"""

import argparse
import re
import sys
import tempfile
from pathlib import Path

from runs import call, simulate

SIGNALS = '["G1C", "G2L"]'
COARSE = (("imu", "rate_hz", "50"), ("rover", "rate_hz", "1"), ("base", "rate_hz", "1"), ("rover", "signals", SIGNALS),
          ("base", "signals", SIGNALS), ("navigator", "output_hz", "2"))
MOST_SILENT_PERCENT = 0.1
BEGIN, END = "<!-- make survival writes from here -->", "<!-- to here -->"


def flips(folder, n, seed=1, workers=2, program="pelorus-flips"):
    """(exit code, table, percent silent, crashed)."""
    done = call(program, simulate(folder, "faults", duration=26, edits=COARSE), "--flips", n, "--seed", seed, "--workers", workers, "-v", ok=(0, 1))
    print(done.stderr, end="")
    silent, crashed = re.search(r"([\d.]+) % silent beyond a bound, (\d+) crashed", done.stdout).groups()
    return done.returncode, done.stdout, float(silent), int(crashed)


def main():
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("--flips", type=int, default=20000)
    p.add_argument("--seed", type=int, default=1)
    p.add_argument("--workers", type=int, default=2)
    p.add_argument("--program", default="pelorus-flips")
    p.add_argument("--docs")
    a = p.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        _, table, silent, crashed = flips(folder, a.flips, a.seed, a.workers, a.program)
    print(table, end="")
    if a.docs:
        page = Path(a.docs).read_text()
        before, _, rest = page.partition(BEGIN)
        Path(a.docs).write_text(f"{before}{BEGIN}\n\n{table}\n{END}{rest.partition(END)[2]}")
    return 1 if crashed or silent > MOST_SILENT_PERCENT else 0


if __name__ == "__main__":
    sys.exit(main())
