"""Decoders of wire/ on real receivers' bytes, against RTKLIB's convbin and pyubx2."""
import collections
import datetime
import json

import pytest
import rtklib_nav
from gnss_peer import recording
from pyubx2 import calc_checksum
from wire_peer import STATE, compare_ephemerides, compare_signals, convbin, convbin_glonass, decode, key, match_epochs, unpacked

UBX = {  # file: epochs that convbin writes of its UBX frames
    ("walk-imu-ubx-2025", "gnss_1730.ubx.gz"): 536,
    ("ubx-coldstart-2025", "coldstart.ubx.gz"): 562,
    ("galway-walk-20181009", "rover-20181009-1221.ubx.gz"): 2072,
    ("galway-walk-20181009", "base-20181009-1220.ubx.gz"): 529,
    ("gpsd-logs", "ublox-zed-f9p_hpg1.11.log.gz"): 654,
}
RTCM = {  # file: (its date, epochs that convbin writes)
    ("rtcm3-streams", "missing-beidou-STR17.rtcm3"): ((2018, 7, 18), 502),
    ("rtcm3-streams", "msm7.rtcm"): ((2018, 1, 1), 36),
    ("rtcm3-streams", "sept.rtcm"): ((2018, 1, 1), 55),
    ("rtcm3-streams", "trimble.rtcm"): ((2018, 1, 1), 153),
    ("rtcm3-streams", "jenoba-jrr32m.rtcm3"): ((2018, 1, 1), 67),
    ("rtcm3-streams", "piksi-5Hz.rtcm3"): ((2018, 1, 1), 38),
    ("rtcm3-streams", "leica.rtcm"): ((2018, 1, 1), 21),
    ("rtcm3-streams", "navcom.rtcm"): ((2018, 1, 1), 64),
    ("rtcm3-streams", "mixed-msm-legacy.rtcm"): ((2018, 1, 1), 34),
    ("rtklib-rcvraw", "testglo.rtcm3"): ((2009, 12, 12), 186),
}
RINEX_HALF_UNIT = 0.000501  # three decimals


def gps_seconds(date):
    return int((datetime.datetime(*date, 12) - datetime.datetime(1980, 1, 6)).total_seconds())


def ubx_alone(path):
    """The UBX frames of a stream. RAWX beside RTCM observations of the same receiver is not used: its integers differ."""
    data, frames, i = path.read_bytes(), [], 0
    while (i := data.find(b"\xb5\x62", i)) >= 0:
        frame = data[i:i + 8 + int.from_bytes(data[i + 4:i + 6], "little")]
        good = len(frame) >= 8 and calc_checksum(frame[2:-2]) == frame[-2:]
        frames += [frame] if good else []
        i += len(frame) if good else 1
    path.write_bytes(b"".join(frames))
    return path


def assert_same_numbers(worst):
    assert max(worst.values()) < RINEX_HALF_UNIT, worst


@pytest.mark.parametrize("parts", UBX, ids=lambda p: p[-1])
def test_ubx_recording_equals_convbin(parts, tmp_path):
    path = ubx_alone(unpacked(tmp_path, *parts))
    ours, (epochs, ephemerides) = decode(path), convbin(path, "ubx", tmp_path)
    pairs = match_epochs(ours.epochs, epochs)
    worst, counts = compare_signals(pairs)
    matched, lost, different = compare_ephemerides(ours.ephemerides, ephemerides)
    print(f"\n{parts[-1]}: {len(pairs)} of {len(epochs)} epochs, {counts['both']} signals, worst P {worst['P']:.6f} m "
          f"L {worst['L']:.6f} cyc D {worst['D']:.6f} Hz; {matched} of {len(ephemerides)} ephemerides equal")
    assert len(epochs) == UBX[parts] == len(pairs)
    assert_same_numbers(worst)
    # convbin drops phases whose stated deviation is above 0.02 cycles; it never has one that we lack
    assert counts["missing"] == 0 and counts["only_theirs"] == 0
    assert counts["both"] > 10000 and not lost and not different


