"""pelorus-capture on recordings: what it makes of RINEX, read back by RTKLIB; raw bytes unchanged; times; exit codes."""
import gzip
import struct
import subprocess

import numpy as np
import pytest
import rinex_reader
from gnss_peer import recording

from pelorus_tools import eventlog

CODE, PHASE, DOPPLER = rinex_reader.CODE, rinex_reader.PHASE, rinex_reader.DOPPLER
GEONET = {"07590920.05o": "rover", "30400920.05o": "base"}
GEONET_BASE = (-3978242.4348, 3382841.1715, 3649902.7667)

RINEX = {  # recording: (rover, epochs)
    "geonet-0759-3040": ("07590920.05o", 120),
    "yamatogawa-kinematic-2010": ("yamatogawa_rover.obs", 203),
    "fujisawa-car-2021265": ("SEPT265G.21O.gz", 360),
    "attitude-static-099m-2024": ("ant2_rover.obs.gz", 301),
    "hongkong-urban-2019": ("rover.obs.gz", 1760),
}


def capture(tmp_path, *args, code=0):
    """Run it; {channel: [(t_us, bytes)]} and what it said."""
    out = tmp_path / "capture.log"
    p = subprocess.run(["pelorus-capture", "-v", "-o", out, *map(str, args)], capture_output=True, text=True, timeout=120)
    assert p.returncode == code, p.stderr
    channels, last = {}, None
    if out.exists():
        for t_us, channel, data in eventlog.events(eventlog.open_bytes(str(out))):
            assert last is None or t_us >= last, "events out of order"
            last = t_us
            channels.setdefault(channel.decode(), []).append((t_us, bytes(data)))
    return channels, p.stderr


def joined(events):
    return b"".join(data for _, data in events)


def unix_us(t_ns, leap):
    return t_ns // 1000 + (315964800 - leap) * 1000000


def convbin(tmp_path, name, data):
    ubx, obs = tmp_path / f"{name}.ubx", tmp_path / f"{name}.obs"
    ubx.write_bytes(data)
    subprocess.run(["convbin", "-r", "ubx", "-v", "3.03", "-od", "-os", ubx, "-o", obs, "-n", tmp_path / f"{name}.nav"],
                   check=True, capture_output=True)
    return obs


# ---- RINEX ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("folder", RINEX)
def test_rinex_epochs_read_by_rtklib_are_those_of_the_file(folder, tmp_path):
    name, n_epochs = RINEX[folder]
    path = recording(folder, name)
    channels, _ = capture(tmp_path, "--rover", f"{path}:rinex")
    back, _ = rinex_reader.read_obs(convbin(tmp_path, "rover", joined(channels["UART_ROVER"])))
    file, _ = rinex_reader.read_obs(path)
    file = [(t, obs) for t, obs in file if obs]
    assert len(channels["UART_ROVER"]) >= len(back) == n_epochs == len(file)
    signals = missing = 0
    for (t_back, theirs), (t_file, ours) in zip(back, file):
        assert t_back == t_file  # RINEX says 0.1 us
        for o in theirs:
            if o["carrier"] not in (rinex_reader.L1, rinex_reader.L2, rinex_reader.B1I) or not o["flags"] & (CODE | PHASE):
                continue
            # convbin adds half a cycle to the phase of BeiDou GEO satellites in RXM-RAWX
            shift = 0.5 if o["sys"] == 3 and (o["prn"] <= 5 or o["prn"] >= 59) else 0.0
            same = [f for f in ours if (f["sys"], f["prn"], f["carrier"]) == (o["sys"], o["prn"], o["carrier"])
                    and abs(f["P"] - o["P"]) < 6e-4 and (not o["flags"] & PHASE or abs(f["L"] + shift - o["L"]) < 6e-4)
                    and (not o["flags"] & DOPPLER or abs(f["D"] - o["D"]) < 6e-4)]
            assert same, (t_back, o)
            signals += 1
        have = {(o["sys"], o["prn"]) for o in theirs}
        missing += len({(f["sys"], f["prn"]) for f in ours if f["carrier"] == rinex_reader.L1 and f["flags"] & CODE
                        and f["sys"] in (0, 2)} - have)
    print(f"\n{folder}: {n_epochs} epochs, {signals} signals equal through RXM-RAWX and convbin")
    assert missing == 0 and signals > 5 * n_epochs


