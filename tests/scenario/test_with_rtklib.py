"""RTKLIB and Pelorus on the same simulated bytes: both are right, and they agree."""

import numpy as np
import pytest
import runs
from pelorus_tools import eventlog, truth
from replay import rtklib, tracks

pytestmark = pytest.mark.skipif(not rtklib.available(), reason="RTKLIB is not installed (Debian package rtklib)")


FORM = ("-v", "3.04", "-f", "5", "-od", "-os")     # of the RINEX files: five frequencies, with Doppler and strength

CONF = """pos1-posmode=kinematic
pos1-frequency=l1+l2
pos1-elmask=15
pos1-ionoopt=off
pos1-navsys=9
pos2-armode=continuous
"""     # GPS and Galileo


def bytes_of(capture, channel, path):
    with open(path, "wb") as f:
        for _, c, data in eventlog.events(eventlog.open_bytes(str(capture))):
            if c == channel:
                f.write(data)
    return path


def test_static_pair_of_four_systems(tmp_path):
    capture = runs.simulate(tmp_path, "static_base_rover", duration=300)
    out, _ = runs.firmware(capture)
    ours = tracks.ours(str(out))
    reference = truth.load(str(capture))
    rover, nav = rtklib.convert(bytes_of(capture, b"UART_ROVER", tmp_path / "rover.ubx"), tmp_path, "ubx", *FORM)
    # Week 2300 began on 2024-02-04; the scenario starts on Thursday 12:00.
    base, _ = rtklib.convert(bytes_of(capture, b"UART_BASE", tmp_path / "base.rtcm3"), tmp_path, "rtcm3", "-tr", "2024/02/08", "12:00:00", *FORM)
    station = runs.Result(out).run.used["r_station_e"]
    (tmp_path / "conf").write_text(CONF)
    peer = rtklib.solve(tmp_path, 2, ["-k", tmp_path / "conf", "-r", *station], rover, base, nav)
    place = reference.r_e[0]
    figures = {}
    for name, t in (("Pelorus", ours), ("RTKLIB", peer)):
        e = tracks.enu(t.r_e, place)[t.fixed]
        figures[name] = e
        print(f"{name}: {t.fixed.sum()} of {t.t_ns.size} fixed, mean {np.round(1e3 * e.mean(0), 1)} mm, std {np.round(1e3 * e.std(0), 1)} mm ENU")
        assert t.fixed.mean() > 0.95
        assert np.hypot(*e[:, :2].T).max() < 0.08
        assert np.hypot(*e.mean(0)[:2]) < 0.01 and abs(e.mean(0)[2]) < 0.03
    apart = figures["Pelorus"].mean(0) - figures["RTKLIB"].mean(0)
    print("means apart by", np.round(1e3 * apart, 1), "mm")
    assert np.hypot(*apart[:2]) < 0.01 and abs(apart[2]) < 0.03
