// SPDX-License-Identifier: BSD-3-Clause
#include "evaluate/alignment.hpp"

#include <cmath>
#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <fmt/format.h>

namespace hmcdyn::evaluate {
namespace {

/// Points closer together than this coincide (m).
constexpr double kCoincident = 1e-9;
/// Points that leave their line by less than this share of their extent lie on it.
constexpr double kCollinear = 1e-5;

using Points = Eigen::Matrix3Xd;

Points toMatrix(Span<const Eigen::Vector3d> points, const char* argument) {
  Points matrix(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) {
      throw std::invalid_argument(fmt::format(
          "align: {} holds NaN or infinity at {}; expected finite points", argument, i));
    }
    matrix.col(static_cast<Eigen::Index>(i)) = points[i];
  }
  return matrix;
}

/// Root mean square extents (m) of the points along their principal axes, falling.
Eigen::Vector3d extents(const Points& points) {
  // Squared, a share of kCollinear is 1e-10 still, far above a double's rounding; the singular
  // values of a matrix of any width take the compiler longer than the rest of this folder.
  const Points centred = points.colwise() - points.rowwise().mean();
  const Eigen::Matrix3d scatter =
      centred * centred.transpose() / static_cast<double>(points.cols());
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .reverse()
      .cwiseMax(0.0)
      .cwiseSqrt();
}

bool coincide(const Eigen::Vector3d& extent) { return extent[0] < kCoincident; }

bool spansPlane(const Eigen::Vector3d& extent) {
  return !coincide(extent) && extent[1] > kCollinear * extent[0];
}

}  // namespace

Alignment align(Span<const Eigen::Vector3d> source, Span<const Eigen::Vector3d> target,
                AlignmentModel model) {
  if (source.size() != target.size()) {
    throw std::invalid_argument(
        fmt::format("align: source has {} points, target {}; expected equal sizes", source.size(),
                    target.size()));
  }
  if (source.size() < 3) {
    throw std::runtime_error(
        fmt::format("alignment needs at least 3 pairs of positions; there are {}", source.size()));
  }
  const Points from = toMatrix(source, "source");
  const Points to = toMatrix(target, "target");
  const Eigen::Vector3d from_extent = extents(from);
  const Eigen::Vector3d to_extent = extents(to);
  const bool with_scale = model == AlignmentModel::kSimilarity;
  if (with_scale && (coincide(from_extent) || coincide(to_extent))) {
    throw std::runtime_error(
        fmt::format("no scale can be estimated: all positions of the {} coincide",
                    coincide(from_extent) ? "estimate" : "ground truth"));
  }
  const Eigen::Matrix4d transform = Eigen::umeyama(from, to, with_scale);
  Alignment alignment;
  alignment.scale = with_scale ? transform.topLeftCorner<3, 1>().norm() : 1.0;
  if (!(alignment.scale > 0.0)) {
    throw std::runtime_error("no scale can be estimated: the positions are not related");
  }
  alignment.rotation = transform.topLeftCorner<3, 3>() / alignment.scale;
  alignment.translation = transform.topRightCorner<3, 1>();
  alignment.unique = spansPlane(from_extent) && spansPlane(to_extent);
  return alignment;
}

}  // namespace hmcdyn::evaluate
