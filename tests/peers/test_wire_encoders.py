"""Encoders of wire/ read by other people's decoders: convbin, pyubx2, pyrtcm, gpsdecode, pynmeagps, and NovAtel's layout."""
import collections
import datetime
import json
import struct
import subprocess

import pytest
import rtklib_nav
from wire_peer import ORBIT, compare_ephemerides, compare_signals, convbin, decode, match_epochs, parse, recode, unpacked

LIGHT_MS = 299792.458
EPHEMERIS_S = 1215864000  # 2018-07-18 00:00 and later: the Canberra stream


def canberra(tmp_path):
    return unpacked(tmp_path, "rtcm3-streams", "missing-beidou-STR17.rtcm3")


def unique(ephemerides):
    return {(e["sys"], e["prn"], e["toe_ns"], e["iode"]): e for e in ephemerides}


def test_ubx_of_a_recording_is_read_alike_by_pyubx2_and_convbin(tmp_path):
    from pyubx2 import UBXReader

    source = unpacked(tmp_path, "walk-imu-ubx-2025", "gnss_1730.ubx.gz")
    target = tmp_path / "again.ubx"
    assert recode(source, "ubx", target) == []
    ours = decode(source)
    counts = collections.Counter()
    with open(target, "rb") as f:
        for raw, m in UBXReader(f, protfilter=7, quitonerror=2):
            counts[m.identity] += 1
    again = decode(target)
    epochs, ephemerides = convbin(target, "ubx", tmp_path)
    worst, signals = compare_signals(match_epochs(ours.epochs, epochs))
    matched, lost, different = compare_ephemerides(ours.ephemerides, ephemerides)
    print(f"\npyubx2 {dict(counts)}; convbin {signals['both']} signals, worst {worst}, {matched} ephemerides")
    assert counts["RXM-RAWX"] == 536 and counts["NAV-PVT"] == 536
    assert again.epochs == ours.epochs and again.pvt == ours.pvt
    assert again.counters["frames"] == sum(counts.values()) and again.counters["noise"] == 0
    assert {k: [e[n] for n in ORBIT] for k, e in unique(again.ephemerides).items()} == {
        k: [e[n] for n in ORBIT] for k, e in unique(ours.ephemerides).items()
    }
    assert len(epochs) == 536 and max(worst.values()) < 0.000501 and signals["missing"] == 0
    assert matched == len(ephemerides) >= 12 and not lost and not different


def test_sfrbx_is_read_alike_by_rtklib(tmp_path):
    """GPS and QZSS LNAV, Galileo I/NAV, from the ephemerides of an RTCM stream."""
    source, target = canberra(tmp_path), tmp_path / "nav.ubx"
    assert recode(source, "ubx", target, EPHEMERIS_S) == []
    ours = decode(source, EPHEMERIS_S)
    theirs = convbin(target, "ubx", tmp_path)[1] + list(rtklib_nav.galileo_ephemerides(target))
    matched, lost, different = compare_ephemerides(ours.ephemerides, theirs, [n for n in ORBIT if n != "tgd1"])
    systems = collections.Counter(e["sys"] for e in theirs)
    print(f"\nRTKLIB read {dict(systems)} of GPS 0, Galileo 2, QZSS 4; {matched} equal")
    assert matched == len(theirs) and not lost and not different
    assert systems[0] >= 8 and systems[2] >= 5 and systems[4] >= 1


def test_d2_of_a_geostationary_satellite_is_read_alike_by_convbin(tmp_path):
    """Ten pages of BeiDou D2. No recording has any: a D1 ephemeris is sent as C03's."""
    source, target = unpacked(tmp_path, "walk-imu-ubx-2025", "gnss_1730.ubx.gz"), tmp_path / "geo.ubx"
    recode(source, "ubxgeo", target)
    ours = [dict(e, prn=3) for e in decode(source).ephemerides if e["sys"] == 3]
    theirs = [e for e in convbin(target, "ubx", tmp_path)[1] if e["sys"] == 3]
    again = [e for e in decode(target).ephemerides if e["sys"] == 3]
    matched, lost, different = compare_ephemerides(ours, theirs)
    print(f"\nconvbin read {len(theirs)} sets of C03, {matched} equal; we read {len(again)} of {len(ours)}")
    assert {e["prn"] for e in theirs} == {3} and matched == len(theirs) >= 1 and not lost and not different
    assert [[e[n] for n in ORBIT] for e in again] == [[e[n] for n in ORBIT] for e in ours]


