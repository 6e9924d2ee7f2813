"""pelorus-decode on made-up output: what went in comes out, what is damaged is counted, wrong usage is one clear line."""

import csv
import gzip
import io
import json
import re
import sys
import time
import xml.etree.ElementTree as ET

import numpy as np
import pytest
import synth

from pelorus_tools import decode, eventlog, frames, gpstime, nmea, outlog

ARCHITECTURE_COLUMNS = (
    "gpst_s,status,lat_deg,lon_deg,height_m,vel_n_mps,vel_e_mps,vel_d_mps,roll_deg,pitch_deg,heading_deg,"
    "sd_n_m,sd_e_m,sd_d_m,sd_vn_mps,sd_ve_mps,sd_vd_mps,sd_roll_deg,sd_pitch_deg,sd_heading_deg,hpl_m,vpl_m,n_sat,n_fixed,ratio")


@pytest.fixture(scope="module")
def flight(tmp_path_factory):
    f = synth.Flight(60)
    f.path = str(f.write(tmp_path_factory.mktemp("out") / "a.out"))
    return f


def run(capsys, *argv):
    code = decode.main([str(a) for a in argv])
    said = capsys.readouterr()
    return code, said.out, said.err


def test_csv_has_the_columns_of_the_design_and_the_numbers_that_went_in(flight, capsys):
    code, out, err = run(capsys, flight.path, "--csv")
    assert code == 0
    assert out.splitlines()[0].startswith(ARCHITECTURE_COLUMNS)
    rows = list(csv.DictReader(io.StringIO(out)))
    assert len(rows) == flight.sol.size
    for i in (0, 7, 599):
        row, s = rows[i], flight.sol[i]
        assert row["gpst_s"] == f"{s['t_ns'] // 10**9}.{s['t_ns'] % 10**9:09d}"
        assert row["status"] == "fixed+ins"
        assert abs(float(row["lat_deg"]) - np.degrees(s["lat_rad"])) < 1e-11
        assert abs(float(row["height_m"]) - s["height_m"]) < 6e-5
        assert abs(float(row["vel_d_mps"]) - s["v_ned"][2]) < 1e-5
        assert float(row["sd_d_m"]) == pytest.approx(3.4e-3, abs=1e-5)
        assert row["at_epoch"] == ("1" if i % 10 == 0 else "0")
    assert rows[7]["ratio"] == "" and rows[10]["ratio"] != ""
    assert len(rows[0]["lat_deg"].split(".")[1]) >= 10
    assert "ins-rtk" in err and "L1+L2" in err and "no data" in err


def test_what_is_not_meaningful_is_an_empty_field(tmp_path, capsys):
    f = synth.Flight(5, ins=False)
    f.sol["fix"][3] = 0
    _, out, _ = run(capsys, f.write(tmp_path / "spp.out"), "--csv", "-q")
    rows = list(csv.DictReader(io.StringIO(out)))
    assert rows[0]["status"] == "spp" and rows[3]["status"] == "none"
    assert rows[0]["heading_deg"] == rows[0]["roll_deg"] == rows[0]["sd_heading_deg"] == ""
    assert rows[0]["lat_deg"] != "" and rows[3]["lat_deg"] == "" and rows[3]["vel_n_mps"] == ""


def test_solutions_come_in_order_of_time_and_the_one_at_an_epoch_wins():
    sol = np.zeros(4, frames.SOLUTION_DTYPE)
    sol["t_ns"] = [20, 10, 20, 10]
    sol["n_sat"] = [1, 2, 3, 4]
    sol["flags"] = [frames.SOL_AT_EPOCH, 0, 0, 0]
    assert outlog.in_order(sol)["n_sat"].tolist() == [4, 1]


def test_json_opens_with_what_was_used_and_ends_with_the_events(flight, capsys):
    code, out, err = run(capsys, flight.path, "--json")
    objects = [json.loads(line) for line in out.splitlines()]
    assert code == 0 and err == ""
    assert objects[0]["type"] == "run"
    assert {"what": "Galileo", "offered": "rover L1, base none", "used": "not used", "why": "no data"} in objects[0]["used"]
    assert objects[1]["type"] == "solution" and objects[2]["ratio"] is None
    assert objects[-1]["type"] == "event" and objects[-1]["id"] == 17


