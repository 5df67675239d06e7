// SPDX-License-Identifier: BSD-3-Clause
#include "pcl_clusters.hpp"

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>

namespace hmcdyn::bench {

struct PclCloud::Implementation {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud{new pcl::PointCloud<pcl::PointXYZ>};
};

PclCloud::PclCloud(const std::vector<float>& x, const std::vector<float>& y)
    : implementation_(std::make_unique<Implementation>()) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    implementation_->cloud->push_back({x[i], y[i], 0.0f});
  }
}

PclCloud::~PclCloud() = default;
PclCloud::PclCloud(PclCloud&& other) noexcept = default;
PclCloud& PclCloud::operator=(PclCloud&& other) noexcept = default;

std::vector<int> PclCloud::cluster(double tolerance, int min_size) const {
  const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>(false));
  tree->setInputCloud(implementation_->cloud);
  pcl::EuclideanClusterExtraction<pcl::PointXYZ> extraction;
  extraction.setClusterTolerance(tolerance);
  extraction.setMinClusterSize(min_size);
  extraction.setSearchMethod(tree);
  extraction.setInputCloud(implementation_->cloud);
  std::vector<pcl::PointIndices> clusters;
  extraction.extract(clusters);
  std::vector<int> labels(implementation_->cloud->size(), -1);
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    for (const auto i : clusters[k].indices) {
      labels[static_cast<std::size_t>(i)] = static_cast<int>(k);
    }
  }
  return labels;
}

}  // namespace hmcdyn::bench
