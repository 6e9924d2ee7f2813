"""Run the fuzz targets: each over its corpus, then so many seconds of mutations; a table; exit code 1 if any found something.

    python tests/fuzz/run.py BUILD [--seconds S] [--jobs N] [TARGET...]

An input that breaks a target is left in BUILD/findings/; `BUILD/tests/fuzz/fuzz_<target> FILE` runs it alone. New inputs
that reach new code are kept in BUILD/corpus/ and used the next time."""

import argparse
import re
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).resolve().parent
LONGEST = {"navigator": 200, "problem": 2000, "config": 2000}  # bytes of an input; others 4096
TIMEOUT_S = 10  # for one input


def run(target, build, seconds):
    name = target.name.removeprefix("fuzz_")
    own, seeds, findings = build / "corpus" / name, HERE / "corpus" / name, build / "findings"
    for folder in (own, findings):
        folder.mkdir(parents=True, exist_ok=True)
    command = [target, f"-max_total_time={seconds}", f"-max_len={LONGEST.get(name, 4096)}", f"-timeout={TIMEOUT_S}",
               "-rss_limit_mb=2048", "-print_final_stats=1", f"-artifact_prefix={findings}/{name}-", own]
    if seeds.exists():
        command.append(seeds)
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, errors="replace")
    log = done.stderr
    (findings / f"{name}.log").write_text(log)

    def number(pattern):
        found = re.findall(pattern, log)
        return int(found[-1]) if found else 0

    trouble = re.findall(r"(?:does not hold: .*|runtime error: .*|ERROR: \w+Sanitizer: [\w-]+|ERROR: libFuzzer: .*)", log)
    return {"name": name, "inputs": number(r"stat::number_of_executed_units:\s*(\d+)"), "edges": number(r"cov: (\d+)"),
            "corpus": number(r"corp: (\d+)/"), "ok": done.returncode == 0, "trouble": trouble[0] if trouble else ""}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("build", type=Path)
    parser.add_argument("targets", nargs="*")
    parser.add_argument("--seconds", type=int, default=30, help="of mutations, each target (0: a few, the corpus alone)")
    parser.add_argument("--jobs", type=int, default=2)
    a = parser.parse_intermixed_args()
    build = a.build.resolve()
    targets = sorted(t for t in (build / "tests/fuzz").glob("fuzz_*") if t.is_file() and t.suffix == "")
    if a.targets:
        targets = [t for t in targets if t.name.removeprefix("fuzz_") in a.targets]
    if not targets:
        sys.exit("run.py: no such fuzz target in " + str(build))
    print(f"{'target':<18}{'inputs':>10}{'edges':>8}{'corpus':>8}  verdict", flush=True)
    bad = 0
    with ThreadPoolExecutor(a.jobs) as pool:
        for r in pool.map(lambda t: run(t, build, max(a.seconds, 1)), targets):
            bad += not r["ok"]
            verdict = "nothing found" if r["ok"] else f"FOUND: {r['trouble']} (see findings/{r['name']}-*)"
            print(f"{r['name']:<18}{r['inputs']:>10}{r['edges']:>8}{r['corpus']:>8}  {verdict}", flush=True)
    print(f"{len(targets)} targets, {bad} with findings")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