@pytest.mark.parametrize("parts", RTCM, ids=lambda p: p[-1])
def test_rtcm_recording_equals_convbin(parts, tmp_path):
    date, n_epochs = RTCM[parts]
    path = unpacked(tmp_path, *parts)
    ours = decode(path, gps_seconds(date))
    epochs, ephemerides = convbin(path, "rtcm3", tmp_path, "{}/{}/{} 12:00:00".format(*date))
    pairs = match_epochs(ours.epochs, epochs)
    worst, counts = compare_signals(pairs)
    matched, lost, different = compare_ephemerides(ours.ephemerides, ephemerides)
    print(f"\n{parts[-1]}: {len(pairs)} of {len(epochs)} epochs, {counts['both']} signals, worst P {worst['P']:.6f} m "
          f"L {worst['L']:.6f} cyc D {worst['D']:.6f} Hz; {matched} of {len(ephemerides)} ephemerides equal")
    assert len(epochs) == n_epochs == len(pairs)
    assert_same_numbers(worst)
    assert counts["only_theirs"] == 0 and not lost and not different
    for a, b in pairs:  # what only convbin has is a carrier that is no member here, a second code on a carrier, or GLONASS
        have = {key(o)[:3] for o in a}  # of a stream that does not tell the channels
        channels = any(o["sys"] == 1 for o in a)
        assert {key(o)[:3] for o in b if o["sys"] != 1 or channels} <= have


@pytest.mark.parametrize("name, sets", [("rover-20181009-1221", 18), ("base-20181009-1220", 27)])
def test_glonass_strings_equal_convbin(name, sets, tmp_path):
    """The base's line loses strings: convbin joins those of several frames, we only those of one."""
    path = ubx_alone(unpacked(tmp_path, "galway-walk-20181009", name + ".ubx.gz"))
    ours = {(e["prn"], e["toe_ns"]): e for e in decode(path).glonass}
    theirs = convbin_glonass(path, "ubx", tmp_path)
    both = [(ours[e["prn"], e["toe_ns"]], e) for e in theirs if (e["prn"], e["toe_ns"]) in ours]
    worst = {n: max(abs(a[n] - b[n]) for a, b in both) for n in STATE if n != "tgd0"}
    print(f"\n{name}: {len(both)} of {len(theirs)} sets of {len({e['prn'] for e in theirs})} satellites, worst {worst['x']:.1e} m "
          f"{worst['vx']:.1e} m/s {worst['af0']:.1e} s")
    assert len(theirs) == sets and len(both) >= (sets if "rover" in name else 20)
    assert max(worst[n] for n in "xyz") < 6e-5 and worst["vx"] < 6e-9 and worst["af0"] < 6e-16 and worst["k"] == 0  # 12 digits
    assert all(a["health"] == b["health"] for a, b in both) and len(ours) == len(both)


def test_glonass_1020_equals_convbin(tmp_path):
    """Its N_T is that of the week after its GPS messages: then the nearest day counts."""
    path = recording("rtklib-rcvraw", "testglo.rtcm3")
    ours = {(e["prn"], e["toe_ns"]): e for e in decode(path, gps_seconds((2009, 12, 12))).glonass}
    theirs = convbin_glonass(path, "rtcm3", tmp_path, "2009/12/12 12:00:00")
    print(f"\n{len(ours)} sets, convbin {len(theirs)}")
    assert theirs
    for e in theirs:
        mine = ours[e["prn"], e["toe_ns"]]
        assert max(abs(mine[n] - e[n]) for n in "xyz") < 6e-5 and abs(mine["af0"] - e["af0"]) < 6e-16 and mine["k"] == e["k"]


def test_epoch_whose_last_message_is_another_systems_ends_there():
    """GMSD7: BeiDou messages that carry GPS time still belong to their epoch: 11 GPS, 1 QZSS and 8 BeiDou satellites."""
    ours = decode(recording("rtklib-rcvraw", "GMSD7_20121014.rtcm3"), gps_seconds((2012, 10, 14)))
    systems = [collections.Counter({(o["sys"], o["prn"]): 1 for o in obs}) for _, obs in ours.epochs]
    assert len(ours.epochs) == 257
    assert all(sum(1 for s, _ in c if s == 3) >= 6 and sum(1 for s, _ in c if s == 0) >= 8 for c in systems)


