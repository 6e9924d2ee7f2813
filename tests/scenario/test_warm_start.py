"""A power cut while standing: the attitude is there again at the first GNSS epoch, or the snapshot is refused with its reason."""

import re

import numpy as np
import pytest
from pelorus_tools import eventlog, frames, outlog, stats, truth
from runs import SCENARIOS, call

OFF_S, ON_S = 230, 290      # a minute without power, standing since 135 s


def seconds(rows):
    first = min(t for t, c, _ in rows if c == "UART_IMU")
    return lambda t_us: (t_us - first) * 1e-6


def without_attitude(rows):
    """The second start is told nothing of the attitude."""
    return [(t, c, re.sub(rb"\n *attitude_deg = [^\n]*", b"", d) if c == "SETUP" else d) for t, c, d in rows]


def keep(rows, start_s, end_s):
    """What is heard with power on in this span; a receiver needs a second longer than an IMU to say its first word."""
    at = seconds(rows)
    return [r for r in rows if r[1] == "SETUP" or start_s + (1.0 if r[1] == "UART_ROVER" else 0.0) <= at(r[0]) < end_s]


def drive(folder, name, legs):
    """A capture of a car: 60 s standing, a street, and then these segments."""
    text = (SCENARIOS / "car.toml").read_text().replace("repeat = 4", "repeat = 1").replace("    { duration_s = 15 },\n]", f"    {legs},\n]")
    text = re.sub(r"\[\[outage\]\]\n(\w.*\n)+", "", text)
    scenario = folder / f"{name}.toml"
    scenario.write_text(text)
    capture = folder / f"{name}.log"
    call("pelorus-sim", scenario, "-o", capture, "-q")
    return [(t, c.decode(), bytes(d)) for t, c, d in eventlog.events(eventlog.open_bytes(str(capture)))]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("warm")


@pytest.fixture(scope="module")
def standing(folder):
    return drive(folder, "standing", "{ duration_s = 200 }")


@pytest.fixture(scope="module")
def stored(folder, standing):
    """The store's first slot, as the power cut left it."""
    eventlog.write(folder / "before.log", keep(standing, 0, OFF_S))
    call("pelorus-sil", folder / "before.log", "-o", folder / "before.out", "-q", "--store", folder / "store")
    return [(folder / "store.0").read_bytes()]


@pytest.fixture(scope="module")
def moves_on(folder):
    """Stands from 135 to 235 s, then goes elsewhere."""
    return drive(folder, "moves_on", "{ duration_s = 100 },\n    { duration_s = 10, to_speed_mps = 10 },\n    { duration_s = 10, to_speed_mps = 0 },\n    { duration_s = 200 }")


def power_on(folder, rows, slots, name):
    for i, data in enumerate(slots):
        (folder / f"{name}.store.{i}").write_bytes(data)
    eventlog.write(folder / f"{name}.log", without_attitude(rows))
    call("pelorus-sil", folder / f"{name}.log", "-o", folder / f"{name}.out", "-q", "--store", folder / f"{name}.store")
    return outlog.load(str(folder / f"{name}.out"))


def verdict(run):
    assert run.frames.warm.size == 1
    word = frames.SNAPSHOT[run.frames.warm["verdict"][0]]
    assert run.frames.warm["count"][0][frames.SNAPSHOT.index(word)] == 1
    return word


def test_attitude_is_there_at_the_first_epoch(folder, standing, stored):
    rows = keep(standing, ON_S, 400)
    run = power_on(folder, rows, stored, "on")
    epochs = run.frames.solution[(run.frames.solution["flags"] & frames.SOL_AT_EPOCH) != 0]
    from_bytes_s = (epochs["t_ns"][0] - run.frames.warm["t_ns"][0]) * 1e-9
    print(f"verdict {verdict(run)}, age {run.frames.warm['age_s'][0]:.1f} s; first epoch flags {epochs['flags'][0]:#x}, {len(epochs)} epochs")
    assert verdict(run) == "used" and from_bytes_s == 0.0
    assert epochs["flags"][0] & frames.SOL_INS and epochs["flags"][0] & frames.SOL_HEADING
    stood_s = OFF_S - 135.0                               # the snapshot is of its beginning
    assert 59.0 + stood_s - 10.0 < run.frames.warm["age_s"][0] < 62.0 + stood_s + 10.0
    e = stats.Errors(epochs, truth.from_events(run.truth_events, "on"), lever_ba_b=run.lever_ba_b)
    for group in ("att", "pos", "vel"):
        z = np.abs(e.err[group]) / e.sd[group]
        print(f"{group}: first {z[0]}, worst of all {np.nanmax(z):.2f} sigma")
        assert (z[0] < 3.0).all() and np.nanmax(z) < 5.33


