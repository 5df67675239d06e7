#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds the libFuzzer targets (clang) and runs each for a while.
set -euo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--seconds N] [--jobs N] [--no-build] [TARGET...]

Builds the libFuzzer targets with AddressSanitizer and UndefinedBehaviorSanitizer (preset asan-ubsan) and
runs each, from the seeds in fuzz/corpus and what earlier runs found (build/fuzz/corpus). An input that
breaks something is written to build/fuzz/found. Fails when there is one.

  --seconds N   how long each runs (default: 60)
  --jobs N      compile jobs, and targets that run, at a time (default: number of processors, $(nproc))
  --no-build    take the targets as they are
  TARGET        of: ${targets[*]} (default: all)
USAGE
}

cd "$(dirname "${BASH_SOURCE[0]}")/.."
mapfile -t targets < <(sed -n 's/^hmcdyn_add_fuzzer(\([a-z_]*\).*/\1/p' fuzz/CMakeLists.txt)
seconds=60
jobs=$(nproc)
build=true
chosen=()
while (($# > 0)); do
  case "$1" in
    --seconds | --jobs)
      [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || { echo "${0##*/}: $1 needs a number above 0" >&2 && exit 2; }
      if [[ $1 == --seconds ]]; then seconds=$2; else jobs=$2; fi
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
  cmake --preset asan-ubsan >/dev/null
  cmake --build --preset fuzz --parallel "$jobs"
fi

# Readers open a file a run; one in memory costs less.
[[ -w /dev/shm ]] && export TMPDIR=${TMPDIR:-/dev/shm}
export SECONDS_A_TARGET=$seconds

# Runs target $1; its verdict on standard output, in one piece.
run() {
  local target=$1 verdict=clean runs coverage
  local corpus=build/fuzz/corpus/$target log=build/fuzz/$target.log seeds=()
  mkdir -p "$corpus" build/fuzz/found
  [[ -d fuzz/corpus/$target ]] && seeds=("fuzz/corpus/$target")
  build/asan-ubsan/bin/fuzz_"$target" -max_total_time="$SECONDS_A_TARGET" -max_len=4096 -timeout=10 \
    -rss_limit_mb=2048 -print_final_stats=1 -artifact_prefix="build/fuzz/found/$target-" \
    "$corpus" "${seeds[@]}" >"$log" 2>&1 || verdict=FAILED
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  coverage=$(sed -n 's/^#[0-9].* cov: \([0-9]*\) .*/\1/p' "$log" | tail -n 1)
  echo "fuzz_$target: $verdict, ${runs:-?} executions in $SECONDS_A_TARGET s, ${coverage:-?} edges"
  [[ $verdict == clean ]] && return
  grep -m 3 -E '^(violated|SUMMARY|==[0-9]+==)' "$log" || tail -n 20 "$log"
  return 1
}
export -f run

# shellcheck disable=SC2016 # $1 is the inner shell's
printf '%s\0' "${chosen[@]}" | xargs -0 -n 1 -P "$jobs" bash -c 'run "$1"' run
