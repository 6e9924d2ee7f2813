"""RTKLIB's decoders of single navigation messages (libRTKLib.so), fed with the words of SFRBX frames that are taken apart here."""
import ctypes
import os

import pytest


class Time(ctypes.Structure):
    _fields_ = [("time", ctypes.c_int64), ("sec", ctypes.c_double)]


class Eph(ctypes.Structure):
    _fields_ = (
        [(n, ctypes.c_int) for n in "sat iode iodc sva svh week code flag".split()]
        + [(n, Time) for n in "toe toc ttr".split()]
        + [(n, ctypes.c_double) for n in "A e i0 OMG0 omg M0 deln OMGd idot crc crs cuc cus cic cis toes fit f0 f1 f2".split()]
        + [("tgd", ctypes.c_double * 6), ("beyond", ctypes.c_double * 32)]  # the library's own is longer and is copied whole
    )


UNIX_OF_GPS = 315964800
NAMES = dict(af0="f0", af1="f1", af2="f2", e="e", i0="i0", Omega0="OMG0", omega="omg", M0="M0", dn="deln", Omega_dot="OMGd",
             idot="idot", cuc="cuc", cus="cus", crc="crc", crs="crs", cic="cic", cis="cis")


def library():
    try:
        return ctypes.CDLL("libRTKLib.so.1", mode=os.RTLD_LAZY)  # it leaves callbacks of its programs undefined
    except OSError:
        if os.environ.get("PELORUS_REQUIRE_DATA") == "1":
            pytest.fail("libRTKLib.so.1 is missing (Debian: librtklib1)")
        pytest.skip("libRTKLib.so.1 is not here (Debian: librtklib1)")


def sfrbx(path, gnss):
    """(svId, sigId, words) of each frame of one system; framing checked by its checksum."""
    data, at = path.read_bytes(), 0
    while True:
        at = data.find(b"\xb5\x62\x02\x13", at)
        if at < 0 or at + 8 > len(data):
            return
        n = int.from_bytes(data[at + 4 : at + 6], "little")
        p = data[at + 6 : at + 6 + n]
        a = b = 0
        for byte in data[at + 2 : at + 6 + n]:
            a = (a + byte) & 255
            b = (b + a) & 255
        if data[at + 6 + n : at + 8 + n] == bytes([a, b]) and p[0] == gnss:
            yield p[1], p[2], [int.from_bytes(p[8 + 4 * i : 12 + 4 * i], "little") for i in range(p[4])]
        at += 4


def galileo_words(path):
    """(svId, word type, 16 bytes) of nominal I/NAV pages."""
    for sv, sig, w in sfrbx(path, 2):
        if sig != 1 or len(w) != 8 or w[0] >> 30 != 0:
            continue
        even = int.from_bytes(b"".join(x.to_bytes(4, "big") for x in w[:4]), "big")
        odd = int.from_bytes(b"".join(x.to_bytes(4, "big") for x in w[4:]), "big")
        word = ((even >> 14) & ((1 << 112) - 1)) << 16 | (odd >> 110) & 0xFFFF
        yield sv, word >> 122, word.to_bytes(16, "big")


def galileo_ephemerides(path):
    """Every complete set that RTKLIB makes of the words."""
    lib, store = library(), {}
    for sv, kind, word in galileo_words(path):
        words = store.setdefault(sv, {})
        if 1 <= kind <= 5:
            words[kind] = word
        if len(words) == 5:
            e = Eph()
            if lib.decode_gal_inav(bytes(16) + b"".join(words[i] for i in range(1, 6)), ctypes.byref(e), None, None) == 1:
                row = {ours: getattr(e, theirs) for ours, theirs in NAMES.items()}
                row.update(sys=2, prn=sv, iode=e.iode, sqrt_a=e.A**0.5, tgd0=e.tgd[0], tgd1=e.tgd[1],
                           toe_ns=(e.toe.time - UNIX_OF_GPS) * 10**9 + round(e.toe.sec * 1e9),
                           toc_ns=(e.toc.time - UNIX_OF_GPS) * 10**9 + round(e.toc.sec * 1e9))
                yield row
                store[sv] = {}


def klobuchar(path):
    """Every page that RTKLIB takes ionosphere parameters from."""
    lib = library()
    for _, _, w in sfrbx(path, 0):
        bits = 0
        for x in w:
            bits = bits << 24 | (x >> 6) & 0xFFFFFF
        if (bits >> 194) & 7 == 4:  # subframe number: bits 20 to 22 of the second word
            ion, utc = (ctypes.c_double * 8)(), (ctypes.c_double * 8)()
            frame = bytes(90) + bits.to_bytes(30, "big") + bytes(30)  # subframe 4 of five
            if lib.decode_frame(frame, None, None, ion, utc) and any(ion):
                yield list(ion)
