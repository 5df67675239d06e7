#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs the filter over rendered scenes with one parameter changed at a time, and scores the labels
# against the true masks: the table in docs/parameters.md.
set -euo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--preset NAME] [--frames N] [--output DIR] [SCENE...]

Prints a Markdown table: F1 of 'dynamic' and the share of static points in boxes that were kept, over
all scenes (default: walking_xyz crowd), a row a setting. The preset must have been built.

  --preset NAME   whose binaries are used (default: release)
  --frames N      frames a scene (default: 60)
  --output DIR    where sequences and runs go (default: build/sweep)
USAGE
}

preset=release
frames=60
output=
scenes=()
while (($# > 0)); do
  case "$1" in
    --preset) preset=$2 && shift ;;
    --frames) frames=$2 && shift ;;
    --output) output=$2 && shift ;;
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
  [[ -f $output/$scene/associations.txt ]] || "$bin/hmcdyn_synthesize" --scene "$scene" \
    --frames "$frames" --output "$output/$scene" --overwrite --quiet
done

row() {
  local name=$1 pairs=()
  shift
  for scene in "${scenes[@]}"; do
    "$bin/hmcdyn_slam" --dataset "$output/$scene" --camera "$output/$scene/calibration.yaml" \
      --detector file --boxes "$output/$scene/boxes.txt" --write-keypoints --quiet \
      --output "$output/run_$scene" "$@" >/dev/null
    pairs+=("$output/$scene:$output/run_$scene/keypoints.csv")
  done
  "$bin/hmcdyn_label_score" "${pairs[@]}" --skip-frames 3 |
    awk -v name="$name" 'END { printf "| %s | %s | %s | %s | %s |\n", name, $2, $3, $4, $5 }'
}

echo "| setting | precision | recall | F1 | kept |"
echo "|---|---|---|---|---|"
row "defaults"
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
