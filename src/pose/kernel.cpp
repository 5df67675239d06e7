// SPDX-License-Identifier: BSD-3-Clause
#include "pose/kernel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pose/lanes.hpp"

namespace hmcdyn::detail {
namespace {

/// What the sums need of four points. e is unwhitened here: the factors hold the information.
struct Linearised {
  Lanes x, y, inverse_z;            // p / z and 1 / z in the camera's frame
  Lanes factor_u, factor_v;         // f / sigma^2 times the squared focal length
  Lanes residual_u, residual_v;     // f / sigma^2 times the focal length times the residual
  Lanes third_x, third_y, third_z;  // dh_3/dp times (x, y, z), see addThirdRow()
  Lanes factor_third, residual_third;
};

/// So many blocks are linearised before they are summed: the sums then stay in registers, and the
/// linearised points in the first-level cache.
constexpr std::size_t kChunk = 8;
using Chunk = std::array<Linearised, kChunk * kBlock / kLanes>;

// Sums over the points, lane by lane: h for the upper triangle of sum f J^T J, g for sum f J^T e.
// h34 is zero, and h25 = -(h03 + h14) for the pixel rows.
struct TranslationSums {
  Lanes h03, h04, h05, h13, h14, h15, h23, h24, h33, h35, h44, h45, h55;
};
struct RotationSums {
  Lanes h00, h01, h02, h11, h12, h22;
};
struct GradientSums {
  Lanes g0, g1, g2, g3, g4, g5;
};
struct CostSums {
  Lanes cost, behind;
};
struct Sums {
  TranslationSums t;
  RotationSums r;
  GradientSums g;
  CostSums c;
  Lanes h25_third;
};

Lanes spread(double value) { return Lanes{} + value; }

/// A pose and a camera, spread over the lanes once.
struct View {
  View(const ProjectionModel& model, const Eigen::Matrix3d& rotation,
       const Eigen::Vector3d& translation)
      : fx(spread(model.camera.fx)),
        fy(spread(model.camera.fy)),
        square_fx(fx * fx),
        square_fy(fy * fy),
        baseline_fx(spread(model.baseline_fx)),
        nearest(spread(model.min_depth)) {
    for (std::size_t i = 0; i < 3; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      r[i] = {spread(rotation(row, 0)), spread(rotation(row, 1)), spread(rotation(row, 2))};
      t[i] = spread(translation(row));
    }
  }

