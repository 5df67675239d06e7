#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs the Debian packages in an empty Debian 12 and uses them. Needs root and debootstrap.
set -euo pipefail

if [[ $# != 2 || $EUID != 0 ]]; then
  cat >&2 <<USAGE
Usage (as root): ${0##*/} BUILD ROOT

Packs what lies in the build folder BUILD (configured with -DHMCDYN_BUILD_TESTS=OFF, built, Debian 12),
makes a Debian 12 in the folder ROOT with debootstrap, where there is none yet, and there
  1. installs libhmcdyn-core-dev, and builds and runs a user of core, without OpenCV;
  2. installs libhmcdyn-dev, and builds and runs a user of all components, with CMake and pkg-config;
  3. installs hmcdyn-tools, renders a short sequence, tracks it, and evaluates the trajectory;
  4. where BUILD has -DHMCDYN_BUILD_PYTHON=ON, installs python3-hmcdyn, and draws labels on two images;
  5. removes the packages again.
About 3 GB.
USAGE
  exit 2
fi
build=$(realpath "$1")
root=$2
cd "$(dirname "${BASH_SOURCE[0]}")/.."

[[ -x $root/bin/sh ]] || debootstrap --variant=minbase bookworm "$root"
rm -rf "$root/packages" "$root/consumers"
mkdir "$root/packages"
(cd "$build" && cpack -G DEB -B "$build/packages" >/dev/null)
cp "$build"/packages/*.deb "$root/packages"
cp -r tests/consumers "$root/consumers"
cp examples/python/labels_on_two_images.py "$root"

# shellcheck disable=SC2016 # the inner shell's variables
chroot "$root" env DEBIAN_FRONTEND=noninteractive sh -euxc '
  install() { apt-get -q -y install --no-install-recommends "$@" >/tmp/apt.log || { cat /tmp/apt.log; exit 1; }; }
  apt-get -q update >/dev/null
  install g++ cmake make pkg-config

  install /packages/libhmcdyn-core-dev_*.deb
  if dpkg-query -W libopencv-dev; then echo "OpenCV came along"; exit 1; fi
  cmake -S /consumers/core -B /tmp/core >/dev/null && cmake --build /tmp/core >/dev/null
  /tmp/core/consumer

  install /packages/libhmcdyn-dev_*.deb
  cmake -S /consumers/full -B /tmp/full >/dev/null && cmake --build /tmp/full >/dev/null
  /tmp/full/consumer
  g++ -std=c++17 /consumers/full/main.cpp -o /tmp/by_pkg_config \
    $(pkg-config --cflags --libs hmcdyn-vision hmcdyn-optimization)
  /tmp/by_pkg_config

  install /packages/hmcdyn-tools_*.deb
  dpkg --contents /packages/hmcdyn-tools_*.deb >/tmp/contents
  grep -q "/man1/hmcdyn_slam.1$" /tmp/contents
  grep -q "/bash-completion/completions/hmcdyn_slam$" /tmp/contents
  rm -rf /tmp/crowd /tmp/run
  hmcdyn_synthesize --scene crowd --frames 40 --quiet --output /tmp/crowd
  hmcdyn_slam --dataset /tmp/crowd --camera /tmp/crowd/calibration.yaml --detector file \
    --boxes /tmp/crowd/boxes.txt --filter robust --output /tmp/run --quiet
  hmcdyn_evaluate summary --groundtruth /tmp/crowd/groundtruth.txt --estimate /tmp/run/trajectory.txt

  if ls /packages/python3-hmcdyn_*.deb; then
    install /packages/python3-hmcdyn_*.deb python3-matplotlib
    python3 -c "import hmcdyn; print(hmcdyn.__version__)"
    python3 /labels_on_two_images.py /tmp/labels.png && test -s /tmp/labels.png
    apt-get -q -y purge python3-hmcdyn >/dev/null
  fi

  apt-get -q -y purge --autoremove hmcdyn-tools libhmcdyn-dev libhmcdyn-core-dev >/dev/null
  if test -e /usr/include/hmcdyn || test -e /usr/bin/hmcdyn_slam; then echo "something stayed"; exit 1; fi'
echo "The packages install, work and leave."
