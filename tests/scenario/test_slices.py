"""The integer search cut into slices between IMU samples: the same epochs to the bit, and outputs that go on meanwhile."""

import numpy as np
import runs


def run(tmp_path, capture, slice_nodes):
    config = tmp_path / f"{slice_nodes}.toml"
    text = (runs.ROOT / "scenarios" / "s5_leg.toml").read_text()
    table = text[text.index("[navigator]"):]
    config.write_text(table.replace("[navigator.integers]", f"[navigator.integers]\nslice_nodes = {slice_nodes}"))
    out = tmp_path / f"{slice_nodes}.out"
    runs.call("pelorus-sil", capture, "-o", out, "--config", config, "-q")
    return runs.Result(out)


def test_epochs_do_not_depend_on_how_the_search_is_cut(tmp_path):
    capture = runs.simulate(tmp_path, "s5_leg", 7, duration=90)
    results = {n: run(tmp_path, capture, n) for n in (0, 1, 7, 200)}
    whole = results[0]
    for n, r in results.items():
        assert np.array_equal(r.sol["t_ns"][r.epoch], whole.sol["t_ns"][whole.epoch]), n
        assert np.array_equal(r.sol["state_hash"][r.epoch], whole.sol["state_hash"][whole.epoch]), n
        assert np.array_equal(r.sol["search_nodes"][r.epoch], whole.sol["search_nodes"][whole.epoch]), n
        assert (r.sol["fix"][r.epoch] == 3).mean() > 0.9
        assert r.sol.size == whole.sol.size, "an output was missed while a search was under way"
    nodes = whole.sol["search_nodes"][whole.epoch]
    print(f"\n{whole.epoch.sum()} epochs, {nodes.mean():.0f} nodes on average, {nodes.max()} at most; slices of 1, 7 and 200: the same hashes")
    assert nodes.max() > 20
