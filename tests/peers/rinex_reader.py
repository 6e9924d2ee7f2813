"""RINEX 2 and 3 observation and navigation files, read into plain dictionaries. Shares no code with the library under test."""
import gzip
from datetime import datetime
from pathlib import Path

SYSTEMS = {"G": 0, "R": 1, "E": 2, "C": 3, "J": 4, "S": 5}
L1, L2, L5, E5B, E6, B1I, B3I = range(7)
CARRIERS = {
    "G": {"1": L1, "2": L2, "5": L5}, "J": {"1": L1, "2": L2, "5": L5, "6": E6},
    "E": {"1": L1, "5": L5, "7": E5B, "6": E6}, "C": {"2": B1I, "7": E5B, "6": B3I, "1": L1, "5": L5},
}
CODE, PHASE, DOPPLER, HALF, SLIP = 1, 2, 4, 8, 16
GPS_EPOCH = datetime(1980, 1, 6)
BDT_LAG_NS = 14 * 10**9
WEEK_S = 604800


def lines_of(path):
    data = Path(path).read_bytes()
    if str(path).endswith(".gz"):
        data = gzip.decompress(data)
    return data.decode("ascii", "replace").splitlines()


def gps_ns(year, month, day, hour, minute, second_text):
    whole, _, fraction = second_text.strip().partition(".")
    days = (datetime(year, month, day) - GPS_EPOCH).days
    return (days * 86400 + hour * 3600 + minute * 60 + int(whole)) * 10**9 + int(fraction.ljust(9, "0")[:9] or 0)


def full_year(two_digits):
    return two_digits + (2000 if two_digits < 80 else 1900)


def number(text):
    text = text.strip().replace("D", "e").replace("d", "e")
    return float(text) if text else 0.0


def fields(block, first_column, column):
    """Numbers of a navigation record, 19 wide: three on its first line, four on each other."""
    values = [number(block[0][c : c + 19]) for c in range(first_column, first_column + 57, 19)]
    for line in block[1:]:
        values += [number(line[c : c + 19]) for c in range(column, column + 76, 19)]
    return values


def ephemeris(system, prn, toc_ns, v):
    week, toe_s = int(v[21]), v[11]
    toe_ns = (week * WEEK_S * 10**9) + round(toe_s * 1e9)
    source, tgd = 0, (v[25], v[26])
    if system == "C":
        toe_ns += 1356 * WEEK_S * 10**9 + BDT_LAG_NS
        toc_ns += BDT_LAG_NS
    elif system == "E":
        source = 1 if int(v[20]) & 0x100 else 0
    else:
        tgd = (v[25], 0.0)
    return dict(sys=SYSTEMS[system], prn=prn, health=int(v[24]), source=source, iode=int(v[3]), ura=v[23], toe_ns=toe_ns, toc_ns=toc_ns,
                af0=v[0], af1=v[1], af2=v[2], crs=v[4], dn=v[5], M0=v[6], cuc=v[7], e=v[8], cus=v[9], sqrt_a=v[10], cic=v[12],
                Omega0=v[13], cis=v[14], i0=v[15], crc=v[16], omega=v[17], Omega_dot=v[18], idot=v[19], tgd0=tgd[0], tgd1=tgd[1])


def read_nav(path):
    """(list of ephemerides, Klobuchar parameters or None)."""
    lines = lines_of(path)
    version = float(lines[0][:9])
    alpha = beta = None
    at = 0
    while "END OF HEADER" not in lines[at]:
        line = lines[at]
        if line[60:].startswith("ION ALPHA") or line.startswith("GPSA"):
            c = 2 if version < 3 else 5
            alpha = [number(line[c + 12 * i : c + 12 * i + 12]) for i in range(4)]
        if line[60:].startswith("ION BETA") or line.startswith("GPSB"):
            c = 2 if version < 3 else 5
            beta = [number(line[c + 12 * i : c + 12 * i + 12]) for i in range(4)]
        at += 1
    at += 1
    found = []
    while at < len(lines):
        line = lines[at]
        if not line.strip():
            at += 1
            continue
        if version < 3:
            system, prn = "G", int(line[:2])
            t = line[3:22].split()
            toc = gps_ns(full_year(int(t[0])), *map(int, t[1:5]), t[5])
            block, at = lines[at : at + 8], at + 8
            found.append(ephemeris(system, prn, toc, fields(block, 22, 3)))
            continue
        system, prn = line[0], int(line[1:3])
        if system not in "GECJ":
            at += 1
            while at < len(lines) and lines[at].startswith("    "):
                at += 1
            continue
        t = line[4:23].split()
        toc = gps_ns(*map(int, t[:5]), t[5])
        block, at = lines[at : at + 8], at + 8
        found.append(ephemeris(system, prn, toc, fields(block, 23, 4)))
    return found, (alpha + beta if alpha and beta and any(alpha) else None)


