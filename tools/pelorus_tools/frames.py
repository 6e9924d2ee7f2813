"""Output frames: bytes of UART_OUT -> arrays. The byte layouts are those of docs/FORMATS.md.

A frame is 'P' 'L', id u8, version u8, payload length u16 LE, payload, CRC-24Q (MSB first) over id..payload; NMEA
sentences may stand between frames. Everything that is neither is counted by cause. Frames of one size are checked and
converted together with numpy, so that hours of output take seconds.
"""

import re
from collections import Counter

import numpy as np

LONGEST_PAYLOAD = 8192

SOLUTION, USED, COUNTERS, SATELLITES, EVENT, WARM = 0x10, 0x11, 0x12, 0x13, 0x14, 0x15
VERSION = 1

N_SYS = 6
SYSTEMS = ("GPS", "GLONASS", "Galileo", "BeiDou", "QZSS", "SBAS")
SYSTEM_LETTERS = "GRECJS"
CARRIERS = ("L1", "L2", "L5", "E5b", "E6", "B1I", "B3I")

FIX = ("none", "spp", "float", "fixed", "coast")
INT_REASON = ("ok", "not-tried", "few", "budget", "ratio", "chi2", "band", "prior", "success", "base-age")
SNAPSHOT = ("none", "waiting", "used", "damaged", "newer version", "impossible value", "foreign", "remounted", "stale", "taken under way",
            "not still", "moved", "turned")
WHY = ("", "no data", "switched off", "no orbit", "no station position", "not aligned", "unsupported")

SOL_INS, SOL_ATTITUDE, SOL_HEADING, SOL_AT_EPOCH, SOL_RESTARTED = 1, 2, 4, 8, 16
SAT_PIVOT, SAT_CODE, SAT_PHASE, SAT_DOPPLER, SAT_FIXED, SAT_SLIP, SAT_EXCLUDED = 1, 2, 4, 8, 16, 32, 64


def _dtype(*fields):
    return np.dtype([(name, "<" + kind, *shape) for name, kind, *shape in fields])


SOLUTION_DTYPE = _dtype(
    ("t_ns", "i8"), ("fix", "u1"), ("int_reason", "u1"), ("flags", "u2"),
    ("r_eb_e", "f8", 3), ("lat_rad", "f8"), ("lon_rad", "f8"), ("height_m", "f8"),
    ("v_ned", "f4", 3), ("roll_rad", "f4"), ("pitch_rad", "f4"), ("heading_rad", "f4"),
    ("cov_r_ned", "f4", 6), ("cov_v_ned", "f4", 6), ("cov_att", "f4", 6),
    ("sd_roll_rad", "f4"), ("sd_pitch_rad", "f4"), ("sd_heading_rad", "f4"),
    ("hpl_m", "f4"), ("vpl_m", "f4"), ("base_age_s", "f4"), ("ratio", "f4"), ("success_rate", "f4"), ("nis", "f4"),
    ("nis_dof", "u2"), ("search_nodes", "u2"), ("n_sat", "u1"), ("n_fixed", "u1"), ("n_amb", "u1"), ("reserved", "u1"),
    ("state_hash", "u4"), ("b_g", "f4", 3), ("sd_b_g", "f4", 3), ("b_a", "f4", 3), ("sd_b_a", "f4", 3))

USED_DTYPE = _dtype(
    ("t_ns", "i8"), ("preset_asked", "u1"), ("preset_used", "u1"), ("preset_why", "u1"),
    ("imu_seen", "u1"), ("imu_used", "u1"), ("imu_why", "u1"), ("base_seen", "u1"), ("base_used", "u1"), ("base_why", "u1"),
    ("imu_rate_hz", "f4"), ("base_age_s", "f4"),
    ("rover_seen", "u1", N_SYS), ("base_carriers", "u1", N_SYS), ("carriers_used", "u1", N_SYS), ("sys_why", "u1", N_SYS),
    ("arw_rad_rts", "f4"), ("vrw_mps_rts", "f4"), ("sd_bg_radps", "f4"), ("sd_ba_mps2", "f4"), ("r_station_e", "f8", 3))

NAV_COUNTERS = (
    "epochs_used", "epochs_late", "epochs_no_eph", "epochs_few_sats", "epochs_unpaired", "epochs_spp_failed",
    "imu_used", "imu_gap", "imu_out_of_order", "imu_bad_value", "rows_used", "rows_gated",
    "sats_no_eph", "sats_unhealthy", "sats_low", "sats_excluded",
    "slip_lock", "slip_half_cycle", "slip_geometry_free", "slip_doppler", "slip_ins", "clock_jumps",
    "fix_tried", "fix_ok", "fix_ratio", "fix_chi2", "fix_band", "fix_prior", "fix_success", "fix_budget",
    "restarts", "numeric_faults", "coast_epochs", "events", "events_refused", "fix_released")
