"""Epochs that arrive late are applied at their own time; those older than the ring are counted and refused."""

import numpy as np
import runs


def delayed(folder, latency_ms, jitter_ms):
    """200 s of the leg with this delay on the rover's line."""
    sub = folder / f"late{latency_ms}_{jitter_ms}"
    sub.mkdir()
    edits = [("rover", "latency_ms", latency_ms), ("rover", "jitter_ms", jitter_ms)]
    out, _ = runs.firmware(runs.simulate(sub, "s5_leg", duration=200, edits=edits))
    return runs.Result(out)


def test_late_within_the_ring_makes_no_difference(tmp_path):
    on_time, late = delayed(tmp_path, 20, 0), delayed(tmp_path, 300, 150)
    a, b = on_time.sol[on_time.epoch], late.sol[late.epoch]
    common, ka, kb = np.intersect1d(a["t_ns"], b["t_ns"], return_indices=True)
    a, b = a[ka], b[kb]
    settled = a["t_ns"] - a["t_ns"][0] > 30e9        # the first ephemerides are late as well
    d = np.linalg.norm(a["r_eb_e"] - b["r_eb_e"], axis=1)[settled]
    sigma = np.sqrt(b["cov_r_ned"][:, 0])[settled]
    print(f"\n300 to 450 ms late: {common.size} common epochs, position differs by at most {1e3 * d.max():.4f} mm ({(d / sigma).max():.4f} sigma)")
    assert common.size >= 195 and late.run.counters["nav"]["epochs_late"] == 0
    assert (d < 0.05 * sigma).all()
    assert (b["fix"][settled] == 3).all()
    # What is said between epochs is predicted from farther back, and hardly worse.
    ok = np.isfinite(late.errors.horizontal) & (late.sol["t_ns"] - late.sol["t_ns"][0] > 60e9)
    assert np.sqrt(np.mean(late.errors.horizontal[ok] ** 2)) < 0.005


def test_older_than_the_ring_is_counted_and_refused(tmp_path):
    late = delayed(tmp_path, 60, 900)
    used, refused = (int(late.run.counters["nav"][f"epochs_{k}"]) for k in ("used", "late"))
    print(f"\n60 to 960 ms late with a ring of 0.5 s: {used} epochs used, {refused} refused")
    assert refused > 50 and used > 50 and used + refused == 200
    ins = (late.sol["flags"] & 1) != 0
    assert ins[1:].all(), "the IMU was given up because an epoch was late"
    ok = np.isfinite(late.errors.horizontal) & (late.sol["t_ns"] - late.sol["t_ns"][0] > 60e9)
    print(f"horizontal error {1e3 * np.sqrt(np.mean(late.errors.horizontal[ok] ** 2)):.2f} mm rms, at most {1e3 * late.errors.horizontal[ok].max():.1f} mm")
    assert late.errors.horizontal[ok].max() < 0.08
