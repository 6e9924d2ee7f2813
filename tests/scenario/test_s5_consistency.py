"""NEES and NIS over 32 seeds of the survey leg: the filter claims what it does, no more and no less."""

import numpy as np
import runs
from scipy import stats as distributions

SEEDS = range(101, 133)
TIMES = (60, 90, 120, 150, 180, 210, 240, 270, 300, 330)      # s, far enough apart to be nearly independent


def test_nees_and_nis(tmp_path):
    nees = {g: np.zeros((len(SEEDS), len(TIMES))) for g in ("pos", "vel", "att")}
    nis, dof, fixed, wrong, epochs = np.zeros(len(SEEDS)), np.zeros(len(SEEDS)), 0, 0, 0
    for i, seed in enumerate(SEEDS):
        capture = runs.simulate(tmp_path, "s5_leg", seed)
        out, _ = runs.firmware(capture)
        r = runs.Result(out)
        capture.unlink()
        out.unlink()
        k = np.flatnonzero(r.epoch)
        t = r.seconds(r.sol["t_ns"][0] // 10**9 * 10**9)[k]
        at = [k[np.argmin(np.abs(t - x))] for x in TIMES]
        for g in nees:
            nees[g][i] = r.nees(g)[at]
        nis[i], dof[i] = r.sol["nis"][k].astype(float).sum(), r.sol["nis_dof"][k].astype(int).sum()
        fixed, epochs = fixed + int((r.sol["fix"][k] == 3).sum()), epochs + k.size
        wrong += int(((r.sol["fix"][k] == 3) & (r.errors.horizontal[k] > 0.08)).sum())
    n = len(SEEDS)
    low, high = distributions.chi2.ppf([0.025, 0.975], 3 * n) / n
    print(f"\n{n} seeds, {fixed} of {epochs} epochs fixed, {wrong} wrong; NEES of 3, 95 % bounds {low:.2f} to {high:.2f}")
    for g, x in nees.items():
        mean = x.mean(axis=0)
        inside = int(((mean > low) & (mean < high)).sum())
        print(f"{g}: " + " ".join(f"{m:.2f}" for m in mean) + f"  ({inside} of {len(TIMES)} inside)")
        # Of ten times 95 % are expected inside; seven or fewer happen by chance once in a hundred (binomial 99 %).
        assert inside >= 8, g
    low, high = (distributions.chi2.ppf(q, dof) for q in (0.025, 0.975))
    inside = int(((nis > low) & (nis < high)).sum())
    total = nis.sum() / dof.sum()
    print(f"NIS: {inside} of {n} runs inside their own 95 % bounds; all together {total:.4f} of {dof.sum():.0f} degrees of freedom")
    assert wrong == 0
    assert abs(total - 1) < 0.02
    # NIS of one run has bounds of one percent, narrower than the gate's cut of the tails: most runs must still be inside.
    assert inside >= 0.75 * n
