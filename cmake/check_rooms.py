#!/usr/bin/env python3
"""Who knows whom: a room of firmware/ includes only headers of rooms above it, wire/ knows base/ alone, no room knows
hal/, and of the C library only <stdint.h>, <stddef.h>, <stdbool.h> and <string.h>; sim/ knows wire/ and base/ alone."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
ROOMS = "base math earth wire gnss inertial model filter observe ambiguity attitude integrity tracking navigator".split()
C_LIBRARY = {"stdint.h", "stddef.h", "stdbool.h", "string.h"}
OF_BASE = {"base", "bits", "config", "solution"}  # headers that are the room base/
OF_ROOM = {"snapshot": "navigator"}  # second headers of other rooms


def room_of_header(stem):
    """ambiguity.h and ambiguity_methods.h are both the room ambiguity/."""
    room = stem.split("_")[0]
    return room if room in ROOMS else "base"


def allowed(room):
    above = ["base"] if room == "wire" else ROOMS[: ROOMS.index(room)]
    return {*above, room, *OF_BASE, *(h for h, r in OF_ROOM.items() if r == room or r in above)}


def includes(path):
    for number, line in enumerate(path.read_text().splitlines(), 1):
        m = re.match(r'\s*#\s*include\s*([<"])([^>"]+)[>"]', line)
        if m:
            yield number, m[1] == "<", m[2]


def complaints():
    firmware = ROOT / "firmware"
    files = [(f, f.parent.name) for f in sorted((firmware / "src").glob("*/*.[ch]"))]
    files += [(f, OF_ROOM.get(f.stem, room_of_header(f.stem))) for f in sorted((firmware / "include/pelorus").glob("*.h"))
              if f.stem != "pelorus"]
    for path, room in files:
        for number, system, name in includes(path):
            where = f"{path.relative_to(ROOT)}:{number}: "
            if system and name not in C_LIBRARY:
                yield where + f"<{name}> is not for firmware/"
            elif name.startswith("pelorus/") and room_of_header(pathlib.Path(name).stem) not in allowed(room):
                yield where + f"{room}/ may not know {name}"
            elif not system and not name.startswith("pelorus/") and not (path.parent / name).exists():
                yield where + f"{name} is not a header of {room}/"
    for path in sorted((ROOT / "sim").glob("*.[ch]*")):
        for number, _, name in includes(path):
            if name.startswith("pelorus/") and pathlib.Path(name).stem not in {"wire", *OF_BASE}:
                yield f"{path.relative_to(ROOT)}:{number}: sim/ may not know {name}"


found = list(complaints())
print("\n".join(found) or "   every room knows only rooms above it")
sys.exit(1 if found else 0)
