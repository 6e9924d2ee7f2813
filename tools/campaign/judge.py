"""Pooled figures against the table: what is said of a case, and what is wrong with it."""

import math

from scipy.stats import chi2

GROUPS = ("attitude", "velocity", "position")
UNIT = {"attitude": "arc seconds", "velocity": "m/s", "position": "m"}
DIGITS = {"attitude": 2, "velocity": 4, "position": 4}
BAND = 0.99             # NEES over seeds
FEW = 6                 # seeds: their mean NEES says little
CHANCE = 1e-3           # of a quick run's rms to miss what its few seeds allow


def nees_band(seeds):
    """Limits of the mean of NEES (3 components) over seeds."""
    tail = 0.5 * (1.0 - BAND)
    return tuple(chi2.ppf([tail, 1.0 - tail], 3 * seeds) / seeds)


def ratio_band(seeds):
    """Limits of rms over sigma when errors of one flight are as good as one number."""
    return tuple(math.sqrt(x / seeds) for x in chi2.ppf([0.5 * CHANCE, 1.0 - 0.5 * CHANCE], seeds))


def at_the_end(case, found):
    """Cases whose sigma is wide on purpose: rms against the bounds, and what is left when they end."""
    out = []
    for group in GROUPS:
        for i, bound in enumerate(case["bound"].get(group, [])):
            if found[group]["rms"][i] > bound:
                out.append(f"{group} {('east', 'north', 'up')[i]} {found[group]['rms'][i]:.4g} {UNIT[group]}, bound {bound:g}")
    if found["end_h_m"] > case.get("end_m", math.inf):
        out.append(f"{found['end_h_m']:.2f} m at the end, bound {case['end_m']:g} m")
    least, most = (0.0, case["nees_h"][1] * chi2.ppf(BAND, 2) / 2) if found["seeds"] < FEW else case["nees_h"]
    if not least <= found["end_nees_h"] <= most:
        out.append(f"half of the horizontal NEES at the end {found['end_nees_h']:.2f}, limits {least:.2f} and {most:.2f}")
    return out


def complaints(case, found, quick=False):
    """[] if the case is as it must be. Few seeds: sigma is within the bound and errors are as large as sigma says."""
    if "nees_h" in case:
        return at_the_end(case, found)
    out = []
    low, high = ratio_band(found["seeds"]) if quick else case["ratio"]
    for group in GROUPS:
        f = found[group]
        for i, bound in enumerate(case["bound"].get(group, [])):
            value, ratio = f["sigma" if quick else "rms"][i], f["rms"][i] / f["sigma"][i]
            axis = ("east", "north", "up")[i]
            if value > bound:
                out.append(f"{group} {axis} {value:.4g} {UNIT[group]}, bound {bound:g}")
            if not low <= ratio <= high:
                out.append(f"{group} {axis} is {ratio:.2f} of its sigma, limits {low:.2f} and {high:.2f}")
        least, most = nees_band(found["seeds"])
        if not least <= f["nees"] <= most:
            out.append(f"NEES of {group} {f['nees']:.2f}, limits {least:.2f} and {most:.2f}")
    if found["wrong"]:
        out.append(f"{found['wrong']} wrong fixes")
    if found["first_fix_s"] > case.get("fixed_by_s", math.inf):
        out.append(f"a flight is fixed after {found['first_fix_s']:.0f} s, bound {case['fixed_by_s']} s")
    return out


def three(values, digits):
    return " ".join(f"{v:.{digits}f}" for v in values)


def published(case, which, group):
    return " ".join("-" if math.isnan(v) else f"{v:g}" for v in case.get(which, {}).get(group, [])) or "-"


def title(case):
    return f"**{case['system']}, {case['name']}**"


def words(case, found):
    """The case as a table of a page."""
    low, high = case["window_s"]
    least, most = nees_band(found["seeds"])
    out = [f"{title(case)} (`{case['scenario']}`, {found['seeds']} seeds, {low} to {high} s; east, north, up)", "",
           "| | attitude, arc seconds | velocity, m/s | position, m |", "|---|---|---|---|"]
    row = lambda name, cells: out.append(f"| {name} | " + " | ".join(cells) + " |")
    if "paper" in case:
        row("paper", (published(case, "paper", g) for g in GROUPS))
    row("bound", (published(case, "bound", g) for g in GROUPS))
    row("rms", (three(found[g]["rms"], DIGITS[g]) for g in GROUPS))
    row("rms / sigma", (three(found[g]["rms"] / found[g]["sigma"], 2) for g in GROUPS))
    row(f"NEES of 3, {least:.2f} to {most:.2f}", (f"{found[g]['nees']:.2f}" for g in GROUPS))
    if "nees_h" in case:
        paper = f" (paper {case['paper_end_m']:g} m)" if "paper_end_m" in case else ""
        out += ["", f"At the end {found['end_h_m']:.2f} m rms horizontally{paper}, half of its NEES {found['end_nees_h']:.2f}."]
    out += ["", fixes(found) + f"Innovations: {found['nis']:.3f} of what was predicted.", ""]
    return "\n".join(out)


def fixes(found):
    if not found["fixed"]:
        return ""
    return (f"Integers: {found['fixed']} of {found['epochs']} epochs fixed, the last flight from {found['first_fix_s']:.0f} s on, "
            f"{found['wrong']} wrong. ")
