#!/bin/bash
# make fuzz: build the fuzz targets and run each for SECONDS (30).   fuzz.sh [SECONDS|quick [TARGET...]]
# quick: 3 seconds, or what PELORUS_FUZZ_SECONDS says (CI: 30).
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-30}
[ "$seconds" != quick ] || seconds=${PELORUS_FUZZ_SECONDS:-3}
jobs=${JOBS:-$(nproc)}
shift || true
cmake/bootstrap.sh host fuzz
cmake --preset fuzz --log-level=WARNING >/dev/null
cmake --build build/fuzz -j "$jobs" --target fuzz_targets -- --quiet
build/deps/venv/bin/python tests/fuzz/run.py build/fuzz --seconds "$seconds" --jobs "$jobs" "$@"
