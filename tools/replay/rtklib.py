"""RTKLIB (Debian package rtklib) on the same recordings."""

import gzip
import shutil
import subprocess
from pathlib import Path

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


def solve(work, mode, options, *files):
    """rnx2rtkp; mode 0 single, 2 kinematic, 3 static."""
    out = Path(work) / "peer.pos"
    subprocess.run(["rnx2rtkp", "-p", str(mode), *map(str, options), "-o", out, *map(str, files)], capture_output=True, check=True)
    return tracks.peers(out)
