"""docs/SIZES.md is true, and what holds firmware to its promises fails when it must."""

import re
import subprocess
import sys

import pytest
from pil import sizes
from pil.board import ROOT, Board, names

BOARD = "mps2-an386"
FLAGS = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16", "-O2", "-fcallgraph-info=su", "-ffunction-sections",
         "-nostartfiles", "-Wl,--gc-sections", "-Wl,--emit-relocs", "-Wl,-Map=planted.elf.map", "-T", ROOT / "hal/mps2/mps2.ld"]


def test_the_page_is_true_and_no_budget_newly_missed():
    done = subprocess.run([sys.executable, "-m", "pil.sizes", "--check"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_number_that_moved_makes_the_page_stale():
    page = ["| wire | 31252 | 30492 |", "Deepest: `a` 100 > `b` 20."]
    assert sizes.stale(page, ["| wire | 31300 | 30492 |", page[1]]) == []
    assert sizes.stale(page, ["| wire | 34000 | 30492 |", page[1]]) != []
    assert sizes.stale(page, [page[0], "Deepest: `a` 100 > `c` 20."]) != []


@pytest.mark.parametrize("board", names())
def test_every_board_links_firmware_that_holds_its_promises(board):
    done = subprocess.run(["bash", ROOT / "cmake/firmware.sh", board], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_known_miss_may_neither_grow_nor_outlive_itself():
    what, (most, _) = next(iter(sizes.KNOWN_MISSES.items()))
    limit = most // 2
    assert sizes.wrong([(what, most, limit), ("another", limit, limit)]) == []
    assert "known up to" in sizes.wrong([(what, most + 1, limit)])[0]
    assert "take it out" in sizes.wrong([(what, limit, limit)])[0]
    assert "budget missed: another" in sizes.wrong([("another", limit + 1, limit)])[0]


def report(folder, source, *flags):
    """The report on a firmware of one file; its name is the board's, its start is the linker script's."""
    (folder / "planted.c").write_text("void __attribute__((noipa)) firmware_main(void);\nvoid reset_handler(void) { firmware_main(); }\n" + source)
    subprocess.run(["arm-none-eabi-gcc", *FLAGS, *flags, "planted.c", "-o", "planted.elf"], cwd=folder, check=True)
    return subprocess.run([sys.executable, "-m", "firmware.report", BOARD, folder / "planted.elf", folder], capture_output=True, text=True,
                          check=False, cwd=ROOT)


PLANTED = {
    "recursion: the stack has no bound": """
        volatile int x;
        static int __attribute__((noinline)) odd(int n);
        static int __attribute__((noinline)) even(int n) { return n == 0 ? x : odd(n - 1) + x; }
        static int odd(int n) { return n == 0 ? 1 : even(n - 1) + x; }
        void firmware_main(void) { x = even(x); }""",
    "a heap is linked": """
        #include <stddef.h>
        void __attribute__((noipa)) *malloc(size_t n); static char pool[64];
        void *malloc(size_t n) { return &pool[n]; }
        volatile void *x; volatile size_t n;
        void firmware_main(void) { x = malloc(n); }""",
    "frames of variable size": """
        volatile int n;
        static void __attribute__((noinline)) fill(volatile char *p, int k) { while (k > 0) { p[--k] = 1; } }
        void firmware_main(void) { char a[n]; fill(a, n); }""",
    "a call through a pointer to nowhere known": """
        void firmware_main(void) { (*(void (*volatile *)(void))0x20001000)(); }""",
    "an entry point takes more stack than the design allows": """
        volatile char sink;
        void __attribute__((noipa)) pel_deep(void);
        static void __attribute__((noinline)) fill(volatile char *p) { p[0] = sink; }
        void pel_deep(void) { char a[6200]; fill(a); sink = a[6199]; }
        void firmware_main(void) { pel_deep(); }""",
    "the stack is too small": """
        volatile char sink;
        static void __attribute__((noinline)) fill(volatile char *p) { p[0] = sink; }
        void firmware_main(void) { char a[40000]; fill(a); sink = a[39999]; }""",
}


@pytest.mark.parametrize("reason", PLANTED)
def test_a_planted_defect_fails_the_report(reason, tmp_path):
    done = report(tmp_path, PLANTED[reason])
    assert done.returncode == 1 and reason in done.stderr, done.stdout + done.stderr


def test_a_firmware_without_defects_passes(tmp_path):
    done = report(tmp_path, "volatile int x;\nvoid firmware_main(void) { x++; }")
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_double_in_an_object_of_floats_fails_the_report(tmp_path):
    (tmp_path / "firmware").mkdir()
    (tmp_path / "time_update.c").write_text("double f(double x); double f(double x) { return x * 1.5; }")
    subprocess.run(["arm-none-eabi-gcc", *FLAGS[:5], "-c", "time_update.c", "-o", "time_update.c.obj"], cwd=tmp_path, check=True)
    subprocess.run(["arm-none-eabi-ar", "rcs", "firmware/libpel_filter.a", "time_update.c.obj"], cwd=tmp_path, check=True)
    done = report(tmp_path, "volatile int x;\nvoid firmware_main(void) { x++; }")
    assert done.returncode == 1 and "filter/time_update.c uses __aeabi_dmul" in done.stdout, done.stdout + done.stderr


def test_the_counters_see_no_work_that_is_not_there():
    """Every kind of work the page speaks of is counted on the board: a renamed function would leave an empty row."""
    text = sizes.PAGE.read_text()
    for kind in ("IMU step", "push that works on an epoch", "row into the filter", "slice of a search"):
        assert re.search(rf"^\| {kind}, M4F \| [1-9]\d+ \|", text, re.M), kind
    assert Board(BOARD).elf("pil").exists()
