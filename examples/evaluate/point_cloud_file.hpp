// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include <Eigen/Core>

namespace hmcdyn::evaluate {

/// The positions of a PLY file's vertices, ASCII or binary little endian, whose first element is
/// "vertex" with x, y and z among scalar properties of the usual types. Vertices with a coordinate
/// that is not finite are left out.
/// @throws std::runtime_error naming the file where it cannot be read, is no such PLY or is cut
/// off.
std::vector<Eigen::Vector3f> readPlyPositions(const std::filesystem::path& file);

}  // namespace hmcdyn::evaluate
