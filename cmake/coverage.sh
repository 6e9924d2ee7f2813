#!/bin/bash
# make coverage: what of firmware/ the unit tests, the fuzz corpus and a short simulated run reach.   coverage.sh [FILE...]
# With names of files (firmware/src/wire/ubx.c) it shows their lines, branches and conditions instead of the table.
set -euo pipefail
cd "$(dirname "$0")/.."
jobs=${JOBS:-$(nproc)}
build=build/coverage
cmake/bootstrap.sh host coverage
cmake --preset coverage --log-level=WARNING -DPEL_BIN_DIR="$PWD/$build/bin" >/dev/null
cmake --build $build -j "$jobs" --target unit_tests fuzz_targets pelorus-sim pelorus-sil -- --quiet
profiles=$PWD/$build/profiles
rm -rf "$profiles"
export LLVM_PROFILE_FILE="$profiles/%4m.profraw"

# Tests in double are the same code compiled again.
ctest --test-dir $build -L unit -E '_f64$|ils_many' -j "$jobs" --output-on-failure >$build/ctest.log || tail -20 $build/ctest.log
for target in $build/tests/fuzz/fuzz_*; do
    seeds=tests/fuzz/corpus/$(basename "$target" | cut -c6-)
    [ ! -d "$seeds" ] || [ ! -x "$target" ] || "$target" -runs=0 "$seeds" >$build/fuzz.log 2>&1 || tail -5 $build/fuzz.log
done
$build/bin/pelorus-sim scenarios/s5_leg.toml --duration 90 -q -o $build/run.log
$build/bin/pelorus-sil $build/run.log -q -o $build/run.out

llvm-profdata-19 merge -sparse "$profiles"/*.profraw -o $build/all.profdata
objects=($build/bin/pelorus-sil)
for program in $build/tests/unit/* $build/tests/fuzz/fuzz_*; do
    case $program in *_f64 | *.a) continue ;; esac
    [ ! -f "$program" ] || [ ! -x "$program" ] || objects+=(-object "$program")
done
if [ $# -gt 0 ]; then
    llvm-cov-19 show "${objects[@]}" -instr-profile=$build/all.profdata --show-branches=count --show-mcdc -sources "$@"
    exit
fi
llvm-cov-19 export "${objects[@]}" -instr-profile=$build/all.profdata -summary-only -sources firmware/src 2>$build/cov.log >$build/summary.json
python3 cmake/coverage_table.py $build/summary.json
