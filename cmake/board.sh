#!/bin/bash
# Cross-compile every program of a board into build/BOARD.  board.sh BOARD...; SIZES="PEL_MAX_OBS=32 ..." overrides.
set -euo pipefail
cd "$(dirname "$0")/.."
boards() { (cd hal && ls -d */board.cmake | xargs -n1 dirname | tr '\n' ' '); }
[ $# -gt 0 ] || { echo "board.sh: which board? There are: $(boards)" >&2; exit 2; }
for board in "$@"; do
    if [ ! -e "hal/$board/board.cmake" ]; then
        echo "no board '$board'; there are: $(boards)" >&2
        exit 2
    fi
    preset=$(sed -n 's/^set(PEL_BOARD_PRESET \(.*\))/\1/p' "hal/$board/board.cmake")
    cmake/bootstrap.sh "$([ "$preset" = rv32 ] && echo firmware-rv32 || echo firmware)"
    cmake --preset "$preset" -B "build/$board" -DPEL_BOARD="$board" -DPEL_SIZES="${SIZES:-}" --log-level=WARNING --no-warn-unused-cli >/dev/null
    cmake --build "build/$board" -j "${JOBS:-2}" -- --quiet
done
