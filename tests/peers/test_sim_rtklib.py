"""What pelorus-sim emits, read by programs that we did not write: pyubx2, pyrtcm, and RTKLIB down to fixed positions."""
import math
import struct
import subprocess
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np
import pytest
from pelorus_tools import eventlog

SCENARIOS = Path(__file__).resolve().parents[2] / "scenarios"
TRUTH = struct.Struct(">8xq27d")
GPS, GALILEO, QZSS, BEIDOU = 1, 8, 16, 32
GEO = "C01 C02 C03 C04 C05"  # convbin adds half a cycle to their UBX phases, for a quirk of u-blox receivers alone

OPTIONS = """pos1-posmode=kinematic
pos1-frequency=l1+l2
pos1-elmask=15
pos1-dynamics=off
pos1-ionoopt=off
pos1-tropopt={tropo}
pos1-navsys={systems}
pos1-exclsats={excluded}
pos2-armode=continuous
pos2-bdsarmode=on
out-solformat=xyz
out-timesys=gpst
out-timeform=tow
"""


def ecef(lat_deg, lon_deg, height):
    a, f = 6378137.0, 1 / 298.257223563
    lat, lon, e2 = math.radians(lat_deg), math.radians(lon_deg), f * (2 - f)
    n = a / math.sqrt(1 - e2 * math.sin(lat) ** 2)
    return np.array([(n + height) * math.cos(lat) * math.cos(lon), (n + height) * math.cos(lat) * math.sin(lon),
                     (n * (1 - e2) + height) * math.sin(lat)])


def simulate(scenario, folder):
    """Run a scenario; its channels as bytes, and its truth as rows (ns, place of the antenna, lever arm turned)."""
    log = folder / "capture.lcm"
    subprocess.run(["pelorus-sim", scenario, "-o", log, "-q"], check=True)
    channels = defaultdict(bytearray)
    for _, name, data in eventlog.events(eventlog.open_bytes(log)):
        channels[name.decode()] += bytes(data)
    truth = [TRUTH.unpack_from(channels["TRUTH"], i) for i in range(0, len(channels["TRUTH"]), TRUTH.size)]
    for name in ("UART_ROVER", "UART_BASE"):
        (folder / name).write_bytes(channels[name])
    return channels, truth


@pytest.fixture(scope="module")
def static(tmp_path_factory):
    folder = tmp_path_factory.mktemp("static")
    return folder, *simulate(SCENARIOS / "static_base_rover.toml", folder)


@pytest.fixture(scope="module")
def leg(tmp_path_factory):
    """The leg with what RTKLIB models: its dry troposphere cannot be switched off, its code noise is decimetres."""
    folder = tmp_path_factory.mktemp("leg")
    text = (SCENARIOS / "s5_leg.toml").read_text()
    for old, new in (("troposphere = true", "humidity = 0\ntroposphere = true"), ("\ncode_m = 3", "\ncode_m = 0.3"),
                     ("\nmask_deg = 5", "\nmask_deg = 12")):
        assert old in text
        text = text.replace(old, new)
    scenario = folder / "leg.toml"
    scenario.write_text(text)
    return folder, *simulate(scenario, folder)


def rtklib(folder, base, date, systems=GPS + GALILEO, excluded="", tropo="saas"):
    """Kinematic solution of the two byte streams: rows (ns, place, quality)."""
    for name, form in (("UART_ROVER", "ubx"), ("UART_BASE", "rtcm3")):
        obs = folder / f"{name}.obs"
        if not obs.exists():
            subprocess.run(["convbin", "-r", form, "-tr", *date.split(), "-v", "3.04", "-f", "5", "-os", "-od", "-o", obs, "-n",
                            folder / f"{name}.nav", folder / name], check=True, capture_output=True)
    conf = folder / "conf"
    conf.write_text(OPTIONS.format(systems=systems, excluded=excluded, tropo=tropo))
    out = folder / "out.pos"
    subprocess.run(["rnx2rtkp", "-k", conf, "-r", *(f"{x:.4f}" for x in base), "-o", out, folder / "UART_ROVER.obs",
                    folder / "UART_BASE.obs", folder / "UART_ROVER.nav"], check=True, capture_output=True)
    rows = [line.split() for line in out.read_text().splitlines() if not line.startswith("%")]
    return [(round((int(r[0]) * 604800 + float(r[1])) * 1e9), np.array(r[2:5], float), int(r[5])) for r in rows]


