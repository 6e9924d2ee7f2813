"""The S5 survey flight, 2 h (S5 section 13): acceptance over six flights, float against double, desktop speed."""

import numpy as np
import pytest
import runs

SEEDS = (1, 2, 3, 4, 5, 6)         # the published table is of six runs
WINDOW = "600,6900"
LIMITS = {"pos_e": (3e-3, "m"), "pos_n": (3e-3, "m"), "pos_d": (6e-3, "m"),
          "vel_e": (1e-3, "mps"), "vel_n": (1e-3, "mps"), "vel_d": (1e-3, "mps"),
          "att_e": (1.2, "arcsec"), "att_n": (1.2, "arcsec"), "att_d": (2.5, "arcsec")}


@pytest.fixture(scope="module")
def flights(tmp_path_factory):
    """Figures of each flight; of the first also the double build's output."""
    found = {}
    for seed in SEEDS:
        folder = tmp_path_factory.mktemp(f"flight{seed}")
        capture = runs.simulate(folder, "s5_flight", seed)
        out, seconds = runs.firmware(capture)
        found[seed] = {"figures": runs.figures(out, "--window", WINDOW), "all": runs.figures(out), "seconds": seconds, "why": runs.not_fixed(out)}
        if seed == SEEDS[0]:
            double, _ = runs.firmware(capture, program="pelorus-sil-f64")
            found["float"], found["double"] = runs.Result(out), runs.Result(double)
        capture.unlink()
        out.unlink()
    return found


def pooled(flights, name, unit):
    square = lambda which: np.mean([flights[s]["figures"][f"{name}_{which}_{unit}"] ** 2 for s in SEEDS])
    return np.sqrt(square("rms")), np.sqrt(square("rms") / square("sigma"))


def test_errors_are_those_of_the_reference_and_sigma_is_honest(flights):
    print(f"\n{len(SEEDS)} flights of 2 h, 600 to 6900 s")
    for name, (limit, unit) in LIMITS.items():
        rms, ratio = pooled(flights, name, unit)
        k, u = (1, "arcsec") if unit == "arcsec" else (1e3, "mm" if unit == "m" else "mm/s")
        each = " ".join(f"{flights[s]['figures'][f'{name}_rms_{unit}'] * k:.2f}" for s in SEEDS)
        print(f"{name}: rms {rms * k:.2f} {u} (limit {limit * k:g}), rms/sigma {ratio:.2f}, flights {each}")
        assert rms <= limit, name
        assert 0.7 <= ratio <= 1.3, name
        assert all(flights[s]["figures"][f"{name}_rms_{unit}"] <= limit for s in SEEDS), name


def test_every_epoch_is_fixed_and_none_wrongly(flights):
    """Of 6 x 7200 epochs. The tests of ratio (before the prior is narrow) and of chi-square have false alarms of their own: here
    at most one in 10 000. Such an epoch is refused and told, never wrong."""
    missed = 0
    for s in SEEDS:
        f = flights[s]["all"]
        missed += int(f["epochs"] - f["fixed_epochs"])
        print(f"flight {s}: {f['fixed_epochs']:.0f} of {f['epochs']:.0f} fixed, {f['wrong_fixes']:.0f} wrong; not fixed: {flights[s]['why'] or 'none'}")
        assert f["wrong_fixes"] == 0
        assert set(flights[s]["why"]) <= {"chi2", "ratio"}
    print(f"all flights: {missed} epochs not fixed")
    assert missed <= 4


def test_innovations_are_as_large_as_predicted(flights):
    for s in SEEDS:
        assert flights[s]["figures"]["nis_ratio"] == pytest.approx(1.0, abs=0.02)


def test_two_hours_take_less_than_a_minute(flights):
    print("seconds for 2 h:", [round(flights[s]["seconds"], 1) for s in SEEDS])
    assert min(flights[s]["seconds"] for s in SEEDS) < 60


def test_float_factors_do_what_double_factors_do(flights):
    """Difference of the two builds over the whole flight, in sigma."""
    a, b = flights["float"].sol, flights["double"].sol
    assert np.array_equal(a["t_ns"], b["t_ns"])
    assert np.array_equal(a["fix"], b["fix"]) and np.array_equal(a["n_fixed"], b["n_fixed"])
    late = (a["t_ns"] - a["t_ns"][0]) > 60e9      # before, sigma changes by orders of magnitude within seconds
    ea, eb = flights["float"].errors, flights["double"].errors
    for group in ("pos", "vel", "att"):
        d = ((ea.err[group] - eb.err[group]) / eb.sd[group])[late]
        d = d[np.isfinite(d).all(1)]
        print(f"float minus double, {group}: rms {np.sqrt(np.mean(d**2)):.4f} sigma, at most {np.abs(d).max():.4f} sigma")
        assert np.sqrt(np.mean(d**2)) < 0.05 and np.abs(d).max() < 0.3
        ratio = (ea.sd[group] / eb.sd[group])[late]
        assert np.nanmax(np.abs(ratio - 1)) < 0.02
