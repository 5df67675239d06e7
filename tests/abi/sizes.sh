#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# sizes.sh INCLUDE SCRATCH GCC CLANG CFLAGS...: size and alignment of every public type, compiled with one set of
# flags after the other; all must agree, since a program and the libraries may differ in them. CLANG may be empty.
# Nothing is run: the table lies in the object file, and the processor need not know the instructions.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
include=$1 scratch=$2 gcc=$3 clang=$4
shift 4
mkdir -p "$scratch"
command -v objcopy >/dev/null || { echo "skipped: no objcopy here"; exit 0; }

types=$(awk -f "$here/public_types.awk" "$include"/hmcdyn/{,steps/,votes/,peers/}*.hpp | LC_ALL=C sort -u)
for must in EarlierFrame MotionBeliefWorkspace Pose PoseRefinementResult PoseRefinementWorkspace TwoViewModel; do
  grep -qx "$must" <<<"$types" || { echo "public_types.awk no longer finds $must"; exit 1; }
done
for type in $types; do echo "HMCDYN_ROW(hmcdyn::$type),"; done >"$scratch/rows.inc"
echo "HMCDYN_ROW(hmcdyn::Span<float>)," >>"$scratch/rows.inc"
echo "HMCDYN_ROW(hmcdyn::PlainMatrix<3 _ 3>), HMCDYN_ROW(hmcdyn::PlainMatrix<6 _ 6>)," |
  sed 's/ _ /, /g' >>"$scratch/rows.inc"

tables=()
table() { # NAME COMPILER FLAGS...
  local name=$1 compiler=$2
  shift 2
  tables+=("$name")
  echo "$name: $(basename "$compiler") $*" >"$scratch/$name.flags"
  "$compiler" -std=c++17 "$@" -I"$include" -I"$scratch" "${cflags[@]}" -c "$here/sizes.cpp" -o "$scratch/$name.o"
  objcopy -O binary --only-section=hmcdyn_sizes "$scratch/$name.o" "$scratch/$name.txt"
  echo "compiled $(cat "$scratch/$name.flags")"
}
cflags=("$@")
table plain "$gcc" -O2
table avx2 "$gcc" -O2 -mavx2 -mfma
# Eigen 3.4 asks for FMA where there is AVX-512.
table avx512 "$gcc" -O2 -mavx512f -mavx512vl -mfma
table o0 "$gcc" -O0
table ndebug "$gcc" -O2 -DNDEBUG
if [[ -n $clang ]]; then
  table clang_plain "$clang" -O2
  table clang_avx2_o0 "$clang" -O0 -mavx2 -mfma
  table clang_avx512_ndebug "$clang" -O2 -DNDEBUG -mavx512f -mavx512vl -mfma
else
  echo "no clang++ here: its tables are missing"
fi

echo
echo "type                                           size align (bytes, the same in all)"
cat "$scratch/plain.txt"
status=0
for name in "${tables[@]}"; do
  if ! diff "$scratch/plain.txt" "$scratch/$name.txt" >"$scratch/$name.diff"; then
    echo "differs from plain (<) with $(cat "$scratch/$name.flags") (>):"
    cat "$scratch/$name.diff"
    status=1
  fi
done
grep -q '^hmcdyn::Pose  *96 *8$' "$scratch/plain.txt" || { echo "no line of Pose, 96 bytes"; status=1; }
exit $status
