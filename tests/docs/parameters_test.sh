#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# parameters_test.sh SOURCE: docs/parameters.md has every field of every options struct of the library.
set -euo pipefail
source=$1
page=$source/docs/parameters.md
fields=$(awk '
  /^struct [A-Za-z]+Options \{/ { name = $2; next }
  /^};/ { name = "" }
  name && match($0, /^  [A-Za-z_:0-9]+ [a-z_0-9]+( =|;)/) { split($0, word, /[ ;]+/); print name, word[3] }
' "$source"/include/hmcdyn/{,steps/,votes/,peers/}*.hpp)

(($(wc -l <<<"$fields") > 70)) || { echo "only these options were found: $fields" >&2 && exit 1; }
failed=0
while read -r name field; do
  if ! awk -v name="\`$name\`" -v field="\`$field\`" '
      /^\| `/ { current = $2 }
      /^\|/ && current == name && index($0, field) { found = 1 }
      END { exit !found }' "$page"; then
    echo "docs/parameters.md: $name has no row with \`$field\`" >&2
    failed=1
  fi
done <<<"$fields"
exit $failed