def test_rawx_equals_pyubx2(tmp_path):
    """Every number and flag, to the last bit."""
    import struct

    from pyubx2 import UBXReader

    path = unpacked(tmp_path, "ubx-coldstart-2025", "coldstart.ubx.gz")
    ours = {t: obs for t, obs in decode(path).epochs}
    systems = {0: 0, 1: 5, 2: 2, 3: 3, 5: 4, 6: 1}
    signals = 0

    def single(x):
        return struct.pack("<f", x)

    with open(path, "rb") as f:
        for _, m in UBXReader(f, protfilter=2, quitonerror=0):
            if m is None or m.identity != "RXM-RAWX":
                continue
            t = m.week * 604800 * 10**9 + round(m.rcvTow * 1e9)
            theirs = []
            for i in range(1, m.numMeas + 1):
                g = lambda name: getattr(m, f"{name}_{i:02d}")  # noqa: E731
                if g("prValid") or g("cpValid"):
                    theirs.append((systems[g("gnssId")], g("svId") - (119 if g("gnssId") == 1 else 0), g("prMes") * g("prValid"),
                                   g("cpMes") * g("cpValid"),
                                   single(g("doMes")), g("cno"), g("locktime"),
                                   bool(g("cpValid")) and not g("halfCyc")))
            if not theirs or t not in ours:
                continue
            mine = [(o["sys"], o["prn"], o["P"], o["L"], single(o["D"]), int(o["cn0"]), o["lock"],
                     bool(o["flags"] & 8)) for o in ours[t]]
            assert sorted(mine) == sorted(theirs)
            signals += len(mine)
    print(f"\n{signals} signals equal")
    assert signals > 11000


def test_pvt_equals_pyubx2(tmp_path):
    from pyubx2 import UBXReader

    path = unpacked(tmp_path, "walk-imu-ubx-2025", "gnss_1730.ubx.gz")
    ours = decode(path).pvt
    with open(path, "rb") as f:
        theirs = [m for _, m in UBXReader(f, protfilter=2, quitonerror=0) if m is not None and m.identity == "NAV-PVT"]
    assert len(ours) == len(theirs) == 536
    for a, m in zip(ours, theirs):
        utc = datetime.datetime(m.year, m.month, m.day, m.hour, m.min, m.second) - datetime.datetime(1980, 1, 6)
        t = (utc.days * 86400 + utc.seconds + 18) * 10**9 + m.nano
        assert abs(a[0] - t) < 10**6  # iTOW is whole milliseconds
        assert int(a[1]) == m.fixType and int(a[2]) == m.carrSoln and int(a[3]) == m.numSV
        assert abs(a[4] * 57.29577951308232 - m.lat) < 1e-7 and abs(a[5] * 57.29577951308232 - m.lon) < 1e-7
        assert abs(a[6] - m.height / 1e3) < 1e-4 and abs(a[7] - m.velN / 1e3) < 1e-4 and abs(a[9] - m.velD / 1e3) < 1e-4


def test_klobuchar_equals_rtklib(tmp_path):
    """Subframe 4 page 18 of each satellite."""
    path = unpacked(tmp_path, "galway-walk-20181009", "rover-20181009-1221.ubx.gz")
    ours, theirs = decode(path).klobuchar, list(rtklib_nav.klobuchar(path))
    print(f"\n{len(ours)} pages, {ours[0]}")
    assert len(ours) == len(theirs) == 24
    assert all(abs(x - y) <= 1e-6 * abs(y) for a, b in zip(ours, theirs) for x, y in zip(a, b))