def test_kml_is_valid_xml_and_coloured_by_status(tmp_path, capsys):
    f = synth.Flight(60, outage=(20, 30))
    _, out, _ = run(capsys, f.write(tmp_path / "k.out"), "--kml", "-q")
    ns = {"k": "http://www.opengis.net/kml/2.2"}
    root = ET.fromstring(out)
    tracks = [p for p in root.iterfind(".//k:Placemark", ns) if p.find("k:LineString", ns) is not None]
    assert [p.find("k:styleUrl", ns).text for p in tracks] == ["#fixed", "#coast", "#fixed"]
    styles = {s.get("id") for s in root.iterfind(".//k:Style", ns)}
    assert {p.find("k:styleUrl", ns).text[1:] for p in root.iterfind(".//k:Placemark", ns)} <= styles
    lon, lat, h = map(float, tracks[0].find(".//k:coordinates", ns).text.split()[0].split(","))
    assert (lon, lat, h) == pytest.approx((114.3, 30.5, 1500), abs=0.1)


def test_nmea_made_here_is_read_by_pynmeagps(flight, capsys):
    pynmeagps = pytest.importorskip("pynmeagps")
    _, out, _ = run(capsys, flight.path, "--nmea", "-q")
    read = [pynmeagps.NMEAReader.parse(line + "\r\n", validate=1) for line in out.split()[:6]]
    assert [m.msgID for m in read] == ["GGA", "RMC", "HDT"] * 2
    assert read[0].quality == 4
    assert read[0].lat == pytest.approx(np.degrees(flight.sol["lat_rad"][0]), abs=1e-9)
    assert read[1].spd == pytest.approx(139 * 3600 / 1852, rel=0.01)
    # 21:30:00 GPS time is 21:29:42 UTC.
    assert read[0].time.isoformat() == "21:29:42" and read[1].date.isoformat() == "2026-06-01"


def test_nmea_of_the_firmware_is_passed_on_as_sent(capsys, tmp_path):
    f = synth.Flight(6)
    own = nmea.checksum("GPHDT,123.456,T")
    wrong = own[:-2] + f"{int(own[-2:], 16) ^ 1:02X}"
    body = b"".join(data for _, data in f.uart()) + f"{own}\r\n{wrong}\r\n".encode()
    (tmp_path / "raw.bin").write_bytes(body)
    code, out, err = run(capsys, tmp_path / "raw.bin", "--nmea", "-q")
    assert out == own + "\r\n"
    assert code == 4 and "NMEA: bad checksum" in err


def test_noise_and_damage_are_counted_by_cause_and_cost_only_the_damaged_frame(tmp_path, capsys):
    f = synth.Flight(10)
    blocks = [data for _, data in f.uart()]
    flipped = bytearray(blocks[5])
    flipped[40] ^= 1
    blocks[5] = bytes(flipped)
    unknown = frames.encode(0x7F, b"abc")
    noise = b"\x00P\xffnoise PL"
    impossible = b"PL\x10\x01\xff\xff"
    (tmp_path / "raw.bin").write_bytes(noise.join([*blocks[:8], unknown + impossible + blocks[8]]) + b"".join(blocks[9:-1]) + blocks[-1][:-5])
    code, out, err = run(capsys, tmp_path / "raw.bin", "--csv")
    assert code == 4
    assert len(out.splitlines()) == 1 + f.sol.size - 1
    for cause in ("bad checksum", "outside any frame", "impossible length", "cut short", "id 0x7f"):
        assert cause in err, err


def test_random_bytes_never_raise_and_never_pass_as_a_frame():
    rng = np.random.default_rng(3)
    for size in (0, 1, 5, 8, 9, 100, 100_000):
        found = frames.parse(rng.integers(0, 256, size, dtype=np.uint8).tobytes())
        assert found.solution.size == 0 and not found.nmea


def test_a_frame_inside_another_payload_is_not_taken_twice():
    inner = frames.encode(frames.EVENT, bytes(frames.EVENT_DTYPE.itemsize))
    payload = bytearray(frames.SOLUTION_DTYPE.itemsize)
    payload[50:50 + len(inner)] = inner
    found = frames.parse(frames.encode(frames.SOLUTION, bytes(payload)))
    assert found.solution.size == 1 and found.event.size == 0


def test_crc_is_the_one_of_rtcm():
    # RTCM 10403 example: message 1005 without its checksum.
    message = bytes.fromhex("D300133ED7D30202980EDEEF34B4BD62AC0941986F33")
    assert frames.crc24q(message) == 0x360B98


