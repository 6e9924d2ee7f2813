"""pelorus-sim as a program: repeatable, ordered in time, and plain about mistakes."""
import struct
import subprocess
import tomllib
from pathlib import Path

import numpy as np
import pytest
from pelorus_tools import earth, eventlog, truth

SCENARIOS = Path(__file__).resolve().parents[2] / "scenarios"
LEG = SCENARIOS / "s5_leg.toml"


def sim(*args, **kwargs):
    return subprocess.run(["pelorus-sim", *map(str, args)], capture_output=True, check=False, **kwargs)


def events(path):
    return [(t, name.decode(), bytes(data)) for t, name, data in eventlog.events(eventlog.open_bytes(str(path)))]


def test_one_seed_gives_the_same_bytes_and_another_does_not(tmp_path):
    paths = [tmp_path / name for name in "abc"]
    for path, seed in zip(paths, (7, 7, 8)):
        assert sim(LEG, "-o", path, "--seed", seed, "--duration", 20, "-q").returncode == 0
    a, b, c = (path.read_bytes() for path in paths)
    assert a == b and a != c


def test_events_come_in_order_of_arrival_and_setup_first(tmp_path):
    assert sim(LEG, "-o", tmp_path / "a", "--duration", 30, "-q").returncode == 0
    log = events(tmp_path / "a")
    times = [t for t, _, _ in log]
    assert times == sorted(times) and log[0][1] == "SETUP"
    assert {name for _, name, _ in log} == {"SETUP", "TRUTH", "UART_IMU", "UART_ROVER", "UART_BASE"}
    assert times[0] == 315964800_000000 - 18_000000 + (2300 * 604800 + 77400) * 1_000000
    setup = tomllib.loads(log[0][2].decode())
    assert setup["scenario"]["seed"] == 1 and "--seed 1" in setup["scenario"]["command"]
    roll, pitch, heading = setup["navigator"]["start"]["attitude_deg"]
    assert 0 < abs(roll) < 0.1 and 0 < abs(pitch) < 0.1 and 0 < abs(heading) < 1.0


def test_the_start_attitude_is_drawn_with_its_stated_error(tmp_path):
    errors = []
    for seed in range(60):
        assert sim(LEG, "-o", tmp_path / "a", "--seed", seed, "--duration", 0.01, "-q").returncode == 0
        setup = tomllib.loads(events(tmp_path / "a")[0][2].decode())
        errors.append([3600 * x for x in setup["navigator"]["start"]["attitude_deg"]])
    rms = [(sum(e[i] ** 2 for e in errors) / 60) ** 0.5 for i in range(3)]
    print("roll, pitch, heading error, arc seconds rms:", rms)
    assert 40 < rms[0] < 80 and 40 < rms[1] < 80 and 400 < rms[2] < 800


def test_a_barometer_tells_the_true_height_within_its_weather(tmp_path):
    """Frames taken apart here, by the page of wire formats; heights against the truth."""
    assert sim(SCENARIOS / "s3_highway.toml", "-o", tmp_path / "a", "--duration", 700, "-q").returncode == 0
    line = b"".join(data for _, name, data in events(tmp_path / "a") if name == "UART_IMU")
    heights, at = {}, line.find(b"PL")
    while at >= 0:
        size = struct.unpack_from("<H", line, at + 4)[0]
        if line[at + 2] == 3:
            t_ns, height_mm, sd_mm, seq = struct.unpack_from("<qiHH", line, at + 6)
            assert seq == len(heights) and sd_mm == 100
            heights[t_ns] = height_mm / 1000
        at = line.find(b"PL", at + size + 9)
    assert len(heights) == 701
    track = truth.load(tmp_path / "a")
    where, covered = track.at(np.array(list(heights)))
    off = (np.array(list(heights.values())) - earth.ecef_to_llh(where.r_e)[2])[covered]
    mean, spread = off.mean(), off.std()
    print(f"{len(off)} heights: mean {mean:.2f} m, spread {spread:.2f} m; terrain from {min(heights.values()):.0f} to {max(heights.values()):.0f} m")
    assert len(off) > 600 and abs(mean) < 2.5 and 0.1 < spread < 2
    assert max(heights.values()) - min(heights.values()) > 25


