"""Real recordings through `make replay`: its table, and the bounds that are known for the recordings."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from replay import tracks
from replay.__main__ import folder_of

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
    keep = tmp_path_factory.mktemp("replay")
    found = keep / "replay.json"
    command = [sys.executable, ROOT / "tools" / "replay", "--data", data, "--json", found, "--keep", keep]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    print("\n" + done.stdout)
    assert found.exists(), done.stderr
    return {r["name"]: r | {"folder": keep / folder_of(r["name"])} for r in json.loads(found.read_text())}


def peer_of(r):
    """RTKLIB's figures; None where it is not installed, which PELORUS_REQUIRE_DATA=1 does not allow."""
    if r["peer"] is None and os.environ.get("PELORUS_REQUIRE_DATA") == "1":
        pytest.fail(f"{r['name']}: RTKLIB has not run")
    return r["peer"]


def test_every_recording_is_replayed(rows):
    failed = {name: r["failed"] for name, r in rows.items() if r["failed"]}
    assert not failed
    assert all(r["ours"]["epochs"] > 0 for r in rows.values()), {name: r["ours"]["epochs"] for name, r in rows.items()}


def test_geonet_all_epochs_are_fixed_where_rtklib_stops(rows):
    """The receivers' clocks drift 9 ms apart; RTKLIB pairs 115 of the 120 epochs."""
    r = rows["geonet-0759-3040"]
    assert r["ours"]["epochs"] == r["ours"]["fixed"] == 120 and r["ours"]["wrong"] == 0
    assert np.abs(r["ours"]["mean_off_mm"]).max() < 3.0
    peer = peer_of(r)
    if peer:
        assert peer["fixed"] < 120


def test_walk_single_receiver_and_imu_beat_single_point(rows):
    r, alone = rows["walk-imu-ubx-2025"], rows["walk, without IMU"]
    peer = peer_of(r)
    limit = peer["h_rms_m"] if peer else 0.97
    assert 0.95 < limit < 0.99, "RTKLIB's own run is not the one of the recording's README"
    assert r["ours"]["h_rms_m"] < 0.97 and r["ours"]["h_rms_m"] < limit
    if peer:
        assert r["ours"]["h_rms_m"] < peer["h_rms_same_m"]
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


def test_walk_with_phases_knows_how_far_it_came(rows):
    """North and east, against the receiver's own RTK, whose walking antenna is no better than this: standing, ours moves by a millimetre."""
    f = rows["walk, with phases"]["ours"]
    assert f["moved"]["1"]["n"] > 200 and f["moved"]["10"]["n"] > 180
    assert max(f["moved"]["1"]["ned_m"][:2]) <= 0.02
    assert max(f["moved"]["10"]["ned_m"][:2]) <= 0.06 and f["moved"]["10"]["ned_m"][2] <= 0.12
    assert f["h_rms_m"] < rows["walk-imu-ubx-2025"]["ours"]["h_rms_m"]
    assert max(f["v_rms_mps"]) < max(rows["walk-imu-ubx-2025"]["ours"]["v_rms_mps"])


def fixed_of(rows, name):
    f = rows[name]["ours"]
    return f["fixed"], f.get("wrong", 0)


def test_static_pairs_are_fixed_on_one_frequency_too(rows):
    """RTKLIB-EX with its best settings: 115 with 2 wrong on L1 of geonet, 295 of 301 of the short baseline."""
    fixed, wrong = fixed_of(rows, "geonet, L1")
    assert fixed >= 118 and wrong == 0
    for name in ("attitude-static-099m-2024", "attitude, L1"):
        assert fixed_of(rows, name) == (301, 0), name


def test_car_is_fixed_with_all_signals_and_with_one(rows):
    """RTKLIB-EX: 351 and 287. No truth, but heights stay in the README's band."""
    for name in ("fujisawa-car-2021265", "fujisawa, L1"):
        assert rows[name]["ours"]["epochs"] == 360 and fixed_of(rows, name) == (360, 0), name