def errors(solution, truth, lever=(0, 0, 0)):
    """ENU errors of fixed positions, at the true time of each epoch (its tag less the receiver clock)."""
    fixed = [(t, r) for t, r, quality in solution if quality == 1]
    times = np.array([row[0] for row in truth])
    enu = []
    for t, r in fixed:
        near = np.flatnonzero(np.abs(times - t) < 1e6)
        row = truth[max(near, key=lambda i: abs(times[i] - t))]
        where = np.array(row[1:4]) + np.array(row[7:16]).reshape(3, 3) @ np.array(lever)
        lon, lat = math.atan2(where[1], where[0]), math.atan2(where[2], math.hypot(where[0], where[1]))
        s, c, so, co = math.sin(lat), math.cos(lat), math.sin(lon), math.cos(lon)
        enu.append(np.array([[-so, co, 0], [-s * co, -s * so, c], [c * co, c * so, s]]) @ (r - where))
    return np.array(enu)


def report(name, enu, n):
    print(f"{name}: {len(enu)} of {n} fixed, mean ENU {np.round(enu.mean(0) * 1e3, 1)} mm, sd {np.round(enu.std(0) * 1e3, 1)} mm")


def test_every_frame_is_read_by_pyubx2_and_pyrtcm(static):
    from pyrtcm import RTCMReader
    from pyubx2 import UBXReader
    folder = static[0]
    with open(folder / "UART_ROVER", "rb") as f:
        ubx = Counter(m.identity for _, m in UBXReader(f, protfilter=7, quitonerror=2))
    with open(folder / "UART_BASE", "rb") as f:
        rtcm = Counter(m.identity for _, m in RTCMReader(f, quitonerror=2))
    print(dict(ubx), dict(rtcm))
    assert ubx["RXM-RAWX"] == 600 and ubx["RXM-SFRBX"] > 500 and set(ubx) == {"RXM-RAWX", "RXM-SFRBX"}
    assert all(rtcm[kind] >= 598 for kind in ("1077", "1097", "1117", "1127"))
    assert all(rtcm[kind] >= 30 for kind in ("1006", "1019", "1042", "1044", "1046"))


@pytest.mark.parametrize("name, systems, excluded", [("GPS + Galileo", GPS + GALILEO, ""), ("BeiDou + QZSS", BEIDOU + QZSS, GEO)])
def test_rtklib_fixes_the_static_rover_at_its_place(static, name, systems, excluded):
    folder, _, truth = static
    solution = rtklib(folder, ecef(35.20, 139.65, 60), "2024/02/08 12:00:00", systems, excluded)
    enu = errors(solution, truth)
    report(name, enu, len(solution))
    assert len(solution) >= 598 and len(enu) >= 0.95 * len(solution)
    assert np.all(np.abs(enu.mean(0)) < (0.010, 0.012, 0.020))  # 5 km of 1 mm/km ionosphere, and multipath


def test_rtklib_fixes_the_flying_rover_at_its_place(leg):
    folder, _, truth = leg
    solution = rtklib(folder, ecef(30.6, 114.35, 35), "2024/02/04 21:30:00", GPS, tropo="off")
    enu = errors(solution, truth, (0.6, 1.0, 2.764))
    report("leg at 139 m/s", enu, len(solution))
    assert len(solution) >= 338 and len(enu) >= 0.99 * len(solution)
    assert np.all(np.abs(enu.mean(0)) < (0.010, 0.010, 0.025))
    assert np.all(enu.std(0) < (0.010, 0.010, 0.020))
