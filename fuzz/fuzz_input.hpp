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

#include <hmcdyn/regions.hpp>
#include <hmcdyn/types.hpp>
#include <hmcdyn/votes/motion_belief.hpp>

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

/// Appends up to `most` points around one pixel and one depth, as a person gives them: many points
/// from few bytes, for what only many points reach.
inline void addCrowd(FuzzedDataProvider& data, int most, KeyPoints& points) {
  const int n = data.ConsumeBool() ? data.ConsumeIntegralInRange<int>(0, most) : 0;
  const float u = anyFloat(data, 0.0f, 100.0f);
  const float v = anyFloat(data, 0.0f, 100.0f);
  const float depth = anyFloat(data, 0.5f, 6.0f);
  const float spread = anyFloat(data, 0.0f, 60.0f);
  const float depth_spread = anyFloat(data, 0.0f, 2.0f);
  std::uint32_t state = data.ConsumeIntegral<std::uint16_t>();
  const auto draw = [&state] {  // -1..1, by a linear congruential generator (Numerical Recipes)
    state = 1664525U * state + 1013904223U;
    return static_cast<float>(state >> 16U) / 32767.5f - 1.0f;
  };
  for (int i = 0; i < n; ++i) {
    const float column = u + spread * draw();
    const float row = v + spread * draw();
    points.push_back(column, row, depth + depth_spread * draw());
  }
}

inline std::vector<float> anyFloats(FuzzedDataProvider& data, std::size_t n, float low,
                                    float high) {
  std::vector<float> values;
  for (std::size_t i = 0; i < n; ++i) {
    values.push_back(anyFloat(data, low, high));
  }
  return values;
}

inline std::vector<DetectionBox> anyBoxes(FuzzedDataProvider& data, std::size_t most) {
  std::vector<DetectionBox> boxes(data.ConsumeIntegralInRange<std::size_t>(0, most));
  for (DetectionBox& box : boxes) {
    box.x_min = anyFloat(data, 0.0f, 60.0f);
    box.y_min = anyFloat(data, 0.0f, 60.0f);
    box.x_max = box.x_min + anyFloat(data, -5.0f, 80.0f);
    box.y_max = box.y_min + anyFloat(data, -5.0f, 80.0f);
    box.class_id = data.ConsumeIntegralInRange<int>(0, 2);
  }
  return boxes;
}

/// Labels in 0..3, now and then any.
template <class Label>
std::vector<Label> anyLabels(FuzzedDataProvider& data, std::size_t n) {
  std::vector<Label> labels;
  for (std::size_t i = 0; i < n; ++i) {
    const auto byte = data.ConsumeIntegral<std::uint8_t>();
    labels.push_back(byte == 255 ? data.ConsumeIntegral<Label>() : static_cast<Label>(byte % 4));
  }
  return labels;
}

inline std::vector<LabelRegion> anyRegions(FuzzedDataProvider& data) {
  std::vector<LabelRegion> regions(data.ConsumeIntegralInRange<std::size_t>(0, 4));
  for (LabelRegion& region : regions) {
    region.label =
        data.ConsumeBool() ? data.ConsumeIntegralInRange<int>(0, 3) : data.ConsumeIntegral<int>();
    region.class_id = data.ConsumeIntegralInRange<int>(0, 2);
  }
  return regions;
}

/// What a frame before believed, in the ranges that MotionBelief documents.
inline MotionBelief anyMemory(FuzzedDataProvider& data) {
  const auto n = data.ConsumeIntegralInRange<std::size_t>(0, 40);
  MotionBelief memory;
  memory.u = anyFloats(data, n, 0.0f, 100.0f);
  memory.v = anyFloats(data, n, 0.0f, 100.0f);
  memory.depth = anyFloats(data, n, 0.0f, 6.0f);
  for (std::size_t i = 0; i < n; ++i) {
    memory.belief.push_back(data.ConsumeBool() ? data.ConsumeProbability<float>() : kNaN);
    memory.weight.push_back(data.ConsumeProbability<float>());
  }
  return memory;
}

/// Equal bit for bit; NaN equals NaN.
inline bool same(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
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
