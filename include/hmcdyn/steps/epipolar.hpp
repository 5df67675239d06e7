// SPDX-License-Identifier: BSD-3-Clause
// Step 3: how far each key point lies from where the camera's motion alone would have put it.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/plain_matrix.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// Pixels of one set of points in the two frames of a pair, structure of arrays, borrowed. NaN in
/// the earlier frame = the point was not found there.
struct PointPairsView {
  Span<const float> earlier_u;  ///< Columns in the earlier frame (px).
  Span<const float> earlier_v;  ///< Rows in the earlier frame (px).
  Span<const float> current_u;  ///< Columns in the current frame (px).
  Span<const float> current_v;  ///< Rows in the current frame (px).

  /// N, the number of pairs.
  std::size_t size() const noexcept { return current_u.size(); }
};

/// What the background's motion between two frames is explained by.
enum class TwoViewModelKind : std::uint8_t {
  kNone,         ///< Nothing: too few matches. Distances are unknown.
  kFundamental,  ///< A fundamental matrix, eq. 2: the camera translated, and the scene has depth.
  kHomography,   ///< A homography: the camera only rotated, or the background is one plane.
  kIdentity,     ///< The camera stood still: every background point stays where it is.
};

/// "none", "fundamental", "homography" or "identity".
inline const char* toString(TwoViewModelKind kind) noexcept {
  switch (kind) {
    case TwoViewModelKind::kNone:
      return "none";
    case TwoViewModelKind::kFundamental:
      return "fundamental";
    case TwoViewModelKind::kHomography:
      return "homography";
    case TwoViewModelKind::kIdentity:
      return "identity";
  }
  return "invalid";
}

/// The motion model of a frame pair: the matrix takes pixels of the earlier frame to the current
/// one, as F of eq. 2 (current^T F earlier = 0) or as a homography (current ~ H earlier).
struct TwoViewModel {
  TwoViewModelKind kind = TwoViewModelKind::kNone;  ///< What `matrix` is.
  /// F or H; else not used.
  PlainMatrix<3, 3> matrix{{1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}};
};

/// The fundamental matrix of a known motion, F = K^-T [t]x R K^-1 (Hartley, Zisserman 2004, 9.2);
/// zero where the camera only rotates.
/// @param current_from_earlier motion that takes points from the earlier camera's frame to the
/// current one's: p_current = R p_earlier + t (m).
inline Eigen::Matrix3d fundamentalOfMotion(const PinholeCamera& camera,
                                           const Eigen::Isometry3d& current_from_earlier) {
  Eigen::Matrix3d inverse;  // K^-1
  inverse << 1.0 / camera.fx, 0.0, -camera.cx / camera.fx, 0.0, 1.0 / camera.fy,
      -camera.cy / camera.fy, 0.0, 0.0, 1.0;
  const Eigen::Vector3d t = current_from_earlier.translation();
  Eigen::Matrix3d cross;
  cross << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
  return inverse.transpose() * cross * current_from_earlier.linear() * inverse;
}

/// What a known motion does to the background: epipolar lines, or, where it moves no point that is
/// a metre or more away by min_parallax beyond what the rotation does, the homography K R K^-1.
/// @param min_parallax (px)
inline TwoViewModel modelOfMotion(const PinholeCamera& camera,
                                  const Eigen::Isometry3d& current_from_earlier,
                                  double min_parallax = 0.1) {
  if (camera.fx * current_from_earlier.translation().norm() >= min_parallax) {  // at 1 m
    return {TwoViewModelKind::kFundamental, fundamentalOfMotion(camera, current_from_earlier)};
  }
  Eigen::Matrix3d k;
  k << camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0;
  return {TwoViewModelKind::kHomography, k * current_from_earlier.linear() * k.inverse()};
}

/// Epipolar line (X, Y, Z) in the current frame of a pixel of the earlier frame, eq. 3:
/// X u + Y v + Z = 0.
inline Eigen::Vector3d epipolarLine(const Eigen::Matrix3d& fundamental,
                                    const Eigen::Vector2d& earlier) {
  return fundamental * earlier.homogeneous();  // eq. 3
}

/// Distance (px) of a pixel of the current frame from the epipolar line of its match, eq. 4. NaN
/// where the line is undefined (F p = 0 in its first two components, at the epipole).
inline double epipolarDistance(const Eigen::Matrix3d& fundamental, const Eigen::Vector2d& earlier,
                               const Eigen::Vector2d& current) {
  const Eigen::Vector3d line = epipolarLine(fundamental, earlier);
  const double norm = line.head<2>().norm();
  return norm > 0.0 ? std::abs(line.dot(current.homogeneous())) / norm
                    : std::numeric_limits<double>::quiet_NaN();  // eq. 4
}

