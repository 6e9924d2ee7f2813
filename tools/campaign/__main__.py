"""make campaign: the published systems over seeds, one table of paper, bound and ours.

    python -m campaign [--only TEXT] [--quick] [--jobs N] [--docs FILE]      exit 1 if a figure misses its bound
"""

import os
import re
import sys
import tempfile
import tomllib
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from campaign import fly, judge
from pelorus_tools import cli

TABLE = Path(__file__).with_name("table.toml")
BEGIN, END = "<!-- make campaign writes from here -->", "<!-- to here -->"


def campaign(cases, count, jobs, progress=None):
    """[(case, pooled figures)]: `count` names the key that says how many seeds."""
    with tempfile.TemporaryDirectory(prefix="campaign-") as folder, ProcessPoolExecutor(jobs) as pool:
        flights = [[pool.submit(fly.fly, c, seed, folder) for seed in range(1, c[count] + 1)] for c in cases]
        total, done, found = sum(map(len, flights)), 0, []
        for case, futures in zip(cases, flights, strict=True):
            figures = []
            for future in futures:
                figures.append(future.result())
                done += 1
                if progress:
                    progress(done / total)
            found.append((case, fly.pool(figures)))
    return found


def merged(old, cases, new):
    """The page's tables, one a case in the order of the table: new ones ({title: text}) where there are, else those of before."""
    before = {c: b for b in re.split(r"(?m)^(?=\*\*)", old) for c in map(judge.title, cases) if b.startswith(c)}
    return "\n".join((new.get(t) or before[t]).strip() + "\n" for t in map(judge.title, cases) if t in new or t in before)


def write(page, cases, new):
    before, _, rest = page.read_text().partition(BEGIN)
    old, _, after = rest.partition(END)
    page.write_text(f"{before}{BEGIN}\n\n{merged(old, cases, new)}\n{END}{after}")


def body(argv):
    p = cli.Parser(prog="campaign", description=__doc__)
    p.add_argument("--only", default="", metavar="TEXT", help="cases whose system and name contain this")
    p.add_argument("--quick", action="store_true", help="the seeds of the tests; bounds hold for sigma, errors are held against it")
    p.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N", help="processes (all cores)")
    p.add_argument("--docs", metavar="FILE", help="write the tables into this page, in place of those of the same cases")
    args = p.parse_args(argv)
    with TABLE.open("rb") as f:
        table = tomllib.load(f)
    count = "quick" if args.quick else "seeds"
    wanted = lambda c: args.only.lower() in f"{c['system']} {c['name']}".lower()
    cases = [c for c in table["case"] if wanted(c) and c[count] > 0]
    if not cases:
        p.error(f"no case's system and name contain '{args.only}'")
    found = campaign(cases, count, args.jobs, cli.Progress("flights", args.quiet))
    new = {judge.title(case): judge.words(case, f) for case, f in found}
    print("\n".join(new.values()))
    if args.docs and not args.quick:
        write(Path(args.docs), table["case"], new)
    bad = [f"{case['system']} {case['name']}: {c}" for case, f in found for c in judge.complaints(case, f, args.quick)]
    print("\n".join(bad) if bad else f"{len(found)} cases within their bounds", file=sys.stderr)
    return cli.MISSED if bad else cli.DONE


if __name__ == "__main__":
    sys.exit(cli.run("campaign", body, None))
