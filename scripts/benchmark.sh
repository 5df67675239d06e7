#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Builds and runs the benchmarks and writes docs/benchmarks.md.
set -euo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--no-install] [--repetitions N] [--filter REGEX]

Installs the optional peers (Open3D, PCL), builds the bench preset, runs every benchmark program with
random interleaving and writes docs/benchmarks.md. The raw results stay in build/bench/results.

  --no-install      take the peers that are there
  --repetitions N   of each benchmark (default: 9)
  --filter REGEX    only benchmarks whose name matches
  --help            this text
USAGE
}

install=true
repetitions=9
filter=.
while (($# > 0)); do
  case "$1" in
    --no-install) install=false ;;
    --repetitions) repetitions=${2:?} && shift ;;
    --filter) filter=${2:?} && shift ;;
    --help | -h) usage && exit 0 ;;
    *)
      echo "${0##*/}: unknown argument $1" >&2
      usage >&2
      exit 2
      ;;
  esac
  shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.."
if $install; then
  scripts/install_dependencies.sh
  as_root=()
  ((EUID == 0)) || as_root=(sudo)
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y install \
    --no-install-recommends libopen3d-dev libpcl-dev ||
    echo "${0##*/}: Open3D and PCL could not be installed; going on without" >&2
fi

programs=(bench_clustering bench_filter_stage bench_epipolar)
[[ -f bench/bench_pose_refinement.cpp ]] && programs+=(bench_pose_refinement)
cmake --preset bench
cmake --build --preset bench --target "${programs[@]}"

results=build/bench/results
rm -rf "$results"
mkdir -p "$results"
export OMP_NUM_THREADS=1
for program in "${programs[@]}"; do
  echo "Running $program"
  "build/bench/bin/$program" --benchmark_filter="$filter" \
    --benchmark_repetitions="$repetitions" --benchmark_enable_random_interleaving=true \
    --benchmark_min_time=0.05 --benchmark_out="$results/$program.json" \
    --benchmark_out_format=json >/dev/null
done
machine="$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -1), $(getconf _NPROCESSORS_ONLN) cores; $(c++ --version | head -1); $(date -u +%F)"
python3 scripts/benchmark_report.py "$results" --machine "$machine" \
  --command "scripts/benchmark.sh --repetitions $repetitions --filter $filter" \
  --notes docs/benchmarks_notes.md >docs/benchmarks.md
echo "Written: docs/benchmarks.md"
