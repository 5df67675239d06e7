// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>
#include <vector>

#include <fuzzer/FuzzedDataProvider.h>

#include <hmcdyn/types.hpp>

namespace hmcdyn::fuzz {

/// Ends the run, so that the fuzzer keeps the input.
inline void require(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "violated: %s\n", what);
    std::abort();
  }
}

/// A float from the input: mostly a likely value, now and then any bits at all (NaN, infinity,
/// 1e38).
inline float anyFloat(FuzzedDataProvider& data, float low, float high) {
  if (data.ConsumeIntegralInRange<int>(0, 15) == 0) {
    const auto bits = data.ConsumeIntegral<std::uint32_t>();
    float value = 0.0f;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  return low + (high - low) * static_cast<float>(data.ConsumeIntegral<std::uint16_t>()) / 65535.0f;
}

inline KeyPoints anyPoints(FuzzedDataProvider& data, int most) {
  KeyPoints points;
  const int n = data.ConsumeIntegralInRange<int>(0, most);
  for (int i = 0; i < n; ++i) {
    const float u = anyFloat(data, -10.0f, 110.0f);
    const float v = anyFloat(data, -10.0f, 110.0f);
    points.push_back(u, v, anyFloat(data, 0.0f, 6.0f));
  }
  return points;
}

inline std::vector<float> anyFloats(FuzzedDataProvider& data, std::size_t n, float low,
                                    float high) {
  std::vector<float> values;
  for (std::size_t i = 0; i < n; ++i) {
    values.push_back(anyFloat(data, low, high));
  }
  return values;
}

/// A folder of this process for files that a reader is to open.
class ScratchFolder {
 public:
  ScratchFolder()
      : path_(std::filesystem::temp_directory_path() /
              ("hmcdyn_fuzz_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ScratchFolder(ScratchFolder&&) = delete;
  ScratchFolder& operator=(ScratchFolder&&) = delete;

  const std::filesystem::path& path() const noexcept { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace hmcdyn::fuzz
