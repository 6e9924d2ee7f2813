"""Seeds of the fuzz targets: short pieces of recordings, of a simulated minute and of what our encoders write.

    python tests/fuzz/make_corpus.py [--data DIR] [--bin DIR] [--found build/fuzz]

Writes tests/fuzz/corpus/<target>/. Without the recordings (PELORUS_DATA) only what is made here is written anew."""

import argparse
import gzip
import os
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
CORPUS = HERE / "corpus"

SCENARIO = "static_base_rover"


def put(target, name, data):
    folder = CORPUS / target
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_bytes(data)


def frames(data):
    """Whole frames of a stream in order: (kind, key, bytes); checksums are not looked at."""
    at = 0
    while at + 6 < len(data):
        n = 0
        if data[at:at + 2] == b"\xb5\x62":
            n = 8 + struct.unpack_from("<H", data, at + 4)[0]
            kind = ("ubx", data[at + 2] << 8 | data[at + 3])
        elif data[at] == 0xD3 and data[at + 1] < 4:
            n = 6 + (struct.unpack_from(">H", data, at + 1)[0] & 0x3FF)
            kind = ("rtcm3", struct.unpack_from(">H", data, at + 3)[0] >> 4)
        elif data[at:at + 2] == b"PL":
            n = 9 + struct.unpack_from("<H", data, at + 4)[0]
            kind = ("pelorus", data[at + 2])
        elif data[at:at + 3] == b"\xaa\x44\x13":
            n = 16 + data[at + 3]
            kind = ("novatel", struct.unpack_from("<H", data, at + 4)[0])
        if n == 0 or at + n > len(data):
            at += 1
            continue
        yield (*kind, data[at:at + n])
        at += n


UBX_TARGETS = {0x0215: "ubx_rawx", 0x0213: "ubx_sfrbx", 0x0107: "ubx_pvt"}


def rtcm3_target(number):
    if number in (1019, 1020, 1042, 1044, 1045, 1046):
        return "rtcm3_ephemeris"
    return "rtcm3_msm" if 1071 <= number <= 1137 else "rtcm3_legacy"


