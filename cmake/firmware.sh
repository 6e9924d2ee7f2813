#!/bin/bash
# make firmware: cross-compile for a board and say what it costs.  firmware.sh BOARD; SIZES="PEL_MAX_OBS=32 ..." overrides.
set -euo pipefail
cd "$(dirname "$0")/.."
board=${1:?usage: firmware.sh BOARD}
cmake/board.sh "$board"
build=build/$board
PYTHONPATH=tools python3 -m firmware.report "$board" "$build/hal/pelorus-$board.elf" "$build"

# The navigator's RAM budget of the design is for 2 x 32 signals; the board has the sizes of config.h and board.cmake.
small="PEL_MAX_OBS=32 PEL_MAX_SATS=16 PEL_MAX_EPH=16 PEL_MAX_AMB=24 PEL_MAX_STATES=24 PEL_MAX_TRACKED=32 PEL_IMU_RING=128 PEL_POSE_RING=32"
# shellcheck disable=SC2086
echo '#include "pelorus/navigator.h"
      char size[sizeof(pel_navigator_t)];' |
    arm-none-eabi-gcc -mthumb -mcpu=cortex-m4 -I firmware/include $(printf -- '-D%s ' $small) -x c -c -o "$build/size.o" -
echo "navigator with $small: $((16#$(arm-none-eabi-nm -S "$build/size.o" | cut -d' ' -f2))) bytes of 49152"
