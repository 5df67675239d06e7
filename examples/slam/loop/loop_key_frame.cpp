// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/loop_key_frame.hpp"

#include <cmath>
#include <stdexcept>
#include <string>

#include "slam/features/hamming_distance.hpp"

namespace hmcdyn::slam {

void checkLoopKeyFrame(const LoopKeyFrame& key_frame, const char* argument) {
  checkKeyPoints(key_frame.points.view());
  const std::size_t n = key_frame.points.size();
  const auto checkSize = [argument, n](const char* array, std::size_t size) {
    if (size != n) {
      throw std::invalid_argument(std::string("size of ") + argument + "." + array + " is " +
                                  std::to_string(size) + ", expected " + std::to_string(n) +
                                  ", the number of key points");
    }
  };
  checkSize("descriptors", static_cast<std::size_t>(key_frame.descriptors.rows));
  checkSize("sigma", key_frame.sigma.size());
  checkSize("map_point", key_frame.map_point.size());
  if (n > 0 &&
      (key_frame.descriptors.type() != CV_8UC1 || key_frame.descriptors.cols != kDescriptorBytes)) {
    throw std::invalid_argument(std::string(argument) + ".descriptors has type " +
                                std::to_string(key_frame.descriptors.type()) + " and " +
                                std::to_string(key_frame.descriptors.cols) +
                                " columns, expected CV_8U (0) and 32");
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (!(key_frame.sigma[i] > 0.0f) || !std::isfinite(key_frame.sigma[i])) {
      throw std::invalid_argument(std::string(argument) + ".sigma[" + std::to_string(i) + "] is " +
                                  std::to_string(key_frame.sigma[i]) + ", expected finite and > 0");
    }
  }
}

}  // namespace hmcdyn::slam
