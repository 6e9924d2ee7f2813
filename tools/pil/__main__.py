"""make pil: captures through the firmware on an emulated board; its output must be the desktop's, byte for byte.

    python -m pil [--quick] [BOARD...]        needs the board's and the desktop's programs built (cmake/pil.sh)
"""

import argparse
import pathlib
import subprocess
import sys
import tempfile
import time

from pelorus_tools import eventlog, frames
from pil import captures, compare, uart
from pil.board import Board, names
from replay.__main__ import data_folder


def desktop_output(board, capture, folder):
    """What the desktop's firmware of the board's sizes sends."""
    out = folder / "desktop.out"
    subprocess.run([board.sil, "-q", capture, "-o", out], check=False)  # 4: it refused some bytes, as the board will
    return b"".join(bytes(d) for _, channel, d in eventlog.events(eventlog.open_bytes(str(out))) if channel == b"UART_OUT")


def replay(board, capture, folder):
    """(what went wrong or None, bytes of the desktop) of one capture on one board."""
    desktop = desktop_output(board, capture, folder)
    subprocess.run(["pelorus-tape", capture, "-o", folder / "in.tape"], check=True)
    wrong = board.run("pil", folder)
    if wrong is None:
        wrong = compare.difference(desktop, (folder / "out.bin").read_bytes())
    return wrong, desktop


def line(board, case, wrong, desktop, seconds):
    solutions = frames.parse(desktop).solution
    print(f"{board:16s} {case:8s} {len(desktop):9d} bytes {solutions.size:6d} solutions  "
          f"{'IDENTICAL' if wrong is None else 'DIFFERENT: ' + wrong}  ({seconds:.0f} s)", flush=True)
    return wrong is None and solutions.size > 0


def main():
    parser = argparse.ArgumentParser(prog="make pil")
    parser.add_argument("boards", nargs="*", help=f"of {', '.join(names())}; default all")
    parser.add_argument("--quick", action="store_true", help="seconds instead of minutes")
    args = parser.parse_args()
    unknown = set(args.boards) - set(names())
    if unknown:
        print(f"make pil: no board '{unknown.pop()}'; there are: {' '.join(names())}", file=sys.stderr)
        return 2
    boards = [Board(n) for n in args.boards or names()]
    data = data_folder(None)
    same = True
    with tempfile.TemporaryDirectory() as work:
        for case, make in (captures.QUICK if args.quick else captures.ALL).items():
            if make.folder and (data is None or not (data / make.folder).is_dir()):
                print(f"{'':16s} {case:8s} skipped: recording {make.folder} is not there (PELORUS_DATA)")
                continue
            capture = pathlib.Path(work) / f"{case}.log"
            make(capture, data)
            for board in boards:
                folder = pathlib.Path(work) / f"{case}-{board.name}"
                folder.mkdir()
                start = time.monotonic()
                wrong, desktop = replay(board, capture, folder)
                same &= line(board.name, case, wrong, desktop, time.monotonic() - start)
        for board in boards:
            start = time.monotonic()
            wrong, desktop = uart.replay(board, pathlib.Path(work))
            same &= line(board.name, "uart", wrong, desktop, time.monotonic() - start)
    print("make pil: the boards say what the desktop says" if same else "make pil: FAILED")
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