def test_car_has_no_jumps_that_motion_does_not_explain(rows):
    """Whatever the car does, solutions of two disjoint sets of signals do it too: a jump of the whole one would show against both."""
    whole = tracks.ours(rows["fujisawa-car-2021265"]["folder"] / "run.out")
    for name in ("fujisawa, L1", "fujisawa, L2 and L5"):
        farthest, jump, n = tracks.apart(whole, tracks.ours(rows[name]["folder"] / "run.out"))
        print(f"all signals against {name}, {n} epochs fixed by both: {100 * farthest:.1f} cm apart at most, jumps of {100 * jump:.1f} cm at most")
        assert n == 360 and farthest < 0.08 and jump < 0.05


def test_urban_walk_with_glonass_is_fixed_more_often_and_not_wrong(rows):
    """RTKLIB-EX: 1708, 15 of the epochs that the receiver fixed itself beyond 8 cm, none beyond 0.5 m."""
    f = rows["galway-walk-20181009"]["ours"]
    assert f["fixed"] > 1750
    assert f["wrong"] <= 15 and f["far"] == 0
    peer = peer_of(rows["galway-walk-20181009"])
    if peer:
        assert peer["fixed"] < f["fixed"]


def test_ten_seconds_without_gnss_cost_no_more_than_that(rows):
    """The longest waits for a fix are single frequency's."""
    for name in ("geonet-0759-3040", "geonet, L1", "attitude-static-099m-2024", "attitude, L1", "fujisawa-car-2021265", "fujisawa, L1"):
        assert rows[name]["ours"]["refix_s"] <= 5.0, name
    assert rows["galway-walk-20181009"]["ours"]["refix_s"] <= 60.0


def test_pillars_are_found_and_no_fix_is_false(rows):
    f = rows["valencia-pillars-2016"]["ours"]
    assert f["fixed"] == 3 and f["wrong"] == 0 and f["pillar_mm"] < 10.0


def test_a_canyon_without_a_base_claims_no_fix_and_is_placed_better_than_epoch_by_epoch(rows):
    """RTKLIB's single point solves 1076 epochs, 26 m rms; ours nearly all."""
    r = rows["hongkong-urban-2019"]
    assert r["ours"]["fixed"] == 0 and r["ours"]["epochs"] > 1700
    assert r["ours"]["h_rms_m"] < 22.0
    peer = peer_of(r)
    if peer:
        assert r["ours"]["h_rms_m"] < peer["h_rms_same_m"]


def test_half_cycles_and_few_satellites_give_an_honest_float(rows):
    r = rows["yamatogawa-kinematic-2010"]
    assert r["ours"]["epochs"] == 203 and r["ours"]["fixed"] == 0
    peer = peer_of(r)
    assert r["ours"]["step_max_m"] < (peer["step_max_m"] if peer else 2.44)


def test_city_car_with_imu_is_a_third_better_than_least_squares_of_each_epoch(rows):
    """RTKLIB's single point of the very same frames, on our epochs; velocity and heading against the RTK track (tools/replay/car.py says where)."""
    r, alone = rows["car-imu-codedoppler-2020"], rows["car, without IMU"]
    assert r["ours"]["epochs"] == 4269 and r["ours"]["fixed"] == 0
    assert r["ours"]["h_rms_m"] < alone["ours"]["h_rms_m"]
    assert max(r["ours"]["v_rms_mps"]) < 0.1
    assert r["ours"]["heading_rms_deg"] < 1.0 and r["ours"]["heading_compared"] > 500
    peer = peer_of(r)
    limit = peer["h_rms_same_m"] if peer else 5.6
    assert r["ours"]["h_rms_m"] < 0.7 * limit
    assert r["ours"]["h_rms_m"] < 2.0


def test_city_car_without_gnss_goes_on(rows):
    """Median and largest growth of the horizontal error over gaps all along the drive, against the true velocity carried on."""
    for seconds, median_m, largest_m in ((10, 1.0, 5.0), (30, 5.0, 40.0), (60, 30.0, 150.0)):
        f = rows[f"car, {seconds} s removed"]["ours"]
        assert f["gaps"] >= 10
        assert f["growth_median_m"] < median_m and f["growth_max_m"] < largest_m, seconds
        assert f["growth_median_m"] < 0.2 * f["carried_median_m"] and f["growth_max_m"] < 0.5 * f["carried_max_m"], seconds
