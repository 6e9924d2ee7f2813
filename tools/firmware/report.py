"""What a linked firmware costs: code, RAM, the deepest call path; and that it has neither heap nor recursion.

    python3 -m firmware.report BOARD ELF BUILD_DIR

Code and RAM come from the linker's map and symbols, the stack bound from callgraph.py. Fails if a heap symbol is linked, if a function may
call itself by any path, if a call through a pointer has no known target, if doubles are computed in software where they are not meant to
be, if the stack does not hold the deepest path and an interrupt on top of it, or if an entry point takes more than the design's 6 KB of it.
"""

import pathlib
import sys

from firmware import doubles
from firmware.callgraph import CallGraph
from firmware.image import Image

BUDGET = {"code": 64 * 1024, "navigator": 48 * 1024, "stack": 6 * 1024}  # of the design; printed beside


def against(value, budget):
    return f"{value:7d} of {budget} {'' if value <= budget else ' OVER'}"


def print_memory(image):
    rooms, board, compiler = image.code_by_room()
    print(f"{image.elf.name}\n\ncode and constants, bytes")
    for name, size in sorted(rooms.items(), key=lambda x: -x[1]):
        print(f"  {name:12s} {size:7d}")
    print(f"  {'library':12s} {against(sum(rooms.values()), BUDGET['code'])}")
    print(f"  {'board, main':12s} {board:7d}\n  {'compiler, C':12s} {compiler:7d}\n  {'flash':12s} {image.flash():7d}")

    print("\nRAM, bytes")
    data = image.variables()
    for name, size in sorted(data.items(), key=lambda x: -x[1])[:10]:
        print(f"  {name:12s} {size:7d}")
    print(f"  {'all':12s} {sum(data.values()):7d}, and {image.stack_reserved()} of stack")


def print_stack(image, graph):
    print("\nstack, bytes: deepest path below each entry point of the library")
    entries = graph.entries()
    for name, depth in list(entries.items())[:10]:
        print(f"  {name:32s} {against(depth, BUDGET['stack'])}")
    depth, chain = graph.of("reset_handler")
    total = depth + graph.interrupt()
    print(f"  deepest path {depth} + interrupt {graph.interrupt()} = {total} of {image.stack_reserved()} reserved")
    for name, size in chain:
        print(f"      {size:6d} {name}")
    return total, [name for name, depth in entries.items() if depth > BUDGET["stack"]]


def main():
    board, elf, build = sys.argv[1:4]
    image, build = Image(elf), pathlib.Path(build)
    graph = CallGraph(image, build)
    print_memory(image)
    total, deep = print_stack(image, graph)

    hard = "set(PEL_BOARD_PRESET m7)" in pathlib.Path(f"hal/{board}/board.cmake").read_text()
    soft = doubles.unexpected(image, build, hard)
    indirect, targets = graph.indirect(), ", ".join(sorted(graph.name(a) for a in graph.targets))
    print(f"\nheap symbols: {', '.join(image.heap()) or 'none'}")
    print(f"recursion: {'; '.join(' -> '.join(c) for c in graph.cycles) or 'none'}")
    print(f"calls through pointers: {', '.join(indirect) or 'none'}" + (f" (to one of: {targets})" if indirect else ""))
    print(f"frames of variable size: {', '.join(graph.unbounded) or 'none'}")
    print(f"doubles in software where none are meant: {'; '.join(soft) or 'none'}")
    failed = {
        "a heap is linked": image.heap(),
        "recursion: the stack has no bound": graph.cycles,
        "a call through a pointer to nowhere known: the stack bound does not cover it": indirect and not graph.targets,
        "frames of variable size": graph.unbounded,
        "doubles in software": soft,
        "the stack is too small": total > image.stack_reserved(),
        "an entry point takes more stack than the design allows": deep,
    }
    for reason in (r for r, wrong in failed.items() if wrong):
        print(f"FAILED: {reason}", file=sys.stderr)
    return 1 if any(failed.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