@pytest.mark.parametrize("parts", [("ubx-coldstart-2025", "coldstart.ubx.gz"), ("walk-imu-ubx-2025", "gnss_1730.ubx.gz")])
def test_galileo_inav_equals_rtklib(parts, tmp_path):
    """convbin does not read these pages; RTKLIB's decoder of their words does."""
    path = unpacked(tmp_path, *parts)
    ours, theirs = decode(path).ephemerides, list(rtklib_nav.galileo_ephemerides(path))
    matched, lost, different = compare_ephemerides(ours, theirs, tolerance=1e-15)
    print(f"\n{parts[-1]}: {matched} sets of {len({e['prn'] for e in theirs})} satellites equal")
    assert matched == len(theirs) == sum(e["sys"] == 2 for e in ours) > 0 and not lost and not different


def test_a_base_that_sends_both_is_read_from_its_rtcm(tmp_path):
    """529 RAWX and 1605 MSM epochs of one receiver, whose phases have other integers in each; 461 lost their GPS message."""
    both = decode(unpacked(tmp_path, "galway-walk-20181009", "base-20181009-1220.ubx.gz"))
    print(f"\n{len(both.epochs)} epochs of the mixed stream")
    assert len(both.epochs) == 1605 and sum(any(o["sys"] == 0 for o in obs) for _, obs in both.epochs) == 1144


def test_station_of_galway_base(tmp_path):
    stations = decode(unpacked(tmp_path, "galway-walk-20181009", "base-20181009-1220.ubx.gz")).stations
    assert len(stations) > 1000
    assert max(abs(a - b) for a, b in zip(stations[-1][1:], (3774696.5547, -596647.9083, 5089485.6511))) < 1e-4


@pytest.mark.parametrize("name", ["ublox-zed-f9t-rtcm3", "ublox-f9p-rtcm", "rtcm3.2", "rtcm3.bndm"])
def test_stations_equal_gpsd(name):
    """gpsd's own decode, shipped beside each log. Comment lines before the bytes are noise and nothing else."""
    expected = []
    for line in recording("gpsd-logs", name + ".log.chk").read_text().splitlines():
        if line.startswith("{") and '"RTCM3"' in line:
            m = json.loads(line)
            if m.get("type") in (1005, 1006):
                expected.append((m["station_id"], m["x"], m["y"], m["z"]))
    ours = decode(recording("gpsd-logs", name + ".log"), gps_seconds((2019, 6, 1))).stations
    print(f"\n{name}: {len(ours)} stations, gpsd {len(expected)}")
    assert len(ours) == len(expected)
    for a, b in zip(ours, expected):
        assert a[0] == b[0] and max(abs(x - y) for x, y in zip(a[1:], b[1:])) < 2e-4


def test_any_cut_of_a_recording_gives_a_prefix(tmp_path):
    """A stream that ends anywhere gives the same epochs as far as it goes, and never a wrong one."""
    path = unpacked(tmp_path, "walk-imu-ubx-2025", "gnss_1730.ubx.gz")
    whole = decode(path)
    data = path.read_bytes()
    for n in range(1000, 60000, 3777):
        cut = tmp_path / "cut.ubx"
        cut.write_bytes(data[:n])
        part = decode(cut)
        assert part.epochs == whole.epochs[: len(part.epochs)]
        assert part.counters["checksum"] == 0


def test_damaged_recording_gives_only_true_epochs(tmp_path):
    """One byte in 2000 replaced: every epoch that comes out is one of the undamaged file, bit for bit."""
    import random

    path = unpacked(tmp_path, "walk-imu-ubx-2025", "gnss_1730.ubx.gz")
    whole = {t: obs for t, obs in decode(path).epochs}
    data = bytearray(path.read_bytes())
    rng = random.Random(5)
    for _ in range(len(data) // 2000):
        data[rng.randrange(len(data))] = rng.randrange(256)
    broken = tmp_path / "broken.ubx"
    broken.write_bytes(data)
    part = decode(broken)
    print(f"\n{len(part.epochs)} of {len(whole)} epochs survive; {part.counters}")
    assert 0.2 * len(whole) < len(part.epochs) < len(whole)
    assert all(whole.get(t) == obs for t, obs in part.epochs)
    assert part.counters["checksum"] > 100