  std::array<std::array<Lanes, 3>, 3> r{};
  std::array<Lanes, 3> t{};
  Lanes fx, fy, square_fx, square_fy, baseline_fx, nearest;
};

// The helpers below must become part of the loop that calls them, or the sums leave the registers.
#define HMCDYN_INLINE [[gnu::always_inline]] inline

struct Loss {
  Lanes rho, slope;  // rho(s), rho'(s)
};

/// Both losses without a branch. Huber: rho = min(s, d^2) + 2 d (q - d), rho' = d / q with
/// q = max(sqrt(s), d). Geman-McClure: rho = share s, rho' = share^2, share = kappa / (kappa + s).
template <bool kHuber, bool kSwitch>
HMCDYN_INLINE Loss lossOf(const PointBlock& block, std::size_t first, const Lanes& s) {
  Loss loss{s, spread(1.0)};
  if constexpr (kHuber) {
    const Lanes d = loadLanes(&block.huber[first]);
    const Lanes square = d * d;
    const Lanes q = squareRoot(larger(s, square));
    loss.rho = smaller(s, square) + 2.0 * d * (q - d);
    loss.slope = d / q;
  }
  if constexpr (kSwitch) {
    const Lanes share = 1.0 / (1.0 + s * loadLanes(&block.inverse_kappa[first]));
    loss.rho *= share;
    loss.slope *= share * share;
  }
  return loss;
}

/// Residuals, losses and their factors of kLanes points of a block; adds to cost and behind.
template <DepthRow kRow, bool kHuber, bool kSwitch>
HMCDYN_INLINE void linearise(const PointBlock& block, std::size_t first, const View& view,
                             Linearised& linearised, double* squared_residuals, CostSums& sums) {
  const auto& r = view.r;
  const auto& t = view.t;
  const Lanes wx = loadLanes(&block.x[first]);
  const Lanes wy = loadLanes(&block.y[first]);
  const Lanes wz = loadLanes(&block.z[first]);
  const Lanes weight = loadLanes(&block.weight[first]);
  const Lanes information = loadLanes(&block.information[first]);
  const Lanes px = r[0][0] * wx + r[0][1] * wy + r[0][2] * wz + t[0];
  const Lanes py = r[1][0] * wx + r[1][1] * wy + r[1][2] * wz + t[1];
  const Lanes unbounded = r[2][0] * wx + r[2][1] * wy + r[2][2] * wz + t[2];
  // Behind the camera the formulas stay finite, too, and `missing` is positive.
  const Lanes pz = larger(unbounded, view.nearest);
  const Lanes missing = pz - unbounded;
  sums.behind += smaller(weight, missing);

  const Lanes inverse_z = 1.0 / pz;
  const Lanes x = px * inverse_z;
  const Lanes y = py * inverse_z;
  const Lanes du = loadLanes(&block.u[first]) - view.fx * x;
  const Lanes dv = loadLanes(&block.v[first]) - view.fy * y;
  Lanes s = information * (du * du + dv * dv);
  Lanes third{};
  if constexpr (kRow == DepthRow::kDepth) {
    third = loadLanes(&block.third[first]) - pz;
  } else if constexpr (kRow == DepthRow::kDisparity) {
    third = loadLanes(&block.third[first]) - view.fx * x + view.baseline_fx * inverse_z;
  }
  if constexpr (kRow != DepthRow::kNone) {
    s += loadLanes(&block.third_information[first]) * third * third;
  }
  storeLanes(missing > 0.0 ? spread(std::numeric_limits<double>::infinity())
                           : smaller(s, spread(kBehindCamera)),
             squared_residuals);

  const Loss loss = lossOf<kHuber, kSwitch>(block, first, s);
  sums.cost += weight * loss.rho;

  const Lanes factor = weight * loss.slope;
  const Lanes pixel_factor = factor * information;
  linearised.x = x;
  linearised.y = y;
  linearised.inverse_z = inverse_z;
  linearised.factor_u = pixel_factor * view.square_fx;
  linearised.factor_v = pixel_factor * view.square_fy;
  linearised.residual_u = pixel_factor * view.fx * du;
  linearised.residual_v = pixel_factor * view.fy * dv;
  if constexpr (kRow != DepthRow::kNone) {
    linearised.factor_third = factor * loadLanes(&block.third_information[first]);
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
// Their weighted products share most of their factors, which the next function makes use of: it is
// bound by the multiplications.

HMCDYN_INLINE void addPixelRows(const Linearised& a, TranslationSums& t, RotationSums& r) {
  const Lanes ux = a.factor_u * a.x;
  const Lanes uy = a.factor_u * a.y;
  const Lanes vx = a.factor_v * a.x;
  const Lanes vy = a.factor_v * a.y;
  const Lanes uxx = ux * a.x;
  const Lanes vyy = vy * a.y;
  const Lanes u1xx = a.factor_u + uxx;
  const Lanes v1yy = a.factor_v + vyy;
  const Lanes uxy = ux * a.y;
  const Lanes vxy = vy * a.x;
  const Lanes by_y = (uxx + v1yy) * a.y;
  const Lanes by_x = (u1xx + vyy) * a.x;
  const Lanes square = a.inverse_z * a.inverse_z;
  t.h33 += a.factor_u * square;
  t.h44 += a.factor_v * square;
  t.h35 -= ux * square;
  t.h45 -= vy * square;
  t.h55 += (uxx + vyy) * square;
  t.h03 -= uxy * a.inverse_z;
  t.h13 += u1xx * a.inverse_z;
  t.h23 -= uy * a.inverse_z;
  t.h04 -= v1yy * a.inverse_z;
  t.h14 += vxy * a.inverse_z;
  t.h24 += vx * a.inverse_z;
  t.h05 += by_y * a.inverse_z;
  t.h15 -= by_x * a.inverse_z;
  r.h00 += by_y * a.y + v1yy;
  r.h01 -= by_y * a.x + uxy;
  r.h02 += uxy * a.y - v1yy * a.x;
  r.h11 += by_x * a.x + u1xx;
  r.h12 -= u1xx * a.y - vxy * a.x;
  r.h22 += uy * a.y + vx * a.x;
}

/// dh^T e; e = z - h turns the sign in the end.
HMCDYN_INLINE void addPixelGradient(const Linearised& a, GradientSums& sums) {
  const Lanes along = a.x * a.residual_u + a.y * a.residual_v;
  sums.g0 -= a.y * along + a.residual_v;
  sums.g1 += a.x * along + a.residual_u;
  sums.g2 += a.x * a.residual_v - a.y * a.residual_u;
  sums.g3 += a.inverse_z * a.residual_u;
  sums.g4 += a.inverse_z * a.residual_v;
  sums.g5 -= a.inverse_z * along;
}

/// The row of depth is (p_y, -p_x, 0, 0, 0, 1).
HMCDYN_INLINE void addDepthRow(const Linearised& a, Sums& sums) {
  const Lanes mx = a.factor_third * a.third_x;
  const Lanes my = a.factor_third * a.third_y;
  sums.r.h00 += my * a.third_y;
  sums.r.h01 -= my * a.third_x;
  sums.r.h11 += mx * a.third_x;
  sums.t.h05 += my;
  sums.t.h15 -= mx;
  sums.t.h55 += a.factor_third;
  sums.g.g0 += a.residual_third * a.third_y;
  sums.g.g1 -= a.residual_third * a.third_x;
  sums.g.g5 += a.residual_third;
}

/// With dh_3/dp = (fx, 0, w) / z the row of disparity is (w y, fx - w x, -fx y, fx/z, 0, w/z).
HMCDYN_INLINE void addDisparityRow(const Linearised& a, const Lanes& fx, Sums& sums) {
  const Lanes j0 = a.third_z * a.y;
  const Lanes j1 = fx - a.third_z * a.x;
  const Lanes j2 = -fx * a.y;
  const Lanes j3 = fx * a.inverse_z;
  const Lanes j5 = a.third_z * a.inverse_z;
  const Lanes m0 = a.factor_third * j0;
  const Lanes m1 = a.factor_third * j1;
  const Lanes m2 = a.factor_third * j2;
  const Lanes m3 = a.factor_third * j3;
  sums.r.h00 += m0 * j0;
  sums.r.h01 += m0 * j1;
  sums.r.h02 += m0 * j2;
  sums.t.h03 += m0 * j3;
  sums.t.h05 += m0 * j5;
  sums.r.h11 += m1 * j1;
  sums.r.h12 += m1 * j2;
  sums.t.h13 += m1 * j3;
  sums.t.h15 += m1 * j5;
  sums.r.h22 += m2 * j2;
  sums.t.h23 += m2 * j3;
  sums.h25_third += m2 * j5 + m0 * j3;  // m0 j3 went into h03, from which h25 is derived
  sums.t.h33 += m3 * j3;
  sums.t.h35 += m3 * j5;
  sums.t.h55 += a.factor_third * j5 * j5;
  sums.g.g0 += a.residual_third * j0;
  sums.g.g1 += a.residual_third * j1;
  sums.g.g2 += a.residual_third * j2;
  sums.g.g3 += a.residual_third * j3;
  sums.g.g5 += a.residual_third * j5;
}

CollapsedSystem systemOf(const Sums& sums) {
  const TranslationSums& t = sums.t;
  const RotationSums& r = sums.r;
  const GradientSums& g = sums.g;
  const double h03 = total(t.h03);
  const double h14 = total(t.h14);
  CollapsedSystem system;  // the lower triangle, column by column
  Eigen::Matrix<double, 6, 6>& h = system.normal;
  h.col(0) << total(r.h00), total(r.h01), total(r.h02), h03, total(t.h04), total(t.h05);
  h.col(1).tail<5>() << total(r.h11), total(r.h12), total(t.h13), h14, total(t.h15);
  h.col(2).tail<4>() << total(r.h22), total(t.h23), total(t.h24), total(sums.h25_third) - h03 - h14;
  h.col(3).tail<3>() << total(t.h33), 0.0, total(t.h35);
  h.col(4).tail<2>() << total(t.h44), total(t.h45);
  h(5, 5) = total(t.h55);
  for (Eigen::Index column = 1; column < 6; ++column) {
    h.col(column).head(column) = h.row(column).head(column).transpose();
  }
  system.gradient << -total(g.g0), -total(g.g1), -total(g.g2), -total(g.g3), -total(g.g4),
      -total(g.g5);
  // The diagonal bounds the other entries.
  const double cost = total(sums.c.cost);
  const bool feasible =
      total(sums.c.behind) == 0.0 && std::isfinite(cost + h.trace() + system.gradient.lpNorm<1>());
  system.cost = feasible ? cost : std::numeric_limits<double>::infinity();
  return system;
}

template <DepthRow kRow, bool kHuber, bool kSwitch>
CollapsedSystem collapseAll(const std::vector<PointBlock>& blocks, const View& view,
                            double* squared_residuals) {
  Chunk chunk;
  Sums sums{};
  for (std::size_t begin = 0; begin < blocks.size(); begin += kChunk) {
    const std::size_t end = std::min(begin + kChunk, blocks.size());
    std::size_t count = 0;
    CostSums cost = sums.c;
    for (std::size_t i = begin; i < end; ++i) {
      for (std::size_t first = 0; first < kBlock; first += kLanes) {
        linearise<kRow, kHuber, kSwitch>(blocks[i], first, view, chunk[count++],
                                         squared_residuals + i * kBlock + first, cost);
      }
    }
    sums.c = cost;
    TranslationSums translation = sums.t;
    RotationSums rotation = sums.r;
    for (std::size_t i = 0; i < count; ++i) {
      addPixelRows(chunk[i], translation, rotation);
    }
    sums.t = translation;
    sums.r = rotation;
    GradientSums gradient = sums.g;
    for (std::size_t i = 0; i < count; ++i) {
      addPixelGradient(chunk[i], gradient);
    }
    sums.g = gradient;
    for (std::size_t i = 0; i < count && kRow != DepthRow::kNone; ++i) {
      if constexpr (kRow == DepthRow::kDepth) {
        addDepthRow(chunk[i], sums);
      } else {
        addDisparityRow(chunk[i], view.fx, sums);
      }
    }
  }
  return systemOf(sums);
}

template <DepthRow kRow>
CollapsedSystem collapseRows(const std::vector<PointBlock>& blocks, const View& view,
                             CollapseVariant variant, double* squared_residuals) {
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
  const View view(model, rotation, translation);
  switch (variant.depth_row) {
    case DepthRow::kDepth:
      return collapseRows<DepthRow::kDepth>(blocks, view, variant, squared_residuals.data());
    case DepthRow::kDisparity:
      return collapseRows<DepthRow::kDisparity>(blocks, view, variant, squared_residuals.data());
    case DepthRow::kNone:
      break;
  }
  return collapseRows<DepthRow::kNone>(blocks, view, variant, squared_residuals.data());
}

}  // namespace hmcdyn::detail
