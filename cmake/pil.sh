#!/bin/bash
# make pil: captures through the firmware on emulated boards and on the desktop; the same bytes must come out.
#   pil.sh [--quick] [BOARD...]    default: all boards
set -euo pipefail
cd "$(dirname "$0")/.."
boards=()
for word in "$@"; do case $word in -*) ;; *) boards+=("$word") ;; esac; done
[ ${#boards[@]} -gt 0 ] || boards=($(cd hal && ls -d */board.cmake | xargs -n1 dirname))
cmake/bootstrap.sh host target
cmake/board.sh "${boards[@]}"
cmake --preset host --log-level=WARNING >/dev/null
cmake --build build/host -j "${JOBS:-2}" --target programs pil_programs -- --quiet
export PATH="$PWD/build/bin:$PWD/build/deps/venv/bin:$PATH" PYTHONPATH="$PWD/tools:$PWD/build/host/lcm/python"
exec build/deps/venv/bin/python -m pil "$@"