def test_geonet_solved_by_rtklib_from_our_frames_is_the_same_baseline(tmp_path):
    """The frames, decoded by convbin and solved by rnx2rtkp, give what the files give."""
    folder = "geonet-0759-3040"
    nav = recording(folder, "07590920.05n")
    channels, _ = capture(tmp_path, "--rover", f"{recording(folder, '07590920.05o')}:rinex",
                          "--base", f"{recording(folder, '30400920.05o')}:rinex")
    ours = [convbin(tmp_path, c, joined([e for e in channels[c] if e[1][:2] == b"\xb5b"])) for c in ("UART_ROVER", "UART_BASE")]
    theirs = [recording(folder, n) for n in GEONET]
    found = []
    for files in (ours, theirs):
        # RTKLIB treats L2C and P2 alike only if it is not asked which; static, L1+L2, as in the recording's README
        p = subprocess.run(["rnx2rtkp", "-p", "3", "-f", "2", "-m", "15", "-v", "3", "-a", "-r", *map(str, GEONET_BASE), *map(str, files),
                            str(nav)], check=True, capture_output=True, text=True)
        rows = [line.split() for line in p.stdout.splitlines() if line[:1].isdigit()]
        found.append(np.array([[float(r[2]), float(r[3]), float(r[4]), float(r[5])] for r in rows]))
    fixed = [f[f[:, 3] == 1] for f in found]
    off_deg = np.abs(fixed[0][:, :3].mean(0) - fixed[1][:, :3].mean(0))
    print(f"\nfixed {len(fixed[0])} of {len(found[0])} from frames, {len(fixed[1])} of {len(found[1])} from files, "
          f"mean position differs by {off_deg[0] * 111e6:.2f} / {off_deg[1] * 90e6:.2f} / {off_deg[2] * 1e3:.2f} mm")
    assert len(fixed[0]) == len(fixed[1]) == 115
    assert off_deg[0] * 111e3 < 5e-4 and off_deg[1] * 90e3 < 5e-4 and off_deg[2] < 1e-3


def test_base_position_and_orbits_come_before_the_first_epoch(tmp_path):
    from pyrtcm import RTCMReader

    folder = "fujisawa-car-2021265"
    channels, said = capture(tmp_path, "--rover", f"{recording(folder, 'SEPT265G.21O.gz')}:rinex", "--nav",
                             recording(folder, "SEPT2650.21P.gz"), "--base", f"{recording(folder, '3034265G.21O.gz')}:rinex",
                             "--base-ecef", "-3959400.631,3385704.533,3667523.111")
    rover, base = channels["UART_ROVER"], channels["UART_BASE"]
    station = RTCMReader.parse(base[0][1])
    assert station.identity == "1006"
    assert [round(getattr(station, f), 4) for f in ("DF025", "DF026", "DF027")] == [-3959400.631, 3385704.533, 3667523.111]
    first = next(i for i, (_, data) in enumerate(rover) if data[:4] == b"\xb5b\x02\x15")
    orbits = [RTCMReader.parse(data) for _, data in rover if data[:1] == b"\xd3"]
    before = [RTCMReader.parse(data) for _, data in rover[:first] if data[:1] == b"\xd3"]
    kinds = {k: sum(m.identity == k for m in orbits) for k in ("1019", "1042", "1044", "1045", "1046")}
    print(f"\n{len(orbits)} orbits in frames, {len(before)} before the first epoch: {kinds}")
    assert len(orbits) >= 25 and len(before) >= 20 and kinds["1019"] >= 8 and kinds["1046"] >= 8 and kinds["1044"] >= 3
    assert rover[first][0] == unix_us((2176 * 604800 + 282600) * 10**9 + 50_000_000, 18)
    satellites = {(m.identity, getattr(m, f)) for m in before for f in ("DF009", "DF252", "DF429") if hasattr(m, f)}
    assert len(satellites) == len(before), "one orbit a satellite at the start"


