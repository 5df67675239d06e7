#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# man_test.sh PAGES BIN: each program's page is whole: its sections, and every option of its help.
set -euo pipefail
pages=$1
bin=$2
failed=0
for call in hmcdyn_slam hmcdyn_evaluate "hmcdyn_evaluate ate" "hmcdyn_evaluate rpe" \
  "hmcdyn_evaluate summary" hmcdyn_synthesize hmcdyn_label_score hmcdyn_mask hmcdyn_mask_score \
  hmcdyn_map_score hmcdyn_tables hmcdyn_calibrate_depth; do
  page=$pages/${call// /-}.1
  text=$(<"$page")
  for section in NAME SYNOPSIS DESCRIPTION OPTIONS; do
    [[ $text == *$'\n'".SH $section"$'\n'* ]] || { echo "$page: no $section" >&2 && failed=1; }
  done
  read -ra words <<<"$call"
  options=$("$bin/${words[0]}" "${words[@]:1}" --help | sed -n 's/^  \(-[^ ={]*\).*/\1/p')
  (($(wc -l <<<"$options") > 1)) || { echo "$call: help without options" >&2 && failed=1; }
  while read -r option; do
    [[ $text == *".B ${option//-/\\-}"* ]] || { echo "$page: no $option" >&2 && failed=1; }
  done <<<"$options"
  if command -v groff >/dev/null; then
    complaints=$(groff -man -Tutf8 -ww "$page" 2>&1 >/dev/null)
    [[ -z $complaints ]] || { echo "$page: $complaints" >&2 && failed=1; }
  fi
done
exit $failed
