"""S5 section 13.5: accelerometers of 50 ug/sqrt(Hz), or ten times the phase noise."""

import numpy as np
import pytest
import runs

SEEDS = (1, 2)
LIMITS = {"pos_e": (12e-3, "m"), "pos_n": (14e-3, "m"), "pos_d": (30e-3, "m"), "att_e": (1.6, "arcsec"), "att_n": (1.6, "arcsec"), "att_d": (3.0, "arcsec")}


@pytest.mark.parametrize("scenario", ["s5_hostile_imu", "s5_hostile_phase"])
def test_hostile_flight(scenario, tmp_path):
    found = []
    for seed in SEEDS:
        capture = runs.simulate(tmp_path, scenario, seed)
        out, _ = runs.firmware(capture)
        found.append((runs.figures(out, "--window", "600,6900"), runs.figures(out)))
        capture.unlink()
        out.unlink()
    print(f"\n{scenario}, {len(SEEDS)} flights of 2 h, 600 to 6900 s")
    for name, (limit, unit) in LIMITS.items():
        rms, sigma = (np.sqrt(np.mean([f[f"{name}_{k}_{unit}"] ** 2 for f, _ in found])) for k in ("rms", "sigma"))
        print(f"{name}: rms {rms:.4g} {unit} (limit {limit:g}), rms/sigma {rms / sigma:.2f}")
        assert rms <= limit and 0.7 <= rms / sigma <= 1.3, name
    for f, whole in found:
        print(f"fixed {100 * f['fixed_share']:.2f} % (of the whole flight {100 * whole['fixed_share']:.2f} %), wrong {whole['wrong_fixes']:.0f}")
        assert f["fixed_share"] == 1.0
        assert f["wrong_fixes"] == 0 and whole["wrong_fixes"] == 0
