#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the filter over rendered scenes with one parameter changed at a time, and scores the labels
# against the true masks: the table in docs/parameters.md.
set -euo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--preset NAME] [--frames N] [--sequences DIR] [--output DIR] [SCENE...]

Prints a Markdown table, a row a setting: precision, recall and F1 of 'dynamic' and the share of static
points in boxes that were kept, over all scenes (default: walking_xyz crowd), and the filter's CPU
time a frame (the mean of the scenes). The preset must have been built.

  --preset NAME     whose binaries are used (default: release)
  --frames N        frames a scene (default: 60)
  --sequences DIR   folders that hmcdyn_synthesize rendered, one a scene; a scene that is missing
                    there is an error (default: OUTPUT, where missing ones are rendered)
  --output DIR      where sequences and runs go (default: build/sweep)
USAGE
}

preset=release
frames=60
output=
sequences=
scenes=()
while (($# > 0)); do
  case "$1" in
    --preset | --frames | --output | --sequences)
      (($# > 1)) || { usage >&2 && exit 2; }
      case "$1" in
        --preset) preset=$2 ;;
        --frames) frames=$2 ;;
        --output) output=$(realpath -m "$2") ;;
        --sequences) sequences=$(realpath -m "$2") ;;
      esac
      shift
      ;;
    --help | -h) usage && exit 0 ;;
    -*) usage >&2 && exit 2 ;;
    *) scenes+=("$1") ;;
  esac
  shift
done
cd "$(dirname "${BASH_SOURCE[0]}")/.."
output=${output:-$PWD/build/sweep}
bin=$PWD/build/$preset/bin
((${#scenes[@]} > 0)) || scenes=(walking_xyz crowd)

for scene in "${scenes[@]}"; do
  if [[ -n $sequences && ! -f $sequences/$scene/associations.txt ]]; then
    echo "${0##*/}: $sequences/$scene is no rendered sequence" >&2
    exit 1
  fi
  [[ -n $sequences || -f $output/$scene/associations.txt ]] || "$bin/hmcdyn_synthesize" \
    --scene "$scene" --frames "$frames" --output "$output/$scene" --overwrite --quiet
done
sequences=${sequences:-$output}

filter_ms() {
  python3 -c 'import json, sys
times = [json.load(open(file))["stages"]["filter"]["mean_cpu_ms"] for file in sys.argv[1:]]
print(f"{sum(times) / len(times):.1f}")' "$@"
}

row() {
  local name=$1 pairs=() summaries=()
  shift
  for scene in "${scenes[@]}"; do
    local status=0
    "$bin/hmcdyn_slam" --dataset "$sequences/$scene" \
      --camera "$sequences/$scene/calibration.yaml" --detector file \
      --boxes "$sequences/$scene/boxes.txt" --write-keypoints --no-dense-map --no-report --quiet \
      --max-frames "$frames" --output "$output/run_$scene" "$@" >"$output/run_$scene.log" 2>&1 || status=$?
    if ((status != 0 && status != 3)); then # 3: few frames tracked, which is a result
      echo "${0##*/}: '$name' failed on $scene, see $output/run_$scene.log" >&2
      echo "| $name | failed | | | | |"
      return
    fi
    pairs+=("$sequences/$scene:$output/run_$scene/keypoints.csv")
    summaries+=("$output/run_$scene/summary.json")
  done
  "$bin/hmcdyn_label_score" "${pairs[@]}" --skip-frames 3 |
    awk -v name="$name" -v ms="$(filter_ms "${summaries[@]}")" \
      'END { printf "| %s | %s | %s | %s | %s | %s |\n", name, $2, $3, $4, $5, ms }'
}

mkdir -p "$output"
echo "| setting | precision | recall | F1 | kept | filter (ms CPU) |"
echo "|---|---|---|---|---|---|"
row "defaults"
row "without beliefs (the paper's steps alone)" --no-belief
for sigma in 40 160; do
  row "vote sigma $sigma px" --vote-sigma "$sigma"
done
for gain in 0 1 4; do
  row "memory gain $gain" --memory-gain "$gain"
done
for weight in 0.1 0.6 1; do
  row "quiet weight $weight" --quiet-weight "$weight"
done
for belief in 0.5 0.7; do
  row "dynamic belief $belief" --dynamic-belief "$belief"
done
for window in 15 21; do # 11 is the default
  row "flow window $window px" --flow-window "$window"
done
row "forward and backward" --forward-backward
for count in 225 900 0; do # 450 is the default
  row "followed $count" --max-followed "$count"
done
row "the paper's rules (both floors 0)" --min-strongest-distance 0 --screening-floor 0
row "the neighbour alone" --baselines 0
row "0.1 s alone" --baselines 0.1
row "neighbour and 0.3 s" --baselines 0,0.3
for epsilon in 0.05 0.15 0.3; do
  row "d_eps $epsilon" --cluster-epsilon "$epsilon"
done
for scale in 0.02 0.1; do
  row "s_d $scale / px" --distance-scale "$scale"
done
for points in 3 8; do
  row "MinPoints $points" --cluster-min-points "$points"
done
row "strongest cluster from 0.4 px" --min-strongest-distance 0.4
row "strongest cluster from 1.2 px" --min-strongest-distance 1.2
for rule in box epipolar two_threshold chi2 depth_ransac; do
  row "rule $rule" --filter "$rule"
done
