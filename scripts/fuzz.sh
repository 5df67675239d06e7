#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the libFuzzer targets (clang) and runs each for a while.
set -euo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--seconds N] [--no-build] [TARGET...]

Builds the libFuzzer targets with AddressSanitizer and UndefinedBehaviorSanitizer and runs each, one
after the other, from the seeds in fuzz/corpus and what earlier runs found (build/fuzz/corpus). An input
that breaks something is written to build/fuzz/found. Fails when there is one.

  --seconds N   how long each runs (default: 60)
  --no-build    take the targets as they are
  TARGET        of: ${targets[*]} (default: all)
USAGE
}

cd "$(dirname "${BASH_SOURCE[0]}")/.."
mapfile -t targets < <(sed -n 's/^hmcdyn_add_fuzzer(\([a-z_]*\).*/\1/p' fuzz/CMakeLists.txt)
seconds=60
build=true
chosen=()
while (($# > 0)); do
  case "$1" in
    --seconds)
      [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || { echo "${0##*/}: --seconds needs a number above 0" >&2 && exit 2; }
      seconds=$2
      shift
      ;;
    --no-build) build=false ;;
    --help | -h) usage && exit 0 ;;
    *)
      if [[ " ${targets[*]} " != *" $1 "* ]]; then
        echo "${0##*/}: unknown argument $1" >&2
        usage >&2
        exit 2
      fi
      chosen+=("$1")
      ;;
  esac
  shift
done
((${#chosen[@]} > 0)) || chosen=("${targets[@]}")

if $build; then
  cmake --preset fuzz >/dev/null
  cmake --build --preset fuzz
fi

failed=0
for target in "${chosen[@]}"; do
  corpus=build/fuzz/corpus/$target
  log=build/fuzz/$target.log
  mkdir -p "$corpus" build/fuzz/found
  seeds=()
  [[ -d fuzz/corpus/$target ]] && seeds=("fuzz/corpus/$target")
  verdict=clean
  build/fuzz/bin/fuzz_"$target" -max_total_time="$seconds" -max_len=4096 -timeout=10 \
    -rss_limit_mb=2048 -print_final_stats=1 -artifact_prefix="build/fuzz/found/$target-" \
    "$corpus" "${seeds[@]}" >"$log" 2>&1 || verdict=FAILED
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  echo "fuzz_$target: $verdict, ${runs:-?} executions in $seconds s"
  if [[ $verdict == FAILED ]]; then
    failed=$((failed + 1))
    grep -m 3 -E '^(violated|SUMMARY|==[0-9]+==)' "$log" || tail -n 20 "$log"
  fi
done
((failed == 0))
