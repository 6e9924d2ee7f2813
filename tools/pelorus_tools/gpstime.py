"""GPS time (ns since 1980-01-06) and the clocks people read."""

import datetime

import numpy as np

GPS_EPOCH = datetime.datetime(1980, 1, 6)
NS = 1_000_000_000
UNIX_AT_GPS_EPOCH = 315_964_800

# The first instant (UTC) at which GPS - UTC is that many seconds.
LEAPS = [(1981, 7, 1), (1982, 7, 1), (1983, 7, 1), (1985, 7, 1), (1988, 1, 1), (1990, 1, 1), (1991, 1, 1), (1992, 7, 1),
         (1993, 7, 1), (1994, 7, 1), (1996, 1, 1), (1997, 7, 1), (1999, 1, 1), (2006, 1, 1), (2009, 1, 1), (2012, 7, 1),
         (2015, 7, 1), (2017, 1, 1)]
_LEAP_NS = np.array([(int((datetime.datetime(*d) - GPS_EPOCH).total_seconds()) + n) * NS for n, d in enumerate(LEAPS, 1)])


def leap_s(t_ns):
    """GPS - UTC at GPS time(s) t."""
    return np.searchsorted(_LEAP_NS, t_ns, side="right")


def from_calendar(year, month, day, hour, minute, second):
    """Calendar date read on a GPS clock -> ns; second may be a float and is kept to the nanosecond."""
    whole = datetime.datetime(year, month, day, hour, minute) - GPS_EPOCH
    return int(whole.total_seconds()) * NS + round(second * NS)


def to_utc(t_ns):
    """UTC date and time to the microsecond."""
    us = (int(t_ns) + 500) // 1000
    return GPS_EPOCH + datetime.timedelta(microseconds=us) - datetime.timedelta(seconds=int(leap_s(t_ns)))


def text(t_ns, digits=1):
    """'2024-06-24 08:20:00.0 GPST', seconds cut (not rounded) to 1 to 6 digits."""
    d = GPS_EPOCH + datetime.timedelta(microseconds=int(t_ns) // 1000)
    return f"{d:%Y-%m-%d %H:%M:%S}.{d.microsecond:06d}"[:20 + digits] + " GPST"


def seconds_text(t_ns):
    """Seconds of GPS time with nine decimals, exact."""
    return f"{t_ns // NS}.{t_ns % NS:09d}"
