#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Memory of a long run: loops a rendered sequence forth and back, tracks it, and samples the resident
# memory of hmcdyn_slam by frames done.
set -euo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} --sequence DIR [--frames N] [--every N] [--output DIR] [--preset NAME] [-- OPTION...]

Prints a Markdown table: frames done, resident memory (MiB); writes every sample to OUTPUT/memory.csv.
The time stamps go on through all rounds, so the camera's way is one of N frames through one place.
The preset must have been built. Linux only (/proc).

  --sequence DIR   folder that hmcdyn_synthesize rendered
  --frames N       frames of the run (default: 5000)
  --every N        frames between two rows of the table (default: 500)
  --output DIR     where sequence and results go (default: build/memory)
  --preset NAME    whose binary is used (default: release)
  -- OPTION...     further options of hmcdyn_slam
USAGE
}

sequence=
frames=5000
every=500
output=
preset=release
while (($# > 0)); do
  case "$1" in
    --sequence | --frames | --every | --output | --preset)
      (($# > 1)) || { usage >&2 && exit 2; }
      case "$1" in
        --sequence) sequence=$(realpath -m "$2") ;;
        --frames) frames=$2 ;;
        --every) every=$2 ;;
        --output) output=$(realpath -m "$2") ;;
        --preset) preset=$2 ;;
      esac
      shift
      ;;
    --help | -h) usage && exit 0 ;;
    --) shift && break ;;
    *) usage >&2 && exit 2 ;;
  esac
  shift
done
cd "$(dirname "${BASH_SOURCE[0]}")/.."
output=${output:-$PWD/build/memory}
slam=$PWD/build/$preset/bin/hmcdyn_slam
for file in associations.txt boxes.txt calibration.yaml groundtruth.txt; do
  [[ -f $sequence/$file ]] || { echo "${0##*/}: '$sequence/$file' is missing" >&2 && exit 1; }
done
[[ -x $slam ]] || { echo "${0##*/}: $slam is missing; build the preset first" >&2 && exit 1; }

looped=$output/sequence
rm -rf "$output/run"
mkdir -p "$looped"
ln -sfn "$sequence/rgb" "$looped/rgb"
ln -sfn "$sequence/depth" "$looped/depth"
cp "$sequence/calibration.yaml" "$looped/"

# The n frames of the sequence in the order 1 2 ... n ... 2 1 2 ...; each list's lines belong to the
# frame whose time stamp they begin with.
loop_list() {
  awk -v frames="$frames" '
    FNR == NR { stamp[++n] = $1; next }
    /^#/ { next }
    { line = $0; sub(/^[^ ]+/, "", line); rows[$1] = rows[$1] line "\n" }
    END {
      period = n > 1 ? 2 * (n - 1) : 1
      for (k = 0; k < frames; ++k) {
        j = k % period
        if (j >= n) j = period - j
        now = sprintf("%.6f", stamp[1] + k / 30)
        count = split(rows[stamp[j + 1]], part, "\n") - 1
        for (i = 1; i <= count; ++i) print now part[i]
      }
    }' "$sequence/associations.txt" "$1"
}
loop_list "$sequence/groundtruth.txt" >"$looped/groundtruth.txt"
loop_list "$sequence/boxes.txt" >"$looped/boxes.txt"
loop_list "$sequence/associations.txt" >"$looped/associations.txt"

"$slam" --dataset "$looped" --camera "$looped/calibration.yaml" --detector file \
  --boxes "$looped/boxes.txt" --output "$output/run" --quiet "$@" >"$output/log.txt" 2>&1 &
pid=$!
trap 'kill "$pid" 2>/dev/null || true' EXIT

samples=$output/memory.csv
echo 'frames,rss_mib,peak_mib' >"$samples"
while kill -0 "$pid" 2>/dev/null; do
  memory=$(awk '/^VmRSS/ { rss = $2 } /^VmHWM/ { peak = $2 }
                END { if (rss) printf "%.1f,%.1f", rss / 1024, peak / 1024 }' \
    "/proc/$pid/status" 2>/dev/null) || true
  rows=0
  [[ -f $output/run/timings.csv ]] && rows=$(wc -l <"$output/run/timings.csv")
  [[ -n $memory ]] && echo "$((rows > 0 ? rows - 1 : 0)),$memory" >>"$samples"
  sleep 0.2
done
status=0
wait "$pid" || status=$?
trap - EXIT

echo '| frames | memory (MiB) | peak so far (MiB) |'
echo '|---|---|---|'
awk -F, -v every="$every" 'NR > 1 { last = $0 }
  NR > 1 && $1 >= next_row { print "| " $1 " | " $2 " | " $3 " |"; next_row = $1 - $1 % every + every }
  END { split(last, field, ","); print "| end | " field[2] " | " field[3] " |" }' "$samples"
cat "$output/log.txt"
exit "$status"
