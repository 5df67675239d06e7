#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# refusals.sh INCLUDE SCRATCH GCC CLANG CFLAGS...: what the headers refuse, they refuse with one sentence, and the
# compiler stops there. CLANG may be empty.
set -euo pipefail
include=$1 scratch=$2 gcc=$3 clang=$4
shift 4
cflags=("$@")
mkdir -p "$scratch"
status=0

# Every public header stands behind the check; hmcdyn.hpp is made of others.
without=$(grep -L '#include <hmcdyn/detail/requirements.hpp>' "$include"/hmcdyn/{,steps/,votes/,peers/}*.hpp | grep -v '/hmcdyn\.hpp$' || true)
if [[ -n $without ]]; then
  echo "without detail/requirements.hpp: $without"
  status=1
fi

# refused COMPILER SENTENCE FLAGS...
refused() {
  local compiler=$1 sentence=$2 errors
  shift 2
  for header in hmcdyn.hpp span.hpp; do
    echo "#include <hmcdyn/$header>" >"$scratch/refused.cpp"
    if "$compiler" "$@" -fsyntax-only -I"$include" "${cflags[@]}" "$scratch/refused.cpp" 2>"$scratch/refused.txt"; then
      echo "FAILED: $(basename "$compiler") $* takes $header"
      status=1
    fi
    errors=$(grep -c 'error:' "$scratch/refused.txt" || true)
    # The sentence, and the end of the reading.
    if ! grep -q "error: .*$sentence" "$scratch/refused.txt" || ((errors != 2)) ||
      ! grep -q 'fatal error: .*hmcdyn stops here, for the reason above' "$scratch/refused.txt"; then
      echo "FAILED: $(basename "$compiler") $* on $header, $errors errors:"
      cat "$scratch/refused.txt"
      status=1
    else
      echo "refused: $(basename "$compiler") $* on $header: $(grep -o 'hmcdyn [nc][^:]*' "$scratch/refused.txt" | head -1)"
    fi
  done
}

# taken COMPILER FLAGS...
taken() {
  local compiler=$1
  shift
  echo "#include <hmcdyn/span.hpp>" >"$scratch/taken.cpp"
  if "$compiler" "$@" -fsyntax-only -I"$include" "${cflags[@]}" "$scratch/taken.cpp"; then
    echo "taken: $(basename "$compiler") $*"
  else
    status=1
  fi
}

for compiler in "$gcc" ${clang:+"$clang"}; do
  refused "$compiler" "needs C++17" -std=c++11
  refused "$compiler" "needs C++17" -std=c++14
  refused "$compiler" "NaN means 'none'" -std=c++17 -O2 -ffast-math
  refused "$compiler" "NaN means 'none'" -std=c++17 -Ofast
  refused "$compiler" "NaN means 'none'" -std=c++17 -O2 -ffinite-math-only
  taken "$compiler" -std=c++17 -O3
  taken "$compiler" -std=c++17 -O2 -ffast-math -fno-fast-math
done
[[ -n $clang ]] || echo "no clang++ here: tried with g++ only"
exit $status
