"""make promise: simulate epochs, count wrong integers that are accepted, print them and draw them beside the promised rate."""

import argparse
import csv
import subprocess
import sys
from collections import namedtuple
from pathlib import Path

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.ticker import NullLocator
from scipy.stats import beta

from pelorus_tools import plots

ROOT = Path(__file__).resolve().parents[2]
WRONG_MODEL = 1.5
PALETTE = ["#1f2a35", "#24588c", "#2f8f5b", "#dfa03a", "#c0504d", "#7a5c99"]

Row = namedtuple("Row", "name rule limit epochs unsolved wrong_unchecked fixed wrong believed believed_wrong")


def simulate(epochs, noise, seed=1, program="pelorus-promise"):
    """Counts of the program, one Row a class and rule."""
    out = subprocess.run([program, "--csv", "--epochs", str(epochs), "--noise", str(noise), "--seed", str(seed)],
                         capture_output=True, text=True, check=True).stdout
    rows = list(csv.reader(out.splitlines()))[1:]
    return [Row(r[0], r[1], float(r[2]), *map(int, r[3:])) for r in rows]


def clopper_pearson(k, n, confidence=0.95):
    """Limits of a probability of which k of n draws came true."""
    tail = 0.5 * (1.0 - confidence)
    low = beta.ppf(tail, k, n - k + 1) if k > 0 else 0.0
    high = beta.ppf(1.0 - tail, k + 1, n - k) if k < n else 1.0
    return float(low), float(high)


def names_of(rows, kind):
    return list(dict.fromkeys(r.name for r in rows if r.name.startswith(kind)))


def point(ax, x, k, n, colour, filled=True, label=None):
    """Observed rate with its 95 % limits; where nothing was observed the upper limit, an arrow hanging from it."""
    low, high = clopper_pearson(k, n)
    if k == 0:
        ax.plot([x, x], [0.45 * high, high], color=colour, lw=0.9)
        ax.plot([x], [0.45 * high], marker="v", ms=3, color=colour, ls="none", label=label)
        return
    ax.plot([x, x], [low, high], color=colour, lw=1.1)
    ax.plot([x], [k / n], marker="o", ms=4.5, mec=colour, mfc=colour if filled else "white", ls="none", label=label)


def frame_promise(ax, title):
    ax.set_xscale("log")
    ax.set_yscale("log")
    ax.set_xlim(4e-5, 0.3)
    ax.set_ylim(1e-6, 0.6)
    ax.plot([1e-6, 1], [1e-6, 1], color=plots.MUTED, lw=1.0, zorder=0)
    ax.fill_between([1e-6, 1], [1e-6, 1], [1, 1], color="#f6e3e1", lw=0, zorder=-1)
    ax.text(5.5e-5, 0.25, "promise broken", color="#b0574e", fontsize=8)
    ax.xaxis.set_minor_locator(NullLocator())
    ax.yaxis.set_minor_locator(NullLocator())
    ax.set_xlabel("promised rate of wrong fixes")
    ax.set_ylabel("observed, of all epochs")
    ax.set_title(title)


def spread(i, n):
    """Factor that sets class i of n beside the others at the same promise."""
    return 1.12 ** (i - 0.5 * (n - 1))


def draw_classes(ax, rows, kind, title, words):
    frame_promise(ax, title)
    names = names_of(rows, kind)
    for i, name in enumerate(names):
        mine = [r for r in rows if r.name == name and r.rule == "promise"]
        for k, r in enumerate(mine):
            point(ax, r.limit * spread(i, len(names)), r.wrong, r.epochs, PALETTE[i], label=None)
        ax.plot([], [], marker="o", ms=4.5, ls="none", color=PALETTE[i], label=words(name))
    ax.legend(loc="lower right", ncols=2, columnspacing=0.8, handletextpad=0.2, borderaxespad=0.3, labelspacing=0.25)


def draw_wrong_model(ax, honest, lied):
    frame_promise(ax, f"Where the model is wrong: errors {WRONG_MODEL} times what it says")
    series = [(honest, "wrong", PALETTE[1], True, "honest model, ratio alone"), (lied, "wrong", PALETTE[4], True, "wrong model, ratio alone"),
              (lied, "believed_wrong", PALETTE[3], True, "wrong model, all verdicts")]
    for i, (rows, field, colour, filled, label) in enumerate(series):
        for r in (r for r in rows if r.name == "all" and r.rule == "promise"):
            point(ax, r.limit * spread(i, 3), getattr(r, field), r.epochs, colour, filled)
        ax.plot([], [], marker="o", ms=4.5, ls="none", color=colour, label=label)
    ax.legend(loc="lower right", handletextpad=0.2, borderaxespad=0.3, labelspacing=0.25)


