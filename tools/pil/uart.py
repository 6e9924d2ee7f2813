"""A short capture through the firmware as it is, its own drivers and all, over the board's emulated UARTs.

Only the rover's bytes: the order in which bytes of several UARTs reach the main loop is not the capture's. The board has its default
configuration, and its output is read as it comes: a board does not know of an end, so what the desktop still says there is not asked
for.
"""

import select
import socket
import subprocess
import time

from pelorus_tools import eventlog, frames
from pil.board import ROOT

SECONDS = 8         # of the scenario
MAY_MISS = 2        # epochs that the desktop still serves when its input ends
START_S = 1.0       # a board drops what comes before its UARTs are up
END_S = 1.5         # for what the board still says after its last byte of input
TIMEOUT_S = 20      # for an epoch


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

    def receive(self, least, timeout_s):
        """At least so many bytes of what the OUT port says, if they come in time."""
        said = b""
        give_up = time.monotonic() + timeout_s
        while len(said) < least and (left := give_up - time.monotonic()) > 0:
            if select.select([self.socket["out"]], [], [], left)[0]:
                chunk = self.socket["out"].recv(65536)
                if not chunk:
                    break  # the emulator has ended
                said += chunk
        return said

    def loop(self, end, timeout_s):
        """Join the OUT port with all inputs until it has said `end`; what it said."""
        said = b""
        out = self.socket["out"]
        waiting = {s: b"" for port, s in self.socket.items() if port != "out"}  # never block: the emulator may wait for us
        for s in self.socket.values():
            s.setblocking(False)
        give_up = time.monotonic() + timeout_s
        while end not in said and time.monotonic() < give_up:
            readable, writable, _ = select.select([out], [s for s, data in waiting.items() if data], [], 0.2)
            if readable:
                chunk = out.recv(65536)
                if not chunk:
                    break  # the emulator has ended
                said += chunk
                for s in waiting:
                    waiting[s] += chunk
            for s in writable:
                waiting[s] = waiting[s][s.send(waiting[s][:64]):]
        return said

    def close(self):
        self.process.kill()
        self.process.communicate()
        for s in set(self.socket.values()):
            s.close()


def make_capture(path):
    """(time, bytes) of a rover alone, written to a capture as well."""
    whole = path.with_suffix(".whole")
    subprocess.run(["pelorus-sim", "-q", ROOT / "scenarios/walk.toml", "--duration", str(SECONDS), "-o", whole], check=True)
    events = [(t, bytes(d)) for t, c, d in eventlog.events(eventlog.open_bytes(str(whole))) if c == b"UART_ROVER"]
    eventlog.write(path, ((t, "UART_ROVER", d) for t, d in events))
    return events


def replay(board, folder):
    """(what went wrong or None, bytes of the board)."""
    folder = folder / f"uart-{board.name}"
    folder.mkdir()
    events = make_capture(folder / "uart.log")
    subprocess.run([board.sil, "-q", folder / "uart.log", "-o", folder / "uart.out"], check=True)
    out = [(t, bytes(d)) for t, c, d in eventlog.events(eventlog.open_bytes(str(folder / "uart.out"))) if c == b"UART_OUT"]
    desktop = b"".join(d for _, d in out)

    wires = Wires(board, "emulated", folder)
    said = wires.receive(1, START_S)
    try:
        for i, (t, data) in enumerate(events):
            wires.send("rover", data)
            last = i + 1 == len(events)
            if last or events[i + 1][0] > t:  # do not run ahead of the board: what it cannot send at once it drops
                due = len(desktop) if last else sum(len(d) for t_out, d in out if t_out <= t)
                said += wires.receive(due - len(said), END_S if last else TIMEOUT_S)
    finally:
        wires.close()
    if not desktop.startswith(said):
        at = next(i for i, b in enumerate(said) if i >= len(desktop) or desktop[i] != b)
        return f"differs from byte {at} of {len(said)}", said
    epochs = [int((frames.parse(d).solution["flags"] & frames.SOL_AT_EPOCH != 0).sum()) for d in (desktop, said)]
    if epochs[1] < epochs[0] - MAY_MISS or epochs[1] == 0:
        return f"only {epochs[1]} of {epochs[0]} epochs came", said
    return None, said
