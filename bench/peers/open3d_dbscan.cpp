// SPDX-License-Identifier: BSD-3-Clause
#include "open3d_dbscan.hpp"

#include <open3d/geometry/PointCloud.h>

namespace hmcdyn::bench {

struct Open3dCloud::Implementation {
  open3d::geometry::PointCloud cloud;
};

Open3dCloud::Open3dCloud(const std::vector<float>& x, const std::vector<float>& y)
    : implementation_(std::make_unique<Implementation>()) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    implementation_->cloud.points_.emplace_back(static_cast<double>(x[i]),
                                                static_cast<double>(y[i]), 0.0);
  }
}

Open3dCloud::~Open3dCloud() = default;
Open3dCloud::Open3dCloud(Open3dCloud&& other) noexcept = default;
Open3dCloud& Open3dCloud::operator=(Open3dCloud&& other) noexcept = default;

std::vector<int> Open3dCloud::cluster(double epsilon, std::size_t min_points) const {
  return implementation_->cloud.ClusterDBSCAN(epsilon, min_points, false);
}

}  // namespace hmcdyn::bench
