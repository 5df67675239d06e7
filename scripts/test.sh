#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what is missing, configures, builds and runs every test.
set -uo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--preset NAME] [--label NAME] [--jobs N] [--no-install]

Installs what is missing, configures, builds and runs every test. The last line says how it went.

  --preset NAME   preset of CMakePresets.json: ci (default), debug, release, asan-ubsan, tsan, bench
  --label NAME    only the tests with this label, and what they need: threads (code that starts threads)
  --jobs N        compile and test jobs at a time (default: number of processors, $(nproc))
  --no-install    do not look for missing packages
  --help          this text
USAGE
}

usage_error() {
  echo "${0##*/}: $1" >&2
  usage >&2
  exit 2
}

preset=ci
label=
jobs=$(nproc)
install=true
while (($# > 0)); do
  case "$1" in
    --preset | --label | --jobs)
      (($# > 1)) || usage_error "$1 needs a value"
      declare "${1#--}=$2"
      shift
      ;;
    --no-install) install=false ;;
    --help | -h) usage && exit 0 ;;
    *) usage_error "unknown argument $1" ;;
  esac
  shift
done
[[ $jobs =~ ^[1-9][0-9]*$ ]] || usage_error "--jobs is '$jobs'; expected a number above 0"
[[ -z $label || $label == threads ]] || usage_error "--label is '$label'; expected threads"

cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
results=$PWD/build/$preset/test_results.xml
cases=$PWD/build/$preset/test_results

finish() {
  printf 'hmcdyn tests (preset %s%s, %d min %d s): %s\n' "$preset" "${label:+, label $label}" \
    $((SECONDS / 60)) $((SECONDS % 60)) "$2"
  exit "$1"
}

if $install; then
  options=()
  [[ $preset == asan-ubsan ]] && options=(--clang)
  scripts/install_dependencies.sh "${options[@]}" || finish 1 "dependencies are missing"
fi
cmake --preset "$preset" || finish 1 "configuring failed"
build=(--preset "$preset" --parallel "$jobs")
run=(--preset "$preset" --parallel "$jobs")
if [[ -n $label ]]; then
  build+=(--target "tests_$label") # the label's tests have a target of their own
  run+=(--label-regex "^$label\$")
fi
cmake --build "${build[@]}" || finish 1 "building failed"

rm -rf "$results" "$cases"
ctest "${run[@]}" --no-tests=error --output-junit "$results"
status=$?
[[ -f $results ]] || finish 1 "no test ran"
shopt -s nullglob
read -r passed failed skipped < <(awk -f scripts/count_tests.awk results="$results" folder="$cases" \
  "$cases"/*.xml "$results")
finish "$status" "$passed passed, $failed failed, $skipped skipped"
