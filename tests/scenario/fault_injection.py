"""Faults on a capture: each takes rows (time us, channel, bytes), a line and a span of seconds, and gives other rows.

Frames whose fields are changed get their checksum again, so that nothing but the value is wrong.
"""

import math
import struct

from pelorus_tools import frames

SPEED_OF_LIGHT = 299792458.0
WEEK_S = 604800.0
UBX_HZ = {(0, 0): 1575.42e6, (0, 3): 1227.60e6, (2, 0): 1575.42e6, (2, 6): 1207.14e6}   # (gnssId, sigId) of the scenario's signals


# ---- frames inside one event ------------------------------------------------------------------------------------------

def split(data):
    """(kind, frame) of whole frames, ('', bytes) of what is none."""
    pos = 0
    while pos < len(data):
        length, kind = 0, ""
        if data[pos:pos + 2] == b"PL":
            length, kind = 9 + int.from_bytes(data[pos + 4:pos + 6], "little"), "imu"
        elif data[pos:pos + 2] == b"\xb5\x62":
            length, kind = 8 + int.from_bytes(data[pos + 4:pos + 6], "little"), "rawx" if data[pos + 2:pos + 4] == b"\x02\x15" else "ubx"
        elif data[pos] == 0xD3:
            length, kind = 6 + (int.from_bytes(data[pos + 1:pos + 3], "big") & 0x3FF), "rtcm"
        if length == 0 or pos + length > len(data):
            yield "", data[pos:]
            return
        yield kind, data[pos:pos + length]
        pos += length


def seal_imu(payload):
    return frames.encode(1, bytes(payload))


def seal_rawx(payload):
    body = b"\x02\x15" + len(payload).to_bytes(2, "little") + bytes(payload)
    a = b = 0
    for byte in body:
        a = (a + byte) & 0xFF
        b = (b + a) & 0xFF
    return b"\xb5\x62" + body + bytes((a, b))


def changed(data, change):
    """The event with `change(kind, payload)` applied to each IMU and RAWX payload; None from it removes the frame."""
    out = b""
    for kind, frame in split(data):
        if kind in ("imu", "rawx"):
            payload = bytearray(frame[6:-3] if kind == "imu" else frame[6:-2])
            payload = change(kind, payload)
            out += b"" if payload is None else (seal_imu if kind == "imu" else seal_rawx)(payload)
        else:
            out += frame
    return out


def signals(payload):
    return range(16, len(payload), 32)


def put(payload, fmt, at, value):
    payload[at:at + struct.calcsize(fmt)] = struct.pack(fmt, value)


def get(payload, fmt, at):
    return struct.unpack_from(fmt, payload, at)[0]


# ---- what makes a fault ---------------------------------------------------------------------------------------------------

class Span:
    """The rows of one line within seconds [start, end) after the first IMU byte."""

    def __init__(self, rows, channel, start_s, end_s, dice):
        self.rows, self.channel, self.dice, self.start_s = rows, channel, dice, start_s
        self.t0 = next(t for t, c, _ in rows if c == "UART_IMU")
        self.low, self.high = self.t0 + start_s * 1e6, self.t0 + end_s * 1e6

    def inside(self, row):
        return row[1] == self.channel and self.low <= row[0] < self.high

    def each(self, change):
        """change(row) gives a list of rows."""
        out = []
        for row in self.rows:
            out += change(row) if self.inside(row) else [row]
        return sorted(out, key=lambda r: r[0])

    def data(self, change):
        return self.each(lambda r: [(r[0], r[1], change(r[2]))])

    def fields(self, change):
        return self.data(lambda d: changed(d, change))


def bit_flips(s):
    def flip(data):
        return bytes(b ^ (1 << s.dice.randrange(8)) if s.dice.random() < 0.004 else b for b in data)
    return s.data(flip)


def truncation(s):
    return s.data(lambda d: d[:s.dice.randrange(len(d))] if s.dice.random() < 0.5 else d)


def duplication(s):
    return s.each(lambda r: [r, r])


