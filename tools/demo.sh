#!/bin/bash
# make demo: simulate a leg of the survey flight S5, run the firmware on its serial bytes, hold the result against truth.
#   tools/demo.sh [FOLDER [SEED]]      results go to FOLDER (build/demo)
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-build/demo}
seed=${2:-1}
scenario=scenarios/s5_leg.toml
mkdir -p "$out"

say() { printf '\n> %s\n' "$*"; "$@"; }
start=$(date +%s)
say pelorus-sim "$scenario" -o "$out/flight.log" --seed "$seed"
say pelorus-sil "$out/flight.log" -o "$out/flight.out"
# The filter needs its first minutes of turns to learn the heading: figures start after the first quarter.
settle=$(pelorus-report "$out/flight.out" -q --csv-stats | awk -F, '$1 == "duration_s" { printf "%d", $2 / 4 }')
judge=(pelorus-report "$out/flight.out" -q --window "$settle,99999" -o "$out/report.html" --png "$out/demo.png" --csv-stats)
printf '\n> %s\n' "${judge[*]}"
"${judge[@]}" > "$out/figures.csv"

awk -F, -v settle="$settle" '
{ v[$1] = $2 }
function row(words, name, unit, k, reference, accept, paper) {
    printf "  %-18s %-7s %8.2f %8.2f %8.2f %9.2f   |  %9s %11s %7s\n", words, unit, k * v[name "_rms_" u], k * v[name "_max_" u],
           k * v[name "_sigma_" u], v[name "_ratio"], reference, accept, paper
}
END {
    printf "\n  Errors against truth, %d s to the end of %d s\n\n", settle, v["duration_s"]
    printf "  %-18s %-7s %8s %8s %8s %9s   |  %9s %11s %7s\n", "", "", "rms", "largest", "sigma", "rms/sigma", "S5 2 h", "acceptance", "paper"
    u = "m"
    row("position east", "pos_e", "mm", 1e3, "1.3", "<= 3", "100")
    row("position north", "pos_n", "mm", 1e3, "1.6", "<= 3", "100")
    row("position up", "pos_d", "mm", 1e3, "3.4", "<= 6", "100")
    u = "mps"
    row("velocity east", "vel_e", "mm/s", 1e3, "0.2", "<= 1", "50")
    row("velocity north", "vel_n", "mm/s", 1e3, "0.2", "<= 1", "50")
    row("velocity up", "vel_d", "mm/s", 1e3, "0.3", "<= 1", "50")
    u = "arcsec"
    row("tilt about east", "att_e", "arcsec", 1, "0.75", "<= 1.2", "8")
    row("tilt about north", "att_n", "arcsec", 1, "0.72", "<= 1.2", "8")
    row("heading", "att_d", "arcsec", 1, "1.41", "<= 2.5", "10")
    printf "\n  %d of %d epochs fixed (%.2f %%), %d wrong\n", v["fixed_epochs"], v["epochs"], 100 * v["fixed_share"], v["wrong_fixes"]
}' "$out/figures.csv"
printf '\n  Page with every plot: %s/report.html   (%d s from start to report)\n' "$out" "$(($(date +%s) - start))"
