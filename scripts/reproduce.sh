#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Repeats the paper's experiments: every sequence, every ablation and peer's rule, several seeds; then
# its Tables I to VI from them. What is done already is not done again.
set -euo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} (--datasets DIR | --rendered) [options] [-- OPTIONS OF hmcdyn_slam]

  --datasets DIR     folder with unpacked TUM and BONN sequences (scripts/download_datasets.sh)
  --rendered         rendered scenes instead; hmcdyn_synthesize makes those that are missing
  --sequences DIR    rendered: where the scenes lie, or will lie (default: OUTPUT/sequences)
  --scenes LIST      rendered: names with commas between (default: those named after the paper's)
  --variants LIST    of hmc,robust,rs,df,opw,none,two_threshold,chi2,depth_ransac (default: all)
  --runs N           runs of each, with seeds 1 to N (default: 5)
  --jobs N           so many at once on each machine (default: the number of processors)
  --hosts LIST       machines for GNU parallel, with commas between; : is this one. All must see this
                     folder, the sequences and OUTPUT by the same paths
  --output DIR       runs, logs and tables (default: build/reproduce)
  --preset NAME      whose binaries are used; must have been built (default: release)
  --help             this text

What follows -- goes to every run, the detector above all:
  ${0##*/} --datasets data -- --detector darknet --model yolo-fastest-1.1.cfg \\
    --weights yolo-fastest-1.1.weights
Without, the boxes.txt in a sequence's folder is used; a sequence without one is an error.

Writes OUTPUT/tables/tables.md and a CSV file a table. Stop it at any time; the next call with the same
output goes on, and runs again what failed. Other options of hmcdyn_slam need another output.
Exit code: 0 done, 1 a run failed (the others are in the tables), 2 wrong usage.
USAGE
}

fail() {
  echo "${0##*/}: $1" >&2
  exit "${2:-1}"
}

# The options of hmcdyn_slam that make a variant.
variant_options() {
  case "$1" in
    hmc | robust) echo --filter "$1" ;;
    rs | df | opw) echo --filter hmc --ablation "$1" ;;
    none | two_threshold | chi2 | depth_ransac) echo --filter "$1" ;;
    *) return 1 ;;
  esac
}

# The camera of a sequence, by its calibration file or its data set's name.
camera_of() {
  case "${1##*/}" in
    *freiburg1* | fr1_*) echo tum1 ;;
    *freiburg2* | fr2_*) echo tum2 ;;
    *freiburg3* | fr3_*) echo tum3 ;;
    *bonn*) echo bonn ;;
    *) [[ -f $1/calibration.yaml ]] && echo "$1/calibration.yaml" ;;
  esac
}

is_finished() {
  "$bin/hmcdyn_tables" --check "$1/summary.json" 2>/dev/null
}

# One run; says how far all of them are. Arguments: sequence folder, variant, seed.
run_one() {
  local sequence=$1 variant=$2 seed=$3
  local folder=$output/runs/${sequence##*/}/$variant/seed$seed
  local begin=$SECONDS status=0 boxes=() options
  read -ra options <<<"$(variant_options "$variant")"
  if ! $own_detector; then
    boxes=(--detector file --boxes "$sequence/boxes.txt")
  fi
  mkdir -p "$folder"
  "$bin/hmcdyn_slam" --dataset "$sequence" --camera "$(camera_of "$sequence")" \
    "${boxes[@]}" "${options[@]}" --seed "$seed" --no-dense-map --no-report --quiet \
    --output "$folder" "${slam_options[@]}" >"$folder/log.txt" 2>&1 || status=$?
  local verdict="done"
  if ((status != 0)) || ! is_finished "$folder"; then
    verdict="FAILED, exit code $status, see $folder/log.txt"
    # A run that tracked nothing has a result, too: that it tracked nothing.
    is_finished "$folder" && verdict="few or no frames tracked, see $folder/log.txt"
  fi
  echo "${sequence##*/} $variant $seed" >>"$progress" # short lines are appended whole
  local ended left
  ended=$(wc -l <"$progress")
  left=$(((total - ended) * ($(date +%s) - started) / ended))
  printf '[%d/%d] %s %s seed %d: %s (%d s); about %d:%02d h left\n' "$ended" "$total" \
    "${sequence##*/}" "$variant" "$seed" "$verdict" $((SECONDS - begin)) $((left / 3600)) \
    $((left / 60 % 60))
}

# What a child process needs is in a file: arrays cannot be exported, and other machines have no
# environment of ours.
if [[ ${1-} == --one ]]; then
  (($# == 5)) || exit 2
  # shellcheck source=/dev/null
  source "$2"
  run_one "$3" "$4" "$5"
  exit
fi

datasets=
rendered=false
sequences=
scenes=walking_xyz,walking_halfsphere,walking_static,walking_rpy,sitting_halfsphere,sitting_static,crowd,crowd2,crowd3,synchronous2
variants=hmc,robust,rs,df,opw,none,two_threshold,chi2,depth_ransac
runs=5
jobs=$(nproc)
hosts=
output=
preset=release
slam_options=()
while (($# > 0)); do
  case "$1" in
    --datasets | --sequences | --scenes | --variants | --runs | --jobs | --hosts | --output | --preset)
      (($# > 1)) || fail "$1 needs a value" 2
      case "$1" in
        --datasets) datasets=$(realpath -m "$2") ;;
        --sequences) sequences=$(realpath -m "$2") ;;
        --scenes) scenes=$2 ;;
        --variants) variants=$2 ;;
        --runs) runs=$2 ;;
        --jobs) jobs=$2 ;;
        --hosts) hosts=$2 ;;
        --output) output=$(realpath -m "$2") ;;
        --preset) preset=$2 ;;
      esac
      shift
      ;;
    --rendered) rendered=true ;;
    --help | -h) usage && exit 0 ;;
    --) shift && slam_options=("$@") && break ;;
    *) usage >&2 && fail "unknown argument $1" 2 ;;
  esac
  shift
