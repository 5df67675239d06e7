#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# A detector in shell: answers hmcdyn_slam with the boxes of a file, "timestamp class x_min y_min x_max y_max score",
# whose time stamps are written as in rgb.txt.
#
#   hmcdyn_slam --detector command --command 'examples/detectors/replay_boxes.sh boxes.txt' ...
set -eu
boxes=${1:?usage: replay_boxes.sh BOXES.txt}
[ -r "$boxes" ] || { echo "$boxes cannot be read" >&2; exit 1; }
number() { printf '%s\n' "$line" | sed "s/.*\"$1\": *\([0-9.]*\).*/\1/"; }

echo "{\"hmcdyn_detector\": 1, \"version\": \"replay of $boxes\"}"
while IFS= read -r line; do
  head -c "$(number bytes)" >/dev/null # the image, which nobody looks at
  awk -v time="$(number timestamp)" -v frame="$(number frame)" '
    BEGIN { printf "{\"frame\": %s, \"boxes\": [", frame }
    !/^#/ && $1 - time < 1e-4 && time - $1 < 1e-4 {
      class = $2 ~ /^[0-9]+$/ ? $2 : "\"" $2 "\""
      printf "%s[%s, %s, %s, %s, %s, %s]", separator, $3, $4, $5, $6, $7, class
      separator = ", "
    }
    END { print "]}" }' "$boxes"
done
