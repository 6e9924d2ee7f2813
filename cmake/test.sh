#!/bin/bash
# make test: build everything, run every test, then the unit tests once more under sanitizers.
set -euo pipefail
cd "$(dirname "$0")/.."
jobs=${JOBS:-$(nproc)}
cmake/bootstrap.sh host test target

cmake --preset host --log-level=WARNING >/dev/null
cmake --build build/host -j "$jobs"
cmake --build build/host -j "$jobs" --target pil_programs
JOBS=$jobs cmake/board.sh $(cd hal && ls -d */board.cmake | xargs -n1 dirname)
cmake --preset host-asan --log-level=WARNING >/dev/null
cmake --build build/asan -j "$jobs" --target unit_tests

failed=0
ctest --test-dir build/asan -L unit -j "$jobs" --output-on-failure || failed=1
ctest --test-dir build/host -j "$jobs" --output-on-failure || failed=1
if [ $failed = 0 ]; then echo "make test: everything passed"; else echo "make test: FAILED (see above)"; fi
exit $failed
