#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# From nothing to a result: installs, builds, renders a dynamic sequence, runs the SLAM with and
# without the filter, evaluates both, writes pictures and prints the comparison.
set -euo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--scene NAME] [--frames N] [--output DIR] [--no-install]

Renders a sequence with people who walk, tracks the camera with --filter none and --filter robust, and
compares both with the exact truth.

  --scene NAME    scene to render (default: crowd; hmcdyn_synthesize --list names all)
  --frames N      its length (default: 120, which is 4 s)
  --output DIR    where the results go (default: build/demo)
  --no-install    do not look for missing packages
  --help          this text
USAGE
}

usage_error() {
  echo "${0##*/}: $1" >&2
  usage >&2
  exit 2
}

scene=crowd
frames=120
output=
install=true
while (($# > 0)); do
  case "$1" in
    --scene | --frames | --output)
      (($# > 1)) || usage_error "$1 needs a value"
      case "$1" in
        --scene) scene=$2 ;;
        --frames) frames=$2 ;;
        --output) output=$(realpath -m "$2") ;;
      esac
      shift
      ;;
    --no-install) install=false ;;
    --help | -h) usage && exit 0 ;;
    *) usage_error "unknown argument $1" ;;
  esac
  shift
done
[[ $frames =~ ^[1-9][0-9]*$ ]] || usage_error "--frames is '$frames'; expected a number above 0"

cd "$(dirname "${BASH_SOURCE[0]}")/.."
output=${output:-$PWD/build/demo}
bin=$PWD/build/release/bin
sequence=$output/$scene

if $install; then
  scripts/install_dependencies.sh
fi
echo "== Building"
cmake --preset release -DHMCDYN_BUILD_TESTS=OFF >/dev/null
cmake --build --preset release --parallel "$(nproc)"

echo "== Rendering $scene, $frames frames"
"$bin/hmcdyn_synthesize" --scene "$scene" --frames "$frames" --output "$sequence" --overwrite

for filter in none robust; do
  echo "== Tracking with --filter $filter"
  rm -rf "$output/$filter/frames" # those of an earlier demo, which may have been longer
  "$bin/hmcdyn_slam" --dataset "$sequence" --camera "$sequence/calibration.yaml" \
    --detector file --boxes "$sequence/boxes.txt" --filter "$filter" --annotate --write-keypoints \
    --output "$output/$filter"
done

echo "== Comparing with the truth"
"$bin/hmcdyn_evaluate" summary --groundtruth "$sequence/groundtruth.txt" \
  --baseline "none=$output/none/trajectory.txt" --estimate "robust=$output/robust/trajectory.txt" \
  --associations "$sequence/associations.txt" --plot "$output/comparison.png" |
  tee "$output/comparison.txt"
echo
echo "Labels against the masks (people who move):"
"$bin/hmcdyn_label_score" "$sequence:$output/robust/keypoints.csv" | tee "$output/labels.txt"
echo
echo "Time a frame (ms, mean):"
for filter in none robust; do
  awk -F, -v name="$filter" '
    NR == 1 { for (i = 2; i <= NF; ++i) if ($i !~ /_cpu_ms$/) head[i] = $i }
    NR > 1 { for (i in head) sum[i] += $i; ++rows }
    END {
      printf "  %-5s", name
      for (i = 2; i in head; ++i) { sub(/_wall_ms$/, "", head[i]); printf "  %s %.1f", head[i], sum[i] / rows }
      print ""
    }' "$output/$filter/timings.csv"
done
"$bin/hmcdyn_side_by_side" "$output/none/frames" "$output/robust/frames" 4 "$output/frames.png"
echo
echo "Open $output/robust/report.html in a browser: the whole run on one page."
echo "Look at $output/comparison.png (trajectories, error over time) and $output/frames.png (labels, filter off and on); all frames: $output/{none,robust}/frames"