@pytest.mark.parametrize("msm", [4, 5, 6, 7])
def test_msm_of_a_recording_is_read_alike_by_pyrtcm_and_convbin(msm, tmp_path):
    from pyrtcm import RTCMReader

    source, target = canberra(tmp_path), tmp_path / f"again{msm}.rtcm3"
    assert recode(source, f"msm{msm}", target, EPHEMERIS_S) == []
    ours = decode(source, EPHEMERIS_S)
    counts = collections.Counter()
    with open(target, "rb") as f:
        for _, m in RTCMReader(f, quitonerror=2):
            counts[m.identity] += 1
    epochs, ephemerides = convbin(target, "rtcm3", tmp_path, "2018/7/18 00:00:00")
    worst, signals = compare_signals(match_epochs(ours.epochs, epochs), phase_block=4096)
    matched, lost, different = compare_ephemerides(ours.ephemerides, ephemerides)
    print(f"\npyrtcm {dict(counts)}; convbin {signals['both']} signals, worst {worst}, {matched} ephemerides")
    code_step, phase_step = (2**-24, 2**-29) if msm < 6 else (2**-29, 2**-31)
    assert all(counts[str(1070 + s + msm)] == 502 for s in (0, 20, 40, 50))
    assert len(epochs) == 502 and signals["missing"] == 0 and signals["only_theirs"] == 0 and signals["both"] > 39000
    assert worst["P"] < LIGHT_MS * code_step / 2 + 0.0006
    assert worst["L"] < LIGHT_MS * phase_step / 2 / 0.19 + 0.0006
    assert (signals["D"] > 39000 and worst["D"] < 0.00005 / 0.19 + 0.0006) if msm in (5, 7) else signals["D"] == 0
    assert matched == len(ephemerides) >= 20 and not lost and not different
    again = decode(target, EPHEMERIS_S)
    assert len(again.epochs) == 502 and again.stations == ours.stations


def test_1004_of_a_recording_is_read_alike_by_pyrtcm_and_convbin(tmp_path):
    from pyrtcm import RTCMReader

    source, target = unpacked(tmp_path, "rtcm3-streams", "leica.rtcm"), tmp_path / "again.rtcm3"
    when = int((datetime.datetime(2018, 1, 1, 12) - datetime.datetime(1980, 1, 6)).total_seconds())
    assert recode(source, "1004", target, when) == []
    with open(target, "rb") as f:
        identities = collections.Counter(m.identity for _, m in RTCMReader(f, quitonerror=2))
    ours = decode(source, when)
    epochs, _ = convbin(target, "rtcm3", tmp_path, "2018/1/1 12:00:00")
    worst, signals = compare_signals(match_epochs(ours.epochs, epochs), phase_block=1500)
    print(f"\npyrtcm {dict(identities)}; convbin {signals['both']} signals, worst {worst}")
    assert identities["1004"] == len(epochs) == 21
    assert signals["both"] > 400 and signals["missing"] == 0 and worst["P"] < 0.0101 and worst["L"] < 0.00025 / 0.19 + 0.0006


def test_rtcm_is_read_by_gpsdecode(tmp_path):
    source, target = canberra(tmp_path), tmp_path / "again.rtcm3"
    recode(source, "msm7", target, EPHEMERIS_S)
    with open(target, "rb") as f:
        out = subprocess.run(["gpsdecode", "-j"], stdin=f, capture_output=True, text=True, check=True).stdout
    messages = [json.loads(line) for line in out.splitlines() if line.startswith("{")]
    types = collections.Counter(m.get("type") for m in messages)
    stations = [m for m in messages if m.get("type") == 1006]
    expected = decode(source, EPHEMERIS_S).stations[0]
    print(f"\ngpsdecode {dict(types)}")
    assert types[1077] == types[1097] == types[1117] == types[1127] == 502 and types[1019] > 0
    assert all(abs(stations[0][n] - v) < 1e-4 for n, v in zip("xyz", expected[1:]))


def test_klobuchar_is_read_alike_by_rtklib(tmp_path):
    source = unpacked(tmp_path, "galway-walk-20181009", "rover-20181009-1221.ubx.gz")
    target = tmp_path / "again.ubx"
    assert recode(source, "ubx", target) == []
    theirs = list(rtklib_nav.klobuchar(target))
    ours = decode(target).klobuchar
    assert ours == decode(source).klobuchar and len(ours) == len(theirs) == 24
    assert all(abs(x - y) <= 1e-6 * abs(y) for a, b in zip(ours, theirs) for x, y in zip(a, b))


