#!/bin/bash
# make firmware: cross-compile for a board and say what it costs.  firmware.sh BOARD; SIZES="PEL_MAX_OBS=32 ..." overrides.
set -euo pipefail
cd "$(dirname "$0")/.."
board=${1:?usage: firmware.sh BOARD}
if [ ! -e "hal/$board/board.cmake" ]; then
    echo "make firmware: no board '$board'; there are: $(cd hal && ls -d */board.cmake | xargs -n1 dirname | tr '\n' ' ')" >&2
    exit 2
fi
cmake/bootstrap.sh firmware
preset=$(sed -n 's/^set(PEL_BOARD_PRESET \(.*\))/\1/p' "hal/$board/board.cmake")
build=build/$board
cmake --preset "$preset" -B "$build" -DPEL_BOARD="$board" -DPEL_SIZES="${SIZES:-}" --log-level=WARNING
cmake --build "$build" -j "${JOBS:-2}"
python3 cmake/firmware_report.py "$build/hal/pelorus-$board.elf" "$build"
