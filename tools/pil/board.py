"""One board: its settings from hal/<board>/board.cmake, its programs, its emulator."""

import pathlib
import re
import shlex
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXIT = {98: "the board could not be brought up (tape or files refused)", 99: "the core took a fault"}


def names():
    return sorted(p.parent.name for p in (ROOT / "hal").glob("*/board.cmake"))


class Board:
    def __init__(self, name):
        self.name = name
        text = (ROOT / "hal" / name / "board.cmake").read_text()
        self.settings = {k: " ".join(v.split()) for k, v in re.findall(r"^set\((\w+)\s*([^)]*)\)", text, re.M)}
        self.build = ROOT / "build" / name
        self.sil = f"pelorus-sil-{name}" if self.settings.get("PEL_BOARD_DEFINITIONS") else "pelorus-sil"

    def elf(self, program):
        return self.build / "hal" / f"{program}-{self.name}.elf"

    def emulator(self, program, *more):
        return [*shlex.split(self.settings["PEL_BOARD_EMULATOR"]), "-display", "none", "-monitor", "none",
                "-semihosting-config", "enable=on,target=native", *more, "-kernel", str(self.elf(program))]

    def run(self, program, folder, timeout_s=900):
        """To its end, with files in `folder`; an instruction takes 1024 ns of the emulated time. None, or what went wrong."""
        command = self.emulator(program, "-serial", "null", "-icount", "shift=10,sleep=off")
        try:
            done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=timeout_s)
        except subprocess.TimeoutExpired:
            return f"did not end in {timeout_s} s"
        if done.returncode == 0:
            return None
        return EXIT.get(done.returncode, f"emulator ended with {done.returncode}: {done.stderr.strip()}")