def read_glonass(path):
    """State vectors of a RINEX 2 GLONASS file, or of the R records of a RINEX 3 one; times in GPS time."""
    lines = lines_of(path)
    v2 = float(lines[0][:9]) < 3
    lines = lines[next(i for i, line in enumerate(lines) if "END OF HEADER" in line) + 1 :]
    found = []
    for i, line in enumerate(lines):
        if line[:1] != "R" and not (v2 and line[:2].strip()):
            continue
        t = (line[3:22] if v2 else line[4:23]).split()
        year = full_year(int(t[0])) if v2 else int(t[0])
        utc = gps_ns(year, *map(int, t[1:5]), t[5])
        v = fields(lines[i : i + 4], 22 if v2 else 23, 3 if v2 else 4)
        e = dict(sys=1, prn=int(line[:2] if v2 else line[1:3]), health=int(v[6]), toe_ns=utc + leap_s(year, int(t[1])) * 10**9, af0=v[0], af1=v[1], k=int(v[10]))
        for axis, at in zip("xyz", (3, 7, 11)):
            e.update({axis: 1e3 * v[at], "v" + axis: 1e3 * v[at + 1], "a" + axis: 1e3 * v[at + 2]})
        found.append(e)
    return found


def leap_s(year, month):
    """GPS - UTC since 1999."""
    return 13 + sum((year, month) >= (y, m) for y, m in ((2006, 1), (2009, 1), (2012, 7), (2015, 7), (2017, 1)))


def blank(system, prn, carrier, code):
    return dict(sys=SYSTEMS[system], prn=prn, carrier=carrier, code=code, P=0.0, L=0.0, D=0.0, cn0=0.0, flags=0)


def put(obs, kind, field):
    value = number(field[:14])
    if value == 0.0:
        return
    if kind == "C":
        obs["P"], obs["flags"] = value, obs["flags"] | CODE
    elif kind == "L":
        lli = int(field[14:15].strip() or 0)
        obs["L"], obs["flags"] = value, obs["flags"] | PHASE | (SLIP if lli & 1 else 0) | (HALF if lli & 2 else 0)
    elif kind == "D":
        obs["D"], obs["flags"] = value, obs["flags"] | DOPPLER
    elif kind == "S":
        obs["cn0"] = value


def signals(system, prn, types, text):
    """Signals of one satellite from its concatenated 16-column fields."""
    found = {}
    for i, name in enumerate(types):
        field = text[16 * i : 16 * i + 16].ljust(16)
        band, code = name[1], name[2] if len(name) > 2 else {"C": "C", "P": "W"}.get(name[0])
        if system == "C" and band == "1" and code == "I":
            band = "2"  # RINEX 3.02 numbered B1I so
        carrier = CARRIERS.get(system, {}).get(band)
        if carrier is None:
            continue
        if len(name) == 2:  # RINEX 2: one signal a carrier; P1 beside C1 is left out
            if name == "P1" and "C1" in types:
                continue
            code = "C" if band == "1" else "W"
        obs = found.setdefault((carrier, code), blank(system, prn, carrier, code))
        put(obs, "C" if name[0] == "P" else name[0], field)
    return [o for o in found.values() if o["flags"]]


def read_obs(path):
    """(list of (t_ns, [signals]), approximate position of the header)."""
    lines = lines_of(path)
    version = float(lines[0][:9])
    types, position, at = {}, None, 0
    while "END OF HEADER" not in lines[at]:
        line = lines[at]
        label = line[60:].strip()
        if label == "APPROX POSITION XYZ":
            position = [float(x) for x in line[:60].split()]
        elif label == "# / TYPES OF OBSERV":
            types.setdefault("2", []).extend(line[6:60].split())
        elif label == "SYS / # / OBS TYPES":
            current = line[0] if line[0] != " " else current
            types.setdefault(current, []).extend(line[6:60].split())
        at += 1
    at += 1
    epochs = []
    while at < len(lines):
        if version >= 3:
            head = lines[at]
            t = head[2:29].split()
            count = int(head[32:35])
            if int(head[31]) > 1:
                at += 1 + count
                continue
            obs = []
            for line in lines[at + 1 : at + 1 + count]:
                system = line[0]
                obs += signals(system, int(line[1:3]), types.get(system, []), line[3:])
            at += 1 + count
            epochs.append((gps_ns(*map(int, t[:5]), t[5]), obs))
            continue
        head = lines[at]
        if not head.strip():
            at += 1
            continue
        count = int(head[29:32])
        if int(head[28]) > 1:
            at += 1 + count
            continue
        t = head[:26].split()
        ids = head[32:68]
        rows = (count + 11) // 12
        for extra in lines[at + 1 : at + rows]:
            ids += extra[32:68]
        at += rows
        names, obs = types["2"], []
        per_sat = (len(names) + 4) // 5
        for k in range(count):
            system = ids[3 * k] if ids[3 * k] != " " else "G"
            text = "".join(line[:80].ljust(80) for line in lines[at : at + per_sat])
            at += per_sat
            obs += signals(system, int(ids[3 * k + 1 : 3 * k + 3]), names, text)
        epochs.append((gps_ns(full_year(int(t[0])), *map(int, t[1:5]), t[5]), obs))
    return epochs, position