# ---- raw streams ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("parts,epochs,code", [
    (("walk-imu-ubx-2025", "gnss_1730.ubx.gz"), 536, 0),
    (("galway-walk-20181009", "rover-20181009-1221.ubx.gz"), 2072, 0),
    (("ubx-coldstart-2025", "coldstart.ubx.gz"), 562, 4),  # its last frame is cut
])
def test_ubx_passes_unchanged_and_each_epoch_arrives_after_it_was_measured(parts, epochs, code, tmp_path):
    path = recording(*parts)
    with gzip.open(path) as f:
        data = f.read()
    channels, said = capture(tmp_path, "--rover", f"{path}:ubx", code=code)
    events = channels["UART_ROVER"]
    assert joined(events) == data
    ends = np.cumsum([len(d) for _, d in events])
    at, delays = 0, []
    while (at := data.find(b"\xb5b\x02\x15", at)) >= 0 and at + 16 <= len(data):
        length, = struct.unpack_from("<H", data, at + 4)
        tow, week = struct.unpack_from("<dH", data, at + 6)
        end = at + 8 + length
        if end <= len(data) and week > 1000:
            t_us = events[int(np.searchsorted(ends, end))][0]
            delays.append(t_us - unix_us(round((week * 604800 + tow) * 1e9), 18))
        at += 2
    delays = np.array(delays) * 1e-6
    print(f"\n{parts[-1]}: {len(delays)} epochs, arrival {delays.min():.3f} to {delays.max():.3f} s after measurement, "
          f"{len(events)} events")
    assert len(delays) >= epochs and f"{epochs}" in said
    assert -1e-6 <= delays.min() and delays.max() < 0.2


def test_rtcm_takes_its_date_from_its_own_orbits_or_from_the_command(tmp_path):
    path = recording("rtcm3-streams", "missing-beidou-STR17.rtcm3")
    channels, said = capture(tmp_path, "--base", f"{path}:rtcm3", code=4)  # its last frame is cut
    assert joined(channels["UART_BASE"]) == path.read_bytes()
    # week 986 of the count modulo 1024 is 2010: 2018-07-18
    assert "2018-07-18 03:16:09" in said and "502" in said
    _, said = capture(tmp_path, "--base", f"{path}:rtcm3", "--date", "1998-12-02", code=4)
    assert "1998-12-02 03:16:09" in said
    path = recording("rtcm3-streams", "trimble.rtcm")
    _, said = capture(tmp_path, "--base", f"{path}:rtcm3", code=3)
    assert "--date" in said


# ---- IMU --------------------------------------------------------------------------------------------------------------


