#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Measures every kernel against its peers in one process each, and writes docs/benchmarks.md.
set -euo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--no-install] [--no-o2] [--repetitions N] [--filter REGEX] [--output FILE]

Builds the bench preset (-O3 -march=x86-64-v3) and a plain -O2 build, runs all benchmarks with random
interleaving, and writes tables of medians with ratios to the peers, and a plot of time against N.
Some 15 minutes on 2 cores. Nothing else should run on the machine meanwhile.

  --no-install   do not install missing packages, nor the optional peers (Open3D, PCL)
  --no-o2        without the plain -O2 build
  --repetitions N  that medians are of (default: 9)
  --filter REGEX   only these benchmarks, or with - in front all but these, by names such as
                   clustering/1000/hmcdyn, e.g. '-clustering/(316228|1000000)/' for a short run
  --output FILE  the page to write (default: docs/benchmarks.md)
  --help         this text
USAGE
}

usage_error() {
  echo "${0##*/}: $1" >&2
  usage >&2
  exit 2
}

install=true
plain=true
repetitions=9
filter=
output=
call="scripts/benchmark.sh $*"
while (($# > 0)); do
  case "$1" in
    --no-install) install=false ;;
    --no-o2) plain=false ;;
    --output | --repetitions | --filter)
      (($# > 1)) || usage_error "$1 needs a value"
      case "$1" in
        --output) output=$(realpath -m "$2") ;;
        --repetitions) repetitions=$2 ;;
        --filter) filter=$2 ;;
      esac
      shift
      ;;
    --help | -h) usage && exit 0 ;;
    *) usage_error "unknown argument $1" ;;
  esac
  shift
done
cd "$(dirname "${BASH_SOURCE[0]}")/.."
output=${output:-$PWD/docs/benchmarks.md}
command -v python3 >/dev/null || usage_error "python3 is missing; it makes the tables"

if $install; then
  scripts/install_dependencies.sh --bench
fi
[[ $repetitions =~ ^[1-9][0-9]*$ ]] || usage_error "--repetitions is '$repetitions'; expected a number above 0"
benches=(bench_clustering bench_epipolar bench_filter_stage bench_motion_mask bench_pose_refinement)
# With the examples only, and on real frames; HMCDYN_BENCH_FRAMES names a folder in TUM's format.
front_end=(bench_front_end)
export OMP_NUM_THREADS=1 # Open3D and PCL would take all cores

# build FOLDER CMAKE_ARGUMENT...
build() {
  local folder=$1
  shift
  echo "== Building $folder"
  cmake "$@" -DHMCDYN_BUILD_TESTS=OFF >/dev/null
  cmake --build "$folder" --parallel "$(nproc)" --target "${benches[@]}" "${front_end[@]}" >/dev/null
}

# run FOLDER: results in FOLDER/results/NAME.json
run() {
  local folder=$1 start=$SECONDS
  mkdir -p "$folder/results"
  rm -f "$folder"/results/*.json # of an earlier run, perhaps of other benchmarks
  for bench in "${benches[@]}" "${front_end[@]}"; do
    printf '== Running %s in %s ...' "$bench" "$folder"
    "$folder/bin/$bench" --benchmark_enable_random_interleaving=true \
      --benchmark_repetitions=$repetitions --benchmark_min_time=0.02 \
      ${filter:+--benchmark_filter="$filter"} --benchmark_out="$folder/results/$bench.json" \
      --benchmark_out_format=json >"$folder/results/$bench.log" 2>&1 ||
      {
        tail -n 5 "$folder/results/$bench.log" >&2
        exit 1
      }
    echo " $((SECONDS - start)) s so far"
  done
}

build build/bench --preset bench
run build/bench
folders=(build/bench)
front_end=()
if $plain; then
  build build/bench-o2 -S . -B build/bench-o2 -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_CXX_FLAGS_RELEASE="-O2 -DNDEBUG" -DHMCDYN_BUILD_BENCHMARKS=ON \
    -DHMCDYN_BUILD_EXAMPLES=OFF
  run build/bench-o2
  folders+=(build/bench-o2)
fi
python3 scripts/benchmark_page.py --output "$output" --notes docs/benchmarks_notes.md \
  --repetitions $repetitions --call "${call% }" "${folders[@]}"
echo "Wrote $output"
