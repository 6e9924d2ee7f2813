"""A serial line that is silent for a while, or loses frames: what is told afterwards stays within what it claims."""

import random

import numpy as np
import pytest
from pelorus_tools import eventlog
from runs import Result, firmware, simulate


def silent(channel, start_s, end_s):
    def edit(rows):
        first = min(t for t, c, _ in rows if c == "UART_ROVER")
        return [r for r in rows if r[1] != channel or not start_s <= (r[0] - first) * 1e-6 < end_s]
    return edit


def lossy(share):
    def edit(rows):
        dice = random.Random(1)
        return [r for r in rows if not r[1].startswith("UART") or dice.random() > share]
    return edit


def mounting_known(edit):
    """Heading may be taken from the course: the INS comes back under way."""
    def both(rows):
        return [(t, c, d.replace(b"[navigator.mount]", b"[navigator.mount]\nyaw_deg = 0.0") if c == "SETUP" else d)
                for t, c, d in edit(rows)]
    return both


CASES = {"imu silent 2 s in the turn": silent("UART_IMU", 150, 152),
         "imu silent 2 s, mounting known": mounting_known(silent("UART_IMU", 150, 152)),
         "imu silent 20 s": silent("UART_IMU", 150, 170), "base silent 60 s": silent("UART_BASE", 100, 160),
         "rover silent 30 s": silent("UART_ROVER", 100, 130),
         "one frame in a hundred lost": lossy(0.01), "one frame in ten lost": lossy(0.1)}


@pytest.fixture(scope="module", params=["s5_leg", "car"])
def capture(request, tmp_path_factory):
    path = simulate(tmp_path_factory.mktemp("interruptions"), request.param)
    return path, [(t, c.decode(), bytes(d)) for t, c, d in eventlog.events(eventlog.open_bytes(str(path)))]


@pytest.mark.parametrize("case", CASES)
def test_honest_after(capture, case):
    path, rows = capture
    edited = path.with_name("edited.log")
    eventlog.write(edited, CASES[case](rows))
    result = Result(firmware(edited)[0])
    assert np.isfinite(result.sol["r_eb_e"]).all() and (np.diff(result.sol["t_ns"][result.epoch]) > 0).all()
    for group, sd in result.errors.sd.items():
        z = (np.abs(result.errors.err[group]) / sd).max(axis=1)
        z = z[np.isfinite(z)]
        print(f"{case}: {group} worst {z.max():.1f} sigma, 95 % below {np.percentile(z, 95):.1f}")
        assert np.percentile(z, 95) < 3.0 and z.max() < 7.0
