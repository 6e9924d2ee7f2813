"""RTKLIB (Debian package rtklib) on the same recordings."""

import gzip
import shutil
import subprocess
from pathlib import Path

import numpy as np

from pelorus_tools import gpstime
from replay import tracks


def available():
    return shutil.which("rnx2rtkp") is not None and shutil.which("convbin") is not None


def plain(path, work):
    """The file itself, or its unpacked copy in the work folder."""
    path = Path(path)
    if path.suffix != ".gz":
        return path
    copy = Path(work) / path.stem
    copy.write_bytes(gzip.decompress(path.read_bytes()))
    return copy


def convert(path, work, form, *more):
    """Raw receiver bytes -> (observations, navigation) RINEX files."""
    raw = plain(path, work)
    obs, nav = Path(work) / f"{raw.stem}.peer.obs", Path(work) / f"{raw.stem}.peer.nav"
    subprocess.run(["convbin", "-r", form, *more, "-o", obs, "-n", nav, raw], capture_output=True, check=True)
    return obs, nav


def epoch_ns(line, modern):
    w = (line[1:29] if modern else line[:26]).split()
    return gpstime.from_calendar(int(w[0]) + (0 if modern else 2000), *map(int, w[1:5]), float(w[5]))


def without(obs, work, removed_ns, within_ns=300_000_000):
    """A copy of RINEX observations (2 or 3) without the epochs at these GPS times."""
    lines = Path(obs).read_text(errors="replace").splitlines(keepends=True)
    end = next(i for i, line in enumerate(lines) if "END OF HEADER" in line) + 1
    modern = lines[0].strip().startswith("3")
    n_types = next((int(line[:6]) for line in lines[:end] if "# / TYPES OF OBSERV" in line), 0)
    kept, i = lines[:end], end
    while i < len(lines):
        flag, n_sats = (int(lines[i][a:b]) for a, b in (((31, 32), (32, 35)) if modern else ((28, 29), (29, 32))))
        special = flag > 1  # that many lines of another kind
        n = 1 + n_sats if modern or special else 1 + (n_sats - 1) // 12 + n_sats * ((n_types + 4) // 5)
        if special or np.min(np.abs(removed_ns - epoch_ns(lines[i], modern)), initial=within_ns) >= within_ns:
            kept += lines[i:i + n]
        i += n
    copy = Path(work) / "gap.peer.obs"
    copy.write_text("".join(kept))
    return copy


def solve(work, mode, options, rover, *files, removed_ns=()):
    """rnx2rtkp; mode 0 single, 2 kinematic, 3 static. removed_ns: epochs that the rover loses."""
    out = Path(work) / "peer.pos"
    files = (without(rover, work, np.asarray(removed_ns)) if len(removed_ns) else rover, *files)
    subprocess.run(["rnx2rtkp", "-p", str(mode), *map(str, options), "-o", out, *map(str, files)], capture_output=True, check=True)
    return tracks.peers(out)
