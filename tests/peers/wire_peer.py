"""peer_wire's lines as dictionaries, convbin's RINEX of the same file, and how the two compare."""
import gzip
import shutil
import subprocess

import rinex_reader
from gnss_peer import recording

rinex_reader.CARRIERS.setdefault("R", {"1": rinex_reader.L1, "2": rinex_reader.L2})
rinex_reader.CARRIERS.setdefault("S", {"1": rinex_reader.L1, "5": rinex_reader.L5})

COUNTERS = "frames noise checksum length value unknown duplicate back gap overflow".split()
ORBIT = "af0 af1 af2 sqrt_a e i0 Omega0 omega M0 dn Omega_dot idot cuc cus crc crs cic cis tgd0 tgd1".split()
STATE = "af0 af1 tgd0 k x vx ax y vy ay z vz az".split()
WEEK_NS = 604800 * 10**9


class Decoded:
    def __init__(self):
        self.epochs, self.glonass, self.ephemerides, self.klobuchar, self.stations, self.pvt, self.counters = [], [], [], [], [], [], {}


def parse(text):
    d = Decoded()
    for line in text.splitlines():
        kind, *v = line.split()
        if kind == "E":
            d.epochs.append((int(v[0]), []))
        elif kind == "O":
            obs = dict(sys=int(v[0]), prn=int(v[1]), carrier=int(v[2]), code=v[3], P=float(v[4]), L=float(v[5]), D=float(v[6]),
                       cn0=float(v[7]), lock=int(v[8]), flags=int(v[9]), k=int(v[10]))
            d.epochs[-1][1].append(obs)
        elif kind == "N":
            e = dict(sys=int(v[0]), prn=int(v[1]), source=int(v[2]), health=int(v[3]), iode=int(v[4]), iodc=int(v[5]),
                     ura=float(v[6]), fit=float(v[7]), toe_ns=int(v[8]), toc_ns=int(v[9]))
            e.update(zip(ORBIT, map(float, v[10:])))
            d.ephemerides.append(e)
        elif kind == "R":
            e = dict(sys=1, prn=int(v[0]), health=int(v[1]), iode=int(v[2]), ura=float(v[3]), toe_ns=int(v[4]), toc_ns=int(v[5]))
            e.update(zip(STATE, map(float, v[6:])))
            d.glonass.append(e)
        elif kind == "K":
            d.klobuchar.append(list(map(float, v)))
        elif kind == "S":
            d.stations.append((int(v[0]), *map(float, v[1:])))
        elif kind == "V":
            d.pvt.append((int(v[0]), *map(float, v[1:])))
        elif kind == "C":
            d.counters = dict(zip(COUNTERS, map(int, v)))
    return d


