"""S5 section 13.8: 60 s without GNSS in straight flight, six runs."""

import numpy as np
import runs

SEEDS = (1, 2, 3, 4, 5, 6)
FROM, TO = 760.0, 820.0


def test_drift_and_first_epoch_back(tmp_path):
    drifts, sigmas = [], []
    for seed in SEEDS:
        capture = runs.simulate(tmp_path, "s5_outage", seed, duration=840)
        out, _ = runs.firmware(capture)
        r = runs.Result(out)
        capture.unlink()
        t = r.seconds(r.sol["t_ns"][0] // 10**9 * 10**9)
        inside = (t > FROM + 2) & (t < TO)
        assert (r.sol["fix"][inside] == 4).mean() > 0.9, "the status does not say that it coasts"
        last = np.flatnonzero(inside & np.isfinite(r.errors.horizontal))[-1]
        drifts.append(float(np.linalg.norm(r.errors.err["pos"][last])))
        sigmas.append(float(np.linalg.norm(r.errors.sd["pos"][last])))
        back = np.flatnonzero(r.epoch & (t >= TO - 0.5))
        first = back[0]
        print(f"seed {seed}: drift {drifts[-1]:.3f} m (3-D sigma {sigmas[-1]:.3f} m) after {t[last] - FROM:.0f} s, "
              f"first epoch back at {t[first]:.1f} s: fix {r.sol['fix'][first]}, {1e3 * r.errors.horizontal[first]:.1f} mm off")
        assert r.sol["fix"][first] == 3 and r.errors.horizontal[first] < 0.08
        assert (r.errors.horizontal[r.epoch & (r.sol["fix"] == 3)] < 0.08).all()
    assert max(drifts) < 0.30
    assert 0.05 < np.mean(sigmas) < 0.20          # S5: 0.096 m
    assert np.sqrt(np.mean(np.square(drifts))) < 2.0 * np.mean(sigmas)
