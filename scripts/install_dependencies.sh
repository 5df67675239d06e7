#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Installs what hmcdyn needs to be built and tested, on Debian and Ubuntu.
set -euo pipefail

usage() {
  cat <<USAGE
Usage: ${0##*/} [--check] [--ci] [--python] [--bench] [--clang]

Installs the packages that hmcdyn needs to be built and tested (Debian, Ubuntu). Does nothing where
all are installed. Needs root or sudo; without either it says what to install and fails.

  --check   only list what is missing; exit code 1 when something is
  --ci      also what .ci/run needs: clang-format, clang-tidy and clang's headers, Doxygen, mold, Chromium for the
            report, OctoMap for examples/octomap; --python
  --python  also what the Python module and its tests need: pybind11, numpy, pytest, OpenCV, matplotlib
  --bench   also the peers that the benchmarks measure against: Open3D and PCL
  --clang   also clang, its sanitizers and its fuzzer: preset asan-ubsan, scripts/fuzz.sh
  --help    this text
USAGE
}

packages=(
  g++ cmake ninja-build git pkg-config
  libeigen3-dev libnanoflann-dev # the library's core
  libopencv-dev                  # images, optical flow, robust estimation, object detection
  libceres-dev                   # optimisation
  libcli11-dev libspdlog-dev libfmt-dev libyaml-cpp-dev nlohmann-json3-dev # the examples
  libgtest-dev libgmock-dev      # the tests
  libbenchmark-dev               # the benchmarks
)
python=(pybind11-dev python3-dev python3-numpy python3-pytest python3-opencv python3-matplotlib)
only_check=false
for argument in "$@"; do
  case "$argument" in
    --check) only_check=true ;;
    --ci)
      packages+=(clang-format clang-tidy libclang-dev llvm-dev chromium doxygen liboctomap-dev mold "${python[@]}")
      ;;
    --python) packages+=("${python[@]}") ;;
    --clang) packages+=(clang libclang-rt-14-dev) ;;
    --bench) packages+=(libopen3d-dev libpcl-dev python3) ;;
    --help | -h) usage && exit 0 ;;
    *)
      echo "${0##*/}: unknown argument $argument" >&2
      usage >&2
      exit 2
      ;;
  esac
done

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  cat >&2 <<MESSAGE
${0##*/}: this system has no apt-get, so nothing can be checked or installed. hmcdyn needs:
  a C++17 compiler, CMake >= 3.22, Ninja, git
  Eigen >= 3.3, nanoflann >= 1.3, OpenCV >= 4.2, Ceres Solver >= 1.14
  CLI11, spdlog, fmt, yaml-cpp, nlohmann-json (examples); GoogleTest (tests); Google Benchmark
When all are there, build without this script: scripts/test.sh --no-install
MESSAGE
  exit 1
fi

missing=()
for package in "${packages[@]}"; do
  status=$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  echo "All ${#packages[@]} packages that hmcdyn needs are installed."
  exit 0
fi
echo "Missing: ${missing[*]}"
if $only_check; then
  exit 1
fi

# Words that go in front of a command to run it as root.
as_root=()
if ((EUID != 0)); then
  if command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [[ -t 0 ]]; }; then
    as_root=(sudo)
  else
    cat >&2 <<MESSAGE
${0##*/}: neither root nor sudo, so nothing was installed. Run as root:
  apt-get update && apt-get install --no-install-recommends ${missing[*]}
MESSAGE
    exit 1
  fi
fi

apt() {
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y \
    -o Acquire::Retries=3 -o DPkg::Lock::Timeout=120 "$@"
}

apt update || { echo "apt-get update failed; once more" >&2 && sleep 5 && apt update; }
apt install --no-install-recommends "${missing[@]}"
echo "Installed: ${missing[*]}"
