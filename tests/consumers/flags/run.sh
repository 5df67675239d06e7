#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# run.sh SAME OTHER...: programs in the working folder. SAME was built with the library's flags; every OTHER must
# print the same names with the same values, within rounding: labels exactly, the rest to 1e-3.
set -euo pipefail
grep -qw avx2 /proc/cpuinfo || { echo "skipped: built, but this processor has no AVX2"; exit 0; }
same=$1
shift
"./$same" >"$same.txt"
echo "$same: $(wc -l <"$same.txt") values"
for other in "$@"; do
  "./$other" >"$other.txt"
  paste -d ' ' "$same.txt" "$other.txt" | awk -v other="$other" '
    function bad(why) { print why ": " $0; wrong++ }
    NF != 4 || $1 != $3 { bad("not the same value") ; next }
    $2 ~ /nan/ || $4 ~ /nan/ { if (($2 ~ /nan/) != ($4 ~ /nan/)) bad("NaN in one only"); next }
    {
      difference = $2 > $4 ? $2 - $4 : $4 - $2
      if (difference > largest) largest = difference
      size = $2 < 0 ? -$2 : $2
      limit = $1 ~ /label$|inliers$|model$/ ? 0 : 1e-3 * (1 + size)
      if (difference > limit) bad("differs by " difference)
    }
    END {
      print other ": " NR " values, largest difference " largest + 0
      exit wrong > 0 || NR < 1000
    }'
done
