"""One entry a recording: what goes in, how the firmware is set, what is known about the result, and RTKLIB's way.

`known(track)` turns a track of either program into figures, so both are judged by the same yardstick. Paths in `capture`
may hold {data}, the folder of the recording. A peer is called with the folders of data and work and the rover's epochs to leave
out, so that both lose the same 10 s.
"""

from dataclasses import dataclass, field
from typing import Callable

import numpy as np

from pelorus_tools import earth, gpstime, truth
from replay import car, rtklib, tracks


@dataclass
class Recording:
    name: str                      # of the row
    folder: str                    # of the data
    mode: str                      # words for the table
    capture: list                  # arguments of pelorus-capture
    known: Callable                # (track, data folder) -> figures
    peer: Callable = None          # (data folder, work folder, epochs removed) -> track of RTKLIB
    config: str = ""               # [navigator] table
    sil: list = field(default_factory=list)
    refix: bool = False            # also run with 10 s removed in the middle
    gaps: list = field(default_factory=list)  # runs with these (start, length) removed, s; `known` then gets [(track, gaps of the run)]

L1_ONLY = '[navigator]\ncarriers = ["L1"]\n'


def radians_llh(lat, lon, h):
    return earth.llh_to_ecef(np.radians(lat), np.radians(lon), np.asarray(h, float))


# ---- geonet-0759-3040: static pair, clocks that drift apart ------------------------------------------------------------

GEONET_BASE = (-3978242.4348, 3382841.1715, 3649902.7667)
GEONET_ENU = np.array([-953.336, 3196.237, -6.400])


def geonet_peer(frequencies):
    def run(data, work, removed_ns=()):
        files = [data / n for n in ("07590920.05o", "30400920.05o", "07590920.05n", "30400920.05n")]
        return rtklib.solve(work, 2, ["-m", 15, "-f", frequencies, "-sys", "G", "-r", *GEONET_BASE], *files, removed_ns=removed_ns)
    return run


GEONET_CAPTURE = ["--rover", "{data}/07590920.05o:rinex", "--base", "{data}/30400920.05o:rinex", "--nav", "{data}/07590920.05n",
                  "--nav", "{data}/30400920.05n"]


def geonet_known(track, _):
    return tracks.baseline(track, GEONET_BASE, GEONET_ENU, 120)


# ---- walk-imu-ubx-2025: handheld, one receiver and an IMU ------------------------------------------------------------------

# The receiver's own RTK track: good to centimetres, its datum not absolute, so the mean offset is removed. Its velocities lag its
# positions by a tenth of a second (they fit ours best 0.12 s ago), so velocity is held against the displacements of the track.
#
# The IMU lies 5 cm from the antenna (README); which way it looks the navigator finds out by itself.
WALK_IMU = """[navigator]
preset = "ins-single"
output_hz = 20
[navigator.imu]
model = "mems"
accel_markov_ug = 3000
[navigator.mount]
lever_arm_m = [0.0, 0.05, 0.0]
"""
# With its own phases. The track is the antenna's, and so is ours with the arm left out: that turns with an IMU whose axes nobody measured.
WALK_TDCP = """[navigator]
preset = "ins-tdcp"
output_hz = 20
[navigator.imu]
model = "mems"
accel_markov_ug = 3000
"""
WALK_GNSS = """[navigator]
preset = "single"
output_hz = 20
"""
WALK_CAPTURE = ["--rover", "{data}/gnss_1730.ubx.gz:ubx", "--imu", "{data}/imu_1730.csv.gz:imu-csv"]
WALK_OUTAGE = (60.0, 20.0)         # s after the first GNSS bytes: walking, with turns


def walk_truth(data):
    return truth.load(str(data / "gnss_1730_sf.pos.gz"))


def walk_known(track, data):
    reference = walk_truth(data)
    f = tracks.against(track, reference, 536, remove_mean=True)
    if "v_rms_mps" in f:  # RTKLIB's positions come without velocities
        f["v_receiver_rms_mps"] = f["v_rms_mps"]
        f["v_rms_mps"] = tracks.against_displacements(track, reference)
    return f


def walk_displacements(track, data):
    """How far the antenna came in 1 and 10 s, against the receiver's RTK track while both its ends are fixed and the INS runs."""
    f = walk_known(track, data)
    if track.ins is not None:
        f["moved"] = {span_s: tracks.moved(track, walk_truth(data), span_s) for span_s in (1, 10)}
    return f


def walk_peer(data, work, _=()):
    obs, nav = rtklib.convert(data / "gnss_1730.ubx.gz", work, "ubx")
    return rtklib.solve(work, 0, ["-m", 10, "-f", 2, "-sys", "G,E"], obs, nav)


