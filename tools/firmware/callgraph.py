"""The deepest path below each function: frames as the compiler states them, calls as the linked image has them."""

import collections
import pathlib
import re

EXCEPTION_FRAME = {True: 26 * 4 + 4, False: 36 * 4}  # ARM: pushed by the core, with the FPU in use; RISC-V: by the handler itself


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


class CallGraph:
    """A call through a pointer may reach every function whose address is taken anywhere."""

    def __init__(self, image, build):
        self.image = image
        self.frames, self.unbounded = compiler_frames(build)
        self.functions = image.functions()
        taken = image.address_taken()
        self.targets = {a for a, f in self.functions.items() if f["name"] in taken}
        for f in self.functions.values():
            if f["indirect"]:
                f["calls"] |= self.targets
        self.by_name = {}
        for address, f in self.functions.items():
            self.by_name.setdefault(f["name"], address)
        self.known, self.cycles = {}, []

    def frame(self, address):
        f = self.functions[address]
        return self.frames.get(f["name"], f["frame"])

    def name(self, address):
        return self.functions[address]["name"]

    def deepest(self, address, path=()):
        """(bytes, [(name, frame), ...]) of the deepest path; cycles are collected on the way."""
        if address in self.known:
            return self.known[address]
        if address in path:
            self.cycles.append([self.name(a) for a in path[path.index(address):]])
            return 0, []
        below, chain = 0, []
        for callee in sorted(self.functions[address]["calls"]):
            if callee in self.functions and callee != address:
                depth, names = self.deepest(callee, path + (address,))
                if depth > below:
                    below, chain = depth, names
            elif callee == address and self.frame(address) > 0:
                # With nothing pushed, a branch to its own first instruction is a loop.
                self.cycles.append([self.name(address)])
        result = self.frame(address) + below, [(self.name(address), self.frame(address))] + chain
        self.known[address] = result
        return result

    def of(self, name):
        return self.deepest(self.by_name[name])

    def interrupt(self):
        """Deepest interrupt on top of the main path."""
        handlers = [n for n in self.by_name if n.endswith(("_irq", "_handler")) and n != "reset_handler"]
        return EXCEPTION_FRAME[self.image.is_arm] + max((self.of(n)[0] for n in handlers), default=0)

    def entries(self):
        """name -> deepest path of the library's functions that the main loop calls, deepest first."""
        seen, todo = set(), [self.by_name["firmware_main"]]
        while todo:
            for callee in self.functions[todo.pop()]["calls"]:
                if callee in self.functions and callee not in seen:
                    seen.add(callee)
                    if not self.name(callee).startswith("pel_"):
                        todo.append(callee)
        names = {self.name(a) for a in seen if self.name(a).startswith("pel_")}
        return dict(sorted(((n, self.of(n)[0]) for n in names), key=lambda x: (-x[1], x[0])))

    def indirect(self):
        """Functions on some path that call through a pointer."""
        return sorted(self.name(a) for a in self.known if self.functions[a]["indirect"])
