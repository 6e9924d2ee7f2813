"""One linked firmware: its symbols, its memory by room, its disassembly."""

import collections
import pathlib
import re
import struct
import subprocess

TOOLS = {40: "arm-none-eabi-", 243: "riscv64-unknown-elf-"}  # by the machine number of an ELF
HEAP = {"malloc", "free", "calloc", "realloc", "_malloc_r", "_free_r", "_calloc_r", "_realloc_r", "sbrk", "_sbrk", "_sbrk_r"}


class Image:
    def __init__(self, elf):
        self.elf = pathlib.Path(elf)
        self.machine = struct.unpack_from("<H", self.elf.open("rb").read(20), 18)[0]
        self.prefix = TOOLS[self.machine]
        self.is_arm = self.machine == 40
        self.symbols = {}      # name -> (size, kind) of everything with a size
        self.names = {}        # every name -> kind
        for line in self.run("nm", "-S", self.elf).splitlines():
            parts = line.split()
            self.names[parts[-1]] = parts[-2]
            if len(parts) == 4:
                self.symbols[parts[3]] = (int(parts[1], 16), parts[2])

    def run(self, tool, *arguments):
        return subprocess.run([self.prefix + tool, *map(str, arguments)], check=True, capture_output=True, text=True).stdout

    def sections(self):
        return {m[1]: int(m[2]) for m in re.finditer(r"^(\.\S+)\s+(\d+)\s+\d+", self.run("size", "-A", self.elf), re.M)}

    def stack_reserved(self):
        return self.sections().get(".stack", 0)

    def flash(self):
        s = self.sections()
        return sum(s.get(n, 0) for n in (".text", ".rodata", ".ARM.exidx", ".data"))

    def variables(self):
        """name -> bytes of RAM."""
        return {k: v[0] for k, v in self.symbols.items() if v[1] in "bBdDsS"}

    def heap(self):
        return sorted(HEAP & set(self.names))

    def _map_lines(self):
        text = pathlib.Path(f"{self.elf}.map").read_text()
        text = text[text.index("Linker script and memory map"):]
        return re.findall(r"^ (\.\S+)\s+0x[0-9a-f]{8,}\s+0x([0-9a-f]+) (\S+)$", text, re.M)

    def code_by_archive(self):
        """Code and constants that stayed in the link, by archive ('' = objects named on the command line)."""
        total = collections.Counter()
        for section, size, origin in self._map_lines():
            if section.startswith((".text", ".rodata", ".srodata", ".vectors")):
                archive = re.search(r"lib([^/]+)\.a\(", origin)
                total[archive.group(1) if archive else ""] += int(size, 16)
        return total

    def code_by_room(self):
        """room -> bytes, and the rest under 'board' and 'compiler'."""
        code = self.code_by_archive()
        rooms = {k[4:]: v for k, v in code.items() if k.startswith("pel_")}
        other = sum(v for k, v in code.items() if k and not k.startswith("pel_"))
        return rooms, code[""], other

    def functions(self):
        """address -> {name, calls (addresses), frame by its pushes, indirect calls}."""
        found, current = {}, None
        kinds = {n for n, kind in self.names.items() if kind in "tTwW"}
        read = self._arm_instruction if self.is_arm else self._riscv_instruction
        for line in self.run("objdump", "-d", "--no-show-raw-insn", self.elf).splitlines():
            head = re.match(r"([0-9a-f]{8}) <([^>]+)>:", line)
            if head and head[2].startswith(".L"):
                continue  # a label inside a function
            if head:
                current = {"name": head[2], "calls": set(), "frame": 0, "indirect": 0}
                if head[2] in kinds:
                    found[int(head[1], 16)] = current
                continue
            m = re.match(r"\s*[0-9a-f]+:\s+(\S+)\s*(.*)", line)
            if m and current is not None:
                read(m[1], m[2], current)
        return found

    @staticmethod
    def _arm_instruction(op, args, f):
        op = op.split(".")[0]
        target = re.match(r"([0-9a-f]+) <([^>+]+)>", args)  # the start of a function: a call or a tail call
        if op.startswith("b") and target and "[" not in args:
            f["calls"].add(int(target[1], 16))
        elif op in ("blx", "bx") and not args.startswith("lr"):
            f["indirect"] += 1
        elif op in ("push", "vpush") or (op in ("stmdb", "str") and "sp" in args and "!" in args):
            lists = re.findall(r"\{([^}]*)\}", args)
            f["frame"] += sum(_count_registers(text) for text in lists) or 4
        elif op in ("sub", "subw") and args.startswith("sp"):
            f["frame"] += int(re.search(r"#(\d+)", args)[1]) if "#" in args else 1 << 20

    @staticmethod
    def _riscv_instruction(op, args, f):
        target = re.search(r"(?:^|,|# )([0-9a-f]+) <([^>+]+)>$", args)
        if target and (op[0] in "bj" or op in ("jal", "jalr", "call", "tail")):
            f["calls"].add(int(target[1], 16))
        elif op in ("jalr", "jr") and args != "ra":
            f["indirect"] += 1
        elif op in ("addi", "add") and args.startswith("sp,sp,-"):
            f["frame"] += int(re.match(r"sp,sp,-(\d+)", args)[1])

    def address_taken(self):
        """Names of functions whose address is stored somewhere, start-up vectors aside."""
        kinds = r"R_ARM_(?:ABS32|TARGET1|THM_MOV[WT]_\S+)|R_RISCV_(?:32|HI20|PCREL_HI20)"
        names, section = set(), ""
        for line in self.run("readelf", "-rW", self.elf).splitlines():
            head = re.match(r"Relocation section '([^']+)'", line)
            if head:
                section = head[1]
            m = re.match(rf"[0-9a-f]{{8}} +[0-9a-f]+ +(?:{kinds}) +[0-9a-f]+ +(\S+)", line)
            if m and "debug" not in section and "exidx" not in section and "eh_frame" not in section:
                names.add(m[1])
        return {n for n in names if not n.endswith(("_irq", "_handler"))}


def _count_registers(text):
    n = 0
    for item in text.split(","):
        m = re.match(r"\s*([rds])(\d+)-[rds](\d+)", item)
        width = 8 if item.strip().startswith("d") else 4
        n += width * (int(m[3]) - int(m[2]) + 1 if m else 1)
    return n
