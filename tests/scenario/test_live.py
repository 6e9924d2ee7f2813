"""lcm-logplayer of a capture drives pelorus-sil live, and what comes out is what a replay of the file gives."""

import os
import shutil
import subprocess

import numpy as np
import pytest
import runs

URL = "udpm://239.255.76.67:7667?ttl=0"


def in_namespace(script):
    """A shell in a network of its own: multicast needs a route, and nobody else's LCM must be heard."""
    return ["unshare", "-n", "bash", "-c", "ip link set lo up && ip route add 224.0.0.0/4 dev lo && " + script]


@pytest.mark.skipif(os.geteuid() != 0 or shutil.which("unshare") is None or shutil.which("ip") is None,
                    reason="needs root and a network namespace")
def test_logplayer_drives_the_firmware(tmp_path):
    capture = runs.simulate(tmp_path, "s5_leg", duration=20)
    replayed, _ = runs.firmware(capture)
    live = tmp_path / "live.out"
    script = f"pelorus-sil '{URL}' -o {live} -q & sil=$!; sleep 1; lcm-logplayer --lcm-url='{URL}' --speed=2 {capture} >/dev/null; wait $sil"
    done = subprocess.run(in_namespace(script), capture_output=True, text=True, timeout=120, check=False)
    if "Operation not permitted" in done.stderr:
        pytest.skip("no right to make a network namespace")
    assert done.returncode in (0, 4), done.stderr
    a, b = runs.Result(replayed).sol, runs.Result(live).sol
    common, ka, kb = np.intersect1d(a["t_ns"], b["t_ns"], return_indices=True)
    d = np.linalg.norm(a["r_eb_e"][ka] - b["r_eb_e"][kb], axis=1)
    print(f"\n{a.size} solutions from the file, {b.size} live, {common.size} at common times, at most {1e3 * d.max():.4f} mm apart")
    assert common.size >= 0.95 * a.size
    assert np.array_equal(a["fix"][ka], b["fix"][kb])
    assert d.max() < 0.01
