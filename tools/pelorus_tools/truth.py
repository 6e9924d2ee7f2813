"""Reference trajectories: TRUTH of the simulator, a CSV with the columns of pelorus-decode, or an RTKLIB .pos file."""

import csv
import io

import numpy as np

from pelorus_tools import earth, eventlog, gpstime
from pelorus_tools.cli import UnreadableError

# lcm/pelorus_truth_t.lcm: fingerprint (8 bytes), then the fields, big-endian.
TRUTH_DTYPE = np.dtype([("fingerprint", ">u8"), ("t_ns", ">i8"), ("r_eb_e", ">f8", 3), ("v_eb_e", ">f8", 3),
                        ("C_b_e", ">f8", (3, 3)), ("omega_ib_b", ">f8", 3), ("f_ib_b", ">f8", 3), ("b_g", ">f8", 3),
                        ("b_a", ">f8", 3)])
OMEGA_IE = np.array([0.0, 0.0, 7.292115e-5])


class Truth:
    """t_ns (n), r_e (n,3) m, v_e (n,3) m/s or None, C_b_e (n,3,3) or None, omega_e (n,3) rad/s or None (rate of the body
    against e, resolved in e), b_g/b_a (n,3) or None; sorted by time."""

    def __init__(self, source, t_ns, r_e, v_e=None, C_b_e=None, omega_e=None, b_g=None, b_a=None):
        order = np.argsort(t_ns, kind="stable")
        keep = order[np.append(np.diff(np.asarray(t_ns)[order]) > 0, True)]
        pick = lambda x: None if x is None else np.asarray(x)[keep]
        self.source, self.t_ns, self.r_e, self.v_e = source, pick(t_ns), pick(r_e), pick(v_e)
        self.C_b_e, self.omega_e, self.b_g, self.b_a = pick(C_b_e), pick(omega_e), pick(b_g), pick(b_a)

    def at(self, t_ns, max_gap_s=2.0):
        """The truth at these times: a Truth of the same length, and which of them are covered.

        At equal times the values are exact; between them position is the cubic Hermite of position and velocity (a line
        if there is no velocity), velocity its derivative, attitude the cubic Hermite of
        the rotation vector and its rate (the shortest rotation if there is no rate). Times outside the
        truth, or in a hole of it longer than max_gap_s, are not covered.
        """
        n = self.t_ns.size
        k = np.clip(np.searchsorted(self.t_ns, t_ns, side="right") - 1, 0, max(n - 2, 0))
        exact_at = np.clip(np.searchsorted(self.t_ns, t_ns), 0, n - 1)
        exact = self.t_ns[exact_at] == t_ns
        j = np.minimum(k + 1, n - 1)
        h = np.maximum((self.t_ns[j] - self.t_ns[k]) * 1e-9, 1e-9)
        s = (t_ns - self.t_ns[k]) * 1e-9 / h
        covered = exact | ((s >= 0) & (s <= 1) & (h <= max_gap_s))
        hc, sc = h[:, None], s[:, None]
        r0, r1 = self.r_e[k], self.r_e[j]
        v = None
        if self.v_e is not None:
            v0, v1 = self.v_e[k], self.v_e[j]
            # Relative to r0, so that nothing is lost against the Earth's radius.
            r = r0 + (r1 - r0) * (3 * sc**2 - 2 * sc**3) + hc * (v0 * (sc - 2 * sc**2 + sc**3) + v1 * (sc**3 - sc**2))
            v = (r1 - r0) * (6 * sc - 6 * sc**2) / hc + v0 * (1 - 4 * sc + 3 * sc**2) + v1 * (3 * sc**2 - 2 * sc)
            v = np.where(exact[:, None], self.v_e[exact_at], v)
        else:
            r = r0 + (r1 - r0) * sc
        r = np.where(exact[:, None], self.r_e[exact_at], r)
        C = None
        if self.C_b_e is not None:
            C0 = self.C_b_e[k]
            step = earth.rotvec(self.C_b_e[j] @ np.swapaxes(C0, -1, -2))
            if self.omega_e is not None:
                # Rate of the vector from the rate of the body: w - 1/2 step x w (Bortz, 1971), exact at the start.
                w0, w1 = self.omega_e[k], self.omega_e[j] - 0.5 * np.cross(step, self.omega_e[j])
                step = step * (3 * sc**2 - 2 * sc**3) + hc * (w0 * (sc - 2 * sc**2 + sc**3) + w1 * (sc**3 - sc**2))
            else:
                step = step * sc
            C = np.where(exact[:, None, None], self.C_b_e[exact_at], earth.rotvec_to_dcm(step) @ C0)
        blend = lambda b: None if b is None else b[k] + (b[j] - b[k]) * np.clip(sc, 0, 1)
        out = Truth.__new__(Truth)
        out.source, out.t_ns, out.r_e, out.v_e, out.C_b_e = self.source, t_ns, r, v, C
        out.omega_e, out.b_g, out.b_a = blend(self.omega_e), blend(self.b_g), blend(self.b_a)
        out.attitude_good = exact if self.omega_e is None else covered
        return out, covered


