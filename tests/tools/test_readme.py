"""The README's program is the file it names, compiles without a warning, and navigates."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import synth
from pelorus_tools import eventlog

ROOT = Path(__file__).resolve().parents[2]
README = (ROOT / "README.md").read_text()

DRIVER = r"""
#include <stdio.h>
#include "pelorus/solution.h"
void navigation_start(void);
void navigation_imu_byte(uint8_t byte);
void navigation_rover_byte(uint8_t byte);
const pel_solution_t *navigation_solution(void);
int main(void)
{
    const pel_solution_t *s;
    navigation_start();
    for (int port; (port = getchar()) != EOF;) {
        if (port == 'I') { navigation_imu_byte((uint8_t)getchar()); }
        else { navigation_rover_byte((uint8_t)getchar()); }
        if ((s = navigation_solution()) != NULL) { printf("%.9f %.9f %.3f %d\n", s->lat_rad, s->lon_rad, s->height_m, s->fix); }
    }
    return 0;
}
"""


def test_the_program_shown_is_the_file():
    shown = re.search(r"```c\n(.*?)```", README, re.S).group(1)
    assert shown == (ROOT / "firmware" / "examples" / "minimal.c").read_text()


def test_files_and_programs_it_names_exist():
    for page in [ROOT / "README.md", *sorted((ROOT / "docs").glob("**/*.md"))]:
        for path in re.findall(r"\]\(([\w./-]+)(?:#[\w-]+)?\)", page.read_text()):
            assert (page.parent / path).exists(), f"{page.name}: {path}"
    for verb in re.findall(r"`make (\w+)", README):
        assert re.search(rf"^{verb}:", (ROOT / "Makefile").read_text(), re.M), verb


@pytest.mark.skipif(shutil.which("gcc") is None or shutil.which("pelorus-sim") is None, reason="needs gcc and the programs")
def test_the_program_navigates(tmp_path):
    (tmp_path / "driver.c").write_text(DRIVER)
    sources = sorted((ROOT / "firmware" / "src").glob("*/*.c"))
    subprocess.run(["gcc", "-std=c11", "-O1", "-Wall", "-Wextra", "-Werror", "-I", ROOT / "firmware" / "include", "-o", tmp_path / "minimal",
                    ROOT / "firmware" / "examples" / "minimal.c", tmp_path / "driver.c", *sources], check=True, cwd=ROOT, env=os.environ)
    subprocess.run(["pelorus-sim", ROOT / "scenarios" / "car.toml", "-o", tmp_path / "car.log", "--duration", "70", "-q"], check=True)
    stream = bytearray()
    for _, channel, data in eventlog.events(eventlog.open_bytes(str(tmp_path / "car.log"))):
        if channel in (b"UART_IMU", b"UART_ROVER"):
            for byte in bytes(data):
                stream += bytes((channel[5], byte))
    out = subprocess.run([tmp_path / "minimal"], input=bytes(stream), capture_output=True, check=True).stdout.decode().splitlines()
    lat, lon, height, fix = map(float, out[-1].split())
    print(f"{len(out)} solutions, the last {lat:.6f} {lon:.6f} {height:.1f}")
    assert len(out) > 60 and fix == 1
    assert abs(lat - 0.84015) < 2e-4 and abs(lon - 0.20202) < 2e-4 and abs(height - 520) < 30


assert synth     # puts tools/ into the path
