"""Real recordings through `make replay`: its table, and the bounds that are known for two of the recordings."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


def data_folder():
    for folder in (os.environ.get("PELORUS_DATA"), ROOT.parent / "shared" / "data"):
        if folder and Path(folder).is_dir():
            return Path(folder)
    return None


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    data = data_folder()
    if data is None:
        if os.environ.get("PELORUS_REQUIRE_DATA") == "1":
            pytest.fail("PELORUS_REQUIRE_DATA=1, and there are no recordings")
        pytest.skip("no recordings here: set PELORUS_DATA")
    found = tmp_path_factory.mktemp("replay") / "replay.json"
    done = subprocess.run([sys.executable, ROOT / "tools" / "replay", "--data", data, "--json", found], capture_output=True, text=True, check=False)
    print("\n" + done.stdout)
    assert found.exists(), done.stderr
    return {r["name"]: r for r in json.loads(found.read_text())}


def test_every_recording_is_replayed(rows):
    failed = {name: r["failed"] for name, r in rows.items() if r["failed"]}
    assert not failed
    assert all(r["ours"]["epochs"] > 0 for r in rows.values()), {name: r["ours"]["epochs"] for name, r in rows.items()}


def test_geonet_all_epochs_are_fixed_where_rtklib_stops(rows):
    """The receivers' clocks drift 9 ms apart; RTKLIB pairs 115 of the 120 epochs."""
    r = rows["geonet-0759-3040"]
    assert r["ours"]["epochs"] == r["ours"]["fixed"] == 120 and r["ours"]["wrong"] == 0
    assert np.abs(r["ours"]["mean_off_mm"]).max() < 3.0
    if r["peer"]:
        assert r["peer"]["fixed"] < 120


def test_walk_single_receiver_and_imu_beat_single_point(rows):
    r, alone = rows["walk-imu-ubx-2025"], rows["walk, without IMU"]
    limit = r["peer"]["h_rms_m"] if r["peer"] else 0.97
    assert 0.95 < limit < 0.99, "RTKLIB's own run is not the one of the recording's README"
    assert r["ours"]["h_rms_m"] < 0.97 and r["ours"]["h_rms_m"] < limit
    if r["peer"]:
        assert r["ours"]["h_rms_m"] < r["peer"]["h_rms_same_m"]
    assert r["ours"]["h_rms_m"] < alone["ours"]["h_rms_m"]
    # Each axis, against the displacements of the receiver's RTK track.
    assert max(r["ours"]["v_rms_mps"]) <= 0.1
    # All epochs from the first ephemerides on; the receiver sends them within 25 s.
    assert r["ours"]["epochs"] > 420


def test_walk_coasts_through_twenty_seconds(rows):
    with_imu, alone = rows["walk, 20 s removed"]["ours"], rows["walk, 20 s removed, without IMU"]["ours"]
    assert with_imu["gap_said"] > 300, "silent while coasting"
    assert with_imu["gap_h_max_m"] < 0.5 * alone["gap_h_max_m"]
    assert with_imu["gap_h_rms_m"] < 0.5 * alone["gap_h_rms_m"]
    assert with_imu["gap_h_max_m"] < 5.0


def test_fixes_of_the_other_recordings_are_right(rows):
    attitude = rows["attitude-static-099m-2024"]["ours"]
    assert attitude["fixed"] == 301 and attitude["wrong"] == 0
    for name in ("fujisawa-car-2021265",):
        f = rows[name]["ours"]
        assert f.get("wrong", 0) <= 0.01 * max(f["fixed"], 1), name
