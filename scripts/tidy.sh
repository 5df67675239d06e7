#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Runs clang-tidy over our .cpp files and the headers they include.
set -uo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--jobs N] [--together] [--since REVISION | --all | FILE...]

Runs clang-tidy with the checks of .clang-tidy over the given files, or over all .cpp files of the
library, the examples and the Python module with the headers they include. A file that passed is not
looked at again until it, a header it includes, its flags or the checks change.

  --since REVISION  only .cpp files and headers that changed since then (of git: HEAD~5, main, v0.1.0)
  --together        sources that a unity build compiles as one are looked at as one, with those beside them:
                    a fifth of the time; misc-unused-using-decls sees no source then
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
together=false
left_out='^(python/)?tests/'
files=()
while (($# > 0)); do
  case "$1" in
    --jobs | --since)
      (($# > 1)) || usage_error "$1 needs a value"
      declare "${1#--}=$2"
      shift
      ;;
    --all) left_out='^$' ;;
    --together) together=true ;;
    --help | -h) usage && exit 0 ;;
    -*) usage_error "unknown argument $1" ;;
    *)
      [[ -f $1 ]] || usage_error "$1 is no file"
      files+=("$(realpath -s "$1")")
      ;;
  esac
  shift
done
[[ $jobs =~ ^[1-9][0-9]*$ ]] || usage_error "--jobs is '$jobs'; expected a number above 0"

cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
export ROOT=$PWD BUILD=$PWD/build/tidy
# Configured only: the compile commands are all that is asked of it, and what the Python module includes.
configure() {
  local folder=$1 configured
  shift
  if ! configured=$(cmake --preset tidy -B "$folder" "$@" 2>&1 &&
    { ! grep -q hmcdyn_python_comments "$folder/build.ninja" || cmake --build "$folder" --target hmcdyn_python_comments; } 2>&1); then
    echo "$configured"
    exit 1
  fi
}
configure "$BUILD"
if ((${#files[@]} == 0)); then
  if [[ -n $since ]]; then
    changed=$(git diff --name-only --diff-filter=d "$since" -- '*.cpp' '*.hpp') ||
      usage_error "--since is '$since', which git does not know"
    mapfile -t sources < <(grep -E '^(src|examples|python/src)/.*\.cpp$' <<<"$changed")
    files=("${sources[@]/#/$ROOT/}")
    # A header by itself where none of these sources shows it.
    while read -r header; do
      name=${header#python/}
      if ! grep -qsE "^#include [\"<]${name#*/}[\">]" "${sources[@]}" /dev/null; then
        files+=("$ROOT/$header")
      fi
    done < <(grep -E '^(src|examples|include|python/src)/.*\.hpp$' <<<"$changed")
    if ((${#files[@]} == 0)); then
      echo "clang-tidy: no source of the library or the examples changed since $since"
      exit 0
    fi
  else
    # Generated sources lie in the build folder and are not ours to tidy.
    mapfile -t files < <(sed -n "s|^ *\"file\": \"$ROOT/\(.*\)\",\{0,1\}$|\1|p" "$BUILD/compile_commands.json" |
      grep -v '^build/' | grep -vE "$left_out" | sort -u | sed "s|^|$ROOT/|")
  fi
fi

# The unity sources in place of what they include. A header stays where none of their sources includes it.
unite() {
  local file name units chosen sources beside
  mapfile -t units < <(find "$UNITED" -path '*/Unity/*.cxx' -not -path '*/tests/*' | sort)
  mapfile -t chosen < <(for file in "${files[@]}"; do
    [[ $file == *.hpp ]] || grep -lF "\"$file\"" "${units[@]}" /dev/null | head -n 1 | grep . || echo "$file"
  done | sort -u)
  mapfile -t sources < <(sed -n 's/^#include "\(\/.*\)"$/\1/p' "${chosen[@]}" /dev/null)
  sources+=("${chosen[@]}")
  printf '%s\n' "${chosen[@]}"
  for file in "${files[@]}"; do
    name=${file#"$ROOT"/}
    name=${name#python/}
    mapfile -t beside < <(printf '%s\n' "${sources[@]}" | grep -E "^${file%/*}/[^/]*$")
    if [[ $file == *.hpp ]] && ! grep -qsE "^#include [\"<]${name#*/}[\">]" "${sources[@]}" /dev/null &&
      ! grep -qsF "#include \"${file##*/}\"" "${beside[@]}" /dev/null; then
      echo "$file"
    fi
  done
}
export UNITED=$ROOT/build/tidy-united
if $together; then
  configure "$UNITED" -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=0
  mapfile -t files < <(unite)
  # Of what a build generates, the sources that these include.
  mapfile -t generated < <(sed -n "s|^#include \"$UNITED/\(.*\)\"$|\1|p" "${files[@]}" /dev/null | sort -u)
  if ((${#generated[@]} > 0)) && ! output=$(cmake --build "$UNITED" --target "${generated[@]}" 2>&1); then
    echo "$output"
    exit 1
  fi
fi

export CACHE=$BUILD/passed FAILED=$BUILD/failed
rm -rf "$FAILED"
mkdir -p "$CACHE" "$FAILED"
VERSION=$(clang-tidy --version) || exit 1

# The same is found without the plug-in, where clang's headers are missing, in five times the time.
plugin=$ROOT/scripts/tidy/own_declarations.cpp
headers=$(dirname "$(realpath "$(command -v clang-tidy)")")/../include # of the same version
VERSION+=$(cat "$plugin")
PLUGIN=$BUILD/own_declarations-$(sha256sum <<<"$VERSION" | cut -c-8).so
if [[ ! -f $PLUGIN ]] && { [[ ! -f $headers/clang/AST/ASTContext.h || ! -d $headers/llvm ]] ||
  ! c++ -std=c++17 -fno-rtti -fPIC -shared -isystem "$headers" "$plugin" -o "$PLUGIN"; }; then
  echo "clang-tidy: slowly, without scripts/tidy/own_declarations.cpp (libclang-dev, llvm-dev)"
  PLUGIN=
fi
export VERSION PLUGIN

# The flags that a file is compiled with. A header has no command of its own: it gets that of a source next to it,
# or of one in the nearest folder above (src/ for those of include/). clang-tidy by itself takes the source of the
# most similar name, which may be one that sees neither Eigen nor OpenCV.
flags() {
  local folder line
  folder=$(dirname "${1/#$ROOT\/include\/hmcdyn/$ROOT\/src}")
  line=$(grep -h -m 1 -F -- " -c $1\"" "$BUILD/compile_commands.json" "$UNITED/compile_commands.json" 2>/dev/null |
    head -n 1) # a source that is in no unit is in both
  while [[ -z $line && $folder == "$ROOT"/* ]]; do
    line=$(grep -m 1 -F -- " -c $folder/" "$BUILD/compile_commands.json")
    folder=$(dirname "$folder")
  done
  sed 's/^ *"command": "[^ ]* \(.*\) -o [^ ]* -c [^ ]*$/\1/; s/\\"/"/g; s/\\\\/\\/g' <<<"$line"
}
export -f flags

# What the verdict on a file depends on: the tool, the checks, the flags, and all text it sees.
fingerprint() {
  {
    echo "$VERSION $2"
    cat "$ROOT/.clang-tidy"
    # A header is no main file, says the compiler; what else it says, clang-tidy says again.
    (cd "$BUILD" && eval "c++ $2 -E -C -x c++ $1" 2>/dev/null)
  } | sha256sum | cut -d' ' -f1
}
export -f fingerprint

tidy_file() {
  local name=${1#"$ROOT"/} options=() flags print output start=$SECONDS
  if [[ $1 == "$UNITED"/* ]]; then # sources that are included are no headers, but ours
    options=(--checks=-bugprone-suspicious-include "--header-filter=$ROOT/(include|src|examples|bench|python/src)/")
  fi
  [[ -z $PLUGIN ]] || options+=("--load=$PLUGIN")
  flags=$(flags "$1")
  print=$(fingerprint "$1" "$flags")
  [[ ! -f $CACHE/$print ]] || return 0
  if output=$(cd "$BUILD" && eval "clang-tidy --quiet ${options[*]@Q} $1 -- $flags" 2>&1); then
    echo "$name: passed in $((SECONDS - start)) s"
    touch "$CACHE/$print"
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
