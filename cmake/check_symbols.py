#!/usr/bin/env python3
"""What the library needs and keeps: nothing imported but mem*, nothing mutable at file scope.

    check_symbols.py DIR_WITH_libpel_*.a
"""
import pathlib
import subprocess
import sys

C_LIBRARY = {"memcpy", "memset", "memmove", "memcmp"}
PROVIDED_BY_LINKER = {"_GLOBAL_OFFSET_TABLE_"}

defined, wanted, bad = set(), {}, []
archives = sorted(p for p in pathlib.Path(sys.argv[1]).glob("libpel_*.a") if "_f64" not in p.name)
for archive in archives:
    member = ""
    # Tables of addresses: written once by the loader of a desktop program, constants on a board.
    text = subprocess.run(["objdump", "-t", archive], check=True, capture_output=True, text=True).stdout
    constant = {line.split()[-1] for line in text.splitlines() if "\t" in line and ".data.rel.ro" in line.split("\t")[0]}
    for line in subprocess.run(["nm", archive], check=True, capture_output=True, text=True).stdout.splitlines():
        if line.endswith(":"):
            member = f"{archive.name}({line[:-1]})"
            continue
        parts = line.split()
        if len(parts) < 2:
            continue
        kind, name = parts[-2], parts[-1]
        if kind == "U":
            wanted.setdefault(name, member)
        elif kind.isupper() or kind in "dbgs":
            defined.add(name)
        if kind in "dDbBCgGsS" and name not in constant:
            bad.append(f"{member}: '{name}' is mutable and lives at file scope")
        if kind in "TDBR" and not name.startswith(("pel_", "PEL_")):
            bad.append(f"{member}: '{name}' is public and has no prefix")
bad += [f"{member}: imports '{name}'" for name, member in sorted(wanted.items())
        if name not in defined | C_LIBRARY | PROVIDED_BY_LINKER]
print("\n".join(bad) or f"   {len(archives)} rooms: mem* is all they import, nothing mutable is kept")
sys.exit(1 if bad or not archives else 0)
