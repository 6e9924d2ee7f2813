"""One run of the firmware as its output log tells it: solutions in order of time, and everything said beside them."""

import json
import tomllib
from collections import Counter

import numpy as np

from pelorus_tools import eventlog, frames
from pelorus_tools.cli import UnreadableError
from pelorus_tools.gpstime import text

PRESETS = ("auto", "single", "rtk", "ins-single", "ins-rtk", "ins-float", "ins-tdcp")


class Run:
    """Everything read from one OUT: `sol` (sorted), `frames` (raw order), truth bytes, setup text, run description."""

    def __init__(self, name):
        self.name = name
        self.frames = frames.Frames()
        self.sol = self.frames.solution
        self.truth_events = []      # payloads of the TRUTH channel
        self.setup_text = ""        # TOML text of the capture: [navigator] and [scenario]
        self.run = {}               # what pelorus-sil said of itself
        self.refused = Counter()    # by cause

    @property
    def used(self):
        """The last word on what takes part, or None."""
        return self.frames.used[-1] if self.frames.used.size else None

    @property
    def counters(self):
        return self.frames.counters[-1] if self.frames.counters.size else None

    @property
    def setup(self):
        """The stored configuration as a dictionary, empty if there is none or it is no TOML."""
        try:
            return tomllib.loads(self.setup_text)
        except tomllib.TOMLDecodeError:
            return {}

    @property
    def scenario(self):
        """What the simulator said of itself: name, seed, command."""
        table = self.setup.get("scenario", {})
        return table if isinstance(table, dict) else {"name": table}

    @property
    def lever_ba_b(self):
        """IMU to antenna in body axes, m: zero if it is not stored."""
        lever = self.setup.get("navigator", {}).get("mount", {}).get("lever_arm_m", [0.0, 0.0, 0.0])
        return np.array(lever, float)


def load(path, progress=None, want_truth=True):
    """Read an OUT ('-' is standard input). Raises UnreadableError if there is no solution in it."""
    run = Run("standard input" if path == "-" else path)
    data = eventlog.open_bytes(path)
    if not len(data):
        raise UnreadableError(f"{run.name}: empty")
    out = []
    channels = Counter()
    if eventlog.is_log(data):
        for _, channel, payload in eventlog.events(data, run.refused, progress):
            channels[channel] += 1
            if channel == b"UART_OUT":
                out.append(payload)
            elif channel == b"TRUTH" and want_truth:
                run.truth_events.append(bytes(payload))
            elif channel == b"SETUP":
                run.setup_text = bytes(payload).decode("utf-8", "replace").rstrip("\0")
            elif channel == b"RUN":
                run.run.update(_json(payload, run.refused))
        out = b"".join(out)
    else:
        out = bytes(data)
    run.frames = frames.parse(out)
    run.refused.update(run.frames.refused)
    for what, n in run.frames.unknown.items():
        run.refused[f"frame of a kind not known here: {what}"] += n
    if not run.frames.solution.size:
        raise UnreadableError(f"{run.name}: {_why_nothing(channels, out)}")
    run.sol = in_order(run.frames.solution)
    return run


def _json(payload, refused):
    try:
        value = json.loads(bytes(payload).rstrip(b"\0"))
        return value if isinstance(value, dict) else {"run": value}
    except ValueError:
        refused["RUN: not JSON"] += 1
        return {}


def _why_nothing(channels, out):
    if channels and not channels[b"UART_OUT"]:
        seen = ", ".join(sorted(c.decode("ascii", "replace") for c in channels))
        hint = "; it is a capture: run pelorus-sil on it first" if any(c.startswith(b"UART_") for c in channels) else ""
        return f"no UART_OUT in this log (channels: {seen}){hint}"
    return f"no solution among {len(out)} bytes of firmware output"


def in_order(sol):
    """Solutions sorted by time; of several at one time the one at an epoch, else the last sent, is kept."""
    at_epoch = (sol["flags"] & frames.SOL_AT_EPOCH) != 0
    order = np.lexsort((np.arange(sol.size), at_epoch, sol["t_ns"]))
    sol = sol[order]
    last = np.append(sol["t_ns"][1:] != sol["t_ns"][:-1], True)
    return sol[last]


