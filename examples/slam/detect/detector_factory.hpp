// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "slam/detect/detector.hpp"
#include "slam/detect/detector_options.hpp"

namespace hmcdyn::slam {

/// What DetectorOptions::type may be.
std::vector<std::string> detectorTypes();

/// For a type that there was once: what took its place. Empty for any other.
std::string describeFormerType(const std::string& type);

/// The detector that the options describe, loaded and tried on an empty image, so that a model
/// which cannot run is found out here.
/// @throws std::invalid_argument that names the option where the type is unknown, an option that
/// the type needs is missing, or a value is out of range.
/// @throws std::runtime_error that names the file where model, weights or boxes cannot be used.
std::unique_ptr<ObjectDetector> makeDetector(const DetectorOptions& options);

}  // namespace hmcdyn::slam
