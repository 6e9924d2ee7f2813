"""car-imu-codedoppler-2020: a car in a city, one receiver's code and Doppler as a table, an IMU, an RTK track.

Found from the recording itself, by physics: the IMU's y axis is forward (its specific force is the track's acceleration along the course), z up, so
gyro z falls when the course turns right; its times are UTC (innovations of the Doppler are smallest with the 18 leap seconds added, to 0.02 s).
Where it lies from the antenna is not known. The table's maker had taken out the receiver's clock, the satellites' clocks and group delays
(tests/peers/test_obs_csv.py). The track stands on the base's header position, which is ten metres or so above where the base's own codes
put it (more or less by the ionosphere assumed), so figures are horizontal.
"""

import csv
import gzip

import numpy as np

from pelorus_tools import earth, eventlog, gpstime, truth
from replay import rtklib, tracks

WEEK_NS = 2130 * 604800 * gpstime.NS
FIRST_NS = WEEK_NS + 364508_593_000_000   # first GNSS bytes: the orbits, a second before the first epoch
N_EPOCHS = 4269
MOVING_MPS, STRAIGHT_RADPS = 3.0, 0.05    # where the course of the antenna is the heading of the car
JERKED_MPS2 = 5.0                         # second difference of the track that a car does not make: another fix
END_S = 1.0                               # the track may miss the end of a gap by this much

CAPTURE = ["--rover", "{data}/gnss_code_doppler.csv.gz:obs-csv", "--obs-removed", "receiver-clock,satellite-clock,group-delay", "--nav", "{data}/base.nav.gz"]
CAPTURE_IMU = [*CAPTURE, "--imu", "{data}/imu.csv.gz:imu-csv", "--imu-time-offset", "18"]

CONFIG = """[navigator]
preset = "{}"
[navigator.mount]
yaw_deg = 0
wheels = true
"""


class Reference:
    """The fixed positions of the RTK track, in north-east-down about its first one."""

    def __init__(self, data):
        with gzip.open(data / "rtk_reference.csv.gz", "rt") as f:
            rows = [r for r in csv.DictReader(f) if r["Q"] == "1"]
        self.t_ns = WEEK_NS + np.array([round(float(r["tow_s"]) * 1e9) for r in rows])
        r_e = np.array([[float(r[k]) for k in ("x_m", "y_m", "z_m")] for r in rows])
        self.truth = truth.Truth("RTK", self.t_ns, r_e)
        self.C_e_n = earth.C_e_n(*earth.ecef_to_llh(r_e[0])[:2])
        self.origin = r_e[0]
        self.ned = self.to_ned(r_e)
        self.v_n, self.smooth = self.centred_differences()

    def to_ned(self, r_e):
        return (r_e - self.origin) @ self.C_e_n.T

    def centred_differences(self):
        """Velocities, and where five fixes in a row are a car's motion rather than jumps from one set of integers to another."""
        v = np.full_like(self.ned, np.nan)
        bend = np.full(len(v), np.inf)
        even = (np.abs(np.diff(self.t_ns)[1:] - 200_000_000) < 10**7) & (np.abs(np.diff(self.t_ns)[:-1] - 200_000_000) < 10**7)
        k = 1 + np.flatnonzero(even)
        v[k] = (self.ned[k + 1] - self.ned[k - 1]) / 0.4
        bend[k] = np.linalg.norm(self.ned[k + 1] - 2 * self.ned[k] + self.ned[k - 1], axis=1) / 0.04
        smooth = np.zeros(len(v), bool)
        smooth[1:-1] = np.maximum(np.maximum(bend[:-2], bend[1:-1]), bend[2:]) < JERKED_MPS2
        return v, smooth

    def nearest(self, t_ns):
        """Index of the fix at each time, and whether it is within 2 ms."""
        k = np.clip(np.searchsorted(self.t_ns, t_ns - 100_000_000), 0, len(self.t_ns) - 1)
        return k, np.abs(self.t_ns[k] - t_ns) < 2_000_000


def horizontal(ned):
    return np.hypot(ned[:, 0], ned[:, 1])