def tags(path):
    with gzip.open(path) as f:
        data = f.read()
    seconds, fraction = struct.unpack_from("<Id", data, 64)
    pairs = np.frombuffer(data[76:76 + (len(data) - 76) // 8 * 8], "<u4").reshape(-1, 2).astype(float)
    return seconds - 315964800 + fraction + pairs[:, 0] * 1e-3, pairs[:, 1]


def test_walk_imu_times_follow_from_the_loggers_tags(tmp_path):
    folder = "walk-imu-ubx-2025"
    channels, said = capture(tmp_path, "--rover", f"{recording(folder, 'gnss_1730.ubx.gz')}:ubx",
                             "--imu", f"{recording(folder, 'imu_1730.csv.gz')}:imu-csv")
    events = channels["UART_IMU"]
    with gzip.open(recording(folder, "imu_1730.csv.gz")) as f:
        lines = f.read().split(b"\n")
    ends = np.cumsum([len(line) + 2 for line in lines])  # the log was written with CR LF
    good = [(line.split(b","), end) for line, end in zip(lines, ends) if line.count(b",") == 6]
    ms = np.array([float(f[6]) for f, _ in good[:-1]]) * 1e-3
    arrival, upto = tags(recording(folder, "imu_1730.csv.tag.gz"))
    heard = arrival[np.searchsorted(upto, np.array([end for _, end in good[:-1]]))]
    line = np.polyfit(ms - ms[0], heard - ms, 1)
    fitted = ms + np.polyval(line, ms - ms[0])
    ours = np.array([t for t, _ in events]) * 1e-6 - 315964800 + 18 - 1e-3  # nominal latency 1 ms
    n = min(len(ours), len(fitted) - 1)
    difference = ours[:n] - fitted[1:n + 1]
    print(f"\n{len(ours)} samples, clock of the logger {1e6 * line[0]:+.0f} ppm, ours before the mean arrival by "
          f"{-1e3 * difference.mean():.1f} ms (scatter {1e3 * difference.std():.2f} ms)")
    assert len(ours) == len(good) - 2 or len(ours) == len(good) - 1
    assert -0.012 < difference.mean() < 0.0 and difference.std() < 5e-4


# ---- command line -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("args,code,words", [
    (["--rover", "x.ubx:ubc"], 2, "did you mean 'ubx'"),
    (["--rover", "x.ubx"], 2, "FILE:FORMAT"),
    (["--rover", "x:novatel"], 2, "cannot be novatel"),
    (["--rovr", "x:ubx"], 2, "--rover"),
    ([], 2, "--rover"),
    (["--rover", "/nonexistent/x.ubx:ubx"], 3, "No such file"),
    (["--rover", "/:ubx"], 3, "/"),
    (["--rover", "x:ubx", "--date", "20-1-2020"], 2, "YYYY-MM-DD"),
    (["--rover", "x:ubx", "--base-ecef", "1,2,3"], 2, "--base-ecef"),
    (["--rover", "x:obs-csv", "--nav", "n", "--obs-removed", "clock"], 2, "receiver-clock, satellite-clock, group-delay"),
    (["--rover", "x:obs-csv", "--obs-removed", "group-delay"], 2, "--nav"),
])
def test_wrong_usage_is_one_clear_line(args, code, words, tmp_path):
    p = subprocess.run(["pelorus-capture", "-o", tmp_path / "x", *args], capture_output=True, text=True)
    assert p.returncode == code and words in p.stderr and len(p.stderr.splitlines()) == 1, p.stderr


def test_damaged_files_are_read_as_far_as_they_go(tmp_path):
    obs = gzip.decompress(recording("hongkong-urban-2019", "rover.obs.gz").read_bytes())[:200_000]
    whole, cut, bad = (tmp_path / n for n in ("whole.obs.gz", "cut.obs.gz", "bad.obs"))
    whole.write_bytes(gzip.compress(obs))
    cut.write_bytes(whole.read_bytes()[:30_000])
    rng = np.random.default_rng(1)
    noise = np.frombuffer(obs, np.uint8).copy()
    noise[rng.integers(3000, len(noise), 300)] = rng.integers(0, 256, 300)
    bad.write_bytes(noise.tobytes())
    n = {}
    for path, code in ((whole, 0), (cut, 4), (bad, 4)):
        channels, _ = capture(tmp_path, "--rover", f"{path}:rinex", code=code)
        n[path.name] = len(channels["UART_ROVER"])
    print(f"\n{n}")
    assert 0 < n["cut.obs.gz"] < n["whole.obs.gz"] and n["bad.obs"] > 0.8 * n["whole.obs.gz"]


def test_standard_input_output_and_setup(tmp_path):
    path = recording("walk-imu-ubx-2025", "gnss_1730.ubx.gz")
    setup = tmp_path / "setup.toml"
    setup.write_text("[navigator]\npreset = \"single\"\n")
    with open(path, "rb") as f:
        p = subprocess.run(["pelorus-capture", "-q", "-o", "-", "--rover", "-:ubx", "--setup", setup], stdin=f, capture_output=True)
    assert p.returncode == 0 and p.stderr == b""
    events = list(eventlog.events(memoryview(p.stdout)))
    assert events[0][1] == b"SETUP" and bytes(events[0][2]) == setup.read_bytes()
    assert sum(len(e[2]) for e in events[1:]) == len(gzip.decompress(path.read_bytes()))
