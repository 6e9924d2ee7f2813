"""Captures: LCM event logs, read and written without a copy of each event's data.

An event is: sync 0xEDA1DA01, event number u64, timestamp us u64, channel length u32, data length u32, channel, data;
big-endian. The same bytes are read by lcm.EventLog, lcm-logplayer and lcm-spy; this reader adds standard input, .gz
files, logs cut short, and speed (3.6 million events of a two-hour flight in seconds). A file that does not begin like a
log is taken as the raw bytes of one port, so that a serial dump of a board can be decoded as it is.
"""

import gzip
import mmap
import struct
import sys
from collections import Counter

from pelorus_tools.cli import UnreadableError

HEADER = struct.Struct(">IQQII")
SYNC = b"\xed\xa1\xda\x01"
LONGEST_CHANNEL = 63       # of LCM
LONGEST_DATA = 1 << 26     # far above any frame of ours: a longer one is damage


def open_bytes(path):
    """The whole input as something to be sliced: '-' is standard input, .gz is unpacked."""
    if path == "-":
        return memoryview(sys.stdin.buffer.read())
    with open(path, "rb") as f:
        head = f.read(2)
        if not head:
            return memoryview(b"")
        if head == b"\x1f\x8b":
            try:
                with gzip.open(path) as g:
                    return memoryview(g.read())
            except (OSError, EOFError) as e:
                raise UnreadableError(f"{path}: not readable as gzip ({e})") from e
        return memoryview(mmap.mmap(f.fileno(), 0, access=mmap.ACCESS_READ))


def is_log(data):
    return bytes(data[:4]) == SYNC


def events(data, refused=None, progress=None):
    """Yield (timestamp_us, channel bytes, data view) of each event; damage is counted in `refused` and stepped over."""
    refused = Counter() if refused is None else refused
    pos, end, n = 0, len(data), 0
    unpack, size = HEADER.unpack_from, HEADER.size
    while pos + size <= end:
        sync, _, t_us, n_channel, n_data = unpack(data, pos)
        start = pos + size
        if sync != 0xEDA1DA01 or n_channel > LONGEST_CHANNEL or n_data > LONGEST_DATA:
            pos = _next_sync(data, pos + 1, refused)
            continue
        stop = start + n_channel + n_data
        if stop > end:
            refused["log: last event cut short"] += 1
            return
        yield t_us, bytes(data[start:start + n_channel]), data[start + n_channel:stop]
        pos = stop
        n += 1
        if progress is not None and n % 65536 == 0:
            progress(pos / end)
    if pos < end:
        refused["log: last event cut short"] += 1


def _next_sync(data, pos, refused):
    refused["log: damaged event"] += 1
    step = 1 << 20
    while pos < len(data):
        chunk = bytes(data[pos:pos + step + 3])
        found = chunk.find(SYNC)
        if found >= 0:
            return pos + found
        pos += step
    return len(data)


def write(path, rows):
    """Write (timestamp_us, channel str, data bytes) rows as a log; returns the number of events."""
    n = 0
    with open(path, "wb") as f:
        for t_us, channel, data in rows:
            name = channel.encode()
            f.write(HEADER.pack(0xEDA1DA01, n, t_us, len(name), len(data)) + name + data)
            n += 1
    return n
