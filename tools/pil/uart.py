"""A short capture through the firmware as it is, its own drivers and all, over the board's emulated UARTs.

Only the rover's bytes: the order in which bytes of several UARTs reach the main loop is not the capture's. The board has its default
configuration, and its output is read as it comes: a board does not know of an end, so what the desktop still says there is not asked
for.
"""

import socket
import subprocess
import time

from pelorus_tools import eventlog, frames
from pil.board import ROOT

SECONDS = 8         # of the scenario
MAY_MISS = 2        # epochs that the desktop still serves when its input ends
START_S = 0.5       # a board drops what comes before its UARTs are up
QUIET_S = 0.03      # no byte for this long: the board has answered


class Wires:
    """A running board with a socket on each UART, by the port that listens or speaks there."""

    def __init__(self, board, program, folder):
        serials = board.settings["PEL_BOARD_SERIALS"].split()
        more = []
        for i, _ in enumerate(serials):
            more += ["-chardev", f"socket,id=s{i},path={folder}/s{i},server=on,wait=on", "-serial", f"chardev:s{i}"]
        self.process = subprocess.Popen(board.emulator(program, *more), cwd=folder, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.PIPE)
        self.socket = {}
        for i, ports in enumerate(serials):
            s = socket.socket(socket.AF_UNIX)
            for attempt in range(200):
                try:
                    s.connect(f"{folder}/s{i}")
                    break
                except OSError:
                    if attempt == 199 or self.process.poll() is not None:
                        raise RuntimeError(f"emulator did not start: {self.process.stderr.read().decode()}") from None
                    time.sleep(0.02)
            for port in ports.split("+"):
                self.socket[port] = s

    def send(self, port, data):
        self.socket[port].sendall(data)

    def receive(self, quiet_s):
        """What the OUT port says until it is quiet."""
        said = b""
        self.socket["out"].settimeout(quiet_s)
        try:
            while chunk := self.socket["out"].recv(65536):
                said += chunk
        except (TimeoutError, ConnectionError):
            pass
        return said

    def close(self):
        self.process.kill()
        self.process.communicate()
        for s in set(self.socket.values()):
            s.close()


def replay(board, folder):
    """(what went wrong or None, bytes of the board)."""
    whole, capture, out = folder / "uart.whole", folder / "uart.log", folder / "uart.out"
    if not capture.exists():
        subprocess.run(["pelorus-sim", "-q", ROOT / "scenarios/walk.toml", "--duration", str(SECONDS), "-o", whole], check=True)
        rover = ((t, "UART_ROVER", bytes(d)) for t, c, d in eventlog.events(eventlog.open_bytes(str(whole))) if c == b"UART_ROVER")
        eventlog.write(capture, rover)
    subprocess.run([board.sil, "-q", capture, "-o", out], check=True)
    desktop = b"".join(bytes(d) for _, c, d in eventlog.events(eventlog.open_bytes(str(out))) if c == b"UART_OUT")

    folder = folder / f"uart-{board.name}"
    folder.mkdir()
    wires = Wires(board, "emulated", folder)
    said = wires.receive(START_S)
    try:
        for _, _, data in eventlog.events(eventlog.open_bytes(str(capture))):
            wires.send("rover", bytes(data))
            said += wires.receive(QUIET_S)
        said += wires.receive(1.0)
    finally:
        wires.close()
    if not desktop.startswith(said):
        at = next(i for i, b in enumerate(said) if i >= len(desktop) or desktop[i] != b)
        return f"differs from byte {at} of {len(said)}", said
    epochs = [int((frames.parse(d).solution["flags"] & frames.SOL_AT_EPOCH != 0).sum()) for d in (desktop, said)]
    if epochs[1] < epochs[0] - MAY_MISS or epochs[1] == 0:
        return f"only {epochs[1]} of {epochs[0]} epochs came", said
    return None, said
