"""A car that is told it has wheels: 60 s without any satellite cost it less, what it claims stays true, and beside GNSS nothing gets worse."""

import numpy as np
import pytest
import runs

SEEDS = (1, 2, 3)
FROM, TO = 250.0, 310.0


def told(folder, capture, wheels):
    """The scenario's own navigator table with or without wheels."""
    text = (runs.SCENARIOS / "car.toml").read_text()
    config = folder / f"wheels_{wheels}.toml"
    config.write_text(text[text.index("[navigator]"):].replace("[navigator.mount]", f"[navigator.mount]\nwheels = {str(wheels).lower()}"))
    return runs.Result(runs.firmware(capture, "--config", config, name=f"wheels_{wheels}")[0])


@pytest.fixture(scope="module")
def drives(tmp_path_factory):
    out = {True: [], False: []}
    for seed in SEEDS:
        folder = tmp_path_factory.mktemp(f"wheels{seed}")
        capture = runs.simulate(folder, "car", seed, edits=[("outage", "to_s", f"{TO:g}")])
        for wheels in out:
            out[wheels].append(told(folder, capture, wheels))
    return out


def seconds(r):
    return r.seconds(r.sol["t_ns"][0] // 10**9 * 10**9)


def growth(r):
    """Change of the horizontal error from the last epoch before to the end of the outage, m; and what is claimed there, 1 sigma."""
    t, ne = seconds(r), r.errors.err["pos"][:, :2]
    good = np.isfinite(ne).all(1)
    before, last = np.flatnonzero(good & (t < FROM))[-1], np.flatnonzero(good & (t < TO - 0.2))[-1]
    return float(np.hypot(*(ne[last] - ne[before]))), float(np.hypot(*r.errors.sd["pos"][last, :2]))


def test_sixty_seconds_without_satellites_cost_less(drives):
    on, off = ([growth(r) for r in drives[w]] for w in (True, False))
    for seed, a, b in zip(SEEDS, on, off):
        print(f"seed {seed}: error grows {a[0]:.1f} m (sigma {a[1]:.1f}) with wheels, {b[0]:.1f} m (sigma {b[1]:.1f}) without")
    rms = lambda x: np.sqrt(np.mean(np.square(x)))
    assert rms([g for g, _ in on]) < 0.6 * rms([g for g, _ in off])
    assert max(g / sd for g, sd in on) < 3.5
    assert np.mean([sd for _, sd in on]) < 0.6 * np.mean([sd for _, sd in off])


def test_beside_gnss_nothing_gets_worse(drives):
    for on, off in zip(drives[True], drives[False]):
        h = [np.sqrt(np.nanmean(r.errors.horizontal[(seconds(r) > 30) & (seconds(r) < FROM)] ** 2)) for r in (on, off)]
        v = [np.sqrt(np.nanmean(np.sum(r.errors.err["vel"][(seconds(r) > 30) & (seconds(r) < FROM)] ** 2, 1))) for r in (on, off)]
        print(f"horizontal {h[0]:.2f} m with, {h[1]:.2f} m without; velocity {v[0]:.3f}, {v[1]:.3f} m/s")
        assert h[0] < 1.1 * h[1] and v[0] < 1.05 * v[1]
