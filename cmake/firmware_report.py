#!/usr/bin/env python3
"""What a linked firmware costs: code, RAM, the deepest call path; and that it has neither heap nor recursion.

    firmware_report.py FIRMWARE.elf BUILD_DIR

Code and RAM come from the linker's map and symbols. The stack bound is static: frame sizes as the compiler states them
(-fcallgraph-info=su; for library routines, from their disassembly), calls as the linked image has them; a call through
a pointer may reach every function whose address is taken anywhere (relocations kept by -Wl,--emit-relocs). Fails if a
heap symbol is linked, if a function may call itself by any path, or if the stack does not hold the deepest path and an
interrupt on top of it.
"""
import collections
import pathlib
import re
import subprocess
import sys

HEAP = {"malloc", "free", "calloc", "realloc", "_malloc_r", "_free_r", "_calloc_r", "_realloc_r", "sbrk", "_sbrk", "_sbrk_r"}
EXCEPTION_FRAME = 26 * 4 + 4  # what the core pushes with the FPU in use, and its alignment
BUDGET = {"code": 64 * 1024, "navigator": 48 * 1024, "stack": 6 * 1024}  # of the design; printed beside


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def symbols(elf):
    """name -> (size, kind) of everything with a size."""
    out = {}
    for line in run("arm-none-eabi-nm", "-S", elf).splitlines():
        parts = line.split()
        if len(parts) == 4:
            out[parts[3]] = (int(parts[1], 16), parts[2])
    return out


def code_by_archive(map_file):
    """Code and constants that stayed in the link, by archive ('' = objects named on the command line)."""
    text = map_file.read_text()
    text = text[text.index("Linker script and memory map"):]
    total = collections.Counter()
    for section, size, origin in re.findall(r"^ (\.\S+)\s+0x[0-9a-f]{8,}\s+0x([0-9a-f]+) (\S+)$", text, re.M):
        if section.startswith((".text", ".rodata", ".vectors")):
            archive = re.search(r"lib([^/]+)\.a\(", origin)
            total[archive.group(1) if archive else ""] += int(size, 16)
    return total


def compiler_frames(build):
    """function -> frame size, and the functions whose frame is not of fixed size."""
    frames, unbounded = collections.defaultdict(int), []
    for ci in pathlib.Path(build).rglob("*.ci"):
        for title, size, kind in re.findall(r'node: \{ title: "([^"]+)" label: "[^"]*\\n(\d+) bytes \(([^)]*)\)', ci.read_text()):
            name = title.rsplit(":", 1)[-1]
            frames[name] = max(frames[name], int(size))
            if kind.startswith("dynamic") and "bounded" not in kind:
                unbounded.append(name)
    return frames, unbounded


def disassemble(elf):
    """address -> (name, set of callee addresses, frame by its pushes, indirect calls)."""
    functions, current = {}, None
    for line in run("arm-none-eabi-objdump", "-d", "--no-show-raw-insn", elf).splitlines():
        head = re.match(r"([0-9a-f]{8}) <([^>]+)>:", line)
        if head:
            current = {"name": head[2], "calls": set(), "frame": 0, "indirect": 0}
            functions[int(head[1], 16)] = current
            continue
        m = re.match(r"\s*[0-9a-f]+:\s+(\S+)\s*(.*)", line)
        if not m or current is None:
            continue
        op, args = m[1].split(".")[0], m[2]
        target = re.match(r"([0-9a-f]+) <([^>+]+)>", args)  # the start of a function: a call or a tail call
        if op.startswith("b") and target and "[" not in args:
            current["calls"].add(int(target[1], 16))
        elif op in ("blx", "bx") and not args.startswith("lr"):
            current["indirect"] += 1
        elif op in ("push", "vpush") or (op in ("stmdb", "str") and "sp" in args and "!" in args):
            names = re.findall(r"\{([^}]*)\}", args)
            current["frame"] += sum(count_registers(n) for n in names) or 4
        elif op in ("sub", "subw") and args.startswith("sp"):
            current["frame"] += int(re.search(r"#(\d+)", args)[1]) if "#" in args else 1 << 20
    return functions


def address_taken(elf):
    """Names of functions whose address is stored somewhere, start-up vectors aside."""
    names, section = set(), ""
    for line in run("arm-none-eabi-readelf", "-rW", elf).splitlines():
        head = re.match(r"Relocation section '([^']+)'", line)
        if head:
            section = head[1]
        m = re.match(r"[0-9a-f]{8} +[0-9a-f]+ +(R_ARM_(?:ABS32|TARGET1|THM_MOV[WT]_\S+)) +[0-9a-f]+ +(\S+)", line)
        if m and "debug" not in section and "exidx" not in section:
            names.add(m[2])
    return {n for n in names if not n.endswith(("_irq", "_handler"))}


def count_registers(text):
    n = 0
    for item in text.split(","):
        m = re.match(r"\s*([rds])(\d+)-[rds](\d+)", item)
        width = 8 if item.strip().startswith("d") else 4
        n += width * (int(m[3]) - int(m[2]) + 1 if m else 1)
    return n