WIRE_COUNTERS = ("frames", "noise_bytes", "bad_checksum", "bad_length", "bad_value", "unknown", "duplicate", "time_back",
                 "gap", "overflow")
WIRE_DTYPE = _dtype(*((name, "u4") for name in WIRE_COUNTERS))
COUNTERS_DTYPE = np.dtype([("t_ns", "<i8"), ("nav", _dtype(*((name, "u4") for name in NAV_COUNTERS))),
                           ("imu", WIRE_DTYPE), ("rover", WIRE_DTYPE), ("base", WIRE_DTYPE)])

SATS_HEAD = np.dtype([("t_ns", "<i8"), ("n", "<u2")])
SAT_DTYPE = _dtype(
    ("sys", "u1"), ("prn", "u1"), ("carrier", "u1"), ("flags", "u1"), ("az_rad", "f4"), ("el_rad", "f4"), ("cn0_dbhz", "f4"),
    ("innov_code_m", "f4"), ("innov_phase_m", "f4"), ("innov_doppler_mps", "f4"),
    ("sd_code_m", "f4"), ("sd_phase_m", "f4"), ("sd_doppler_mps", "f4"), ("n_fixed", "i4"))
SAT_AT_DTYPE = np.dtype([("t_ns", "<i8")] + SAT_DTYPE.descr)

EVENT_DTYPE = _dtype(
    ("t_ns", "i8"), ("id", "u4"), ("fix", "u1"), ("r_ec_e", "f8", 3), ("lat_rad", "f8"), ("lon_rad", "f8"),
    ("height_m", "f8"), ("omega_rad", "f4"), ("phi_rad", "f4"), ("kappa_rad", "f4"), ("sd_r_m", "f4", 3),
    ("sd_att_rad", "f4", 3))

WARM_DTYPE = _dtype(("t_ns", "i8"), ("verdict", "u1"), ("age_s", "f4"), ("count", "u4", len(SNAPSHOT)))

FIXED_SIZE = {SOLUTION: SOLUTION_DTYPE, USED: USED_DTYPE, COUNTERS: COUNTERS_DTYPE, EVENT: EVENT_DTYPE, WARM: WARM_DTYPE}


def _crc_table():
    crc = np.arange(256, dtype=np.uint32) << 16
    for _ in range(8):
        crc = np.where(crc & 0x800000, (crc << 1) ^ 0x1864CFB, crc << 1)
    return (crc & 0xFFFFFF).astype(np.uint32)


CRC_TABLE = _crc_table()
_CRC_LIST = CRC_TABLE.tolist()


def crc24q(data):
    crc = 0
    for byte in bytes(data):
        crc = ((crc << 8) & 0xFFFFFF) ^ _CRC_LIST[(crc >> 16) ^ byte]
    return crc


def encode(frame_id, payload, version=VERSION):
    """One output frame, for tests."""
    body = bytes([frame_id, version]) + len(payload).to_bytes(2, "little") + payload
    return b"PL" + body + crc24q(body).to_bytes(3, "big")


def satellites_payload(t_ns, reports):
    """Payload of a satellites frame, for tests."""
    head = np.zeros(1, SATS_HEAD)
    head["t_ns"], head["n"] = t_ns, len(reports)
    return head.tobytes() + reports.tobytes()


class Frames:
    """What was found: arrays by frame id, satellites flattened with their time, NMEA lines, refusals by cause."""

    def __init__(self):
        self.solution = np.zeros(0, SOLUTION_DTYPE)
        self.used = np.zeros(0, USED_DTYPE)
        self.counters = np.zeros(0, COUNTERS_DTYPE)
        self.satellites = np.zeros(0, SAT_AT_DTYPE)
        self.event = np.zeros(0, EVENT_DTYPE)
        self.warm = np.zeros(0, WARM_DTYPE)
        self.nmea = []
        self.unknown = Counter()   # well-formed frames of an id or version this program does not know
        self.refused = Counter()   # by cause


def _known(buf, at):
    """Of candidate positions: those whose id, version and length belong together."""
    frame_id, version = buf[at + 2], buf[at + 3]
    length = buf[at + 4].astype(np.int64) | (buf[at + 5].astype(np.int64) << 8)
    known = np.zeros(at.size, bool)
    for i, dtype in FIXED_SIZE.items():
        known |= (frame_id == i) & (length == dtype.itemsize)
    known |= (frame_id == SATELLITES) & (length >= SATS_HEAD.itemsize) & ((length - SATS_HEAD.itemsize) % SAT_DTYPE.itemsize == 0)
    known &= (version == VERSION) & (at + 9 + length <= buf.size)
    return at[known], length[known]


