"""Running the programs on a scenario, and reading what they print. Programs are found by PATH, as a user's would be."""

import csv
import subprocess
import time
from collections import Counter
from pathlib import Path

import numpy as np
from campaign import scenario
from pelorus_tools import outlog, stats, truth

ROOT = Path(__file__).resolve().parents[2]
SCENARIOS = ROOT / "scenarios"


def call(*command, ok=(0,)):
    command = [str(c) for c in command]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode in ok, f"{' '.join(command)}\nended with {done.returncode}\n{done.stderr[-2000:]}"
    return done


def edited(folder, name, edits):
    """A copy of a scenario with lines changed: edits are (table or '', key, value text)."""
    changes = {f"{table}.{key}".lstrip("."): value for table, key, value in edits}
    path = Path(folder) / f"{name}_edited.toml"
    path.write_text(scenario.edited((SCENARIOS / f"{name}.toml").read_text(), changes))
    return path


def simulate(folder, name, seed=1, duration=None, edits=()):
    """A capture of a scenario."""
    source = edited(folder, name, edits) if edits else SCENARIOS / f"{name}.toml"
    capture = Path(folder) / f"{name}_{seed}.log"
    call("pelorus-sim", source, "-o", capture, "--seed", seed, "-q", *(["--duration", duration] if duration else []))
    return capture


def firmware(capture, *options, program="pelorus-sil", name=""):
    """The firmware over a capture; returns (OUT, seconds)."""
    out = Path(capture).with_suffix(f".{name or program}.out")
    start = time.monotonic()
    call(program, capture, "-o", out, "-q", *options)
    return out, time.monotonic() - start


def figures(out, *options):
    """Every figure of pelorus-report."""
    text = call("pelorus-report", out, "--csv-stats", "-q", *options).stdout
    return {r["name"]: float(r["value"]) for r in csv.DictReader(text.splitlines())}


def not_fixed(out):
    """The reasons for which epochs were not fixed, counted."""
    rows = csv.DictReader(call("pelorus-decode", out, "--csv", "-q").stdout.splitlines())
    return dict(Counter(r["int_reason"] for r in rows if r["at_epoch"] == "1" and not r["status"].startswith("fixed")))


class Result:
    """A run read with full covariances, and its errors against truth."""

    def __init__(self, out):
        self.run = outlog.load(str(out))
        self.sol = self.run.sol
        reference = truth.from_events(self.run.truth_events, str(out))
        self.errors = stats.Errors(self.sol, reference, lever_ba_b=self.run.lever_ba_b) if reference else None
        self.epoch = (self.sol["flags"] & 8) != 0

    def seconds(self, start_ns):
        return (self.sol["t_ns"] - start_ns) * 1e-9

    def nees(self, group):
        return stats.nees(self.sol, self.errors, group)