def test_a_capture_can_go_to_standard_output():
    done = sim(LEG, "-o", "-", "--duration", 1, "-q")
    assert done.returncode == 0 and done.stdout[:4] == b"\xed\xa1\xda\x01"


@pytest.mark.parametrize("old, new, says", [
    ("clock_bias_us", "clock_bais_us", "did you mean 'clock_bias_us'"),
    ("turn_deg = 180", "turn_degs = 180", "leg[0].segment[1].turn_degs"),
    ("rate_hz = 500", 'rate_hz = "fast"', "must be a number"),
    ("rate_hz = 500", "rate_hz = 0", "must be within 1 to 4000"),
    ('"G2L"', '"G9L"', "no signal"),
    ('"ideal24"', '"real"', '"ideal24" "multi"'),
    ("lat_deg = 30.5\n", "\n", "needs lat_deg"),
    ("seed = 1", "seed = ", "s5.toml:4"),
])
def test_a_mistake_in_a_scenario_is_one_clear_line(tmp_path, old, new, says):
    text = LEG.read_text()
    assert old in text
    scenario = tmp_path / "s5.toml"
    scenario.write_text(text.replace(old, new, 1))
    done = sim(scenario, "-o", tmp_path / "out")
    line = done.stderr.decode()
    assert done.returncode == 2 and line.count("\n") == 1 and says in line, line
    assert not (tmp_path / "out").exists()


def test_exit_codes_tell_usage_from_unreadable(tmp_path):
    assert sim(LEG).returncode == 2
    assert sim(LEG, "--sed", "1", "-o", tmp_path / "a").returncode == 2
    assert sim(tmp_path / "none.toml", "-o", tmp_path / "a").returncode == 3
    assert sim(LEG, "-o", tmp_path / "no" / "such" / "folder", "--duration", 1).returncode == 3
    assert sim("--help").returncode == 0 and sim("--version").returncode == 0


@pytest.mark.parametrize("scenario", sorted(SCENARIOS.glob("*.toml")), ids=lambda p: p.stem)
def test_every_scenario_runs_and_says_what_it_shows(scenario, tmp_path):
    assert scenario.read_text().startswith("# ")
    assert tomllib.loads(scenario.read_text())["name"] == scenario.stem
    done = sim(scenario, "-o", tmp_path / "a", "--duration", 5)
    assert done.returncode == 0, done.stderr
    assert len(events(tmp_path / "a")) > 50


def test_a_bad_line_loses_and_damages_frames(tmp_path):
    scenario = tmp_path / "bad.toml"
    scenario.write_text(LEG.read_text().replace("[rover]\n", "[rover]\nlost_frames = 0.2\nbit_errors = 1e-4\n", 1))
    done = sim(scenario, "-o", tmp_path / "a", "--duration", 100, "-v")
    clean = sim(LEG, "-o", tmp_path / "b", "--duration", 100, "-q")
    assert done.returncode == 0 and clean.returncode == 0
    count = [sum(name == "UART_ROVER" for _, name, _ in events(tmp_path / x)) for x in "ab"]
    print(done.stderr.decode().strip(), count)
    assert 0.65 * count[1] < count[0] < 0.95 * count[1]


def test_the_manuals_example_runs(tmp_path):
    text = (SCENARIOS.parent / "docs" / "SIMULATOR.md").read_text()
    (tmp_path / "block.toml").write_text(text.split("```toml\n")[1].split("```")[0])
    done = sim(tmp_path / "block.toml", "-o", tmp_path / "a")
    assert done.returncode == 0, done.stderr
    assert b"124 s in" in done.stderr and b"12400 IMU samples" in done.stderr