def test_logs_are_those_of_lcm(flight, tmp_path):
    lcm = pytest.importorskip("lcm")
    theirs = [(e.timestamp, e.channel, e.data) for e in lcm.EventLog(flight.path, "r")]
    ours = [(t, c.decode(), bytes(d)) for t, c, d in eventlog.events(eventlog.open_bytes(flight.path))]
    assert ours == theirs


def test_a_log_cut_short_or_damaged_is_read_as_far_as_it_goes(flight, tmp_path, capsys):
    whole = open(flight.path, "rb").read()
    cut = tmp_path / "cut.out"
    cut.write_bytes(whole[:len(whole) // 2 - 3])
    code, out, err = run(capsys, cut, "--csv")
    assert code == 4 and "cut short" in err and len(out.splitlines()) > 100
    at = whole.index(eventlog.SYNC, len(whole) // 3)
    (tmp_path / "bad.out").write_bytes(whole[:at] + b"\0\0\0\0" + whole[at + 4:])
    code, out, err = run(capsys, tmp_path / "bad.out", "--csv")
    assert code == 4 and "damaged event" in err and len(out.splitlines()) >= flight.sol.size - 1


def test_gzip_and_standard_input(flight, tmp_path, capsys, monkeypatch):
    whole = open(flight.path, "rb").read()
    (tmp_path / "a.out.gz").write_bytes(gzip.compress(whole))
    _, plain, _ = run(capsys, flight.path, "--csv", "-q")
    assert run(capsys, tmp_path / "a.out.gz", "--csv", "-q")[1] == plain
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(whole)))
    assert run(capsys, "-", "--csv", "-q")[1] == plain


@pytest.mark.parametrize("argv, code, words", [
    (["x.out", "--cvs"], 2, "did you mean '--csv'"),
    (["x.out"], 2, "required"),
    (["--csv"], 2, "OUT"),
    (["x.out", "--csv", "--kml"], 2, "not allowed"),
    (["no-such-file", "--csv"], 3, "no-such-file"),
])
def test_wrong_usage_is_one_clear_line(argv, code, words, capsys):
    got, out, err = run(capsys, *argv)
    assert got == code and words in err and out == "" and err.count("\n") == 1


def test_inputs_without_solutions_are_unreadable_and_say_why(tmp_path, capsys):
    eventlog.write(tmp_path / "capture.log", [(1, "UART_IMU", b"x"), (2, "UART_ROVER", b"y")])
    code, _, err = run(capsys, tmp_path / "capture.log", "--csv")
    assert code == 3 and "run pelorus-sil on it first" in err
    (tmp_path / "empty").write_bytes(b"")
    assert run(capsys, tmp_path / "empty", "--csv")[0] == 3
    (tmp_path / "noise").write_bytes(bytes(range(256)) * 10)
    assert run(capsys, tmp_path / "noise", "--csv")[0] == 3


def test_version_and_help(capsys):
    for option in ("--version", "--help"):
        with pytest.raises(SystemExit) as e:
            decode.main([option])
        assert e.value.code == 0


def test_two_hours_at_ten_hertz_decode_in_seconds():
    one = synth.Flight(100)
    block = b"".join(data for _, data in one.uart()[1:-1])
    start = time.monotonic()
    found = frames.parse(block * 72)
    spent = time.monotonic() - start
    print(f"{found.solution.size} solutions, {found.satellites.size} satellites in {spent:.2f} s")
    assert found.solution.size == 72 * one.sol.size and not found.refused
    assert spent < 10


def test_leap_seconds_and_calendar():
    t = gpstime.from_calendar(2017, 1, 1, 0, 0, 17.0)
    assert gpstime.leap_s(t) == 17 and gpstime.leap_s(t + gpstime.NS) == 18
    assert gpstime.text(gpstime.from_calendar(2024, 6, 24, 8, 20, 0.25)) == "2024-06-24 08:20:00.2 GPST"
    assert gpstime.from_calendar(2024, 6, 24, 8, 20, 0.0) // gpstime.NS == 2320 * 604800 + 116400


def test_layouts_are_as_long_as_the_manual_says():
    manual = (synth.ROOT / "docs" / "FORMATS.md").read_text()
    sizes = {int(i, 16): int(n) for i, n in re.findall(r"\| (0x1[0-5]) \| out \| .*?, (\d+)(?: \+ \d+ n)? bytes \|", manual)}
    assert sizes == {**{i: d.itemsize for i, d in frames.FIXED_SIZE.items()}, frames.SATELLITES: frames.SATS_HEAD.itemsize}
    assert f"10 + {frames.SAT_DTYPE.itemsize} n bytes" in manual
