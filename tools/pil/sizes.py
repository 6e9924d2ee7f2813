"""make sizes: write docs/SIZES.md from what is linked and counted. --check: is it still true, and within the budgets?

A number may have moved by 5 % before the page is stale. A budget that is missed is red unless it stands in KNOWN_MISSES, where each has
its reason and how far it may be missed; the page shows it as missed.
"""

import argparse
import re
import sys

from pil import measure
from pil.board import ROOT

PAGE = ROOT / "docs/SIZES.md"
M4F, M7, F405, RV32 = BOARDS = ("mps2-an386", "mps2-an500", "stm32f405", "rv32-virt")
ROOMS = ("base", "math", "earth", "wire", "gnss", "inertial", "model", "filter", "observe", "ambiguity", "attitude", "integrity", "tracking", "navigator")
TOLERANCE = 0.05

# Budgets that are missed: how far they may be, and why they are.
KNOWN_MISSES = {
    "code of the library": (155000, "every format, preset and system is linked; on the M4F each double operation is a call of a dozen bytes and more"),
    "inertial, filter, rows a second": (4850000, "rows and time updates are a third of it; strapdown, slips, differences, screening, checks of memory, the way "
                                                 "back to the present and outputs are in it too"),
    "integers 6": (11900, "taking in, the factor of 59 bits and the exact norms of two vectors are two thirds of it; n = 40 is within"),
    "integers 20": (105500, "the same"),
}

BUDGETS = []  # (what, value, budget): filled while the page is made


def budget(what, value, limit):
    """A cell: the verdict on a value, which is also kept."""
    BUDGETS.append((what, value, limit))
    return f"{limit} | {'met' if value <= limit else 'missed'}"


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "|".join("---" if i == 0 else "---:" for i in range(len(head))) + "|"]
    return "\n".join(lines + ["| " + " | ".join(str(c) for c in row) + " |" for row in rows]) + "\n"


def code(linked):
    rows = [[room, *(linked[b].rooms.get(room, 0) for b in BOARDS)] for room in ROOMS if linked[M4F].rooms.get(room)]
    rows.append(["**library**", *(linked[b].library for b in BOARDS)])
    rows.append(["board, main loop", *(linked[b].board for b in BOARDS)])
    rows.append(["compiler's and C library's", *(linked[b].compiler for b in BOARDS)])
    rows.append(["**flash**, all", *(linked[b].image.flash() for b in BOARDS)])
    return table(["code and constants, bytes", *BOARDS], rows)


def memory(linked):
    names = ("navigator", "rover", "base", "imu_stream", "aux_stream", "frame")
    rows = [[name, *(linked[b].ram.get(name, 0) for b in BOARDS)] for name in names]
    rows.append(["board's rings and the rest", *(sum(linked[b].ram.values()) - sum(linked[b].ram.get(n, 0) for n in names) for b in BOARDS)])
    rows.append(["**static RAM**", *(sum(linked[b].ram.values()) for b in BOARDS)])
    rows.append(["stack reserved", *(linked[b].image.stack_reserved() for b in BOARDS)])
    return table(["bytes", *BOARDS], rows)


def stack(linked, loads):
    names = list(linked[M4F].entries)[:8]
    rows = [[f"`{n}`", *(linked[b].entries.get(n, "-") for b in BOARDS)] for n in names]
    rows.append(["**deepest path from reset**", *(linked[b].deepest for b in BOARDS)])
    rows.append(["an interrupt on top", *(linked[b].graph.interrupt() for b in BOARDS)])
    rows.append(["high-water under the load below, with the counting's own frames", loads[M4F].cost.stack, loads[M7].cost.stack, "", ""])
    chain = " > ".join(f"`{n}` {size}" for n, size in linked[M4F].path if size)
    return table(["bytes below", *BOARDS], rows) + f"\nDeepest on the M4F: {chain}.\n"


def work(loads):
    names = {"imu step": "IMU step", "epoch": "push that works on an epoch", "row": "row into the filter", "slice": "slice of a search"}
    rows = []
    for kind, name in names.items():
        for core, board in (("M4F", M4F), ("M7", M7)):
            per = loads[board].cost.per(kind)
            rows.append([f"{name}, {core}", loads[board].cost.count[kind], *(per if per else ("-", "-", "-"))])
    return table(["instructions", "how often", "mean", "99 %", "maximum"], rows)


def chain(loads):
    rows = [[what, round(a), round(b)] for (what, a), (_, b) in zip(loads[M4F].parts(), loads[M7].parts())]
    rows.append(["**all**", sum(r[1] for r in rows), sum(r[2] for r in rows)])
    return table(["instructions a second", "M4F", "M7"], rows)


# Pieces of make bench, the core that the budget is for, the budget.
PIECES = (
    ("strapdown step (double: M7)", "M7", 450),
    ("both, per IMU step at 200 Hz, 18 states", "M4F", 5000),
    ("  24 states, 6 more in front at 200 Hz", "M4F", 6500),
    ("scalar update, dense row, 18 states", "M4F", 2700),
    ("scalar update, dense row, 24 states", "M4F", 4400),
    ("scalar update, position row, 18 states", "M4F", 1300),
    ("scalar update, position row, 24 states", "M4F", 1600),
    ("integers 6", "M4F", 4500),
    ("integers 20", "M4F", 96000),
    ("integers 40", "M4F", 612000),
)


