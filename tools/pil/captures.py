"""The captures that make pil replays: simulated ones, and parts of real recordings where they are present.

Each is a function (path to write, folder of recordings); recorded ones have the name of their folder in `.folder`.
"""

import subprocess

from pelorus_tools import eventlog
from pil.board import ROOT
from replay import recordings


def simulated(scenario, seconds):
    def make(path, _):
        subprocess.run(["pelorus-sim", "-q", ROOT / scenario, "--duration", str(seconds), "-o", path], check=True)
    make.folder = None
    return make


def recorded(name, seconds):
    """The first seconds of a recording of make replay, set as there."""
    entry = next(r for r in recordings.ALL if r.name == name)

    def make(path, data):
        whole = path.with_suffix(".whole")
        command = ["pelorus-capture", "-q", "-o", whole, *(a.format(data=data / entry.folder) for a in entry.capture)]
        if subprocess.run(command, capture_output=True, check=False).returncode not in (0, 4):  # 4: some messages rightly refused
            raise RuntimeError(f"pelorus-capture failed on {name}")
        log = [e for e in eventlog.events(eventlog.open_bytes(str(whole))) if e[1] != b"SETUP"]
        rows = [(log[0][0], "SETUP", entry.config.encode())] if entry.config else []
        rows += [(t, channel.decode(), bytes(d)) for t, channel, d in log if t < log[0][0] + seconds * 1_000_000]
        eventlog.write(path, rows)
        whole.unlink()
    make.folder = entry.folder
    return make


QUICK = {"leg": simulated("scenarios/s5_leg.toml", 12), "float": simulated("scenarios/s2_flight.toml", 12)}
ALL = {
    "leg": simulated("scenarios/s5_leg.toml", 90),
    "car": simulated("scenarios/car.toml", 60),
    "float": simulated("scenarios/s2_flight.toml", 60),
    "geo3": simulated("scenarios/s3_static.toml", 40),
    "walk": recorded("walk-imu-ubx-2025", 40),
    "phases": recorded("walk, with phases", 40),
    "geonet": recorded("geonet-0759-3040", 900),
}
