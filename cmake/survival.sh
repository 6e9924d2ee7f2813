#!/bin/bash
# make survival: bit flips on the ordinary build, then fewer under sanitizers (a flipped bool or enum is no bool or enum: those two
# checks are off). Arguments go to survival.py.
set -euo pipefail
cd "$(dirname "$0")/.."
cmake/bootstrap.sh host test
export PATH="$PWD/build/bin:$PWD/build/deps/venv/bin:$PATH" PYTHONPATH="$PWD/tools:$PWD/build/host/lcm/python"
flags="-O1 -g -fsanitize=address,undefined -fno-sanitize=bool,enum -fno-sanitize-recover=all -fno-omit-frame-pointer"
cmake --preset host-asan -B build/flips -DCMAKE_C_FLAGS="$flags" --log-level=WARNING >/dev/null
cmake --build build/flips -j "${JOBS:-$(nproc)}" --target pelorus-flips
python tests/scenario/survival.py --docs docs/SURVIVAL.md "$@"
ASAN_OPTIONS=detect_leaks=0 python tests/scenario/survival.py --flips 5000 --seed 5 --program build/flips/bin/pelorus-flips