def decode(path, gps_s=None):
    command = ["peer_wire", "decode", str(path)] + ([str(gps_s)] if gps_s else [])
    return parse(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def recode(path, fmt, out, gps_s=None):
    """Through our decoders and our encoders; returns what the encoders refused."""
    command = ["peer_wire", "recode", str(path), fmt, str(out)] + ([str(gps_s)] if gps_s else [])
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()


def unpacked(tmp, *parts):
    source = recording(*parts)
    target = tmp / (source.name[:-3] if source.suffix == ".gz" else source.name)
    if source.suffix == ".gz":
        with gzip.open(source) as f, open(target, "wb") as out:
            shutil.copyfileobj(f, out)
    else:
        shutil.copyfile(source, target)
    return target


def convbin(path, fmt, tmp, time=None):
    """(epochs, ephemerides) as RTKLIB's convbin reads the file. time: 'y/m/d h:m:s' for RTCM."""
    obs, nav = tmp / (path.name + ".obs"), tmp / (path.name + ".nav")
    command = ["convbin", "-r", fmt, "-v", "3.04", "-od", "-os", "-o", str(obs), "-n", str(nav)]
    command += ["-tr", *time.split()] if time else []
    subprocess.run(command + [str(path)], check=True, capture_output=True)
    epochs = rinex_reader.read_obs(obs)[0] if obs.exists() else []
    for _, signals in epochs:
        for o in signals:
            o["prn"] -= 19 if o["sys"] == rinex_reader.SYSTEMS["S"] else 0
    return epochs, (rinex_reader.read_nav(nav)[0] if nav.exists() else [])


def convbin_glonass(path, fmt, tmp, time=None):
    """GLONASS ephemerides as convbin reads the file."""
    nav = tmp / (path.name + ".glo")
    command = ["convbin", "-r", fmt, "-v", "2.11", "-o", "/dev/null", "-n", "/dev/null", "-g", str(nav)]
    command += ["-tr", *time.split()] if time else []
    subprocess.run(command + [str(path)], check=True, capture_output=True)
    return rinex_reader.read_glonass(nav) if nav.exists() else []


def key(o):
    """SBAS counts from PRN 120 here, RINEX from 100: see convbin()."""
    return o["sys"], o["prn"], o["carrier"], o["code"]


def match_epochs(ours, theirs, tolerance_ns=1000):
    """Pairs of epochs of the same time; RINEX has 100 ns."""
    pairs, i = [], 0
    for t, obs in theirs:
        while i < len(ours) and ours[i][0] < t - tolerance_ns:
            i += 1
        if i < len(ours) and abs(ours[i][0] - t) <= tolerance_ns:
            pairs.append((ours[i][1], obs))
    return pairs


def compare_signals(pairs, phase_block=None):
    """Worst differences in m, cycles, Hz over signals that both have, and how many only one has. phase_block: cycles of
    which whole multiples do not count."""
    worst = dict(P=0.0, L=0.0, D=0.0)
    counts = dict(both=0, missing=0, extra=0, only_theirs=0, P=0, L=0, D=0)
    for ours, theirs in pairs:
        a, b = {key(o): o for o in ours}, {key(o): o for o in theirs}
        counts["missing"] += len(b.keys() - a.keys())
        counts["extra"] += len(a.keys() - b.keys())
        for k in a.keys() & b.keys():
            counts["both"] += 1
            for name, bit in (("P", 1), ("L", 2), ("D", 4)):
                if b[k]["flags"] & bit and a[k]["flags"] & bit:
                    difference = a[k][name] - b[k][name]
                    if name == "L" and phase_block:
                        difference -= phase_block * round(difference / phase_block)
                    counts[name] += 1
                    worst[name] = max(worst[name], abs(difference))
                elif b[k]["flags"] & bit:
                    counts["only_theirs"] += 1
                elif a[k]["flags"] & bit:
                    counts["only_ours_" + name] = counts.get("only_ours_" + name, 0) + 1
    return worst, counts


def compare_ephemerides(ours, theirs, names=ORBIT, tolerance=6e-12):
    """(matched, not found, list of differences) of their sets among ours; RINEX has twelve digits."""
    index = {}
    for e in ours:
        index.setdefault((e["sys"], e["prn"], e["toe_ns"], e["iode"]), []).append(e)
    matched, lost, different = 0, [], []
    for e in theirs:
        candidates = index.get((e["sys"], e["prn"], e["toe_ns"], e["iode"]))
        if not candidates:
            lost.append((e["sys"], e["prn"], e["toe_ns"], e["iode"]))
            continue
        wrong = [[n for n in names + ["toc_ns"] if abs(c[n] - e[n]) > tolerance * max(abs(e[n]), 1e-30) + 1e-24] for c in candidates]
        if e["sys"] in (0, 3) and "ura" in e:  # the others' health has another layout in RINEX
            for c, w in zip(candidates, wrong):
                w += ["ura"] * (abs(c["ura"] - e["ura"]) > 0.06) + ["health"] * (c["health"] != e["health"])
        matched += 1
        if all(wrong):
            different.append((e["sys"], e["prn"], min(wrong, key=len)))
    return matched, lost, different