def reordering(s):
    """Neighbours within a second (of an IMU: within 80 ms) arrive in any order."""
    mine = [i for i, r in enumerate(s.rows) if s.inside(r)]
    size, out = (8 if s.channel == "UART_IMU" else 3), list(s.rows)
    for first in range(0, len(mine), size):
        group = mine[first:first + size]
        order = s.dice.sample(group, len(group))
        for place, source in zip(group, order):
            out[place] = (s.rows[place][0], s.channel, s.rows[source][2])
    return out


def delayed(s):
    return s.each(lambda r: [(r[0] + 10_000_000, r[1], r[2])])


def silent(s):
    return s.each(lambda r: [])


def time_jump(seconds):
    def shift(kind, p):
        if kind == "imu":
            put(p, "<q", 0, get(p, "<q", 0) + int(seconds * 1e9))
        else:
            tow = get(p, "<d", 0) + seconds
            weeks = math.floor(tow / WEEK_S)
            put(p, "<d", 0, tow - weeks * WEEK_S)
            put(p, "<H", 8, get(p, "<H", 8) + weeks)
        return p
    return lambda s: s.fields(shift)


def week_1024(s):
    def shift(kind, p):
        put(p, "<H", 8, get(p, "<H", 8) - 1024)
        return p
    return s.fields(shift)


def not_numbers(s):
    """NaN and infinities in one field of every third signal, and at times in the time of week."""
    def spoil(kind, p):
        for at in signals(p):
            if s.dice.random() < 0.33:
                fmt, place = s.dice.choice((("<d", 0), ("<d", 8), ("<f", 16)))
                put(p, fmt, at + place, s.dice.choice((math.nan, math.inf, -math.inf)))
        if s.dice.random() < 0.2:
            put(p, "<d", 0, math.nan)
        return p
    return s.fields(spoil)


def denormals(s):
    def spoil(kind, p):
        for at in signals(p):
            if s.dice.random() < 0.33:
                fmt, place = s.dice.choice((("<d", 0), ("<d", 8), ("<f", 16)))
                put(p, fmt, at + place, 1e-310 if fmt == "<d" else 1e-42)
        return p
    return s.fields(spoil)


def gross_values(s):
    """Numbers that could be: of a GNSS line every fourth signal off by up to 300 m, cycles and m/s; of an IMU one axis in ten samples off by up to 0.5 rad
    or 5 m/s."""
    def spoil(kind, p):
        if kind == "imu":
            if s.dice.random() < 0.1:
                at, size = 16 + 4 * s.dice.randrange(6), 2 ** 30
                put(p, "<i", at, s.dice.randrange(-size, size))
            return p
        for at in signals(p):
            if s.dice.random() < 0.25:
                fmt, place = s.dice.choice((("<d", 0), ("<d", 8), ("<f", 16)))
                put(p, fmt, at + place, get(p, fmt, at + place) + s.dice.uniform(-300.0, 300.0))
        return p
    return s.fields(spoil)


def extremes(s):
    """The largest and smallest integers an IMU frame can hold, a length of zero, a time of zero."""
    def spoil(kind, p):
        what = s.dice.random()
        if what < 0.1:
            put(p, "<i", 16 + 4 * s.dice.randrange(6), s.dice.choice((-2 ** 31, 2 ** 31 - 1)))
        elif what < 0.15:
            put(p, "<I", 8, s.dice.choice((0, 1, 2 ** 32 - 1)))
        elif what < 0.2:
            put(p, "<q", 0, s.dice.choice((0, -1, 2 ** 63 - 1)))
        return p
    return s.fields(spoil)


def slip(cycles, how_many):
    """From the start on, never told by lock time: the phases of some satellites' first carrier are off by these cycles."""
    def fault(s):
        s.high = math.inf
        chosen = {}

        def shift(kind, p):
            for at in signals(p):
                key = bytes(p[at + 20:at + 23])
                if key not in chosen:
                    chosen[key] = (cycles if cycles < 1 else s.dice.choice((-2, -1, 1, 2)) * cycles) if len(chosen) < how_many else 0.0
                put(p, "<d", at + 8, get(p, "<d", at + 8) + chosen[key])
            return p
        return s.fields(shift)
    return fault