def draw_fixed_ratio(ax, rows):
    """Wrong fixes by number of integers: a fixed ratio means another failure rate for each."""
    names = names_of(rows, "n")
    rules = [("ratio", 1.5, PALETTE[4], "ratio 1.5"), ("ratio", 2.0, PALETTE[3], "ratio 2"), ("ratio", 3.0, PALETTE[2], "ratio 3"),
             ("promise", 0.01, PALETTE[1], "1 % promised")]
    for j, (rule, limit, colour, label) in enumerate(rules):
        for i, name in enumerate(names):
            (r,) = [r for r in rows if (r.name, r.rule, r.limit) == (name, rule, limit)]
            point(ax, i + 0.16 * (j - 1.5), r.wrong, r.epochs, colour)
        ax.plot([], [], marker="o", ms=4.5, ls="none", color=colour, label=label)
    ax.set_yscale("log")
    ax.set_ylim(1e-6, 0.6)
    ax.yaxis.set_minor_locator(NullLocator())
    ax.set_xticks(range(len(names)), [n[2:].replace("..", " to ") for n in names])
    ax.axhline(0.01, color=PALETTE[1], lw=0.8, ls=":")
    ax.set_xlabel("integers sought")
    ax.set_ylabel("observed, of all epochs")
    ax.set_title("A fixed ratio promises another rate for each n")
    ax.legend(loc="upper right", handletextpad=0.2, borderaxespad=0.3, labelspacing=0.25)


def strength(name):
    low, high = name[2:].split("..")
    return f"{low} to {high}"


def draw(path, honest, lied):
    with matplotlib.rc_context(plots.STYLE):
        fig = plots.figure(10.0, 8.2)
        axes = fig.subplots(2, 2)
        draw_classes(axes[0][0], honest, "n", "By number of integers", lambda n: "n = " + n[2:].replace("..", " to "))
        draw_classes(axes[0][1], honest, "P", "By strength: bootstrapped failure rate of the model", strength)
        draw_wrong_model(axes[1][0], honest, lied)
        draw_fixed_ratio(axes[1][1], honest)
        (whole,) = [r for r in honest if r.name == "all" and r.rule == "promise" and r.limit == 0.01]
        fig.suptitle(f"Wrong integers accepted in {whole.epochs:,} simulated epochs; bars: 95 % (Clopper, Pearson); arrows: none observed",
                     fontsize=10, fontweight="bold", x=0.01, ha="left")
        FigureCanvasAgg(fig).print_png(path, metadata={"Software": None})


def table(rows, title):
    print(title)
    print(f"  {'class':16} {'rule':14} {'epochs':>8} {'fixed %':>8} {'wrong %':>9}  {'95 % limits':19} {'by all verdicts: fixed %':>24} {'wrong %':>8}")
    for r in rows:
        low, high = clopper_pearson(r.wrong, r.epochs)
        n = r.epochs / 100.0
        print(f"  {r.name:16} {r.rule + ' ' + format(r.limit, 'g'):14} {r.epochs:8} {r.fixed / n:8.2f} {r.wrong / n:9.4f}  {100 * low:8.4f} .. {100 * high:7.4f} "
              f"{r.believed / n:24.2f} {r.believed_wrong / n:8.4f}")


def main():
    a = argparse.ArgumentParser(prog="promise", description=__doc__)
    a.add_argument("--epochs", type=int, default=200000)
    a.add_argument("--image", type=Path, default=ROOT / "docs" / "img" / "promise.png")
    args = a.parse_args()
    honest = simulate(args.epochs, 1.0)
    lied = simulate(args.epochs // 2, WRONG_MODEL, seed=2)
    table(honest, "errors as the model says")
    table([r for r in lied if r.name == "all" or r.name.startswith("P")], f"errors {WRONG_MODEL} times what the model says")
    draw(args.image, honest, lied)
    print(f"drawn: {args.image}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
