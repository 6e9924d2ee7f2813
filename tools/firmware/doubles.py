"""Where double arithmetic in software is meant to be, on a core whose FPU has floats alone.

Positions, ranges, phases and times are doubles; factors, gains and rows are floats. A double that slips into a hot loop costs fifty
instructions an operation and no test fails, so every object that may use them is listed here.
"""

import re

# Doubles by design: orbits, time and position; what is decoded from numbers of 32 bits and more; ambiguities.
ROOMS = {"ambiguity", "earth", "gnss", "inertial", "math", "navigator"}
OBJECTS = {
    "base": {"bits", "signals", "time"},
    "filter": {"offsets", "propagate", "states"},   # once a step or epoch: decay of offsets, sums of increments; a covariance given in doubles
    "model": {"blocks", "transition", "transition_enu"}, # once a substep
    "observe": {"dd_rows", "motion_rows", "path_fit", "phase_rows", "tdcp"}, # differences of ranges become float innovations
    "wire": {"baro_frame", "bitio", "fields", "framing", "glonass", "imu_frame", "imu_stream", "lnav", "navmsg", "nmea", "novatel_imu", "receiver", "rtcm3",
             "rtcm3_legacy", "rtcm3_msm", "rtcm3_msm_encode", "ubx_pvt", "ubx_rawx"},
}
CONVERSIONS_ONLY = {("filter", "update")}           # a check for infinity
FLOATS_ONLY = {("gnss", "whiten"), ("navigator", "config")}

ARITHMETIC = re.compile(r"__aeabi_(d(add|sub|rsub|mul|div)|dcmp\w+|cdcmp\w+)$|__(add|sub|mul|div)df3$|__(eq|ne|lt|le|gt|ge|unord)df2$")
CONVERSION = re.compile(r"__aeabi_(d2\w+|\w+2d)$|__\w*df\w*$")
HARDWARE_HAS_NOT = re.compile(r"__aeabi_(d2u?lz|u?l2d)$|__fix(uns)?dfdi$|__float(un)?didf$")


def kind(symbol):
    """'arithmetic', 'conversion' or None for a name that is no soft double."""
    if ARITHMETIC.match(symbol):
        return "arithmetic"
    return "conversion" if CONVERSION.match(symbol) else None


def unexpected(image, build, hard):
    """Lines of what should not be there; hard: the FPU has doubles, all but its conversions from and to 64 bits."""
    bad = []
    for archive in sorted((build / "firmware").glob("libpel_*.a")):
        room, member = archive.stem[len("libpel_"):], ""
        for line in image.run("nm", archive).splitlines():
            head = re.match(r"(\w+)\.c\.obj:", line)
            if head:
                member = head[1]
            wanted = re.match(r"\s+U (\S+)", line)
            if not wanted or not kind(wanted[1]):
                continue
            if not (HARDWARE_HAS_NOT.match(wanted[1]) if hard else _may(room, member, kind(wanted[1]))):
                bad.append(f"{room}/{member}.c uses {wanted[1]}")
    return bad


def _may(room, member, what):
    if (room, member) in FLOATS_ONLY:
        return False
    if (room, member) in CONVERSIONS_ONLY:
        return what == "conversion"
    return room in ROOMS or member in OBJECTS.get(room, ())