def walk_gap(track, data):
    """Horizontal error inside the removed 20 s, relative to the error just before it began. Who says nothing inside is taken
    at his last word: last position and velocity, carried on."""
    reference = walk_truth(data)
    t_ns, r_e = track.t_ns, track.r_e
    start, length = (int(x * 1e9) for x in WALK_OUTAGE)
    start += reference.t_ns[0]
    inside = (t_ns > start + 10**9) & (t_ns < start + length)
    said = int(inside.sum())
    last = np.flatnonzero(t_ns <= start)
    if not said and last.size:
        k = last[-1]
        t_gap = np.arange(start + 10**9, start + length, 250_000_000)
        v_e = earth.C_e_n(*earth.ecef_to_llh(r_e[k])[:2]).T @ track.v_n[k]
        t_ns = np.concatenate([t_ns[last], t_gap])
        r_e = np.concatenate([r_e[last], r_e[k] + (t_gap - t_ns[k])[:, None] * 1e-9 * v_e])
    at, covered = reference.at(t_ns)
    lat, lon, _ = earth.ecef_to_llh(at.r_e)
    ned = earth.rotate(earth.C_e_n(lat, lon), r_e - at.r_e)
    before = covered & (t_ns > start - 5 * 10**9) & (t_ns <= start)
    inside = covered & (t_ns > start + 10**9) & (t_ns < start + length)
    f = {"epochs": int(track.t_ns.size), "expected": 0, "fixed": 0}
    if before.any() and inside.any():
        h = np.hypot(*(ned[inside] - ned[before].mean(0))[:, :2].T)
        f["gap_said"], f["gap_h_rms_m"], f["gap_h_max_m"] = said, float(tracks.rms(h)), float(h.max())
    return f


# ---- others ---------------------------------------------------------------------------------------------------------------

ATTITUDE_1 = radians_llh(35.134707705, 136.977577939, 104.853)
ATTITUDE_ENU = np.array([-0.2232, -0.9647, 0.0096])


def attitude_peer(frequencies):
    def run(data, work, removed_ns=()):
        files = [rtklib.plain(data / n, work) for n in ("ant2_rover.obs.gz", "ant1_base.obs.gz", "base.nav.gz")]
        return rtklib.solve(work, 2, ["-m", 15, "-f", frequencies, "-sys", "G,E,J", "-i", "-r", *ATTITUDE_1], *files, removed_ns=removed_ns)
    return run


ATTITUDE_CAPTURE = ["--rover", "{data}/ant2_rover.obs.gz:rinex", "--base", "{data}/ant1_base.obs.gz:rinex", "--nav", "{data}/base.nav.gz",
                    "--base-ecef", "{:.4f},{:.4f},{:.4f}".format(*ATTITUDE_1)]


def attitude_known(track, _):
    return tracks.baseline(track, ATTITUDE_1, ATTITUDE_ENU, 301)


FUJISAWA_BASE = (-3959400.631, 3385704.533, 3667523.111)


FUJISAWA_CAPTURE = ["--rover", "{data}/SEPT265G.21O.gz:rinex", "--base", "{data}/3034265G.21O.gz:rinex", "--nav", "{data}/SEPT2650.21P.gz",
                    "--base-ecef", "{},{},{}".format(*FUJISAWA_BASE)]


def fujisawa_known(track, _):
    """No truth: a fix is wrong whose height leaves the band of the README. Two disjoint sets of signals are rows of their own."""
    f = tracks.shares(track, 360)
    up = tracks.enu(track.r_e, np.array(FUJISAWA_BASE))[track.fixed, 2]
    if up.size:
        f["wrong"] = int(np.sum((up < -1.5) | (up > -1.0)))
        f["up_m"] = [float(up.min()), float(np.median(up)), float(up.max())]
    return f


def fujisawa_peer(frequencies, systems):
    def run(data, work, removed_ns=()):
        files = [rtklib.plain(data / n, work) for n in ("SEPT265G.21O.gz", "3034265G.21O.gz", "SEPT2650.21P.gz")]
        return rtklib.solve(work, 2, ["-m", 15, "-f", frequencies, "-sys", systems, "-r", *FUJISAWA_BASE], *files, removed_ns=removed_ns)
    return run


GALWAY_BASE = (3774696.5547, -596647.9083, 5089485.6511)


