#!/bin/bash
# make coverage: what of firmware/ the tests reach, in lines, branches and conditions (MC/DC).
#
#   coverage.sh           unit tests, fuzz corpus and 90 simulated seconds: the table by room, which also goes into docs/COVERAGE.md
#   coverage.sh ROOM...   the unit tests of these rooms alone (wire, base): their table and each line, branch and condition missed
#   coverage.sh FILE...   these files (firmware/src/wire/ubx.c) line by line as of the last whole run, which is made if there is none
#
# Exit 1: a test failed; figures are printed all the same.
set -euo pipefail
cd "$(dirname "$0")/.."
jobs=${JOBS:-$(nproc)}
build=$PWD/build/coverage
profiles=$build/profiles
failed=0

prepare() { # TARGET...
    cmake/bootstrap.sh host coverage
    cmake --preset coverage --log-level=WARNING -DPEL_BIN_DIR="$build/bin" >/dev/null
    cmake --build "$build" -j "$jobs" --target "$@" -- --quiet
    rm -rf "$profiles"
    export LLVM_PROFILE_FILE="$profiles/%4m.profraw"
}

# Tests in double are the same code compiled again.
run_tests() { # REGEX
    ctest --test-dir "$build" -L unit -R "$1" -E '_f64$|ils_many' -j "$jobs" --output-on-failure >"$build/ctest.log" && return
    grep -E 'FAIL|\(Failed\)|\(Timeout\)' "$build/ctest.log" >&2
    failed=1
}

test_programs() { # GLOB
    local program
    for program in "$build"/tests/unit/$1; do
        case $program in *_f64) continue ;; esac
        [ ! -x "$program" ] || echo "-object $program"
    done
}

report() { # REPORT-OPTION... -- OBJECT...
    local options=()
    while [ "$1" != -- ]; do options+=("$1") && shift; done
    llvm-profdata-19 merge -sparse "$profiles"/*.profraw -o "$build/$scope.profdata"
    llvm-cov-19 export "${@:2}" -instr-profile="$build/$scope.profdata" -sources firmware/src 2>"$build/cov.log" >"$build/$scope.json"
    python3 cmake/coverage_report.py "$build/$scope.json" "${options[@]}"
}

whole_objects() {
    echo "$build/bin/pelorus-sil $(test_programs '*')"
    local target
    for target in "$build"/tests/fuzz/fuzz_*; do
        [ ! -f "$target" ] || [ ! -x "$target" ] || echo "-object $target"
    done
}

whole_run() {
    prepare unit_tests fuzz_targets pelorus-sim pelorus-sil
    run_tests .
    local target seeds
    for target in "$build"/tests/fuzz/fuzz_*; do
        seeds=tests/fuzz/corpus/$(basename "$target" | cut -c6-)
        [ -d "$seeds" ] && [ -x "$target" ] || continue
        "$target" -runs=0 "$seeds" >"$build/fuzz.log" 2>&1 || { tail -5 "$build/fuzz.log" >&2 && failed=1; }
    done
    "$build/bin/pelorus-sim" scenarios/s5_leg.toml --duration 90 -q -o "$build/run.log"
    "$build/bin/pelorus-sil" "$build/run.log" -q -o "$build/run.out"
    scope=whole report --page docs/COVERAGE.md -- $(whole_objects)
}

if [ $# -eq 0 ]; then
    whole_run
elif [ -d "firmware/src/$1" ]; then
    targets=() patterns=() objects=()
    for room in "$@"; do
        targets+=($(ls tests/unit/"$room"/test_*.c | sed "s|.*/\(.*\)\.c|$room-\1|"))
        patterns+=("$room")
    done
    prepare "${targets[@]}"
    run_tests "^unit/($(IFS='|' && echo "${patterns[*]}"))/"
    for room in "$@"; do objects+=($(test_programs "$room-test_*")); done
    scope=rooms report --missing "$@" -- "${objects[@]:1}"
else
    [ -e "$build/whole.profdata" ] || whole_run
    llvm-cov-19 show $(whole_objects) -instr-profile="$build/whole.profdata" --show-branches=count --show-mcdc -sources "$@"
fi
exit $failed