def clock_jump(with_phase):
    """The receiver sets its clock by a millisecond, and stays there: tag and code jump, phase too or not."""
    def fault(s):
        s.high = math.inf

        def shift(kind, p):
            put(p, "<d", 0, get(p, "<d", 0) + 1e-3)
            for at in signals(p):
                put(p, "<d", at, get(p, "<d", at) + SPEED_OF_LIGHT * 1e-3)
                if with_phase:
                    put(p, "<d", at + 8, get(p, "<d", at + 8) + 1e-3 * UBX_HZ[p[at + 20], p[at + 22]])
            return p
        return s.fields(shift)
    return fault


def saturated(told):
    """The vertical gyro ends at 6 deg/s."""
    def clip(kind, p):
        most = int(math.radians(6.0) * 0.01 * 2 ** 31)
        at = 16 + 8
        z = get(p, "<i", at)
        if abs(z) > most:
            put(p, "<i", at, most if z > 0 else -most)
            if told:
                put(p, "<H", 14, get(p, "<H", 14) | 1)
        return p
    return lambda s: s.fields(clip)


def stuck(axes):
    def fault(s):
        held = {}

        def hold(kind, p):
            for axis in axes:
                held.setdefault(axis, get(p, "<i", 16 + 4 * axis))
                put(p, "<i", 16 + 4 * axis, held[axis])
            return p
        return s.fields(hold)
    return fault


# name: (fault, seconds it lasts, lines, does it change fields)
ALL, GNSS = ("imu", "rover", "base"), ("rover", "base")
FAULTS = {
    "bit flips": (bit_flips, 5, ALL, False),
    "truncation": (truncation, 5, ALL, False),
    "duplication": (duplication, 5, ALL, False),
    "reordering": (reordering, 5, ALL, False),
    "delay 10 s": (delayed, 5, ALL, False),
    "burst loss 5 s": (silent, 5, ALL, False),
    "time +1 s": (time_jump(1.0), 5, ALL, True),
    "time -1 s": (time_jump(-1.0), 5, ALL, True),
    "time +1 h": (time_jump(3600.0), 5, ALL, True),
    "time -1 h": (time_jump(-3600.0), 5, ALL, True),
    "time +1 week": (time_jump(WEEK_S), 5, ALL, True),
    "time -1 week": (time_jump(-WEEK_S), 5, ALL, True),
    "week -1024": (week_1024, 5, GNSS, True),
    "NaN, Inf": (not_numbers, 5, GNSS, True),
    "denormals": (denormals, 5, GNSS, True),
    "gross values": (gross_values, 5, ALL, True),
    "extreme integers": (extremes, 5, ("imu",), True),
    "half-cycle slip": (slip(0.5, 1), 0, GNSS, True),
    "full-cycle slip": (slip(1.0, 1), 0, GNSS, True),
    "slip of all": (slip(1.0, 99), 0, GNSS, True),
    "clock +1 ms": (clock_jump(True), 0, GNSS, True),
    "clock +1 ms, code only": (clock_jump(False), 0, GNSS, True),
    "other base": (None, 0, ("base",), False),
    "gap 0.2 s": (silent, 0.2, ("imu",), True),
    "gap 2 s": (silent, 2, ("imu",), True),
    "gyro saturated, told": (saturated(True), 5, ("imu",), True),
    "gyro saturated, silent": (saturated(False), 5, ("imu",), True),
    "gyro axis stuck": (stuck((2,)), 5, ("imu",), True),
    "accelerometer axis stuck": (stuck((4,)), 5, ("imu",), True),
    "IMU frozen": (stuck(range(6)), 5, ("imu",), True),
}
# Moments that strike every line at once, by the scenario's start: week, and the second of it that the phase's instant falls on.
CALENDAR = {"week roll-over": (2300, WEEK_S), "1024-week roll-over": (2047, WEEK_S), "leap second": (1930, 17.0), "day boundary": (2300, 86400.0)}


def outage(rows, start_s, end_s):
    """No GNSS of either receiver."""
    s = Span(rows, "", start_s, end_s, None)
    return [r for r in rows if r[1] not in ("UART_ROVER", "UART_BASE") or not s.low <= r[0] < s.high]
