#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs clang-tidy over our .cpp files and the headers they include.
set -uo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--preset NAME] [--jobs N] [--all | FILE...]

Runs clang-tidy with the checks of .clang-tidy over the given .cpp files, or over the library and
the examples. The preset must have been built. A file that passed is not looked at again until it, a
header it includes, its flags or the checks change.

  --preset NAME   preset whose compile commands are used (default: ci)
  --jobs N        files at a time (default: number of processors, $(nproc))
  --all           the tests, too (some 20 minutes more on 2 cores)
  --help          this text
USAGE
}

preset=ci
jobs=$(nproc)
left_out='/tests/'
files=()
while (($# > 0)); do
  case "$1" in
    --preset) preset=${2:-} && shift ;;
    --jobs) jobs=${2:-} && shift ;;
    --all) left_out='^$' ;;
    --help | -h) usage && exit 0 ;;
    -*)
      echo "${0##*/}: unknown argument $1" >&2
      usage >&2
      exit 2
      ;;
    *) files+=("$(realpath -s "$1")") ;;
  esac
  shift
done

cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
export ROOT=$PWD
export BUILD=$PWD/build/$preset
commands=$BUILD/compile_commands.json
if [[ ! -f $commands ]]; then
  echo "${0##*/}: $commands is missing; run scripts/test.sh --preset $preset first" >&2
  exit 1
fi
if ((${#files[@]} == 0)); then
  # Generated sources lie in the build folder and are not ours to tidy.
  mapfile -t files < <(sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' "$commands" |
    grep -v "^$BUILD/" | grep -v "$left_out" | sort -u)
fi

export CACHE=$BUILD/tidy
rm -rf "$CACHE/failed"
mkdir -p "$CACHE/passed" "$CACHE/failed"
VERSION=$(clang-tidy --version) || exit 1
export VERSION

# What the verdict on a file depends on: the tool, the checks, the flags, and all files it includes.
fingerprint() {
  local command object
  command=$(grep -F -- "-c $1\"" "$BUILD/compile_commands.json")
  object=$(sed -n '1s/.* -o \([^ ]*\) .*/\1/p' <<<"$command")
  {
    echo "$VERSION"
    echo "$command"
    cat "$ROOT/.clang-tidy" "$1"
    (cd "$BUILD" && ninja -t deps "$object" | sed -n 's/^    //p' | xargs -r sha256sum)
  } | sha256sum | cut -d' ' -f1
}
export -f fingerprint

tidy_file() {
  local name=${1#"$ROOT"/} stamp start=$SECONDS
  stamp=$CACHE/passed/$(fingerprint "$1")
  [[ -f $stamp ]] && return
  if output=$(clang-tidy -p "$BUILD" --quiet "$1" 2>&1); then
    echo "$name: passed in $((SECONDS - start)) s"
    touch "$stamp"
  else
    printf '%s: failed\n%s\n' "$name" "$output"
    touch "$CACHE/failed/${name//\//_}"
  fi
}
export -f tidy_file

# shellcheck disable=SC2016 # $1 is the inner shell's
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$jobs" bash -c 'tidy_file "$1"' tidy_file
status=$?
failed=$(find "$CACHE/failed" -type f | wc -l)
echo "clang-tidy: ${#files[@]} files, $failed failed, $((SECONDS / 60)) min $((SECONDS % 60)) s"
((failed == 0 && status == 0))