def test_without_a_store_the_same_start_has_no_attitude(folder, standing):
    eventlog.write(folder / "cold.log", without_attitude(keep(standing, ON_S, 330)))
    call("pelorus-sil", folder / "cold.log", "-o", folder / "cold.out", "-q")
    run = outlog.load(str(folder / "cold.out"))
    assert run.frames.warm.size == 0 and not (run.sol["flags"] & frames.SOL_INS).any()


def test_moved_while_off_is_refused_by_place(folder, stored, moves_on):
    assert verdict(power_on(folder, keep(moves_on, ON_S, 330), stored, "moved_on")) == "moved"


def test_tilted_while_off_is_refused_by_gravity(folder, standing, stored):
    """The same place on a ramp: here the IMU's axes are turned by five degrees instead."""
    rows = keep(standing, ON_S, 330)
    rows = [(t, c, tilted(d) if c == "UART_IMU" else d) for t, c, d in rows]
    assert verdict(power_on(folder, rows, stored, "tilted")) == "turned"


def tilted(frame):
    at = 6 + 16
    counts = np.frombuffer(frame[at:at + 24], "<i4").astype(float).reshape(2, 3)
    c, s = np.cos(np.radians(5.0)), np.sin(np.radians(5.0))
    turned = counts @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]])
    return frames.encode(frame[2], frame[6:at] + np.round(turned).astype("<i4").tobytes(), frame[3])


def test_rocking_while_it_starts_is_refused(folder, standing, stored):
    rows = keep(standing, ON_S, 330)
    at = seconds(rows)
    rows = [(t, c, tilted(d) if c == "UART_IMU" and at(t) > 0.6 else d) for t, c, d in rows]
    assert verdict(power_on(folder, rows, stored, "rocking")) == "not still"


def test_motion_leaves_nothing_to_start_from(folder, moves_on):
    """The power goes while it stands, or as it has moved on for some seconds."""
    for name, end_s, there in (("stood", 230, True), ("left", 245, False)):
        eventlog.write(folder / f"{name}.log", keep(moves_on, 0, end_s))
        call("pelorus-sil", folder / f"{name}.log", "-o", folder / f"{name}.out", "-q", "--store", folder / name)
        assert (folder / f"{name}.0").exists() == there


def test_too_old_is_refused(folder, standing, stored):
    rows = [(t, c, d.replace(b"[navigator.start]", b"[navigator.start]\nwarm_max_age_s = 30") if c == "SETUP" else d)
            for t, c, d in keep(standing, ON_S, 330)]
    assert verdict(power_on(folder, rows, stored, "stale")) == "stale"


def test_another_lever_arm_is_refused(folder, standing, stored):
    rows = [(t, c, re.sub(rb"lever_arm_m = \[ 0\.2", b"lever_arm_m = [ 0.3", d) if c == "SETUP" else d) for t, c, d in keep(standing, ON_S, 330)]
    assert verdict(power_on(folder, rows, stored, "remounted")) == "remounted"


def test_one_torn_slot_is_no_matter(folder, standing, stored):
    whole = stored[0]
    assert verdict(power_on(folder, keep(standing, ON_S, 330), [whole[:100], whole], "torn")) == "used"
    assert verdict(power_on(folder, keep(standing, ON_S, 330), [b"PELS" + bytes(300), whole[:50]], "torn_both")) == "damaged"
