// SPDX-License-Identifier: BSD-3-Clause
// Open3D behind plain types: it is compiled in a library of its own, with the baseline instruction
// set, as Eigen's alignment in its interface depends on the flags.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace hmcdyn::bench {

class Open3dCloud {
 public:
  Open3dCloud(const std::vector<float>& x, const std::vector<float>& y);
  ~Open3dCloud();
  Open3dCloud(Open3dCloud&& other) noexcept;
  Open3dCloud& operator=(Open3dCloud&& other) noexcept;
  Open3dCloud(const Open3dCloud&) = delete;
  Open3dCloud& operator=(const Open3dCloud&) = delete;

  /// PointCloud::ClusterDBSCAN.
  std::vector<int> cluster(double epsilon, std::size_t min_points) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hmcdyn::bench