def from_events(payloads, source):
    """Truth of TRUTH payloads, None if there are none."""
    good = [p for p in payloads if len(p) == TRUTH_DTYPE.itemsize]
    if not good:
        if payloads:
            raise UnreadableError(f"{source}: TRUTH is not of the type truth_t known here ({len(payloads[0])} bytes, "
                                  f"not {TRUTH_DTYPE.itemsize})")
        return None
    a = np.frombuffer(b"".join(good), TRUTH_DTYPE)
    f = lambda name: a[name].astype(float)
    C = f("C_b_e")
    omega_e = earth.rotate(C, f("omega_ib_b")) - OMEGA_IE
    return Truth(source, a["t_ns"].astype(np.int64), f("r_eb_e"), f("v_eb_e"), C, omega_e, f("b_g"), f("b_a"))


def load(path, progress=None):
    """A capture or OUT with TRUTH, a CSV, or a .pos."""
    data = eventlog.open_bytes(path)
    if eventlog.is_log(data):
        found = from_events([bytes(p) for _, c, p in eventlog.events(data, progress=progress) if c == b"TRUTH"], path)
        if found is None:
            raise UnreadableError(f"{path}: this log has no TRUTH channel")
        return found
    try:
        content = bytes(data).decode("utf-8")
    except UnicodeDecodeError as e:
        raise UnreadableError(f"{path}: neither a log nor text") from e
    try:
        return _csv(content, path) if content.startswith("gpst_s") else _pos(content, path)
    except (ValueError, IndexError, KeyError) as e:
        raise UnreadableError(f"{path}: not a CSV of pelorus-decode and not an RTKLIB .pos ({e})") from e


def _ns(words):
    whole, _, part = words.partition(".")
    return int(whole) * gpstime.NS + int((part + "0" * 9)[:9])


def _csv(content, path):
    rows = [r for r in csv.DictReader(io.StringIO(content)) if r["lat_deg"]]
    if not rows:
        raise UnreadableError(f"{path}: no row with a position")
    col = lambda name: np.array([float(r.get(name) or "nan") for r in rows])
    lat, lon = np.radians(col("lat_deg")), np.radians(col("lon_deg"))
    to_n = earth.C_e_n(lat, lon)
    to_e = np.swapaxes(to_n, -1, -2)
    v = np.stack([col(f"vel_{a}_mps") for a in "ned"], -1)
    rpy = np.radians(np.stack([col(f"{a}_deg") for a in ("roll", "pitch", "heading")], -1))
    v_e = earth.rotate(to_e, v) if np.isfinite(v).all() else None
    C = to_e @ earth.rpy_to_C_b_n(*rpy.T) if np.isfinite(rpy).all() else None
    return Truth(path, np.array([_ns(r["gpst_s"]) for r in rows]), earth.llh_to_ecef(lat, lon, col("height_m")), v_e, C)


def _pos(content, path):
    """RTKLIB solutions: week and seconds or calendar, GPST or UTC, latitude/longitude or ECEF, velocity if there."""
    header, rows = "", []
    for line in content.splitlines():
        if line.startswith("%"):
            header = line if "GPST" in line or "UTC" in line else header
        elif line.strip():
            rows.append(line.replace(",", " ").split())
    if not rows or not header:
        raise UnreadableError(f"{path}: no solutions")
    width = max(map(len, rows))
    rows = [r for r in rows if len(r) == width]
    if "/" in rows[0][0]:
        def when(r):
            y, mo, d = map(int, r[0].split("/"))
            hh, mm, ss = r[1].split(":")
            return gpstime.from_calendar(y, mo, d, int(hh), int(mm), float(ss))
    else:
        def when(r):
            return int(r[0]) * 604800 * gpstime.NS + _ns(r[1])
    t = np.array([when(r) for r in rows])
    if "UTC" in header:
        t = t + gpstime.leap_s(t) * gpstime.NS
    a = np.array([[float(x) for x in r[2:]] for r in rows])
    velocity = a[:, 13:16] if a.shape[1] >= 16 else None
    if "x-ecef" in header:
        r_e = a[:, 0:3]
        v_e = velocity
    else:
        lat, lon = np.radians(a[:, 0]), np.radians(a[:, 1])
        r_e = earth.llh_to_ecef(lat, lon, a[:, 2])
        v_e = None
        if velocity is not None:
            ned = velocity * [1, 1, -1]                       # RTKLIB writes north, east, up
            v_e = earth.rotate(np.swapaxes(earth.C_e_n(lat, lon), -1, -2), ned)
    out = Truth(path, t, r_e, v_e)
    out.quality = a[:, 3].astype(int)[np.argsort(t, kind="stable")][:out.t_ns.size]
    return out