class Seeds:
    """A few frames of each message: alone as payload records, together as a stream."""

    def __init__(self):
        self.records = {}
        self.stream = b""

    def take(self, data, each, most=1000):
        for kind, key, frame in frames(data):
            target = UBX_TARGETS.get(key) if kind == "ubx" else rtcm3_target(key) if kind == "rtcm3" else None
            payload = frame[6:-2] if kind == "ubx" else frame[3:-3]
            if target is None or len(payload) > most:
                continue
            kept = self.records.setdefault((target, key), [])
            if len(kept) < each:
                kept.append(payload)
                if len(self.stream) < 6000:
                    self.stream += frame

    def write(self, name):
        for (target, key), payloads in self.records.items():
            body = b"\x01"
            for p in payloads:
                p = p + b"\x00" * (-len(p) % 4)
                body += bytes([len(p) // 4]) + p
            put(target, f"{name}-{key:04x}" if key > 0x100 and target.startswith("ubx") else f"{name}-{key}", body)
        if self.stream:
            put("receiver", name, self.stream)
            put("raw", name, b"\x00" + self.stream[:4000])


def read(path):
    data = path.read_bytes()
    return gzip.decompress(data) if path.suffix == ".gz" else data


def recordings(data):
    """A few hundred bytes of each kind from recordings of real receivers."""
    chosen = {"f9p": ("gpsd-logs/ublox-zed-f9p-hp.log", 2), "glonass": ("gpsd-logs/ublox-glo.log", 4),
              "f9t": ("gpsd-logs/ublox-zed-f9t-rtcm3.log", 2), "msm": ("gpsd-logs/rtcm3.2.log", 2),
              "legacy": ("gpsd-logs/rtcm3.bndm.log", 2), "m8t": ("gpsd-logs/ublox-ned-m8t-sbfrx3.log", 6),
              "galway": ("galway-walk-20181009/rover-20181009-1221.ubx.gz", 6)}
    for name, (path, each) in chosen.items():
        if not (data / path).exists():
            print(f"make_corpus: {path} is not there", file=sys.stderr)
            continue
        seeds = Seeds()
        seeds.take(read(data / path)[:400000], each)
        seeds.write(name)
    text = {"rinex_obs": [("geonet", "geonet-0759-3040/07590920.05o"), ("fujisawa", "fujisawa-car-2021265/SEPT265G.21O.gz")],
            "rinex_nav": [("geonet", "geonet-0759-3040/07590920.05n"), ("mixed", "fujisawa-car-2021265/SEPT2650.21P.gz"),
                          ("hongkong", "hongkong-urban-2019/hksc1180.19n.gz")]}
    for target, files in text.items():
        for name, path in files:
            if (data / path).exists():
                put(target, name, shorten_rinex(read(data / path).decode("latin-1"), 5000))


def shorten_rinex(text, most):
    """The header without comments, and whole lines of the body."""
    head, _, body = text.partition("END OF HEADER")
    head = "\n".join(line for line in head.split("\n") if "COMMENT" not in line)
    body = body[:max(most - len(head), 2000)]
    return (head + "END OF HEADER" + body[:body.rfind("\n") + 1]).encode("latin-1")


def simulated(binaries):
    """What the simulator sends and the firmware answers in its first seconds."""
    from pelorus_tools import eventlog
    with tempfile.TemporaryDirectory() as folder:
        capture, out = Path(folder) / "capture", Path(folder) / "out"
        subprocess.run([binaries / "pelorus-sim", ROOT / f"scenarios/{SCENARIO}.toml", "-q", "--duration", "40", "-o", capture], check=True)
        subprocess.run([binaries / "pelorus-sil", capture, "-q", "-o", out], check=True)
        lines = {}
        for path in (capture, out):
            for _, channel, data in eventlog.events(eventlog.open_bytes(path)):
                lines.setdefault(channel.decode(), bytearray()).extend(data)
    for channel in ("UART_ROVER", "UART_BASE"):
        seeds = Seeds()
        seeds.take(bytes(lines.get(channel, b""))[:400000], 2)
        seeds.write("sim-" + channel[5:].lower())
    kinds = {}
    for kind, key, frame in frames(bytes(lines.get("UART_OUT", b""))[:400000]):
        if kind == "pelorus" and len(kinds.setdefault(key, [])) < 2:
            kinds[key].append(frame)
    for key, kept in kinds.items():
        put("out", f"sim-{key:02x}", b"".join(kept))


def written():
    """Streams and texts made here."""
    def crc24q(data):
        crc = 0
        for byte in data:
            crc ^= byte << 16
            for _ in range(8):
                crc = (crc << 1) ^ (0x1864CFB if crc & 0x800000 else 0)
        return struct.pack(">I", crc & 0xFFFFFF)[1:]

    def pelorus(ident, payload):
        head = struct.pack("<BBH", ident, 1, len(payload))
        return b"PL" + head + payload + crc24q(head + payload)

    t0 = 1300000000 * 10**9
    stream = b""
    for i in range(1, 9):
        stream += pelorus(1, struct.pack("<qIHH6i", t0 + i * 10**7, 10**7, i, 0, 100, -50, 20, 3, 4, 13000000))
    stream += pelorus(2, struct.pack("<qI", t0 + 5 * 10**7, 7))
    put("imu", "pelorus", stream)
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "raw"
        subprocess.run([ROOT / "build/host/tests/peers/peer_wire", "rawimusx", out], check=True, stdout=subprocess.DEVNULL)
        put("imu", "novatel", out.read_bytes()[:56 * 8])

    rows = "".join(f"{1300000000 + 0.01 * i:.3f},0.1,-0.2,9.8,0.001,0.002,-0.003\n" for i in range(12))
    put("imu_csv", "gps-time", b"\x00m/s2,rad" + ("gpst_s,ax,ay,az,gx,gy,gz\n" + rows).encode())
    put("imu_csv", "own-clock", b"\x02g,deg/s " + "".join(f"0.01,0.02,1.0,0.1,0.2,0.3,{1000 + 10 * i}\n" for i in range(12)).encode())
    put("obs_csv", "week", b"week,tow_s,sys,prn,pseudorange_m,range_rate_mps,cn0_dbhz\n" + b"".join(
        b"2130,36450%d.600088,G,%d,219713%02d.8,-334.5,40\n" % (t, g, g) for t in range(3) for g in (5, 12, 20)))
    put("obs_csv", "names", b"gpst_s;sat;doppler_hz;pseudorange_m\n1300000000.2;C06;-100.5;4.0e7\n1300000000.2;E36;7;2.4e7\n")
    put("problem", "three", b"3\n1.2 -0.4 5.9\n0.1\n0.02 0.1\n0.01 0.03 0.2\n# truth\n1 0 6\n2\n0.1 0.2\n1 0.5\n0.5 1\n")
    put("problem", "full", b"# four\n4\n5.45\n3.1\n2.97\n1.5\n6.29 5.978 0.544 1\n5.978 6.292 2.34 1\n0.544 2.34 6.288 1\n1 1 1 5\n")
    put("config", "navigator", CONFIG)
    put("config", "scenario", (ROOT / "scenarios/s5_flight.toml").read_bytes()[:3000])


CONFIG = b"""[navigator]
preset = "ins-rtk"
output_hz = 20
mask_deg = 12.5
systems = ["gps", "galileo"]
carriers = ["L1", "L2", "E5b"]
[navigator.imu]
model = "custom"
arw_deg_rth = 0.3
gyro_tau_s = 300
[navigator.mount]
lever_arm_m = [0.1, -0.2, 1.5]
yaw_deg = 90
[navigator.start]
attitude_deg = [0, 1.5, 270]
[navigator.gnss]
code_m = 0.5
elevation_law = false
ionosphere = "none"
base_wait_s = 0.2
[navigator.integers]
enable = true
ratio_min = 2.5
node_budget = 5000
"""


def found(build, most=120):
    """Of what fuzzing has found, the smallest inputs that together reach most: the navigator's scripts cannot be written by hand."""
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([build / "tests/fuzz/fuzz_navigator", "-set_cover_merge=1", "-max_len=64", folder,
                        build / "corpus/navigator"], check=True, capture_output=True)
        inputs = sorted(Path(folder).iterdir(), key=lambda f: f.stat().st_size)
        for f in inputs[:most]:
            put("navigator", f.name[:12], f.read_bytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--data", type=Path, default=Path(os.environ.get("PELORUS_DATA", "")))
    parser.add_argument("--bin", type=Path, default=ROOT / "build/bin")
    parser.add_argument("--found", type=Path, help="build/fuzz: keep the best of what the navigator's target has found there")
    a = parser.parse_args()
    if a.found:
        found(a.found)
    CORPUS.mkdir(exist_ok=True)
    written()
    simulated(a.bin)
    if str(a.data) not in ("", "."):
        recordings(a.data)
    size = sum(f.stat().st_size for f in CORPUS.rglob("*") if f.is_file())
    print(f"{sum(1 for f in CORPUS.rglob('*') if f.is_file())} seeds, {size / 1024:.0f} KiB")


if __name__ == "__main__":
    main()
