#!/bin/bash
# What the integer engine takes on a Cortex-M4F besides time.  engine_bytes.sh BUILD_DIR: prints "code bytes, largest stack frame".
set -euo pipefail
cd "$(dirname "$0")/../.."
out=$1/bench-engine
mkdir -p "$out"
for source in firmware/src/ambiguity/ils*.c; do
    arm-none-eabi-gcc -std=gnu11 -mthumb -mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16 -O2 -ffp-contract=off -fno-math-errno \
        -Ifirmware/include -fstack-usage -c "$source" -o "$out/$(basename "$source" .c).o"
done
echo "$(arm-none-eabi-size -t "$out"/*.o | awk '/TOTALS/ {print $1}') $(awk '$2 > most {most = $2} END {print most}' "$out"/*.su)"