def _crc_ok(buf, at, length):
    ok = np.zeros(at.size, bool)
    for n in np.unique(length):
        group = np.flatnonzero(length == n)
        start = at[group] + 2
        crc = np.zeros(group.size, np.uint32)
        for j in range(4 + n):
            crc = ((crc << 8) & 0xFFFFFF) ^ CRC_TABLE[(crc >> 16) ^ buf[start + j]]
        end = start + 4 + n
        told = (buf[end].astype(np.uint32) << 16) | (buf[end + 1].astype(np.uint32) << 8) | buf[end + 2]
        ok[group] = crc == told
    return ok


def _gather(buf, start, dtype):
    """Records of one dtype at these positions, copied out."""
    rows = buf[start[:, None] + np.arange(dtype.itemsize)]
    return np.ascontiguousarray(rows).view(dtype)[:, 0]


_NMEA = re.compile(rb"\$([A-Z0-9]{2,8}(?:,[ -)+-~]*)?)\*([0-9A-Fa-f]{2})\r?\n")


def _gap(data, frames):
    """Bytes between known frames: NMEA, frames of another kind, or damage told by cause."""
    kept = []
    last = 0
    for m in _NMEA.finditer(data):
        check = 0
        for byte in m.group(1):
            check ^= byte
        if check == int(m.group(2), 16):
            frames.nmea.append(m.group(0).decode("ascii").strip())
        else:
            frames.refused["NMEA: bad checksum"] += 1
        kept.append(data[last:m.start()])
        last = m.end()
    kept.append(data[last:])
    for piece in kept:
        _damage(piece, frames)


def _damage(piece, frames):
    pos = 0
    while pos < len(piece):
        at = piece.find(b"PL", pos)
        if at < 0:
            frames.refused["bytes outside any frame"] += len(piece) - pos
            return
        if at > pos:
            frames.refused["bytes outside any frame"] += at - pos
        head = piece[at + 2:at + 6]
        length = int.from_bytes(head[2:4], "little") if len(head) == 4 else 0
        if len(head) == 4 and length > LONGEST_PAYLOAD:
            frames.refused["frame: impossible length"] += 1
            pos = at + 2
        elif len(head) < 4 or at + 9 + length > len(piece):
            frames.refused["frame: cut short"] += 1
            pos = at + 2
        elif crc24q(piece[at + 2:at + 6 + length]) != int.from_bytes(piece[at + 6 + length:at + 9 + length], "big"):
            frames.refused["frame: bad checksum"] += 1
            pos = at + 2
        else:
            frames.unknown[f"id 0x{head[0]:02x} version {head[1]} length {length}"] += 1
            pos = at + 9 + length


def parse(data):
    """All frames in the bytes of UART_OUT, in the order they were sent."""
    frames = Frames()
    data = bytes(data)
    buf = np.frombuffer(data, np.uint8)
    if buf.size < 9:
        _gap(data, frames)
        return frames
    at = np.flatnonzero((buf[:-8] == 0x50) & (buf[1:-7] == 0x4C))
    at, length = _known(buf, at)
    ok = _crc_ok(buf, at, length)
    at, length = at[ok], length[ok]

    chosen = np.ones(at.size, bool)     # a frame found inside another one's payload is none
    end = 0
    for i, (a, n) in enumerate(zip(at.tolist(), length.tolist())):
        if a < end:
            chosen[i] = False
            continue
        if a > end:
            _gap(data[end:a], frames)
        end = a + 9 + n
    if end < len(data):
        _gap(data[end:], frames)
    at, length = at[chosen], length[chosen]

    ids = buf[at + 2]
    for frame_id, name in ((SOLUTION, "solution"), (USED, "used"), (COUNTERS, "counters"), (EVENT, "event"), (WARM, "warm")):
        setattr(frames, name, _gather(buf, at[ids == frame_id] + 6, FIXED_SIZE[frame_id]))
    frames.satellites = _satellites(buf, at[ids == SATELLITES] + 6, length[ids == SATELLITES])
    return frames


def _satellites(buf, start, length):
    n = (length - SATS_HEAD.itemsize) // SAT_DTYPE.itemsize
    head = _gather(buf, start, SATS_HEAD)
    first = np.repeat(start + SATS_HEAD.itemsize, n)
    within = np.arange(n.sum()) - np.repeat(np.cumsum(n) - n, n)
    sats = _gather(buf, first + within * SAT_DTYPE.itemsize, SAT_DTYPE)
    out = np.zeros(sats.size, SAT_AT_DTYPE)
    out["t_ns"] = np.repeat(head["t_ns"], n)
    for name in SAT_DTYPE.names:
        out[name] = sats[name]
    return out
