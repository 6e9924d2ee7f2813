"""Running the programs on a scenario, and reading what they print. Programs are found by PATH, as a user's would be."""

import csv
import re
import subprocess
import time
from collections import Counter
from pathlib import Path

import numpy as np
from pelorus_tools import outlog, stats, truth

ROOT = Path(__file__).resolve().parents[2]
SCENARIOS = ROOT / "scenarios"


def call(*command, ok=(0,)):
    command = [str(c) for c in command]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode in ok, f"{' '.join(command)}\nended with {done.returncode}\n{done.stderr[-2000:]}"
    return done


def edited(folder, scenario, edits):
    """A copy of a scenario with lines changed: edits are (section or '', key, value text)."""
    lines, section, todo = [], "", {(s, k): v for s, k, v in edits}
    for line in (SCENARIOS / f"{scenario}.toml").read_text().splitlines():
        header = re.match(r"\[+([\w.]+)\]+", line)
        section = header.group(1) if header else section
        key = re.match(r"(\w+)\s*=", line)
        if key and (section, key.group(1)) in todo:
            line = f"{key.group(1)} = {todo.pop((section, key.group(1)))}"
        lines.append(line)
    assert not todo, f"{scenario}.toml has no {list(todo)}"
    path = Path(folder) / f"{scenario}_edited.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def simulate(folder, scenario, seed=1, duration=None, edits=()):
    """A capture of a scenario."""
    source = edited(folder, scenario, edits) if edits else SCENARIOS / f"{scenario}.toml"
    capture = Path(folder) / f"{scenario}_{seed}.log"
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
        """e' P^-1 e of each solution with the full 3 x 3 covariance."""
        packed = self.sol[{"pos": "cov_r_ned", "vel": "cov_v_ned", "att": "cov_att"}[group]].astype(float)
        P = packed[:, (0, 1, 2, 1, 3, 4, 2, 4, 5)].reshape(-1, 3, 3)
        e = self.errors.err[group]
        good = np.isfinite(e).all(1) & (np.abs(np.linalg.det(P)) > 0)
        out = np.full(len(e), np.nan)
        out[good] = np.einsum("ni,ni->n", e[good], np.linalg.solve(P[good], e[good][..., None])[..., 0])
        return out