done
if $rendered; then
  [[ -z $datasets ]] || fail "--datasets and --rendered exclude each other" 2
else
  [[ -n $datasets ]] || { usage >&2 && fail "expected --datasets DIR or --rendered" 2; }
  [[ -z $sequences ]] || fail "--sequences goes with --rendered" 2
  [[ -d $datasets ]] || fail "--datasets: $datasets is no folder" 2
fi
for number in "$runs" "$jobs"; do
  [[ $number =~ ^[1-9][0-9]*$ ]] || fail "--runs and --jobs: '$number' is no number above 0" 2
done
IFS=, read -ra variant_list <<<"$variants"
for variant in "${variant_list[@]}"; do
  variant_options "$variant" >/dev/null || fail "--variants: '$variant' is unknown" 2
done

script=$(realpath "${BASH_SOURCE[0]}")
root=$(dirname "$(dirname "$script")")
output=${output:-$root/build/reproduce}
sequences=${sequences:-$output/sequences}
bin=$root/build/$preset/bin
for program in hmcdyn_slam hmcdyn_tables; do
  [[ -x $bin/$program ]] ||
    fail "$bin/$program is missing; build it: cmake --preset $preset && cmake --build --preset $preset"
done
own_detector=false
for option in "${slam_options[@]}"; do
  [[ $option == --detector || $option == --detector=* ]] && own_detector=true
done
mkdir -p "$output"
exec 9>"$output/.lock"
flock --nonblock 9 || fail "another call with --output $output is still running"
# The sequences.
found=()
if $rendered; then
  IFS=, read -ra scene_list <<<"$scenes"
  mkdir -p "$sequences"
  for scene in "${scene_list[@]}"; do
    if [[ ! -f $sequences/$scene/associations.txt ]]; then
      echo "== Rendering $scene"
      rm -rf "$sequences/.$scene.part"
      "$bin/hmcdyn_synthesize" --scene "$scene" --output "$sequences/.$scene.part" --quiet
      mv "$sequences/.$scene.part" "$sequences/$scene"
    fi
    found+=("$sequences/$scene")
  done
else
  for folder in "$datasets" "$datasets"/*/; do
    folder=${folder%/}
    [[ -f $folder/rgb.txt && -f $folder/depth.txt ]] && found+=("$folder")
  done
  ((${#found[@]} > 0)) || fail "$datasets: no sequence (a folder with rgb.txt and depth.txt)"
fi
for sequence in "${found[@]}"; do
  [[ $sequence != *$'\n'* && $sequence != *' '* ]] || fail "$sequence: paths with spaces are not supported"
  [[ -n $(camera_of "$sequence") ]] ||
    fail "$sequence: which camera? Expected a TUM or BONN name, or calibration.yaml in the folder"
  $own_detector || [[ -f $sequence/boxes.txt ]] ||
    fail "$sequence: no boxes.txt; name a detector after --, see --help"
done

# Runs with other options must not stand in one table.
options_file=$output/options.txt
printf '%s\n' "${slam_options[@]}" >"$options_file.new"
if [[ -f $options_file ]] && ! cmp -s "$options_file" "$options_file.new"; then
  fail "$output has runs with other options of hmcdyn_slam: $(paste -sd' ' "$options_file"); choose another --output"
fi
mv "$options_file.new" "$options_file"

# What is left to do.
todo=$output/todo.txt
: >"$todo"
count=0
for ((seed = 1; seed <= runs; ++seed)); do
  for sequence in "${found[@]}"; do
    for variant in "${variant_list[@]}"; do
      count=$((count + 1))
      is_finished "$output/runs/${sequence##*/}/$variant/seed$seed" ||
        echo "$sequence $variant $seed" >>"$todo"
    done
  done
done
total=$(wc -l <"$todo")
echo "== ${#found[@]} sequences, ${#variant_list[@]} variants, $runs runs: $count in all," \
  "$((count - total)) done already"

progress=$output/progress.txt
: >"$progress"
started=$(date +%s)
settings=$output/settings.sh
declare -p bin output own_detector slam_options progress total started >"$settings"
if ((total > 0)); then
  workers=(xargs -P "$jobs" -L 1 "$script" --one "$settings")
  if [[ -n $hosts ]]; then
    command -v parallel >/dev/null || fail "--hosts needs GNU parallel (apt-get install parallel)"
    workers=(parallel --sshlogin "$hosts" --jobs "$jobs" --colsep ' ' --line-buffer
      "$script" --one "$settings" '{1}' '{2}' '{3}')
  fi
  # A process group of their own, so that a signal to this script alone stops all runs, too.
  set -m
  "${workers[@]}" <"$todo" &
  group=$!
  set +m
  trap 'kill -TERM -- "-$group" 2>/dev/null; wait; fail "stopped; the same call goes on" 130' INT TERM
  wait "$group" || true
  trap - INT TERM
fi

missing=0
while read -r sequence variant seed; do
  is_finished "$output/runs/${sequence##*/}/$variant/seed$seed" || missing=$((missing + 1))
done <"$todo"
tables_options=()
$rendered && tables_options=(--rendered)
"$bin/hmcdyn_tables" --runs "$output/runs" --paper "$root/scripts/paper_tables.csv" \
  --output "$output/tables" "${tables_options[@]}"
echo "== $output/tables/tables.md"
((missing == 0)) || fail "$missing of $total runs failed; their log.txt say why, a new call tries them again"
