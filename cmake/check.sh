#!/bin/bash
# make check: everything that needs no run. Each step says its name; all steps run, then the verdict.
#   check.sh [STEP...]   steps: format gcc clang tidy cppcheck headers rooms symbols
set -uo pipefail
cd "$(dirname "$0")/.."
jobs=${JOBS:-$(nproc)}
[ $# -gt 0 ] || set -- format gcc clang tidy cppcheck headers rooms symbols
cmake/bootstrap.sh host check || exit 1

sources() { git ls-files -co --exclude-standard -- "$@" | while read -r f; do [ ! -e "$f" ] || echo "$f"; done; }

format() {
    local bad
    bad=$(sources '*.c' '*.h' '*.cpp' | xargs clang-format --dry-run -Werror 2>&1 | sed -n 's|^\([^: ]*:[0-9]*\):[0-9]*: error.*|\1|p' | sort -u -t: -k1,1)
    [ -z "$bad" ] || { echo "$bad: first line to format; make format does it"; return 1; }
}

build_with() { # name, C compiler, C++ compiler
    local log=build/check-$1.log
    cmake -G Ninja -B "build/check-$1" -DCMAKE_C_COMPILER="$2" -DCMAKE_CXX_COMPILER="$3" -DPEL_WERROR_ALL=ON --log-level=WARNING >/dev/null &&
        cmake --build "build/check-$1" -j "$jobs" -- -k 0 >"$log" 2>&1 && return
    grep -vE '^\[[0-9]+/[0-9]+\]|^(/usr)?/bin/|^: &&' "$log"
    return 1
}
gcc() { build_with gcc cc c++; }
clang() { build_with clang clang clang++; }

# With the clang build's commands: the same warnings, the same sizes.
tidy() {
    [ -e build/check-clang/compile_commands.json ] || clang
    local log=build/check-tidy.log
    sources 'firmware/src/*.c' 'hal/main.c' 'hal/desktop/*.c' 'tools/*.c' 'sim/*.c' | grep -v '^tools/bench/target\.c$' |
        xargs -P "$jobs" -I{} sh -c 'clang-tidy -p build/check-clang --quiet {} >build/check-clang/$(echo {} | tr / -).tidy 2>/dev/null || echo {}' >"$log"
    [ -s "$log" ] || return 0
    while read -r f; do grep -E ': (error|warning): ' "build/check-clang/$(echo "$f" | tr / -).tidy"; done <"$log" | sort -u
    echo "   the paths to these: build/check-clang/*.tidy"
    return 1
}

cppcheck() {
    # unusedStructMember: members are for the caller.
    # comparePointers: only start-up code compares pointers to two things, the linker's bounds of one section.
    command cppcheck --quiet --std=c11 --error-exitcode=1 --enable=warning,performance,portability --inline-suppr -j "$jobs" \
        --suppress=missingIncludeSystem --suppress=unusedStructMember --suppress=comparePointers \
        -I firmware/include -I hal -I tools/common $(sources 'firmware/src/*.c' 'hal/*.c' 'tools/*.c' 'sim/*.c')
}

# Every public header alone, as C11 and as C++17.
headers() {
    local ok=0 h
    for h in $(sources 'firmware/include/pelorus/*.h' 'hal/hal.h'); do
        for lang in 'c -std=c11' 'c++ -std=c++17'; do
            echo "#include \"${h#firmware/include/}\"" | command gcc -x $lang -Wall -Wextra -Werror -fsyntax-only -I firmware/include -I . -I hal - ||
                { echo "$h does not compile alone as ${lang%% *}"; ok=1; }
        done
    done
    return $ok
}

rooms() { python3 cmake/check_rooms.py; }

symbols() { python3 cmake/check_symbols.py build/check-gcc/firmware; }

failed=()
for step in "$@"; do
    echo "== $step"
    "$step" || { failed+=("$step"); echo "   FAILED: $step"; }
done
if [ ${#failed[@]} -gt 0 ]; then echo "make check: FAILED: ${failed[*]}"; exit 1; fi
echo "make check: all of it holds"
