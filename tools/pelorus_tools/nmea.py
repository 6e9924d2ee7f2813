"""NMEA 0183 sentences from solutions, for outputs that carry none of the firmware's own."""

import math

import numpy as np

from pelorus_tools import frames
from pelorus_tools.gpstime import to_utc

# By status (none, spp, float, fixed, coast), as the firmware has them: quality of GGA, mode of RMC.
QUALITY = (0, 1, 5, 4, 6)
MODE = "NAFRE"


def checksum(body):
    c = 0
    for ch in body.encode("ascii"):
        c ^= ch
    return f"${body}*{c:02X}"


def _angle(rad, width, letters):
    minutes = round(abs(math.degrees(rad)) * 60.0 * 1e7)      # in 1e-7 minutes: no carry is lost in printing
    degrees, rest = divmod(minutes, 60 * 10**7)
    return f"{degrees:0{width}d}{rest // 10**7:02d}.{rest % 10**7:07d},{letters[int(rad < 0)]}"


def sentences(s):
    """GGA, RMC and, where heading is known, HDT."""
    t = to_utc(s["t_ns"])
    clock = f"{t:%H%M%S}.{t.microsecond // 10000:02d}"
    lat, lon = _angle(s["lat_rad"], 2, "NS"), _angle(s["lon_rad"], 3, "EW")
    fix = min(int(s["fix"]), 4)
    age = f"{s['base_age_s']:.1f}" if s["base_age_s"] >= 0 and fix in (2, 3) else ""
    n, e = float(s["v_ned"][0]), float(s["v_ned"][1])
    knots = math.hypot(n, e) * 3600.0 / 1852.0
    course = np.mod(math.degrees(math.atan2(e, n)), 360.0)
    out = [checksum(f"GNGGA,{clock},{lat},{lon},{QUALITY[fix]},{s['n_sat']:02d},,{s['height_m']:.4f},M,0.0,M,{age},"),
           checksum(f"GNRMC,{clock},A,{lat},{lon},{knots:.3f},{course:.2f},{t:%d%m%y},,,{MODE[fix]},V")]
    if s["flags"] & frames.SOL_HEADING:
        out.append(checksum(f"GNHDT,{np.mod(math.degrees(float(s['heading_rad'])), 360.0):.3f},T"))
    return out
