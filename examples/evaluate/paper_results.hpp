// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hmcdyn::evaluate {

/// One figure of a published table.
struct PaperValue {
  std::string table;     ///< "I" to "VI".
  std::string sequence;  ///< As the paper writes it: "WALKXYZ".
  std::string system;    ///< "HMC", "RS", "ORB-SLAM3", ...
  std::string metric;    ///< "ate_rmse", "tracking_rate", ...
  double value = 0.0;
};

/// Reads `table,sequence,system,metric,value`; lines that begin with # are comments.
/// @throws std::runtime_error naming file and line.
std::vector<PaperValue> readPaperResults(const std::filesystem::path& file);

/// The figure with these names; none where the paper has none.
std::optional<double> findPaperValue(const std::vector<PaperValue>& values,
                                     const std::string& table, const std::string& sequence,
                                     const std::string& system, const std::string& metric);

/// The paper's name of a sequence of TUM ("rgbd_dataset_freiburg3_walking_xyz"), BONN
/// ("rgbd_bonn_crowd2") or of a rendered scene of that kind ("walking_xyz"); empty = not in it.
std::string paperSequence(const std::string& folder);

}  // namespace hmcdyn::evaluate