def galway_truth(data):
    """The rover's own real-time RTK fixes: its GGA of quality 4. Heights above the geoid, so horizontal only."""
    import gzip
    day = gpstime.from_calendar(2018, 10, 9, 0, 0, 18.0)
    t, llh = [], []
    for line in gzip.decompress((data / "rover-20181009-1221.ubx.gz").read_bytes()).split(b"$")[1:]:
        w = line.split(b",")
        if len(w) > 11 and w[0][2:] == b"GGA" and w[6] == b"4":
            try:
                hms = w[1].decode()
                lat, lon = (int(x[:n]) + float(x[n:]) / 60 for x, n in ((w[2], 2), (w[4], 3)))
                t.append(day + round((int(hms[:2]) * 3600 + int(hms[2:4]) * 60 + float(hms[4:])) * 1e9))
                llh.append((lat if w[3] == b"N" else -lat, lon if w[5] == b"E" else -lon, float(w[9]) + float(w[11])))
            except ValueError:
                continue
    return truth.Truth("GGA", np.array(t), radians_llh(*np.array(llh).T))


def galway_known(track, data):
    reference = galway_truth(data)
    at, covered = reference.at(track.t_ns, max_gap_s=1.5)
    f = tracks.shares(track, 2072)
    fixed = covered & track.fixed
    f["compared"] = int(fixed.sum())
    if fixed.any():
        d = tracks.enu(track.r_e, at.r_e[fixed][0])[fixed] - tracks.enu(at.r_e, at.r_e[fixed][0])[fixed]
        h = np.hypot(d[:, 0], d[:, 1])
        # GGA has five decimals of a minute, 2 cm, and the receiver's own fixes are no truth either.
        f["wrong"], f["h_median_m"] = int(np.sum(h > tracks.WRONG_FIX_M)), float(np.median(h))
        f["far"] = int(np.sum(h > 0.5))
    return f


def galway_peer(glonass):
    def run(data, work, removed_ns=()):
        rover, nav = rtklib.convert(data / "rover-20181009-1221.ubx.gz", work, "ubx")
        base, _ = rtklib.convert(data / "base-20181009-1220.ubx.gz", work, "ubx")
        options = ["-p", 2, "-m", 15, "-f", 1, "-r", *GALWAY_BASE]
        if glonass:
            hold = work / "hold.conf"
            hold.write_text("pos1-navsys=5\npos2-armode=fix-and-hold\npos2-gloarmode=on\n")
            options = ["-k", hold, *options]
        else:
            options += ["-sys", "G"]
        return rtklib.solve(work, 2, options, rover, base, nav, removed_ns=removed_ns)
    return run


GALWAY_CAPTURE = ["--rover", "{data}/rover-20181009-1221.ubx.gz:ubx", "--base", "{data}/base-20181009-1220.ubx.gz:ubx"]


def yamatogawa_known(track, _):
    """No truth: smooth at metre level is what can be asked."""
    f = tracks.shares(track, 203)
    if track.t_ns.size > 2:
        f["step_max_m"] = float(np.linalg.norm(np.diff(track.r_e, axis=0), axis=1).max())
    return f


YAMATOGAWA_BASE = (-3749943.5172, 3683398.2394, 3600629.5295)


def yamatogawa_peer(data, work, removed_ns=()):
    nav = rtklib.plain(data / "brdc0060.10n.gz", work)
    return rtklib.solve(work, 2, ["-m", 15, "-f", 1, "-sys", "G", "-r", *YAMATOGAWA_BASE], data / "yamatogawa_rover.obs", data / "yamatogawa_master.obs", nav,
                        removed_ns=removed_ns)


def hongkong_known(track, data):
    a = np.loadtxt(data / "groundTruth.csv", delimiter=",")
    reference = truth.Truth("SPAN", (a[:, 0].astype(np.int64) * 604800 + a[:, 1].astype(np.int64)) * gpstime.NS, radians_llh(*a[:, 2:5].T))
    f = tracks.against(track, reference, 1760, remove_mean=False)
    return f


def hongkong_peer(data, work, _=()):
    return rtklib.solve(work, 0, ["-m", 15, "-sys", "G"], *(rtklib.plain(data / n, work) for n in ("rover.obs.gz", "hksc1180.19n.gz")))


CANBERRA = radians_llh(-35.315523505, 149.010069087, 804.589)


def canberra_peer(data, work, _=()):
    obs, nav = rtklib.convert(data / "missing-beidou-STR17.rtcm3", work, "rtcm3", "-tr", "2020/01/01", "0:0:0")
    return rtklib.solve(work, 0, ["-m", 10, "-sys", "G,E"], obs, nav)


COLDSTART = radians_llh(47.251296, 5.993346, 363.0)


def coldstart_peer(data, work, _=()):
    obs, nav = rtklib.convert(data / "coldstart.ubx.gz", work, "ubx")
    return rtklib.solve(work, 0, ["-m", 10, "-sys", "G,E"], obs, nav)


