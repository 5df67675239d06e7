#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# pkg_config.sh PREFIX LIBDIR COMPILER SCRATCH: plain compiler calls against the installed tree.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")
prefix=$1 libdir=$2 compiler=$3 scratch=$4

command -v pkg-config >/dev/null || { echo "skipped: no pkg-config here"; exit 77; }
export PKG_CONFIG_PATH=$prefix/$libdir/pkgconfig

read -ra core < <(pkg-config --cflags --libs hmcdyn-core)
"$compiler" -std=c++17 "$here/core/main.cpp" "${core[@]}" -o "$scratch/pkg_core"
"$scratch/pkg_core"

read -ra full < <(pkg-config --cflags --libs hmcdyn-vision hmcdyn-optimization)
"$compiler" -std=c++17 "$here/full/main.cpp" "${full[@]}" -o "$scratch/pkg_full"
"$scratch/pkg_full"

# As ORB-SLAM3 and most robotics code is built; the libraries were built without.
"$compiler" -std=c++17 -O3 -march=native "$here/../../examples/03_own_types.cpp" "${full[@]}" -o "$scratch/pkg_native"
"$scratch/pkg_native"