def heading_error(track, reference, k, usable):
    """Against the course over ground of a car that goes straight on, rad."""
    course = np.arctan2(reference.v_n[:, 1], reference.v_n[:, 0])
    turning = np.full(len(course), np.inf)
    turning[1:-1] = np.abs((course[2:] - course[:-2] + np.pi) % (2 * np.pi) - np.pi) / 0.4
    straight = usable & (horizontal(reference.v_n)[k] > MOVING_MPS) & (turning[k] < STRAIGHT_RADPS) & np.isfinite(track.heading)
    return (track.heading - course[k] + np.pi)[straight] % (2 * np.pi) - np.pi


def known(track, data):
    reference = Reference(data)
    f = tracks.shares(track, N_EPOCHS)
    if not track.t_ns.size:
        return f
    k, there = reference.nearest(track.t_ns)
    ned = reference.to_ned(track.r_e) - reference.ned[k]
    f["h_rms_m"], f["h_median_m"] = float(tracks.rms(horizontal(ned[there]))), float(np.median(horizontal(ned[there])))
    usable = there & reference.smooth[k]
    if np.isfinite(track.v_n[usable]).all():
        f["v_rms_mps"] = tracks.rms((track.v_n - reference.v_n[k])[usable]).tolist()
    error = heading_error(track, reference, k, usable)
    if error.size:
        f["heading_rms_deg"], f["heading_compared"] = float(np.degrees(tracks.rms(error))), int(error.size)
    return f


def peer(data, work, _=()):
    """RTKLIB's single-point positions of the very frames the firmware was given: least squares of each epoch, its own exclusion switched on."""
    capture = eventlog.open_bytes(str(work / "capture.log"))
    (work / "rover.ubx").write_bytes(b"".join(bytes(d) for _, channel, d in eventlog.events(capture) if channel == b"UART_ROVER"))
    obs, _ = rtklib.convert(work / "rover.ubx", work, "ubx")
    conf = work / "single.conf"
    conf.write_text("pos1-frequency=l1\npos1-ionoopt=brdc\npos1-tropopt=saas\npos1-navsys=17\npos1-posopt5=on\n")
    return rtklib.solve(work, 0, ["-k", conf, "-m", 10], obs, rtklib.plain(data / "base.nav.gz", work))


# ---- gaps ---------------------------------------------------------------------------------------------------------------------

def gap_batches(length_s):
    """Starts (s after the first GNSS bytes) while the car is under way, 40 s or more between gaps; a run has eight at most."""
    starts = np.arange(170.0, 850.0 - length_s, 20.0)
    step = int(np.ceil((length_s + 40.0) / 20.0))
    return [[(float(s), length_s) for s in part] for first in range(step) for part in np.array_split(starts[first::step], -(-len(starts[first::step]) // 8))]


def gap_options(batch):
    return [word for start, length in batch for word in ("--outage", f"{start:g},{length:g}")]


def gaps_known(runs, data):
    """How much the horizontal error grows from the last epoch before a gap to its end; beside it what the track's own velocity, carried on, would
    have made of it. Gaps at whose ends the track is not fixed are left out."""
    reference = Reference(data)
    grown, carried, epochs = [], [], 0
    for track, batch in runs:
        epochs += int(track.t_ns.size)
        k, there = reference.nearest(track.t_ns)
        for start, length in batch:
            start_ns = FIRST_NS + round(start * 1e9)
            end_ns = start_ns + round(length * 1e9)
            before = np.flatnonzero(there & reference.smooth[k] & (track.t_ns <= start_ns) & (track.t_ns > start_ns - 10**9))
            inside = np.flatnonzero(there & (track.t_ns < end_ns) & (track.t_ns > max(end_ns - END_S * 1e9, start_ns)))
            if not (before.size and inside.size):
                continue
            i, j = before[-1], inside[-1]
            moved = reference.ned[k[j]] - reference.ned[k[i]]
            grown.append(np.hypot(*((reference.to_ned(track.r_e[j]) - reference.to_ned(track.r_e[i])) - moved)[:2]))
            carried.append(np.hypot(*(reference.v_n[k[i]] * (track.t_ns[j] - track.t_ns[i]) * 1e-9 - moved)[:2]))
    f = {"epochs": epochs, "expected": 0, "fixed": 0, "gaps": len(grown)}
    if grown:
        f["growth_median_m"], f["growth_max_m"] = float(np.median(grown)), float(np.max(grown))
        f["carried_median_m"], f["carried_max_m"] = float(np.median(carried)), float(np.max(carried))
    return f
