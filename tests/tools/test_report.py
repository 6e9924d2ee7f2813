"""pelorus-report on made-up output whose errors are known: figures, verdict, limits, truth from every kind of file."""

import csv
import html.parser
import io
import re

import numpy as np
import pytest
import synth

from pelorus_tools import decode, earth, gpstime, outlog, report, stats, truth


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("report")


@pytest.fixture(scope="module")
def flight(folder):
    f = synth.Flight(200, seed=4)
    f.path = f.write(folder / "a.out")
    return f


def run(capsys, *argv):
    code = report.main([str(a) for a in argv])
    said = capsys.readouterr()
    return code, said.out, said.err


def figures(text):
    return {r["name"]: float(r["value"]) for r in csv.DictReader(io.StringIO(text))}


def test_figures_are_those_the_errors_were_drawn_with(flight, capsys):
    code, out, _ = run(capsys, flight.path, "--csv-stats", "-q")
    f = figures(out)
    assert code == 0
    n = flight.sol.size
    for name, want in (("pos_n_rms_m", 1.3e-3), ("pos_e_rms_m", 1.6e-3), ("pos_d_rms_m", 3.4e-3), ("vel_n_rms_mps", 3e-4), ("att_n_rms_arcsec", 0.75), ("att_d_rms_arcsec", 1.6)):
        assert f[name] == pytest.approx(want, rel=5 / np.sqrt(2 * n)), name
    for name in ("pos_n", "pos_e", "pos_d", "vel_n", "vel_d", "att_n", "att_e", "att_d"):
        assert f[f"{name}_ratio"] == pytest.approx(1.0, abs=5 / np.sqrt(2 * n))
    assert f["fixed_share"] == 1 and f["wrong_fixes"] == 0 and f["epochs"] == 201
    assert f["nis_ratio"] == pytest.approx(1.0, abs=5 * np.sqrt(2 / (30 * 201)))
    assert set(f) <= set(report.every_name())


def test_a_perfect_run_has_no_error_at_all(folder, capsys):
    f = figures(run(capsys, synth.Flight(30, clean=True).write(folder / "clean.out"), "--csv-stats", "-q")[1])
    assert f["pos_h_max_m"] < 1e-8 and f["vel_n_max_mps"] < 1e-5
    assert f["att_d_max_arcsec"] < 0.06      # heading is a float: up to 0.05" at 300 degrees


