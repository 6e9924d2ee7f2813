"""Two machines' outputs: the same bytes, or where they part."""

from pelorus_tools import frames, gpstime


def difference(desktop, board):
    """None if equal; else one line that names the first solution whose state hash differs."""
    if desktop == board:
        return None
    n = min(len(desktop), len(board))
    at = next((i for i in range(n) if desktop[i] != board[i]), n)
    where = f"differs from byte {at} of {len(desktop)}" if len(desktop) == len(board) else \
        f"differs from byte {at}, {len(desktop)} bytes on the desktop, {len(board)} on the board"
    ours, theirs = frames.parse(desktop).solution, frames.parse(board).solution
    for a, b in zip(ours, theirs):
        if a["t_ns"] != b["t_ns"]:
            return f"{where}; solution at {gpstime.text(int(a['t_ns']))} on the desktop, at {gpstime.text(int(b['t_ns']))} on the board"
        if a["state_hash"] != b["state_hash"]:
            return f"{where}; state hash differs first at {gpstime.text(int(a['t_ns']))}: {a['state_hash']:08x}, board {b['state_hash']:08x}"
    return f"{where}; all state hashes agree ({len(theirs)} of {len(ours)} solutions)"
