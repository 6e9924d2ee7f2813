#!/bin/bash
# Count the cases on an emulated Cortex-M.  target.sh m4f|m7 BUILD_DIR: prints "name<TAB>instructions".
set -euo pipefail
cd "$(dirname "$0")/../.."
core=$1
out=$2/bench-$core
mkdir -p "$out"
case $core in
m4f) cpu="-mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16 -Ihal/common hal/common/arm_double_add.c -Wl,--wrap=__aeabi_dadd,--wrap=__aeabi_dsub" board=mps2-an386 ;;
m7) cpu="-mcpu=cortex-m7 -mfloat-abi=hard -mfpu=fpv5-d16" board=mps2-an500 ;;
*) echo "target.sh: m4f or m7" >&2; exit 2 ;;
esac
# shellcheck disable=SC2086
arm-none-eabi-gcc -std=gnu11 -mthumb $cpu -O2 -ffp-contract=off -fno-math-errno -ffunction-sections -fdata-sections -Ifirmware/include -Itests/unit/ambiguity \
    tools/bench/{cases,dense,integers,target}.c tests/unit/ambiguity/support_{ambiguity,problem}.c firmware/src/{base,math,earth,inertial,model,filter,ambiguity}/*.c \
    -nostartfiles -Wl,--gc-sections --specs=nosys.specs -T tools/bench/target.ld -lm -o "$out/bench.elf"
qemu-system-arm -M $board -display none -monitor none -serial null -semihosting-config enable=on,target=native \
    -icount shift=10 -kernel "$out/bench.elf" 2>&1