def status_words(sol):
    """'fixed+ins' and the like, one a solution."""
    fix = np.minimum(sol["fix"], len(frames.FIX) - 1)
    ins = (sol["flags"] & frames.SOL_INS) != 0
    table = np.array([[w, w + "+ins"] for w in frames.FIX])
    return table[fix, ins.astype(int)]


def carriers(mask):
    return "+".join(name for i, name in enumerate(frames.CARRIERS) if mask & (1 << i))


def word(table, i):
    return table[i] if i < len(table) else str(i)


def summary(run):
    """What was asked for and what was really used: rows (what, asked or offered, used, reason), words only."""
    u, sol = run.used, run.sol
    rows = []
    if u is None:
        return [("everything", "?", "?", "the firmware sent no 'used' frame")]
    rows.append(("preset", word(PRESETS, u["preset_asked"]), word(PRESETS, u["preset_used"]), word(frames.WHY, u["preset_why"])))
    rate = f"{u['imu_rate_hz']:.4g} Hz" if u["imu_seen"] else "none seen"
    rows.append(("IMU", rate, "yes" if u["imu_used"] else "no", word(frames.WHY, u["imu_why"])))
    if u["imu_used"]:
        rows.append(("IMU model", "", imu_model(u), ""))
    r = u["r_station_e"]
    where = f"at {r[0]:.4f} {r[1]:.4f} {r[2]:.4f}" if np.any(r != 0) else "position unknown"
    rows.append(("base", where if u["base_seen"] else "none seen", "yes" if u["base_used"] else "no", word(frames.WHY, u["base_why"])))
    if u["base_used"]:
        age = sol["base_age_s"][(sol["base_age_s"] >= 0) & ((sol["flags"] & frames.SOL_AT_EPOCH) != 0)]
        if age.size:
            rows.append(("base age", "", f"median {np.median(age):.3g} s, longest {age.max():.3g} s", ""))
    if run.frames.warm.size:
        w = run.frames.warm[-1]
        age = f"{w['age_s']:.0f} s old" if w["age_s"] > 0 else "stored"
        rows.append(("snapshot", age, "yes" if w["verdict"] == 2 else "no", "" if w["verdict"] == 2 else word(frames.SNAPSHOT, w["verdict"])))
    for i, name in enumerate(frames.SYSTEMS):
        if not (u["rover_seen"][i] or u["base_carriers"][i] or u["carriers_used"][i]):
            continue
        offered = f"rover {carriers(u['rover_seen'][i]) or 'none'}"
        if u["base_seen"]:
            offered += f", base {carriers(u['base_carriers'][i]) or 'none'}"
        rows.append((name, offered, carriers(u["carriers_used"][i]) or "not used", word(frames.WHY, u["sys_why"][i])))
    return rows


def imu_model(u):
    """White noise and in-run bias in the units of data sheets."""
    deg_rth = np.degrees(float(u["arw_rad_rts"])) * 60.0
    deg_h = np.degrees(float(u["sd_bg_radps"])) * 3600.0
    ug = 1e6 / 9.80665
    return (f"gyro {deg_rth:.3g} deg/sqrt(h), {deg_h:.3g} deg/h; accelerometer {float(u['vrw_mps_rts']) * ug:.3g} ug/sqrt(Hz), "
            f"{float(u['sd_ba_mps2']) * ug:.3g} ug")


def describe(run):
    """The opening lines every output gets: what was really used, in plain text."""
    sol = run.sol
    lines = [f"{run.name}: {sol.size} solutions, {text(sol['t_ns'][0])} to {text(sol['t_ns'][-1])}"]
    for what, asked, got, why in summary(run):
        lines.append(f"  {what:<10} {asked + ' -> ' if asked else ''}{got}{'  (' + why + ')' if why else ''}")
    return lines


def refused_lines(run):
    return [f"  refused: {n} x {cause}" for cause, n in sorted(run.refused.items())]
