#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# completion_test.sh SCRIPT BIN: what bash offers after a part of a command line.
set -euo pipefail
script=$1
PATH=$2:$PATH
# shellcheck source=/dev/null
source "$script"

failed=0
# expect "COMMAND LINE" OFFERED...: the last word is the one to complete.
expect() {
  local line=$1 word offered
  shift
  read -ra COMP_WORDS <<<"$line"
  [[ $line != *" " ]] || COMP_WORDS+=("")
  COMP_CWORD=$((${#COMP_WORDS[@]} - 1))
  _hmcdyn "${COMP_WORDS[0]}" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
  offered=" ${COMPREPLY[*]} "
  for word in "$@"; do
    if [[ $word == "!"* && $offered == *" ${word#!} "* || $word != "!"* && $offered != *" $word "* ]]; then
      echo "'$line': $word against what was offered:$offered" >&2
      failed=1
    fi
  done
}

expect "hmcdyn_slam --fil" --filter !--output
expect "hmcdyn_slam --no-" --no-report --no-mapping --no-loops
expect "hmcdyn_slam --filter " hmc box chi2 none !--output
expect "hmcdyn_slam --filter h" hmc !box
expect "hmcdyn_slam --detector y" yolo !darknet
expect "hmcdyn_synthesize -" -s --scene --noise
expect "hmcdyn_synthesize --noise " kinect kinect_systematic none
expect "hmcdyn_evaluate " ate rpe summary
expect "hmcdyn_evaluate s" summary !ate
expect "hmcdyn_evaluate rpe --del" --delta --delta-unit
expect "hmcdyn_evaluate ate --del" !--delta
expect "hmcdyn_evaluate rpe --delta-unit " frames deg !ate
expect "hmcdyn_label_score --m" --margin
expect "hmcdyn_map_score --rad" --radius
expect "hmcdyn_tables --ren" --rendered
expect "hmcdyn_calibrate_depth --sensor " structured_light active_stereo

# File names are bash's own: nothing is offered here.
expect "hmcdyn_slam --output "
((${#COMPREPLY[@]} == 0)) || { echo "--output offers ${COMPREPLY[*]}" >&2 && failed=1; }
exit $failed
