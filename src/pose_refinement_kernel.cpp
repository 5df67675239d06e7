// SPDX-License-Identifier: BSD-3-Clause
#include "pose_refinement_kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace hmcdyn::detail {
namespace {

/// What the sums need of four points. e is unwhitened here: the factors hold the information.
struct Linearised {
  Lanes x, y, inverse_z;           // p / z and 1 / z in the camera's frame
  Lanes factor_u, factor_v;        // f / sigma^2 times the squared focal length
  Lanes residual_u, residual_v;    // f / sigma^2 times the focal length times the residual
  Lanes third_x, third_y, third_z;  // dh_3/dp times (x, y, z), see addThirdRow()
  Lanes factor_third, residual_third;
};

/// So many blocks are linearised before they are summed: the sums then stay in registers, and the
/// linearised blocks in the first-level cache.
constexpr std::size_t kChunk = 16;
using Chunk = std::array<Linearised, kChunk>;

/// Sums over the points, lane by lane. h34 is zero and h25 = -(h03 + h14).
struct Sums {
  Lanes h00, h01, h02, h03, h04, h05, h11, h12, h13, h14, h15;
  Lanes h22, h23, h24, h33, h35, h44, h45, h55;
  Lanes g0, g1, g2, g3, g4, g5;
  Lanes h25_third;
  Lanes cost, behind;
};

Sums zeroSums() {
  const Lanes zero = Lanes::Zero();
  return {zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero,
          zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero, zero};
}

/// A pose and a camera, in scalars that the compiler can keep in registers.
struct View {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
  double fx, fy, baseline_fx, nearest;
};

/// Residuals, losses and their factors of one block; adds to cost and behind.
template <DepthRow kRow, bool kHuber, bool kSwitch>
inline void lineariseBlock(const PointBlock& block, const View& view, Linearised& linearised,
                           double* squared_residuals, Sums& sums) {
  const Eigen::Matrix3d& r = view.rotation;
  const Eigen::Vector3d& t = view.translation;
  const Lanes px = r(0, 0) * block.x + r(0, 1) * block.y + r(0, 2) * block.z + t[0];
  const Lanes py = r(1, 0) * block.x + r(1, 1) * block.y + r(1, 2) * block.z + t[1];
  const Lanes unbounded = r(2, 0) * block.x + r(2, 1) * block.y + r(2, 2) * block.z + t[2];
  const Lanes pz = unbounded.max(view.nearest);  // finite formulas behind the camera, too
  const Lanes missing = pz - unbounded;          // > 0 behind
  sums.behind += block.weight * missing;

  const Lanes inverse_z = pz.inverse();
  const Lanes x = px * inverse_z;
  const Lanes y = py * inverse_z;
  const Lanes du = block.u - view.fx * x;
  const Lanes dv = block.v - view.fy * y;
  Lanes s = block.information * (du * du + dv * dv);
  Lanes third = Lanes::Zero();
  if constexpr (kRow == DepthRow::kDepth) {
    third = block.third - pz;
  } else if constexpr (kRow == DepthRow::kDisparity) {
    third = block.third - view.fx * x + view.baseline_fx * inverse_z;
  }
  if constexpr (kRow != DepthRow::kNone) {
    s += block.third_information * third * third;
  }
  constexpr double kLiftAbove = 1e300;  // the smallest `missing` there is becomes > kBehindCamera
  Eigen::Map<Lanes>{squared_residuals} = s.min(kBehindCamera) + kLiftAbove * missing;

  // Both losses without a branch. Huber: rho = min(s, d^2) + 2 d (q - d), rho' = d / q with
  // q = max(sqrt(s), d). Geman-McClure: rho = share s, rho' = share^2, share = kappa / (kappa + s).
  Lanes rho = s;
  Lanes factor = block.weight;
  if constexpr (kHuber) {
    const Lanes d = block.huber;
    const Lanes q = s.max(d * d).sqrt();
    rho = s.min(d * d) + 2.0 * d * (q - d);
    factor *= d / q;
  }
  if constexpr (kSwitch) {
    const Lanes share = (1.0 + s * block.inverse_kappa).inverse();
    rho *= share;
    factor *= share * share;
  }
  sums.cost += block.weight * rho;

  const Lanes pixel_factor = factor * block.information;
  linearised.x = x;
  linearised.y = y;
  linearised.inverse_z = inverse_z;
  linearised.factor_u = pixel_factor * (view.fx * view.fx);
  linearised.factor_v = pixel_factor * (view.fy * view.fy);
  linearised.residual_u = pixel_factor * view.fx * du;
  linearised.residual_v = pixel_factor * view.fy * dv;
  if constexpr (kRow != DepthRow::kNone) {
    linearised.factor_third = factor * block.third_information;
    linearised.residual_third = linearised.factor_third * third;
  }
  if constexpr (kRow == DepthRow::kDepth) {
    linearised.third_x = px;
    linearised.third_y = py;
  } else if constexpr (kRow == DepthRow::kDisparity) {
    linearised.third_z = view.baseline_fx * inverse_z - view.fx * x;  // z dh_3/dp_z
  }
}

// The rows of dh/d(omega, v), each divided by its focal length:
//   u: (-x y,        1 + x^2, -y, 1/z, 0,   -x/z)
//   v: (-(1 + y^2),  x y,      x, 0,   1/z, -y/z)
// Their weighted products share most of their factors, which the next two functions make use of.

inline void addTranslationPart(const Linearised& a, Sums& sums) {
  const Lanes u = a.factor_u * a.inverse_z;
  const Lanes v = a.factor_v * a.inverse_z;
  const Lanes ux = u * a.x;
  const Lanes vy = v * a.y;
  const Lanes both = ux * a.x + vy * a.y;
  sums.h33 += u * a.inverse_z;
  sums.h44 += v * a.inverse_z;
  sums.h35 -= ux * a.inverse_z;
  sums.h45 -= vy * a.inverse_z;
  sums.h55 += both * a.inverse_z;
  sums.h03 -= ux * a.y;
  sums.h13 += u + ux * a.x;
  sums.h23 -= u * a.y;
  sums.h04 -= v + vy * a.y;
  sums.h14 += vy * a.x;
  sums.h24 += v * a.x;
  sums.h05 += (both + v) * a.y;
  sums.h15 -= (both + u) * a.x;
}

inline void addRotationPartAndGradient(const Linearised& a, Sums& sums) {
  const Lanes ux = a.factor_u * a.x;
  const Lanes vy = a.factor_v * a.y;
  const Lanes both = ux * a.x + vy * a.y;
  const Lanes difference = ux * a.y - vy * a.x;
  sums.h00 += (both * a.y + 2.0 * vy) * a.y + a.factor_v;
  sums.h11 += (both * a.x + 2.0 * ux) * a.x + a.factor_u;
  sums.h01 -= (both + a.factor_u + a.factor_v) * (a.x * a.y);
  sums.h02 += difference * a.y - a.factor_v * a.x;
  sums.h12 -= difference * a.x + a.factor_u * a.y;
  sums.h22 += a.factor_u * (a.y * a.y) + a.factor_v * (a.x * a.x);
  // dh^T e; e = z - h turns the sign in the end.
  const Lanes along = a.x * a.residual_u + a.y * a.residual_v;
  sums.g0 -= a.y * along + a.residual_v;
  sums.g1 += a.x * along + a.residual_u;
  sums.g2 += a.x * a.residual_v - a.y * a.residual_u;
  sums.g3 += a.inverse_z * a.residual_u;
  sums.g4 += a.inverse_z * a.residual_v;
  sums.g5 -= a.inverse_z * along;
}

/// The row of depth is (p_y, -p_x, 0, 0, 0, 1).
inline void addDepthRow(const Linearised& a, Sums& sums) {
  const Lanes mx = a.factor_third * a.third_x;
  const Lanes my = a.factor_third * a.third_y;
  sums.h00 += my * a.third_y;
  sums.h01 -= my * a.third_x;
  sums.h11 += mx * a.third_x;
  sums.h05 += my;
  sums.h15 -= mx;
  sums.h55 += a.factor_third;
  sums.g0 += a.residual_third * a.third_y;
  sums.g1 -= a.residual_third * a.third_x;
  sums.g5 += a.residual_third;
}

/// With dh_3/dp = (fx, 0, w) / z the row of disparity is (w y, fx - w x, -fx y, fx/z, 0, w/z).
inline void addDisparityRow(const Linearised& a, double fx, Sums& sums) {
  const Lanes j0 = a.third_z * a.y;
  const Lanes j1 = fx - a.third_z * a.x;
  const Lanes j2 = -fx * a.y;
  const Lanes j3 = fx * a.inverse_z;
  const Lanes j5 = a.third_z * a.inverse_z;
  const Lanes m0 = a.factor_third * j0;
  const Lanes m1 = a.factor_third * j1;
  const Lanes m2 = a.factor_third * j2;
  const Lanes m3 = a.factor_third * j3;
  sums.h00 += m0 * j0;
  sums.h01 += m0 * j1;
  sums.h02 += m0 * j2;
  sums.h03 += m0 * j3;
  sums.h05 += m0 * j5;
  sums.h11 += m1 * j1;
  sums.h12 += m1 * j2;
  sums.h13 += m1 * j3;
  sums.h15 += m1 * j5;
  sums.h22 += m2 * j2;
  sums.h23 += m2 * j3;
  sums.h25_third += m2 * j5 + m0 * j3;  // m0 j3 went into h03, from which h25 is derived
  sums.h33 += m3 * j3;
  sums.h35 += m3 * j5;
  sums.h55 += a.factor_third * j5 * j5;
  sums.g0 += a.residual_third * j0;
  sums.g1 += a.residual_third * j1;
  sums.g2 += a.residual_third * j2;
  sums.g3 += a.residual_third * j3;
  sums.g5 += a.residual_third * j5;
}

CollapsedSystem total(const Sums& s) {
  CollapsedSystem system;
  Eigen::Matrix<double, 6, 6> h;
  h.row(0) << s.h00.sum(), s.h01.sum(), s.h02.sum(), s.h03.sum(), s.h04.sum(), s.h05.sum();
  h.row(1) << 0.0, s.h11.sum(), s.h12.sum(), s.h13.sum(), s.h14.sum(), s.h15.sum();
  h.row(2) << 0.0, 0.0, s.h22.sum(), s.h23.sum(), s.h24.sum(), 0.0;
  h.row(3) << 0.0, 0.0, 0.0, s.h33.sum(), 0.0, s.h35.sum();
  h.row(4) << 0.0, 0.0, 0.0, 0.0, s.h44.sum(), s.h45.sum();
  h.row(5) << 0.0, 0.0, 0.0, 0.0, 0.0, s.h55.sum();
  h(2, 5) = s.h25_third.sum() - h(0, 3) - h(1, 4);
  system.normal = h.selfadjointView<Eigen::Upper>();
  system.gradient << -s.g0.sum(), -s.g1.sum(), -s.g2.sum(), -s.g3.sum(), -s.g4.sum(), -s.g5.sum();
  const bool feasible = s.behind.sum() == 0.0 && h.allFinite() && system.gradient.allFinite();
  const double cost = s.cost.sum();
  system.cost = feasible && std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
  return system;
}

template <DepthRow kRow, bool kHuber, bool kSwitch>
CollapsedSystem collapseAll(const std::vector<PointBlock>& blocks, const View& view,
                            std::vector<double>& squared_residuals) {
  Chunk chunk;
  Sums sums = zeroSums();
  for (std::size_t begin = 0; begin < blocks.size(); begin += kChunk) {
    const std::size_t count = std::min(kChunk, blocks.size() - begin);
    for (std::size_t i = 0; i < count; ++i) {
      lineariseBlock<kRow, kHuber, kSwitch>(blocks[begin + i], view, chunk[i],
                                            &squared_residuals[(begin + i) * kLanes], sums);
    }
    for (std::size_t i = 0; i < count; ++i) {
      addTranslationPart(chunk[i], sums);
    }
    for (std::size_t i = 0; i < count; ++i) {
      addRotationPartAndGradient(chunk[i], sums);
    }
    for (std::size_t i = 0; i < count && kRow != DepthRow::kNone; ++i) {
      if constexpr (kRow == DepthRow::kDepth) {
        addDepthRow(chunk[i], sums);
      } else {
        addDisparityRow(chunk[i], view.fx, sums);
      }
    }
  }
  return total(sums);
}

template <DepthRow kRow>
CollapsedSystem collapseRows(const std::vector<PointBlock>& blocks, const View& view,
                             CollapseVariant variant, std::vector<double>& squared_residuals) {
  if (variant.switchable) {
    return variant.huber ? collapseAll<kRow, true, true>(blocks, view, squared_residuals)
                         : collapseAll<kRow, false, true>(blocks, view, squared_residuals);
  }
  return variant.huber ? collapseAll<kRow, true, false>(blocks, view, squared_residuals)
                       : collapseAll<kRow, false, false>(blocks, view, squared_residuals);
}

}  // namespace

CollapsedSystem collapse(const std::vector<PointBlock>& blocks, const ProjectionModel& model,
                         CollapseVariant variant, const Eigen::Matrix3d& rotation,
                         const Eigen::Vector3d& translation,
                         std::vector<double>& squared_residuals) {
  const View view{rotation,        translation,       model.camera.fx,
                  model.camera.fy, model.baseline_fx, model.min_depth};
  switch (variant.depth_row) {
    case DepthRow::kDepth:
      return collapseRows<DepthRow::kDepth>(blocks, view, variant, squared_residuals);
    case DepthRow::kDisparity:
      return collapseRows<DepthRow::kDisparity>(blocks, view, variant, squared_residuals);
    case DepthRow::kNone:
      break;
  }
  return collapseRows<DepthRow::kNone>(blocks, view, variant, squared_residuals);
}

}  // namespace hmcdyn::detail
