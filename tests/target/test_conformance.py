"""hal/conformance.c on every emulated board: an integrator's own test, run on ours. The test plays the wire that joins OUT with the inputs."""

import pathlib
import re
import struct
import subprocess
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from pil import uart
from pil.board import Board, ROOT, names

# What each emulated board has none of. The STM32F405's flash, watchdog and captures are on the chip, not in the emulator.
MPS2 = {"store", "PPS", "event", "GPS time", "configuration"}
NONE = {
    "mps2-an386": MPS2,
    "mps2-an500": MPS2,
    "stm32f405": MPS2 | {"watchdog"},
    "rv32-virt": {"port IMU", "port BASE", "port AUX1", "PPS", "event", "GPS time", "configuration", "watchdog"},
}


def test_every_board_is_expected_here():
    assert set(names()) == set(NONE)


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    """What each board says; all at once, they mostly wait."""
    folder = tmp_path_factory.mktemp("conformance")      # here: the factory is not for several threads

    def run(name):
        (folder / name).mkdir()
        wires = uart.Wires(Board(name), "conformance", folder / name)
        try:
            return wires.loop(b"DONE\r\n", 90).decode("ascii", "replace")
        finally:
            wires.close()

    subprocess.run(["bash", ROOT / "cmake/board.sh", *names()], check=True, capture_output=True)
    with ThreadPoolExecutor() as pool:
        return dict(zip(names(), pool.map(run, names())))


@pytest.mark.parametrize("name", names())
def test_the_board_keeps_the_contract_of_hal_h(name, said):
    said = said[name]
    lines = re.findall(r"^(PASS|FAIL|NONE) ([^:]*): (.*)\r$", said, re.M)
    assert said.endswith("DONE\r\n"), said
    assert [line for line in lines if line[0] == "FAIL"] == []
    assert {what for verdict, what, _ in lines if verdict == "NONE"} == NONE[name]
    assert len(lines) >= 14, said


def test_the_arithmetic_of_the_contract_is_numpys():
    """The hash that conformance.c expects, from sums, products, quotients, roots and conversions of another program."""
    text = pathlib.Path(ROOT / "hal/conformance.c").read_text()
    pairs, expected = int(re.search(r"#define PAIRS +(\d+)", text)[1]), int(re.search(r"#define ARITHMETIC_HASH (\w+)u", text)[1], 16)
    state, h = 88172645463325252, 2166136261

    def random_bits():
        nonlocal state
        state ^= state << 13 & (1 << 64) - 1
        state ^= state >> 7
        state ^= state << 17 & (1 << 64) - 1
        return state

    def random_double():
        r, fraction = random_bits(), random_bits() & 0xFFFFFFFFFFFFF
        if r & 7 == 0:
            fraction &= 0xFFFFFFFF00000
        return struct.unpack("<d", struct.pack("<Q", r & 1 << 63 | (1023 - 40 + (r >> 8) % 81) << 52 | fraction))[0]

    for _ in range(pairs):
        a, b = random_double(), random_double()
        x, y = np.float32(a), np.float32(b)
        for value in (a + b, a - b, a * b, a / b, np.sqrt(abs(a)), x + y, x * y - x, x / y, np.sqrt(abs(x)), int(a)):
            for byte in struct.pack("<d", float(value)):
                h = (h ^ byte) * 16777619 & 0xFFFFFFFF
    assert h == expected
