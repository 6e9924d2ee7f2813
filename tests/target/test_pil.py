"""Captures through the firmware on every emulated board: the bytes of the desktop."""

import subprocess

from pelorus_tools import frames
from pil import captures, compare
from pil.board import ROOT, names


def test_every_board_says_what_the_desktop_says():
    done = subprocess.run(["bash", ROOT / "cmake/pil.sh", "--quick", *names()], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count("IDENTICAL") == (len(captures.QUICK) + 1) * len(names())  # by files, and over the UART


def one_solution(t_ns, state_hash):
    s = frames.np.zeros(1, frames.SOLUTION_DTYPE)
    s["t_ns"], s["state_hash"] = t_ns, state_hash
    return frames.encode(frames.SOLUTION, s.tobytes())


def test_a_difference_is_told_with_its_first_epoch():
    desktop = b"".join(one_solution(t, h) for t, h in ((10**9, 1), (2 * 10**9, 2), (3 * 10**9, 3)))
    board = b"".join(one_solution(t, h) for t, h in ((10**9, 1), (2 * 10**9, 7), (3 * 10**9, 8)))
    assert compare.difference(desktop, desktop) is None
    assert "state hash differs first at" in compare.difference(desktop, board)
    assert ": 00000002, board 00000007" in compare.difference(desktop, board)
    assert "all state hashes agree (2 of 3 solutions)" in compare.difference(desktop, desktop[:2 * len(desktop) // 3])