class Stack:
    """Deepest path below each function."""

    def __init__(self, functions, frames):
        self.functions, self.frames = functions, frames
        self.known, self.cycles = {}, []
        self.by_name = {}
        for address, f in functions.items():
            self.by_name.setdefault(f["name"], address)

    def frame(self, address):
        f = self.functions[address]
        return self.frames.get(f["name"], f["frame"])

    def deepest(self, address, path=()):
        if address in self.known:
            return self.known[address]
        if address in path:
            self.cycles.append([self.functions[a]["name"] for a in path[path.index(address):]])
            return 0, []
        below, chain = 0, []
        for callee in self.functions[address]["calls"]:
            if callee in self.functions and callee != address:
                depth, names = self.deepest(callee, path + (address,))
                if depth > below:
                    below, chain = depth, names
            elif callee == address and self.frame(address) > 0:
                # With nothing pushed, a branch to its own first instruction is a loop.
                self.cycles.append([self.functions[address]["name"]])
        result = self.frame(address) + below, [(self.functions[address]["name"], self.frame(address))] + chain
        self.known[address] = result
        return result

    def of(self, name):
        return self.deepest(self.by_name[name])


def against(value, budget):
    return f"{value:7d} of {budget} {'' if value <= budget else ' OVER'}"


def main():
    elf, build = sys.argv[1:3]
    sym = symbols(elf)
    failed = []

    code = code_by_archive(pathlib.Path(elf + ".map"))
    rooms = {k: v for k, v in code.items() if k.startswith("pel_")}
    print(f"{pathlib.Path(elf).name}\n\ncode and constants, bytes")
    for name, size in sorted(rooms.items(), key=lambda x: -x[1]):
        print(f"  {name[4:]:12s} {size:7d}")
    print(f"  {'library':12s} {against(sum(rooms.values()), BUDGET['code'])}")
    print(f"  {'board, main':12s} {code['']:7d}")
    print(f"  {'compiler, C':12s} {sum(v for k, v in code.items() if k and k not in rooms):7d}")

    print("\nRAM, bytes")
    data = {k: v[0] for k, v in sym.items() if v[1] in "bBdD"}
    for name, size in sorted(data.items(), key=lambda x: -x[1])[:10]:
        print(f"  {name:12s} {against(size, BUDGET['navigator']) if name == 'navigator' else f'{size:7d}'}")
    print(f"  {'all':12s} {sum(data.values()):7d}")

    frames, unbounded = compiler_frames(build)
    code_names = {n for n, (_, kind) in sym.items() if kind in "tTwW"}
    code_names |= {line.split()[-1] for line in run("arm-none-eabi-nm", elf).splitlines() if line.split()[-2] in "tTwW"}
    functions = {a: f for a, f in disassemble(elf).items() if f["name"] in code_names}
    taken = address_taken(elf)
    targets = {a for a, f in functions.items() if f["name"] in taken}
    for f in functions.values():
        if f["indirect"]:
            f["calls"] |= targets
    stack = Stack(functions, frames)
    sizes = {f["name"] for f in functions.values()}
    entries = sorted(({*callees(functions, stack, "firmware_main")} & {n for n in sizes if n.startswith("pel_")}),
                     key=lambda n: -stack.of(n)[0])
    print("\nstack, bytes: deepest path below each entry point of the library")
    for name in entries[:8]:
        print(f"  {name:32s} {against(stack.of(name)[0], BUDGET['stack'])}")
    depth, chain = stack.of("reset_handler")
    irq = max((stack.of(n)[0] for n in sizes if n.endswith(("_irq", "_handler")) and n != "reset_handler"), default=0)
    total = depth + EXCEPTION_FRAME + irq
    reserved = stack_size(elf)
    print(f"  deepest path {depth} + interrupt {EXCEPTION_FRAME + irq} = {total} of {reserved} reserved")
    for name, size in chain:
        print(f"      {size:6d} {name}")

    reachable = stack.known
    indirect = sorted(functions[a]["name"] for a in reachable if functions[a]["indirect"])
    heap = sorted(HEAP & set(sym))
    print(f"\nheap symbols: {', '.join(heap) or 'none'}")
    print(f"recursion: {'; '.join(' -> '.join(c) for c in stack.cycles) or 'none'}")
    print(f"calls through pointers: {', '.join(indirect) or 'none'}"
          + (f" (to one of: {', '.join(sorted(functions[a]['name'] for a in targets))})" if indirect else ""))
    print(f"frames of variable size: {', '.join(unbounded) or 'none'}")
    if heap:
        failed.append("a heap is linked")
    if stack.cycles:
        failed.append("recursion: the stack has no bound")
    if indirect and not targets:
        failed.append("a call through a pointer to nowhere known: the stack bound does not cover it")
    if unbounded:
        failed.append("frames of variable size")
    if total > reserved:
        failed.append("the stack is too small")
    for reason in failed:
        print(f"FAILED: {reason}", file=sys.stderr)
    return 1 if failed else 0


def callees(functions, stack, name):
    """Functions reached from one without passing another pel_ function: the library's entry points."""
    seen, todo = set(), [stack.by_name[name]]
    while todo:
        a = todo.pop()
        for c in functions[a]["calls"]:
            if c in functions and c not in seen:
                seen.add(c)
                if not functions[c]["name"].startswith("pel_"):
                    todo.append(c)
    return {functions[a]["name"] for a in seen}


def stack_size(elf):
    for line in run("arm-none-eabi-size", "-A", elf).splitlines():
        if line.startswith(".stack"):
            return int(line.split()[1])
    return 0


if __name__ == "__main__":
    sys.exit(main())