ALL = [
    Recording("geonet-0759-3040", "geonet-0759-3040", "RTK L1+L2, 3 km", GEONET_CAPTURE, geonet_known, geonet_peer(2), refix=True),
    Recording("geonet, L1", "geonet-0759-3040", "RTK L1, 3 km", GEONET_CAPTURE, geonet_known, geonet_peer(1), L1_ONLY, refix=True),
    Recording("walk-imu-ubx-2025", "walk-imu-ubx-2025", "single receiver + IMU, tight", WALK_CAPTURE, walk_displacements, walk_peer, WALK_IMU),
    Recording("walk, with phases", "walk-imu-ubx-2025", "single receiver + IMU + phases", WALK_CAPTURE, walk_displacements, None, WALK_TDCP),
    Recording("walk, without IMU", "walk-imu-ubx-2025", "single receiver", WALK_CAPTURE[:2], walk_known, walk_peer, WALK_GNSS),
    Recording("walk, 20 s removed", "walk-imu-ubx-2025", "single receiver + IMU, tight", WALK_CAPTURE, walk_gap, None, WALK_IMU,
              ["--outage", "{:g},{:g}".format(*WALK_OUTAGE)]),
    Recording("walk, 20 s removed, without IMU", "walk-imu-ubx-2025", "single receiver", WALK_CAPTURE[:2], walk_gap, None, WALK_GNSS,
              ["--outage", "{:g},{:g}".format(*WALK_OUTAGE)]),
    Recording("car-imu-codedoppler-2020", "car-imu-codedoppler-2020", "single receiver + IMU, car in a city", car.CAPTURE_IMU, car.known, car.peer,
              car.CONFIG.format("ins-single")),
    Recording("car, without IMU", "car-imu-codedoppler-2020", "single receiver", car.CAPTURE, car.known, None, car.CONFIG.format("single")),
    *(Recording(f"car, {length} s removed", "car-imu-codedoppler-2020", "single receiver + IMU", car.CAPTURE_IMU, car.gaps_known, None,
                car.CONFIG.format("ins-single"), gaps=car.gap_batches(length)) for length in (10, 30, 60)),
    Recording("attitude-static-099m-2024", "attitude-static-099m-2024", "RTK, 0.99 m", ATTITUDE_CAPTURE, attitude_known, attitude_peer(2), refix=True),
    Recording("attitude, L1", "attitude-static-099m-2024", "RTK L1, 0.99 m", ATTITUDE_CAPTURE, attitude_known, attitude_peer(1), L1_ONLY, refix=True),
    Recording("fujisawa-car-2021265", "fujisawa-car-2021265", "RTK, car, 5 km", FUJISAWA_CAPTURE, fujisawa_known, fujisawa_peer(3, "G,E,J"), refix=True),
    Recording("fujisawa, L1", "fujisawa-car-2021265", "RTK L1, car, 5 km", FUJISAWA_CAPTURE, fujisawa_known, fujisawa_peer(1, "G,E"), L1_ONLY, refix=True),
    Recording("fujisawa, L2 and L5", "fujisawa-car-2021265", "RTK without L1, car, 5 km", FUJISAWA_CAPTURE, fujisawa_known,
              config='[navigator]\ncarriers = ["L2", "L5", "E5b"]\n'),
    Recording("galway-walk-20181009", "galway-walk-20181009", "RTK L1, urban walk", GALWAY_CAPTURE, galway_known, galway_peer(glonass=True), refix=True),
    Recording("galway, GPS", "galway-walk-20181009", "RTK L1, urban walk", GALWAY_CAPTURE, galway_known, galway_peer(glonass=False),
              '[navigator]\nsystems = ["gps"]\n', refix=True),
    Recording("yamatogawa-kinematic-2010", "yamatogawa-kinematic-2010", "RTK L1, half cycles",
              ["--rover", "{data}/yamatogawa_rover.obs:rinex", "--base", "{data}/yamatogawa_master.obs:rinex", "--nav", "{data}/brdc0060.10n.gz"],
              yamatogawa_known, yamatogawa_peer),
    Recording("hongkong-urban-2019", "hongkong-urban-2019", "single receiver, urban canyon",
              ["--rover", "{data}/rover.obs.gz:rinex", "--nav", "{data}/hksc1180.19n.gz"], hongkong_known, hongkong_peer),
    Recording("rtcm3 missing-beidou-STR17", "rtcm3-streams", "single receiver, static, RTCM 3",
              ["--rover", "{data}/missing-beidou-STR17.rtcm3:rtcm3", "--date", "2018-07-18"], lambda t, d: tracks.point(t, CANBERRA, 502), canberra_peer),
    Recording("ubx-coldstart-2025", "ubx-coldstart-2025", "single receiver, cold start", ["--rover", "{data}/coldstart.ubx.gz:ubx"],
              lambda t, d: tracks.point(t, COLDSTART, 562), coldstart_peer),
]
