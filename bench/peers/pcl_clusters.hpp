// SPDX-License-Identifier: BSD-3-Clause
// PCL behind plain types: it is compiled in a library of its own, with the baseline instruction
// set, as Eigen's alignment in its interface depends on the flags.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace hmcdyn::bench {

class PclCloud {
 public:
  PclCloud(const std::vector<float>& x, const std::vector<float>& y);
  ~PclCloud();
  PclCloud(PclCloud&& other) noexcept;
  PclCloud& operator=(PclCloud&& other) noexcept;
  PclCloud(const PclCloud&) = delete;
  PclCloud& operator=(const PclCloud&) = delete;

  /// EuclideanClusterExtraction over PCL's kd-tree, which it builds first: single linkage, not
  /// density clusters, but what its users take. Labels; -1 in clusters of fewer than `min_size`.
  std::vector<int> cluster(double tolerance, int min_size) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace hmcdyn::bench