def test_nmea_is_read_by_pynmeagps_and_gpsdecode():
    from pynmeagps import NMEAReader

    text = subprocess.run(["peer_wire", "nmea"], check=True, capture_output=True).stdout
    lines = text.decode("ascii").splitlines()
    assert len(lines) == 15 + 60
    quality, status = [], []
    for i in range(5):
        gga, rmc, hdt = (NMEAReader.parse(line + "\r\n") for line in lines[3 * i : 3 * i + 3])
        quality.append(gga.quality)
        status.append(rmc.status)
        utc = datetime.datetime(1980, 1, 6) + datetime.timedelta(weeks=2388, seconds=345600.25 + 40 * 86400 * i - 18)
        assert rmc.date == utc.date() and abs((datetime.datetime.combine(rmc.date, rmc.time) - utc).total_seconds()) < 0.011
        if i:
            assert abs(gga.lat - (47.123456789 - 30 * i)) < 2e-9 and abs(gga.lon - (-8.987654321 + 40 * i)) < 2e-9
            assert abs(gga.alt - (432.1234 - 200 * i)) < 1e-4 and gga.numSV == 17
            assert abs(rmc.spd - 5 * 3600 / 1852) < 1e-3 and abs(rmc.cog - 306.87) < 0.006
            assert abs(rmc.lat - gga.lat) < 1e-9
        assert hdt.headingT == ("" if i < 2 else 0.0)
    assert quality == [0, 1, 5, 4, 6] and status == ["V", "A", "A", "A", "A"]

    text = "".join(line + "\r\n" for line in lines[15:])
    out = subprocess.run(["gpsdecode"], input=text, capture_output=True, check=True, text=True).stdout
    reports = [json.loads(line) for line in out.splitlines()]
    fixes = [r for r in reports if r["class"] == "TPV" and r["mode"] == 3]
    print(f"\ngpsdecode: {len(fixes)} fixes of 20, {fixes[-1]}")
    assert len(fixes) >= 18 and all(f["status"] == 3 for f in fixes)  # 3: real-time kinematic, fixed
    for f in fixes:
        tenth = round(datetime.datetime.fromisoformat(f["time"][:-1]).microsecond / 1e5 + 10 * int(f["time"][17:19]) - 420)
        assert abs(f["lat"] - (47.123456789 + 1e-7 * tenth)) < 3e-9 and abs(f["lon"] + 8.987654321) < 3e-9
    assert any(r["class"] == "ATT" and abs(r["heading"] - 123.45) < 0.006 for r in reports)


def crc32_novatel(data):
    """As NovAtel documents it: bit by bit."""
    crc = 0
    for byte in data:
        t = (crc ^ byte) & 0xFF
        for _ in range(8):
            t = (t >> 1) ^ (0xEDB88320 if t & 1 else 0)
        crc = ((crc >> 8) & 0x00FFFFFF) ^ t
    return crc


def test_rawimusx_follows_novatels_layout(tmp_path):
    path = tmp_path / "imu.gps"
    subprocess.run(["peer_wire", "rawimusx", str(path)], check=True)
    data = path.read_bytes()
    assert len(data) == 6000 * 56
    gyro, accel = 2.0**-33, 2.0**-29  # HG4930: rad and m/s per count
    theirs = []
    for at in range(0, len(data), 56):
        frame = data[at : at + 56]
        sync, n, number, week, ms = struct.unpack("<3sBHHI", frame[:12])
        info, kind, week_2, tow, status, az, ay, ax, gz, gy, gx = struct.unpack("<BBHdI6i", frame[12:52])
        assert sync == b"\xaa\x44\x13" and n == 40 and number == 1462 and week == week_2 == 2300 and kind == 58 and info == 0
        assert struct.unpack("<I", frame[52:])[0] == crc32_novatel(frame[:52]) and abs(ms / 1000 - tow) < 1e-3
        theirs.append((week * 604800 + tow, gx * gyro, -gy * gyro, gz * gyro, ax * accel, -ay * accel, az * accel))
    out = subprocess.run(["peer_wire", "imu", str(path)], check=True, capture_output=True, text=True).stdout
    ours = [list(map(float, line.split()[1:])) for line in out.splitlines() if line.startswith("I")]
    assert len(ours) == 6000 and parse(out).counters["frames"] == 6000 and parse(out).counters["gap"] == 0
    for i, (a, b) in enumerate(zip(ours, theirs)):
        assert abs(a[0] * 1e-9 - b[0]) < 1e-6
        assert all(abs(x - y) < 1e-14 for x, y in zip(a[2:8], b[1:]))
        assert abs(a[2] - (1e-4 + 1e-7 * i)) < gyro and abs(a[6] - (-2e-2 + 1e-6 * i)) < accel