/// Checks the sizes.
/// @throws std::invalid_argument unless the four arrays have one size.
inline void checkPointPairs(const PointPairsView& pairs) {
  const std::size_t n = pairs.current_u.size();
  if (pairs.current_v.size() != n || pairs.earlier_u.size() != n || pairs.earlier_v.size() != n) {
    throw std::invalid_argument("point pairs: earlier u, v and current u, v have " +
                                std::to_string(pairs.earlier_u.size()) + ", " +
                                std::to_string(pairs.earlier_v.size()) + ", " + std::to_string(n) +
                                " and " + std::to_string(pairs.current_v.size()) +
                                " elements; expected equal sizes");
  }
}

namespace detail {

using FloatMap = Eigen::Map<const Eigen::ArrayXf>;

inline FloatMap mapOf(Span<const float> values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

inline Eigen::Map<Eigen::ArrayXf> mapOf(std::vector<float>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

/// The matrix in single precision at unit norm: float products of pixels then stay below 1e3, and
/// distances agree with double precision to 2e-3 px; to 0.05 px / r at r pixels from the epipole,
/// where lines lose their direction.
inline Eigen::Matrix3f unitNorm(const Eigen::Matrix3d& matrix) {
  const double norm = matrix.norm();
  return (norm > 0.0 ? Eigen::Matrix3d(matrix / norm) : matrix).cast<float>();
}

}  // namespace detail

/// Distances (px) of N points from the epipolar lines of their matches, eq. 3-4, in single
/// precision. NaN for a point without a match and where the line is undefined.
/// @param reuse a vector whose memory is taken over for the result.
/// @throws std::invalid_argument when the arrays differ in size.
inline std::vector<float> epipolarDistances(const Eigen::Matrix3d& fundamental,
                                            const PointPairsView& pairs,
                                            std::vector<float> reuse = {}) {
  checkPointPairs(pairs);
  reuse.resize(pairs.size());
  const auto u1 = detail::mapOf(pairs.earlier_u);
  const auto v1 = detail::mapOf(pairs.earlier_v);
  const auto u2 = detail::mapOf(pairs.current_u);
  const auto v2 = detail::mapOf(pairs.current_v);
  const Eigen::Matrix3f f = detail::unitNorm(fundamental);

  const auto x = f(0, 0) * u1 + f(0, 1) * v1 + f(0, 2);  // eq. 3
  const auto y = f(1, 0) * u1 + f(1, 1) * v1 + f(1, 2);
  const auto z = f(2, 0) * u1 + f(2, 1) * v1 + f(2, 2);
  detail::mapOf(reuse) = (x * u2 + y * v2 + z).abs() / (x.square() + y.square()).sqrt();  // eq. 4
  // 0 / 0 at the epipole is NaN already; a non-zero numerator over 0 would be infinite.
  for (float& distance : reuse) {
    if (std::isinf(distance)) {
      distance = kNaN;
    }
  }
  return reuse;
}

/// Distances (px) between N points and their matches taken over by a homography: what replaces
/// eq. 4 where F is undefined. NaN for a point without a match, or taken to infinity.
/// @throws std::invalid_argument when the arrays differ in size.
inline std::vector<float> transferDistances(const Eigen::Matrix3d& homography,
                                            const PointPairsView& pairs,
                                            std::vector<float> reuse = {}) {
  checkPointPairs(pairs);
  reuse.resize(pairs.size());
  const auto u1 = detail::mapOf(pairs.earlier_u);
  const auto v1 = detail::mapOf(pairs.earlier_v);
  const auto u2 = detail::mapOf(pairs.current_u);
  const auto v2 = detail::mapOf(pairs.current_v);
  const Eigen::Matrix3f h = detail::unitNorm(homography);

  const auto w = h(2, 0) * u1 + h(2, 1) * v1 + h(2, 2);
  const auto du = (h(0, 0) * u1 + h(0, 1) * v1 + h(0, 2)) / w - u2;
  const auto dv = (h(1, 0) * u1 + h(1, 1) * v1 + h(1, 2)) / w - v2;
  detail::mapOf(reuse) = (du.square() + dv.square()).sqrt();
  for (float& distance : reuse) {
    if (std::isinf(distance)) {
      distance = kNaN;
    }
  }
  return reuse;
}

/// Distances (px) under whatever model explains the frame pair; all NaN under kNone.
/// @throws std::invalid_argument when the arrays differ in size.
inline std::vector<float> modelDistances(const TwoViewModel& model, const PointPairsView& pairs,
                                         std::vector<float> reuse = {}) {
  switch (model.kind) {
    case TwoViewModelKind::kFundamental:
      return epipolarDistances(model.matrix, pairs, std::move(reuse));
    case TwoViewModelKind::kHomography:
      return transferDistances(model.matrix, pairs, std::move(reuse));
    case TwoViewModelKind::kIdentity:
      return transferDistances(Eigen::Matrix3d::Identity(), pairs, std::move(reuse));
    case TwoViewModelKind::kNone:
      break;
  }
  checkPointPairs(pairs);
  reuse.assign(pairs.size(), kNaN);
  return reuse;
}

}  // namespace hmcdyn
