#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs clang-tidy over our .cpp files and the headers they include.
set -uo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--jobs N] [--since REVISION | --all | FILE...]

Runs clang-tidy with the checks of .clang-tidy over the given files, or over all .cpp files of the
library and the examples with the headers they include. A file that passed is not looked at again
until it, a header it includes, its flags or the checks change.

  --since REVISION  only .cpp files and headers that changed since then (of git: HEAD~5, main, v0.1.0)
  --all             the tests, too (some 20 minutes more on 2 cores)
  --jobs N          files at a time (default: number of processors, $(nproc))
  --help            this text
USAGE
}

usage_error() {
  echo "${0##*/}: $1" >&2
  usage >&2
  exit 2
}

jobs=$(nproc)
since=
left_out='^tests/'
files=()
while (($# > 0)); do
  case "$1" in
    --jobs | --since)
      (($# > 1)) || usage_error "$1 needs a value"
      declare "${1#--}=$2"
      shift
      ;;
    --all) left_out='^$' ;;
    --help | -h) usage && exit 0 ;;
    -*) usage_error "unknown argument $1" ;;
    *) files+=("$(realpath -s "$1")") ;;
  esac
  shift
done
[[ $jobs =~ ^[1-9][0-9]*$ ]] || usage_error "--jobs is '$jobs'; expected a number above 0"

cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
export ROOT=$PWD BUILD=$PWD/build/tidy
# Configured only: the compile commands are all that is asked of it.
if ! configured=$(cmake --preset tidy 2>&1); then
  echo "$configured"
  exit 1
fi
if ((${#files[@]} == 0)); then
  if [[ -n $since ]]; then
    changed=$(git diff --name-only --diff-filter=d "$since" -- '*.cpp' '*.hpp') ||
      usage_error "--since is '$since', which git does not know"
    mapfile -t sources < <(grep -E '^(src|examples)/.*\.cpp$' <<<"$changed")
    files=("${sources[@]/#/$ROOT/}")
    # A header by itself where none of these sources shows it.
    while read -r header; do
      if ! grep -qsE "^#include [\"<]${header#*/}[\">]" "${sources[@]}" /dev/null; then
        files+=("$ROOT/$header")
      fi
    done < <(grep -E '^(src|examples|include)/.*\.hpp$' <<<"$changed")
    if ((${#files[@]} == 0)); then
      echo "clang-tidy: no source of the library or the examples changed since $since"
      exit 0
    fi
  else
    # Generated sources lie in the build folder and are not ours to tidy.
    mapfile -t files < <(sed -n "s|^ *\"file\": \"$ROOT/\(.*\)\",\{0,1\}$|\1|p" "$BUILD/compile_commands.json" |
      grep -v '^build/' | grep -v "$left_out" | sort -u | sed "s|^|$ROOT/|")
  fi
fi

export CACHE=$BUILD/passed FAILED=$BUILD/failed
rm -rf "$FAILED"
mkdir -p "$CACHE" "$FAILED"
VERSION=$(clang-tidy --version) || exit 1
export VERSION

# What the verdict on a file depends on: the tool, the checks, the flags, and all text it sees.
fingerprint() {
  local command
  command=$(grep -F -- "-c $1\"" "$BUILD/compile_commands.json" | head -n 1 |
    sed 's/^ *"command": "\(.*\)",$/\1/; s/\\"/"/g; s/\\\\/\\/g; s/ -o [^ ]* -c / -E -C /')
  # A header has no command of its own; clang-tidy takes a neighbour's.
  [[ -n $command ]] || return
  {
    echo "$VERSION $command"
    cat "$ROOT/.clang-tidy"
    (cd "$BUILD" && eval "$command")
  } | sha256sum | cut -d' ' -f1
}
export -f fingerprint

tidy_file() {
  local name=${1#"$ROOT"/} print start=$SECONDS
  print=$(fingerprint "$1")
  [[ -n $print && -f $CACHE/$print ]] && return
  if output=$(clang-tidy -p "$BUILD" --quiet "$1" 2>&1); then
    echo "$name: passed in $((SECONDS - start)) s"
    [[ -z $print ]] || touch "$CACHE/$print"
  else
    printf '%s: failed\n%s\n' "$name" "$output"
    touch "$FAILED/${name//\//_}"
  fi
}
export -f tidy_file

# shellcheck disable=SC2016 # $1 is the inner shell's
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$jobs" bash -c 'tidy_file "$1"' tidy_file
status=$?
failed=$(find "$FAILED" -type f | wc -l)
echo "clang-tidy: ${#files[@]} files, $failed failed, $((SECONDS / 60)) min $((SECONDS % 60)) s"
((failed == 0 && status == 0))
