"""The room gnss/ behind a pipe (peer_gnss), and where the recordings are."""
import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def recording(*parts):
    base = Path(os.environ.get("PELORUS_DATA") or ROOT.parent / "shared" / "data")
    path = base.joinpath(*parts)
    if not path.exists():
        if os.environ.get("PELORUS_REQUIRE_DATA") == "1":
            pytest.fail(f"recording {'/'.join(parts)} is missing")
        pytest.skip(f"recording {'/'.join(parts)} is not here")
    return path


class Peer:
    def __init__(self):
        self.process = subprocess.Popen(["peer_gnss"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def tell(self, line):
        self.process.stdin.write(line + "\n")

    def read(self):
        return self.process.stdout.readline().split()

    def ask(self, line):
        self.tell(line)
        self.process.stdin.flush()
        return self.read()

    def ephemeris(self, e):
        names = "af0 af1 af2 sqrt_a e i0 Omega0 omega M0 dn Omega_dot idot cuc cus crc crs cic cis tgd0 tgd1".split()
        head = "N {sys} {prn} {health} {source} {iode} {ura:g} {toe_ns} {toc_ns}".format(**dict(e, health=e["health"] & 255))
        return int(self.ask(head + "".join(f" {e[n]!r}" for n in names))[1])

    def glonass(self, e):
        names = "af0 af1 k x vx ax y vy ay z vz az".split()
        return int(self.ask("R {prn} {health} {toe_ns}".format(**e) + "".join(f" {e[n]:.17g}" for n in names))[1])

    def klobuchar(self, k):
        if k:
            self.tell("K " + " ".join(map(repr, k)))

    def epoch(self, who, t_ns, signals, lock_ms=0):
        self.tell(f"E {who} {t_ns}")
        for o in signals:
            self.tell("O {sys} {prn} {carrier} {code} {P!r} {L!r} {D!r} {cn0!r} {lock} {flags}".format(**o, lock=lock_ms) + f" {o.get('k', 0)}")

    def solve(self, prior, mask_deg=10.0):
        a = self.ask(f"P {int(prior)} {mask_deg}")
        v = list(map(float, a[3:]))
        return dict(status=int(a[1]), t_ns=int(a[2]), r=v[0:3], v=v[3:6], clk=v[6], n=int(v[7]), excluded=int(v[8]),
                    has_velocity=bool(v[9]), rms=v[10], sd=v[11:14])

    def slips(self):
        a = self.ask("L")
        return dict(zip("lock half geometry_free doppler ins jumps".split(), map(int, a[1:7]))), a[7:]

    def differences(self, rover, base, age=0.0):
        n = int(self.ask("D " + " ".join(f"{x:.5f}" for x in [*rover, *base]) + f" {age}")[1])
        names = "sys prn carrier pivot half slip code phase rate lam var_code var_phase var_rate ux uy uz".split()
        return [dict(zip(names, [int(x) for x in a[:6]] + [float(x) for x in a[6:]])) for a in (self.read() for _ in range(n))]

    def close(self):
        self.process.stdin.close()
        self.process.wait(timeout=10)


@pytest.fixture
def peer():
    p = Peer()
    yield p
    p.close()
