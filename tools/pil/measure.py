"""What is counted for docs/SIZES.md: linked images, pieces of work on the emulated boards, a capture of full load."""

import os
import pathlib
import re
import subprocess
import tempfile

from firmware.callgraph import CallGraph
from firmware.image import Image
from pil import captures, cost
from pil.__main__ import replay
from pil.board import ROOT, Board
from pelorus_tools import frames

SECONDS = 20
LOAD = captures.simulated("scenarios/full_load.toml", SECONDS)
SMALL = ("PEL_MAX_OBS=32 PEL_MAX_SATS=16 PEL_MAX_EPH=16 PEL_MAX_AMB=24 PEL_MAX_STATES=24 PEL_MAX_TRACKED=32 PEL_IMU_RING=100 "
         "PEL_POSE_RING=32")  # 24 states, 2 x 32 signals, 0.5 s of a 200 Hz IMU: what the design's budget of RAM is for


class Linked:
    """The firmware of one board."""

    def __init__(self, name):
        board = Board(name)
        self.image = Image(board.elf("pelorus"))
        self.graph = CallGraph(self.image, board.build)
        self.rooms, self.board, self.compiler = self.image.code_by_room()
        self.library = sum(self.rooms.values())
        self.ram = self.image.variables()
        self.entries = self.graph.entries()
        self.deepest, self.path = self.graph.of("reset_handler")


class Load:
    """Costs on one board while it works on the capture of full load."""

    def __init__(self, name):
        with tempfile.TemporaryDirectory() as work:
            work = pathlib.Path(work)
            LOAD(work / "load.log", None)
            wrong, desktop = replay(Board(name), work / "load.log", work)
            if wrong:
                raise RuntimeError(f"{name}: {wrong}")
            self.cost = cost.load(work / "cost.bin")
        counters = frames.parse(desktop).counters[-1]["nav"]
        self.rows_an_epoch = counters["rows_used"] / counters["epochs_used"]
        self.epochs_a_second = counters["epochs_used"] / SECONDS
        self.imu_a_second = counters["imu_used"] / SECONDS
        counted = [self.cost.count[k] for k in ("imu step", "epoch", "row", "slice")]
        if not all(counted):
            raise RuntimeError(f"IMU steps, epochs, rows, slices counted: {counted}: do the names in hal/pil/cost.c still exist?")
        if self.imu_a_second < 195 or self.epochs_a_second < 19 or self.rows_an_epoch < 20:
            raise RuntimeError(f"not full load: {self.imu_a_second:.0f} IMU samples, {self.epochs_a_second:.1f} epochs of {self.rows_an_epoch:.1f} rows a second")

    def a_second(self, *kinds):
        return sum(self.cost.total[k] for k in kinds) / SECONDS

    def parts(self):
        """(what, instructions a second), which together are all of it."""
        inner = self.a_second("integers", "orbits")
        return [
            ("inertial, filter, rows, output", self.a_second("imu step", "epoch") - inner),
            ("integers: float, search, verdict", self.a_second("integers")),
            ("orbits, single-point solution, views", self.a_second("orbits")),
            ("decoding the receivers' bytes", self.a_second("receive")),
            ("decoding the IMU's bytes", self.a_second("imu byte")),
            ("encoding frames and sentences", self.a_second("report")),
            ("epochs and orbits taken in, polls", self.a_second("other")),
        ]


def navigator_bytes(sizes):
    """pel_navigator_t and pel_ud_t on a 32-bit core with these sizes."""
    source = '#include "pelorus/navigator.h"\nchar nav[sizeof(pel_navigator_t)]; char ud[sizeof(pel_ud_t)];'
    with tempfile.TemporaryDirectory() as work:
        subprocess.run(["arm-none-eabi-gcc", "-mthumb", "-mcpu=cortex-m4", "-I", ROOT / "firmware/include", *(f"-D{s}" for s in sizes.split()),
                        "-x", "c", "-c", "-o", f"{work}/size.o", "-"], input=source, text=True, check=True)
        out = subprocess.run(["arm-none-eabi-nm", "-S", f"{work}/size.o"], capture_output=True, text=True, check=True).stdout
    return tuple(int(re.search(rf"\w+ (\w+) \w {name}$", out, re.M)[1], 16) for name in ("nav", "ud"))


def pieces(core):
    """name -> instructions of make bench's cases on one core."""
    out = subprocess.run(["bash", ROOT / "tools/bench/target.sh", core, str(ROOT / "build/host")], capture_output=True, text=True, check=True)
    return {name: int(n) for name, n in re.findall(r"^(.+)\t(\d+)$", out.stdout + out.stderr, re.M)}


def compilers():
    def version(command):
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[0]
    return [version(["arm-none-eabi-gcc", "--version"]), version(["riscv64-unknown-elf-gcc", "--version"]),
            version(["qemu-system-arm", "--version"])]


def build(boards):
    env = dict(os.environ, JOBS=str(os.cpu_count()))
    subprocess.run(["bash", ROOT / "cmake/board.sh", *boards], check=True, stdout=subprocess.DEVNULL, env=env)
