"""Text rows of code and Doppler whose maker took clocks and group delay out: what pelorus-capture makes of them is a receiver's own again.

car-imu-codedoppler-2020: its base recorded raw codes of the same satellites, its RTK track tells where the rover was.
"""
import csv
import gzip

import numpy as np
import rinex_reader as rinex
from gnss_peer import peer, recording  # noqa: F401
from test_capture import capture, convbin, joined
from test_gnss_recordings import feed_nav

FOLDER = "car-imu-codedoppler-2020"
WEEK_NS = 2130 * 604800 * 10**9
BASE = [-3961909.8277, 3348999.2275, 3698216.8430]
STANDS_UNTIL_S = 364630.0  # of the week


def receiver_rows(tmp_path):
    channels, _ = capture(tmp_path, "--rover", f"{recording(FOLDER, 'gnss_code_doppler.csv.gz')}:obs-csv", "--nav", recording(FOLDER, "base.nav.gz"),
                          "--obs-removed", "receiver-clock,satellite-clock,group-delay")
    epochs, _ = rinex.read_obs(convbin(tmp_path, "rover", joined(channels["UART_ROVER"])))
    return epochs


def test_tags_are_the_whole_milliseconds_that_the_receiver_had(tmp_path):
    """Times in the file are true to a microsecond; the receiver's clock comes back by what the codes say, its maker's habit shows."""
    tags = np.array([t for t, _ in receiver_rows(tmp_path)])
    off_ns = (tags + 500_000) % 1_000_000 - 500_000
    print(f"\n{len(tags)} epochs, off whole milliseconds by {off_ns.std():.0f} ns rms, {np.abs(off_ns).max()} ns at most")
    assert len(tags) == 4269
    assert np.abs(off_ns).max() < 1500 and np.abs(off_ns.mean()) < 300


def test_differences_to_a_raw_base_are_multipath(peer, tmp_path):  # noqa: F811
    """Satellite clock, relativity (20 m for QZSS) and group delay (1.4 m apart) cancel against a base that kept them. Above 30 degrees, standing still."""
    with gzip.open(recording(FOLDER, "rtk_reference.csv.gz"), "rt") as f:
        at_rest = [r for r in csv.DictReader(f) if float(r["tow_s"]) < STANDS_UNTIL_S and r["Q"] == "1"]
    rover_e = np.mean([[float(r[k]) for k in ("x_m", "y_m", "z_m")] for r in at_rest], axis=0)
    base, _ = rinex.read_obs(recording(FOLDER, "base_GQ_L1.obs.gz"))
    base_t = np.array([t for t, _ in base])
    rover = [e for e in receiver_rows(tmp_path) if e[0] < WEEK_NS + STANDS_UNTIL_S * 1e9]
    feed_nav(peer, recording(FOLDER, "base.nav.gz"), rover[0][0])
    code, rate = {}, []
    for t, signals in rover[::5]:
        k = int(np.argmin(np.abs(base_t - t)))
        peer.epoch(0, t, signals)
        peer.epoch(1, int(base_t[k]), base[k][1])
        rows = [r for r in peer.differences(rover_e, BASE, 1e-9 * (t - base_t[k])) if r["var_code"] < 0.5]  # above 30 degrees
        for group in {(r["sys"], r["carrier"]) for r in rows}:
            of = [r for r in rows if (r["sys"], r["carrier"]) == group]
            for r in of:
                code.setdefault((r["sys"], r["prn"]), []).append(r["code"] - np.median([q["code"] for q in of]))
            rate += [r["rate"] - np.median([q["rate"] for q in of]) for r in of]
    mean = {s: float(np.mean(v)) for s, v in code.items()}
    print(f"\n{len(rover)} epochs at rest: mean code differences {np.std(list(mean.values())):.2f} m rms over {len(mean)} satellites, "
          f"{max(map(abs, mean.values())):.2f} m at most, range rates {np.std(rate):.3f} m/s rms")
    assert len(mean) >= 9
    assert np.std(list(mean.values())) < 1.0 and max(map(abs, mean.values())) < 2.5
    assert np.std(rate) < 0.04  # two receivers of 0.02 m/s
