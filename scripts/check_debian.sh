#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Compiles the library with the compiler and the packages of another Debian release. Needs root.
set -euo pipefail

if [[ $# != 2 || $EUID != 0 ]]; then
  cat >&2 <<USAGE
Usage (as root): ${0##*/} RELEASE ROOT

Makes a Debian of the RELEASE (bullseye, bookworm, trixie) in the folder ROOT with debootstrap, where
there is none yet, installs the library's dependencies there, checks that every source file compiles,
and builds and runs a program that uses core. About 2 GB.
USAGE
  exit 2
fi
release=$1 root=$2
cd "$(dirname "${BASH_SOURCE[0]}")/.."

[[ -x $root/bin/sh ]] || debootstrap --variant=minbase "$release" "$root"
chroot "$root" apt-get -q update
chroot "$root" env DEBIAN_FRONTEND=noninteractive apt-get -q -y install --no-install-recommends \
  g++ libeigen3-dev libnanoflann-dev libopencv-dev libceres-dev

rm -rf "$root/hmcdyn"
mkdir "$root/hmcdyn"
cp -r include src tests "$root/hmcdyn"
# shellcheck disable=SC2016 # $file is the inner shell's
chroot "$root" sh -ec 'cd /hmcdyn
  flags="-std=c++17 -Wall -Wextra -Iinclude -Isrc -isystem /usr/include/opencv4 -isystem /usr/include/eigen3"
  for file in src/*/*.cpp; do g++ $flags -fsyntax-only "$file"; done
  g++ $flags tests/consumers/core/main.cpp -o consumer && ./consumer
  g++ --version | head -n 1
  dpkg-query -W libeigen3-dev libnanoflann-dev libopencv-dev libceres-dev'
