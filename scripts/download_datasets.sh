#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Fetches the public sequences of the paper's experiments: TUM RGB-D (Sturm et al. 2012) and BONN RGB-D
# Dynamic (Palazzolo et al. 2019). Goes on where it was stopped.
set -euo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} --output DIR [options] [SEQUENCE...]

Downloads and unpacks sequences into DIR, for scripts/reproduce.sh --datasets DIR. Without names: all.

  --output DIR       where the sequences go; archives are kept in DIR/archives
  --checksums FILE   SHA-256 sums as sha256sum writes them; an archive that differs, or that the file
                     does not name, is an error
  --remove-archives  delete each archive once it is unpacked
  --list             the names, and nothing else
  --tum URL          folder of TUM's archives (default: $tum)
  --bonn URL         folder of BONN's archives (default: $bonn)
  --help             this text

We know of no checksums that the two sites publish, and ship none that we could not verify. Each archive
is tested as a whole before it is unpacked, and its sum is written to DIR/archives/SHA256SUMS: later
calls compare with that, and --checksums takes it to other machines.
Exit code: 0 all there, 1 a download failed or an archive is damaged, 2 wrong usage.
USAGE
}

fail() {
  echo "${0##*/}: $1" >&2
  exit "${2:-1}"
}

tum=https://cvg.cit.tum.de/rgbd/dataset/freiburg3
bonn=https://www.ipb.uni-bonn.de/html/projects/rgbd_dynamic2019
all=(rgbd_dataset_freiburg3_sitting_halfsphere rgbd_dataset_freiburg3_sitting_static
  rgbd_dataset_freiburg3_walking_halfsphere rgbd_dataset_freiburg3_walking_rpy
  rgbd_dataset_freiburg3_walking_static rgbd_dataset_freiburg3_walking_xyz rgbd_bonn_crowd
  rgbd_bonn_crowd2 rgbd_bonn_crowd3 rgbd_bonn_synchronous2)
output=
checksums=
remove=false
names=()
while (($# > 0)); do
  case "$1" in
    --output | --checksums | --tum | --bonn)
      (($# > 1)) || fail "$1 needs a value" 2
      case "$1" in
        --output) output=$(realpath -m "$2") ;;
        --checksums) checksums=$(realpath -m "$2") ;;
        --tum) tum=${2%/} ;;
        --bonn) bonn=${2%/} ;;
      esac
      shift
      ;;
    --remove-archives) remove=true ;;
    --list) printf '%s\n' "${all[@]}" && exit 0 ;;
    --help | -h) usage && exit 0 ;;
    -*) usage >&2 && fail "unknown argument $1" 2 ;;
    *) names+=("$1") ;;
  esac
  shift
done
[[ -n $output ]] || { usage >&2 && fail "expected --output DIR" 2; }
((${#names[@]} > 0)) || names=("${all[@]}")
for name in "${names[@]}"; do
  [[ " ${all[*]} " == *" $name "* ]] || fail "'$name' is unknown; --list names all" 2
done
[[ -z $checksums || -f $checksums ]] || fail "--checksums: $checksums is no file" 2
command -v curl >/dev/null || fail "curl is missing (apt-get install curl)"
[[ " ${names[*]}" != *" rgbd_bonn"* ]] || command -v unzip >/dev/null ||
  fail "unzip is missing, BONN's archives need it (apt-get install unzip)"

archives=$output/archives
sums=$archives/SHA256SUMS
mkdir -p "$archives"
touch "$sums"

url_of() {
  case "$1" in
    rgbd_bonn*) echo "$bonn/$1.zip" ;;
    *) echo "$tum/$1.tgz" ;;
  esac
}

is_whole() {
  case "$2" in
    *.zip) unzip -tqq "$1" >/dev/null 2>&1 ;;
    *) gzip -t "$1" 2>/dev/null ;;
  esac
}

# Downloads into FILE.part and renames it at the end, so that FILE is always whole.
download() {
  local url=$1 file=$2 status=0
  curl --fail --location --retry 3 --connect-timeout 20 --continue-at - --output "$file.part" "$url" ||
    status=$?
  # A part that was complete already cannot be continued, which servers answer with an error.
  if ((status != 0)) && ! { [[ -s $file.part ]] && is_whole "$file.part" "$file"; }; then
    case $status in
      5 | 6 | 7 | 28 | 35 | 56) echo "${0##*/}: $url: no connection (curl: $status)" >&2 ;;
      22 | 37 | 78) echo "${0##*/}: $url: not there (curl: $status); has the site moved? See --tum, --bonn" >&2 ;;
      *) echo "${0##*/}: $url: download failed (curl: $status)" >&2 ;;
    esac
    return 1
  fi
  if ! is_whole "$file.part" "$file"; then
    rm "$file.part"
    echo "${0##*/}: $url: what came is no whole archive; it was deleted, the next call starts anew" >&2
    return 1
  fi
  mv "$file.part" "$file"
}

# Compares with the sum in a list; 0 = equal, 1 = differs, 2 = not in the list.
compare_sum() {
  local list=$1 file=$2 expected
  expected=$(awk -v name="${file##*/}" '$2 == name || $2 == "*" name { print $1; exit }' "$list")
  [[ -n $expected ]] || return 2
  [[ $(sha256sum "$file" | cut -d' ' -f1) == "$expected" ]]
}

verify() {
  local file=$1 status=0
  if [[ -n $checksums ]]; then
    compare_sum "$checksums" "$file" || status=$?
    ((status != 2)) || { echo "${0##*/}: ${file##*/} is not in $checksums" >&2 && return 1; }
  fi
  if ((status == 0)); then
    compare_sum "$sums" "$file" || status=$?
    ((status != 2)) || { (cd "$archives" && sha256sum "${file##*/}" >>"$sums") && status=0; }
  fi
  ((status == 0)) && return
  echo "${0##*/}: $file differs from its checksum; delete it to fetch it again" >&2
  return 1
}

unpack() {
  local file=$1 name=$2 part=$output/.$2.part
  rm -rf "$part"
  mkdir "$part"
  case "$file" in
    *.zip) unzip -q "$file" -d "$part" ;;
    *) tar -xzf "$file" -C "$part" ;;
  esac || { rm -rf "$part" && echo "${0##*/}: $file could not be unpacked (disk full?)" >&2 && return 1; }
  if [[ ! -f $part/$name/rgb.txt ]]; then
    rm -rf "$part"
    echo "${0##*/}: $file has no $name/rgb.txt" >&2
    return 1
  fi
  mv "$part/$name" "$output/$name"
  rmdir "$part" 2>/dev/null || rm -rf "$part"
}

fetch() {
  local name=$1 url file
  if [[ -f $output/$name/rgb.txt ]]; then
    echo "== $name: there already"
    return
  fi
  url=$(url_of "$name")
  file=$archives/${url##*/}
  if [[ ! -f $file ]]; then
    echo "== $name: $url"
    download "$url" "$file" || return 1
  fi
  verify "$file" || return 1
  unpack "$file" "$name" || return 1
  $remove && rm "$file"
  echo "== $name: unpacked"
}

failed=()
for name in "${names[@]}"; do
  fetch "$name" || failed+=("$name")
done
((${#failed[@]} == 0)) ||
  fail "${#failed[@]} of ${#names[@]} sequences are missing: ${failed[*]}. The same call goes on where this one ended."
