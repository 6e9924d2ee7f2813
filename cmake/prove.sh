#!/bin/bash
# make prove: every proof and its twin. A run of all of them writes docs/PROOFS.md.   prove.sh [--quick] [NAME...]
set -euo pipefail
cd "$(dirname "$0")/.."
cmake/bootstrap.sh host prove
[ $# -gt 0 ] || set -- --table docs/PROOFS.md
build/deps/venv/bin/python tests/prove/prove.py --jobs "${JOBS:-$(nproc)}" "$@"
