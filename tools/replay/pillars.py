"""valencia-pillars-2016: L1 C/A code and phase of two calibration pillars, satellites given, three epochs; double differences formed here,
integers by the library (peer_integers)."""

import re
import subprocess
from dataclasses import dataclass

import numpy as np

LAMBDA = 299792458.0 / 1575.42e6
BASE = np.array([4929635.440, -29041.877, 4033567.846])
PILLAR = np.array([4929605.542, -29123.828, 4033603.932])
PUBLISHED = {"G10": 12, "G12": 35, "G13": -4, "G15": -4, "G17": 1, "G18": 11, "G19": 34}  # of G24 less the satellite, base less rover

SD_PHASE = 0.003  # m, as the file states it: variance sd^2 / sin(elevation)
SD_CODE = 0.3     # m, not stated; C/A of a geodetic receiver


@dataclass
class Epoch:
    sats: list          # the highest first
    direction: dict     # from the base
    code: dict          # rover less base, m
    phase: dict         # rover less base, m
    place: dict         # ECEF of the satellites
    sin_el: dict


def blocks(text):
    """Numbers by satellite, a dict a dated block, in the order of the file: base, rover, satellites."""
    out = []
    for line in text.splitlines():
        if re.match(r"(> )?2016 11 15 ", line):
            out.append({})
        elif (m := re.match(r"(G\d\d)\s+(.*\d)\s*$", line)) and out:
            out[-1][m[1]] = np.array([float(x) for x in m[2].split()])
    return [b for b in out if b]


def epochs(folder):
    all_blocks = blocks((folder / "GNSS_Data.txt").read_text(encoding="latin-1"))
    base, rover, places = all_blocks[0:3], all_blocks[3:6], all_blocks[6:9]
    out = []
    for b, r, place in zip(base, rover, places):
        direction = {s: (x - BASE) / np.linalg.norm(x - BASE) for s, x in place.items()}
        sin_el = {s: float(u @ BASE / np.linalg.norm(BASE)) for s, u in direction.items()}
        sats = sorted((s for s in place if s in b and s in r), key=lambda s: -sin_el[s])
        out.append(Epoch(sats, direction, {s: r[s][0] - b[s][0] for s in sats}, {s: LAMBDA * (r[s][1] - b[s][1]) for s in sats}, place, sin_el))
    return out


def predicted(e, s, r):
    """Double difference of the ranges for the rover at r."""
    def single(s):
        return np.linalg.norm(e.place[s] - r) - np.linalg.norm(e.place[s] - BASE)
    return single(s) - single(e.sats[0])


def from_code(e, sd_code):
    """Position from double differences of code alone, started at the base."""
    r, rest = BASE.copy(), e.sats[1:]
    var = np.array([2 * sd_code**2 / e.sin_el[s] for s in rest])
    W = np.linalg.inv(np.diag(var) + 2 * sd_code**2 / e.sin_el[e.sats[0]])
    for _ in range(4):
        G = np.array([e.direction[e.sats[0]] - e.direction[s] for s in rest])
        y = np.array([e.code[s] - e.code[e.sats[0]] - predicted(e, s, r) for s in rest])
        r = r + np.linalg.solve(G.T @ W @ G, G.T @ W @ y)
    return r


def problem(group, sd_phase, sd_code):
    """Lines for peer_integers: the mean of these epochs at the code's position of the first. Within the 2 s of this recording neither
    code nor phase errors are taken to average (code_residuals() shows why)."""
    e0 = group[0]
    r, pivot = from_code(e0, sd_code), e0.sats[0]
    lines = ["P 0" + " 0" * 9 + " 0", f"G 0 1 {2 * sd_phase**2 / e0.sin_el[pivot]!r} {2 * sd_code**2 / e0.sin_el[pivot]!r}"]
    for k, s in enumerate(e0.sats[1:], 1):
        g = e0.direction[pivot] - e0.direction[s]
        phase = np.mean([e.phase[s] - e.phase[pivot] - predicted(e, s, r) for e in group])
        code = np.mean([e.code[s] - e.code[pivot] - predicted(e, s, r) for e in group])
        numbers = [*g, LAMBDA, phase, code, 2 * sd_phase**2 / e0.sin_el[s], 2 * sd_code**2 / e0.sin_el[s]]
        lines.append(f"R 0 {k} 1 1 " + " ".join(repr(float(x)) for x in numbers))
    return lines, r


def solve(group, program, tries=1, failure_max=0.0, sd_phase=SD_PHASE, sd_code=SD_CODE):
    """Integers and verdict of some epochs together, by the default limits or by a promised failure rate in place of ratio and success; `right`: published integers of all seven, `off_m`: distance from the pillar."""
    lines, r = problem(group, sd_phase, sd_code)
    limits = [f"L 1 0 {failure_max!r}"] if failure_max else []
    out = subprocess.run([program], input="\n".join([*lines, *limits, f"S {tries}"]) + "\n", capture_output=True, text=True, check=True).stdout.split()
    v = [float(x) for x in out[1:]]
    rest = group[0].sats[1:]
    N = dict(zip(rest, (int(x) for x in out[17:])))
    return dict(status=int(v[0]), reason=int(v[1]), failed=int(v[2]), success=v[3], ratio=v[4], ratio_needed=v[5], chi2=v[6], chi2_max=v[7], dof=int(v[8]),
                accepted=int(v[0]) == 0 and int(v[1]) == 0, integers=N, n_right=sum(N[s] == PUBLISHED[s] for s in rest),
                right=all(N[s] == PUBLISHED[s] for s in rest), r=r + np.array(v[10:13]), sd_m=np.array(v[13:16]),
                off_m=float(np.linalg.norm(r + np.array(v[10:13]) - PILLAR)), code_off_m=float(np.linalg.norm(r - PILLAR)))


def code_residuals(every):
    """Double differences of code less those of the pillar, m: a row an epoch."""
    return np.array([[e.code[s] - e.code[e.sats[0]] - predicted(e, s, PILLAR) for s in e.sats[1:]] for e in every])


def figures(folder, program="peer_integers"):
    """Each epoch alone and all together, by the default limits and by 1 % promised. `right`: epochs whose best integers are the
    published ones, accepted or not; `wrong`: accepted although they are not."""
    every = epochs(folder)
    alone = [solve([e], program) for e in every]
    promised = [solve([e], program, failure_max=0.01) for e in every]
    return dict(epochs=len(every), fixed=sum(a["accepted"] for a in alone), fixed_promised=sum(a["accepted"] for a in promised),
                wrong=sum(a["accepted"] and not a["right"] for a in alone + promised), right=sum(a["right"] for a in alone),
                off_mm=[1e3 * a["off_m"] for a in alone], alone=alone, promised=promised, together=solve(every, program))