class Page(html.parser.HTMLParser):
    """Ids, links and everything that would be fetched from elsewhere."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.links, self.fetched, self.words = set(), [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        a = dict(attrs)
        self.ids.add(a.get("id"))
        if tag == "a":
            self.links.append(a["href"])
        for key in ("src", "href", "xlink:href"):
            if a.get(key) and not a[key].startswith(("#", "data:")):
                self.fetched.append(a[key])

    def handle_data(self, data):
        self.words.append(data)


def test_the_page_is_one_offline_file_with_all_its_parts(flight, folder, capsys):
    page_file = folder / "a.html"
    code, _, err = run(capsys, flight.path, "-o", page_file)
    text = page_file.read_text()
    page = Page(text)
    assert code == 0 and "ins-rtk" in err
    assert not page.fetched and "<script" not in text and "@import" not in text and not re.search(r"url\((?!#)", text)
    for part in ("used", "track", "errors", "status", "innovations", "sky", "biases", "counters", "repeat", "events"):
        assert part in page.ids, part
    assert all(link[1:] in page.ids for link in page.links)
    words = " ".join(" ".join(page.words).split())
    for said in ("201 of 201 epochs fixed, no wrong integer", "pelorus-sim made_up.toml --seed 7 -o CAPTURE", "pelorus-sil made_up.log", "slip lock", "no data", "seed: 7"):
        assert said in words, said
    assert len(text) < 6_000_000


def test_the_same_input_gives_the_same_page(flight, folder, capsys):
    run(capsys, flight.path, "-o", folder / "1.html", "--png", folder / "1.png", "-q")
    run(capsys, flight.path, "-o", folder / "2.html", "--png", folder / "2.png", "-q")
    assert (folder / "1.html").read_bytes() == (folder / "2.html").read_bytes()
    assert (folder / "1.png").read_bytes() == (folder / "2.png").read_bytes()
    assert (folder / "1.png").stat().st_size < 300_000


def test_wrong_fixes_are_counted_and_turn_the_verdict(folder, capsys):
    path = synth.Flight(100, wrong_at=(50, 51, 52)).write(folder / "wrong.out")
    code, out, _ = run(capsys, path, "--csv-stats", "--limit", "wrong_fixes=0", "-o", folder / "wrong.html", "-q")
    assert figures(out)["wrong_fixes"] == 3 and code == 1
    assert figures(out)["wrong_fix_share"] == pytest.approx(3 / 101)
    page = (folder / "wrong.html").read_text()
    assert "3 wrong fixes" in page and "border-left: 6px solid var(--bad)" in page


def test_limits_set_the_exit_code(flight, capsys):
    assert run(capsys, flight.path, "--limit", "pos_n_rms_m=0.003", "--limit", "pos_n_ratio=0.7..1.3", "--limit", "fixed_share=0.99", "-q")[0] == 0
    code, _, err = run(capsys, flight.path, "--limit", "pos_n_rms_m=0.0005", "-q")
    assert code == 1 and "missed: pos_n_rms_m <= 0.0005" in err
    assert run(capsys, flight.path, "--limit", "att_d_ratio=1.2..1.3", "-q")[0] == 1
    code, _, err = run(capsys, flight.path, "--limit", "pos_m_rms_m=1", "-q")
    assert code == 2 and "did you mean 'pos_" in err
    assert run(capsys, flight.path, "--limit", "pos_n_rms_m", "-q")[0] == 2
    assert run(capsys, flight.path)[0] == 2


def test_a_limit_on_what_could_not_be_computed_is_missed(folder, capsys):
    path = synth.Flight(20).write(folder / "no_truth.out", with_truth=False)
    assert run(capsys, path, "--limit", "pos_n_rms_m=1", "-q")[0] == 1


def test_window(flight, capsys):
    f = figures(run(capsys, flight.path, "--window", "100,150", "--csv-stats", "-q")[1])
    assert f["solutions"] == 501 and f["epochs"] == 51
    assert run(capsys, flight.path, "--window", "100", "--csv-stats")[0] == 2


@pytest.mark.parametrize("outage, level", [((20, 30), "coast"), ((), "fixed")])
def test_without_truth_the_page_says_so(folder, capsys, outage, level):
    path = synth.Flight(60, outage=outage).write(folder / "nt.out", with_truth=False)
    code, _, _ = run(capsys, path, "-o", folder / "nt.html", "-q")
    text = (folder / "nt.html").read_text()
    assert code == 0 and "No truth" in text and level in text and 'id="errors"' not in text


def test_truth_may_come_from_our_csv_a_pos_file_or_a_capture(flight, folder, capsys):
    clean = synth.Flight(200, clean=True)
    clean.write(folder / "clean200.out")
    decode.main([str(folder / "clean200.out"), "--csv", "-q"])
    (folder / "truth.csv").write_text(capsys.readouterr().out)
    lines = ["%  GPST          latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio"]
    for s in clean.sol:
        week, tow = divmod(int(s["t_ns"]), 604800 * gpstime.NS)
        lines.append(f"{week} {tow / 1e9:.3f} {np.degrees(s['lat_rad']):.10f} {np.degrees(s['lon_rad']):.10f} {s['height_m']:.4f} 1 9 0 0 0 0 0 0 0 0")
    (folder / "truth.pos").write_text("\n".join(lines))
    reference = figures(run(capsys, flight.path, "--csv-stats", "-q")[1])
    bare = flight.write(folder / "bare.out", with_truth=False)
    for source in ("truth.csv", "truth.pos", "a.out"):
        f = figures(run(capsys, bare, "--truth", folder / source, "--csv-stats", "-q")[1])
        for name in ("pos_n_rms_m", "pos_d_max_m", "wrong_fixes"):
            assert f[name] == pytest.approx(reference[name], abs=2e-4), (source, name)
        if source != "truth.pos":
            assert f["att_d_rms_arcsec"] == pytest.approx(reference["att_d_rms_arcsec"], abs=0.05), source
    code, _, err = run(capsys, bare, "--truth", folder / "no.pos", "--csv-stats", "-q")
    assert code == 3 and "no.pos" in err
    (folder / "junk.pos").write_text("hello\nworld\n")
    assert run(capsys, bare, "--truth", folder / "junk.pos", "--csv-stats", "-q")[0] == 3


def test_mean_offset_can_be_removed(flight, folder, capsys):
    far = synth.Flight(200, clean=True)
    offset = earth.rotate(np.swapaxes(far.C_e_n, 1, 2), np.array([3.9, 7.4, 11.5]))
    far.r_e = far.r_e + offset
    far.write(folder / "far.out")
    f = figures(run(capsys, flight.path, "--truth", folder / "far.out", "--csv-stats", "-q")[1])
    assert f["pos_e_mean_m"] == pytest.approx(-7.4, abs=0.01) and f["wrong_fixes"] > 0
    f = figures(run(capsys, flight.path, "--truth", folder / "far.out", "--remove-mean", "--csv-stats", "-q")[1])
    assert abs(f["pos_e_mean_m"]) < 1e-9 and f["pos_h_rms_m"] < 0.01


def test_truth_between_its_times_is_hermite_in_position_and_attitude():
    w, amp = 2 * np.pi * 0.31, np.radians(0.3)
    t = np.arange(0, 20.05, 0.1)
    fine = np.arange(0.05, 19.95, 0.1)

    def pose(s):
        r = np.stack([6.4e6 + 139 * s, 50 * np.sin(0.1 * s), 20 * np.cos(0.2 * s)], -1)
        v = np.stack([139 + 0 * s, 5 * np.cos(0.1 * s), -4 * np.sin(0.2 * s)], -1)
        zero = 0 * s
        return r, v, earth.rotvec_to_dcm(np.stack([amp * np.sin(w * s), zero, zero], -1)), np.stack([amp * w * np.cos(w * s), zero, zero], -1)

    ns = lambda s: np.round(s * 1e9).astype(np.int64)
    r, v, C, rate = pose(t)
    reference = truth.Truth("made up", ns(t), r, v, C, rate)
    at, covered = reference.at(ns(fine))
    r, v, C, _ = pose(fine)
    assert covered.all()
    assert np.abs(at.r_e - r).max() < 1e-6 and np.abs(at.v_e - v).max() < 1e-5
    assert np.abs(earth.rotvec(at.C_b_e @ np.swapaxes(C, 1, 2))).max() * stats.ARCSEC < 0.02
    outside, covered = reference.at(ns(np.array([-1.0, 21.0])))
    assert not covered.any()


def test_without_imu_truth_is_the_antenna(folder, capsys):
    f = synth.Flight(60, clean=True)
    lever = np.array([0.6, 1.0, 2.764])
    C_b_e = np.swapaxes(f.C_e_n, 1, 2) @ f.C_b_n
    f.sol["r_eb_e"] += C_b_e @ lever
    f.sol["lat_rad"], f.sol["lon_rad"], f.sol["height_m"] = earth.ecef_to_llh(f.sol["r_eb_e"])
    assert figures(run(capsys, f.write(folder / "lever.out"), "--csv-stats", "-q")[1])["pos_h_max_m"] > 0.5
    f.sol["flags"] &= 0xFFFF ^ 1
    assert figures(run(capsys, f.write(folder / "lever.out"), "--csv-stats", "-q")[1])["pos_h_max_m"] < 1e-6


def test_velocity_of_a_pos_file_is_read(tmp_path):
    line = "2024/06/24 08:20:00.000   35.0  137.0   104.8619   1  42   0.0024   0.0024   0.0069   0.0008  -0.0013  -0.0024   0.00   12.0    1.5   -0.25   0.125   0.058 0.057 0.156 0.01 -0.03 -0.05"
    (tmp_path / "v.pos").write_text("%  GPST   latitude(deg)\n" + line + "\n" + line.replace("08:20:00", "08:20:01") + "\n")
    t = truth.load(str(tmp_path / "v.pos"))
    ned = earth.rotate(earth.C_e_n(np.radians(35.0), np.radians(137.0)), t.v_e[0])
    assert ned == pytest.approx([1.5, -0.25, -0.125], abs=1e-12) and t.quality.tolist() == [1, 1]


def test_a_hole_in_the_truth_is_not_bridged():
    t = np.array([0, 1, 2, 12, 13]) * gpstime.NS
    _, covered = truth.Truth("hole", t, np.zeros((5, 3)), np.zeros((5, 3))).at(np.array([1.5, 7.0, 12.0]) * gpstime.NS)
    assert covered.tolist() == [True, False, True]


def test_rotations_and_ellipsoid_round_trip():
    rng = np.random.default_rng(0)
    r, p, h = rng.uniform(-3.1, 3.1, 500), rng.uniform(-1.5, 1.5, 500), rng.uniform(0, 6.28, 500)
    back = earth.C_b_n_to_rpy(earth.rpy_to_C_b_n(r, p, h))
    assert all(np.abs(a - b).max() < 1e-12 for a, b in zip(back, (r, p, h)))
    level_east = earth.rpy_to_C_b_n(np.array(0.0), np.array(0.0), np.array(np.pi / 2))
    assert np.allclose(level_east @ [0, 1, 0], [0, 1, 0]) and np.allclose(level_east @ [1, 0, 0], [-1, 0, 0]) and np.allclose(level_east @ [0, 0, 1], [0, 0, -1])
    nose_up, right_down = (earth.rpy_to_C_b_n(*map(np.array, a)) for a in ((0.0, 0.1, 0.0), (0.1, 0.0, 0.0)))
    assert (nose_up @ [0, 1, 0])[2] < 0 and (right_down @ [1, 0, 0])[2] > 0
    lat, lon, height = rng.uniform(-1.57, 1.57, 500), rng.uniform(-3.14, 3.14, 500), rng.uniform(-500, 20000, 500)
    xyz = earth.llh_to_ecef(lat, lon, height)
    back = earth.ecef_to_llh(xyz)
    assert np.abs(earth.llh_to_ecef(*back) - xyz).max() < 1e-8


def test_the_log_tells_what_was_used(flight):
    lines = "\n".join(outlog.describe(outlog.load(str(flight.path))))
    assert "0.00997 deg/sqrt(h)" not in lines      # units of the data sheet, not something near them
    assert "0.000997 deg/sqrt(h), 0.0099 deg/h" in lines and "9.99 ug" in lines
