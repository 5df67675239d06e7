// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

namespace hmcdyn::slam {

/// Number of classes of the COCO detection task (Lin et al., ECCV 2014), in the order of the
/// networks trained on it: 0 = person, 79 = toothbrush.
inline constexpr int kCocoClassCount = 80;

/// Name of a class, such as "traffic light".
/// @throws std::invalid_argument unless 0 <= class_id < kCocoClassCount.
std::string cocoClassName(int class_id);

/// The class of a name, nothing where there is none. '_' stands for a blank, and Darknet's
/// spellings (motorbike, aeroplane, sofa, pottedplant, diningtable, tvmonitor) are known too.
std::optional<int> findCocoClass(const std::string& name);

}  // namespace hmcdyn::slam
