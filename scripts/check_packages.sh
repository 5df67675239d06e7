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
  4. where BUILD has -DHMCDYN_BUILD_PYTHON=ON, installs python3-hmcdyn, draws labels on two images
     (ROOT/pictures/labels.png), and tracks the sequence with a detector in Python;
  5. removes the packages again, and looks for what they left behind.
About 3 GB.
USAGE
  exit 2
fi
build=$(realpath "$1")
root=$2
cd "$(dirname "${BASH_SOURCE[0]}")/.."

[[ -x $root/bin/sh ]] || debootstrap --variant=minbase bookworm "$root"
rm -rf "$root/packages" "$root/consumers" "$root/pictures"
mkdir "$root/packages" "$root/pictures"
(cd "$build" && cpack -G DEB -B "$build/packages" >/dev/null)
cp "$build"/packages/*.deb "$root/packages"
cp -r tests/consumers "$root/consumers"
cp examples/python/labels_on_two_images.py "$root"

# The caller's environment (compiler launchers, flags, PYTHONPATH) is not the empty system's; a proxy and the
# processor are.
environment=(PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive)
for name in http_proxy https_proxy no_proxy OPENBLAS_CORETYPE OPENBLAS_L2_SIZE; do
  [[ -z ${!name:-} ]] || environment+=("$name=${!name}")
done
# shellcheck disable=SC2016 # the inner shell's variables
chroot "$root" env -i "${environment[@]}" sh -euxc '
  install() { apt-get -q -y install --no-install-recommends "$@" >/tmp/apt.log || { cat /tmp/apt.log; exit 1; }; }
  apt-get -q update >/dev/null
  # An earlier run may have ended before its end.
  apt-get -q -y purge --autoremove $(dpkg-query -W -f "\${Package} " "*hmcdyn*" 2>/dev/null || true) >/dev/null
  rm -rf /tmp/*
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
    install /packages/python3-hmcdyn_*.deb
    version=$(dpkg-query -W -f "\${Version}" python3-hmcdyn)
    python3 -c "import hmcdyn; print(hmcdyn.__version__)" | tee /tmp/version
    test "$(cat /tmp/version)" = "$version"
    install python3-matplotlib
    python3 /labels_on_two_images.py /pictures/labels.png
    # Points on what moves are red, on the wall green.
    python3 -c "
from matplotlib.image import imread
red, green, blue = imread(\"/pictures/labels.png\")[:, :, :3].transpose(2, 0, 1)
moving, standing = (red > 0.8) & (green < 0.2), (green > 0.7) & (red < 0.4)
assert moving.mean() > 0.01 and standing.mean() > 0.01, (moving.mean(), standing.mean())"

    cat >/tmp/replay.py <<SCRIPT
import hmcdyn
boxes = {}
for line in open("/tmp/crowd/boxes.txt"):
    if not line.startswith("#"):
        time, name, *numbers = line.split()
        boxes.setdefault(time, []).append([*map(float, numbers), int(name)])
hmcdyn.serve_detector(lambda image, time: boxes.get(f"{time:.6f}", []), timestamps=True)
SCRIPT
    hmcdyn_slam --dataset /tmp/crowd --camera /tmp/crowd/calibration.yaml --detector command \
      --command "python3 /tmp/replay.py" --filter robust --output /tmp/run_python --quiet
    cmp /tmp/run/trajectory.txt /tmp/run_python/trajectory.txt
    apt-get -q -y purge python3-hmcdyn >/dev/null
    if python3 -c "import hmcdyn" 2>/dev/null; then echo "the Python module stayed"; exit 1; fi
  fi

  apt-get -q -y purge --autoremove hmcdyn-tools libhmcdyn-dev libhmcdyn-core-dev >/dev/null
  find /etc /usr /var /opt -iname "*hmcdyn*" >/tmp/stayed
  if test -s /tmp/stayed; then echo "these stayed:"; cat /tmp/stayed; exit 1; fi'
echo "The packages install, work and leave."
