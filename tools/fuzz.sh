#!/usr/bin/env bash
# Runs the fuzz targets of build/fuzz, two at a time:
#   tools/fuzz.sh SECONDS [TARGET…]     for example: tools/fuzz.sh 1200 ply stl
# Corpora grow in build/fuzz/corpus from the seeds in fuzz/seeds; what breaks a target is left in
# build/fuzz/broken. Ends with a table of executions, coverage and what was found; fails if anything was.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=${1:?usage: tools/fuzz.sh SECONDS [TARGET…]}
shift
[ $# -gt 0 ] || set -- $(cd fuzz/seeds && ls)

run() {
  local target=$1 corpus=build/fuzz/corpus/$1 broken=build/fuzz/broken/$1 longest=65536
  mkdir -p "$corpus" "$broken"
  build/fuzz/fuzz/fuzz_"$target" "$corpus" "fuzz/seeds/$target" -max_total_time="$seconds" -max_len=$longest \
    -rss_limit_mb=2048 -timeout=60 -report_slow_units=60 -print_final_stats=1 -artifact_prefix="$broken/" \
    >"build/fuzz/$target.log" 2>&1 || true
}
export -f run
export seconds LSAN_OPTIONS=suppressions=cmake/lsan.supp:print_suppressions=0
printf '%s\n' "$@" | xargs -P 2 -I{} bash -c 'run {}'

found=0
printf '| %-10s | %11s | %10s | %8s | %6s | %6s |\n' target executions 'a second' coverage corpus broken
printf '|---|---|---|---|---|---|\n'
for target in "$@"; do
  log=build/fuzz/$target.log
  executions=$(awk '/number_of_executed_units/ {print $2}' "$log")
  speed=$(awk '/average_exec_per_sec/ {print $2}' "$log")
  coverage=$(awk '{for (i = 1; i < NF; ++i) if ($i == "cov:") last = $(i + 1)} END {print last}' "$log")
  size=$(ls "build/fuzz/corpus/$target" | wc -l)
  broken=$(ls "build/fuzz/broken/$target" | wc -l)
  printf '| %-10s | %11s | %10s | %8s | %6s | %6s |\n' "$target" "${executions:-–}" "${speed:-–}" "${coverage:-–}" \
    "$size" "$broken"
  found=$((found + broken))
done
[ "$found" -eq 0 ]