def budgets(linked, loads):
    small, ud = measure.navigator_bytes(measure.SMALL)
    cores = {"M4F": measure.pieces("m4f"), "M7": measure.pieces("m7")}
    of_chain = round(loads[M7].parts()[0][1])
    rows = [
        ["code of the library, M4F, bytes", linked[M4F].library, budget("code of the library", linked[M4F].library, 65536)],
        ["navigator, 24 states, 2 x 32 signals, bytes", small, budget("navigator", small, 49152)],
        ["its filter, bytes", ud, budget("filter", ud, 6144)],
        ["deepest stack of an entry point, M4F, bytes", max(linked[M4F].entries.values()), budget("stack", max(linked[M4F].entries.values()), 6144)],
        ["inertial, filter, rows a second, M7", of_chain, budget("inertial, filter, rows a second", of_chain, 3000000)],
    ]
    for name, core, limit in PIECES:
        value = cores[core].get(name)
        if value is None:
            raise RuntimeError(f"tools/bench has no '{name}' any more")
        other = f" (M7: {cores['M7'][name]})" if core == "M4F" else ""
        rows.append([f"{name.strip()}, {core}{other}", value, budget(name.strip(), value, limit)])
    return table(["what", "is", "budget", "verdict"], [[a, b, *c.split(" | ")] for a, b, c in rows])


def page():
    measure.build(BOARDS)
    linked = {b: measure.Linked(b) for b in BOARDS}
    loads = {b: measure.Load(b) for b in (M4F, M7)}
    load = loads[M4F]
    of_budgets = budgets(linked, loads)
    missed = [what for what, value, limit in BUDGETS if value > limit]
    known = "\n".join(f"- {what}: {KNOWN_MISSES[what][1] if what in KNOWN_MISSES else 'not known yet'}" for what in missed)
    return f"""# What it costs

Written by `make sizes`; the tests hold it against what is linked and counted, and are red when it is stale or a budget newly missed. Sizes of
`config.h` are the desktop's except on `stm32f405` (`hal/stm32f405/board.cmake`). Instructions, not cycles: counted by the emulator.

Compilers: {'; '.join(measure.compilers())}.

## Budgets of the design

{of_budgets}
The navigator is sized with `{measure.SMALL}`.

Missed, and why:

{known}

## Code by room

{code(linked)}
## RAM

{memory(linked)}
## Stack

Static bound: frames as the compiler states them (`-fcallgraph-info=su`), calls as the linked image has them, a call through a pointer to every
function whose address is taken. `make firmware` fails on recursion, on frames of variable size, on a pointer to nowhere known, on an entry point
over the budget and where the reserved stack is smaller than the deepest path with an interrupt on top.

{stack(linked, loads)}
## Work

`scenarios/full_load.toml` on the emulated board: {load.imu_a_second:.0f} IMU samples a second, {load.epochs_a_second:.1f} epochs of {load.rows_an_epoch:.1f} rows, {measure.SECONDS} s. Counted
at the calls themselves (`hal/pil/cost.c`); a push that works on an epoch is counted there, with the way back to the present in it; one epoch may take several pushes.

{work(loads)}
{chain(loads)}
The M4F computes every double in software, about fifty instructions an operation; the M7 has them in hardware.
"""


NUMBER = re.compile(r"(?<![\w.-])\d+(?:\.\d+)?(?![\w.-])")


def stale(old, new):
    """Lines of the page that are no longer true."""
    if len(old) != len(new):
        return [f"{len(old)} lines, {len(new)} by now"]
    bad = []
    for a, b in zip(old, new):
        numbers = [(float(x), float(y)) for x, y in zip(NUMBER.findall(a), NUMBER.findall(b))]
        moved = any(abs(x - y) > max(TOLERANCE * y, 16) for x, y in numbers)
        if NUMBER.sub("#", a) != NUMBER.sub("#", b) or moved:
            bad.append(f"- {a}\n+ {b}")
    return bad


def wrong(measured):
    """What is red about budgets as (what, value, budget): missed unknown or more than known, or known as missed and met."""
    lines = []
    for what, value, limit in measured:
        most = KNOWN_MISSES[what][0] if what in KNOWN_MISSES else limit
        if value > max(most, limit):
            lines.append(f"budget missed: {what}: {value} of {limit}" + (f", known up to {most}" if what in KNOWN_MISSES else ""))
        elif value <= limit and what in KNOWN_MISSES:
            lines.append(f"budget met: {what}: {value} of {limit}; take it out of KNOWN_MISSES")
    return lines


def main():
    parser = argparse.ArgumentParser(prog="make sizes")
    parser.add_argument("--check", action="store_true", help="write nothing; fail if the page is stale or a budget newly missed")
    check = parser.parse_args().check
    new = page()
    missed = [f"{what}: {value} of {limit}" for what, value, limit in BUDGETS if value > limit]
    red = wrong(BUDGETS)
    old = PAGE.read_text() if PAGE.exists() else ""
    if not check:
        PAGE.write_text(new)
        print(f"wrote {PAGE.relative_to(ROOT)}; budgets missed: {'; '.join(missed) or 'none'}")
        return 0
    same_tools = all(version in old for version in measure.compilers())
    bad = stale(old.splitlines(), new.splitlines()) if same_tools else []
    if not same_tools:
        print("docs/SIZES.md was written with other compilers: its numbers are not compared")
    for line in bad:
        print(f"stale:\n{line}")
    for line in red:
        print(line)
    print("docs/SIZES.md: " + ("make sizes writes it anew" if bad or red else "true" if same_tools else "not compared; no budget newly missed"))
    return 1 if bad or red else 0


if __name__ == "__main__":
    sys.exit(main())
