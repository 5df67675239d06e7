// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hmcdyn::evaluate {

/// A row of keypoints.csv, as far as scoring needs it.
struct LabelledPoint {
  std::string timestamp;  ///< As written: names the mask.
  double u = 0.0;         ///< Column (px).
  double v = 0.0;         ///< Row (px).
  std::string label;      ///< "static", "suspect", "dynamic" or "unmatched".
  double scale = 1.0;  ///< Of the pyramid level it was found at, >= 1; 1 where the file has none.
};

/// A detection box of a frame, as boxes.txt has it (px, borders included).
struct ScoreBox {
  double x_min = 0.0, y_min = 0.0, x_max = 0.0, y_max = 0.0;
};

/// How labels compare with the truth, points counted.
struct LabelScore {
  std::size_t true_dynamic = 0;    ///< Called dynamic, and moving.
  std::size_t false_dynamic = 0;   ///< Called dynamic, and static.
  std::size_t missed_dynamic = 0;  ///< Moving, and not called dynamic.
  std::size_t true_static = 0;     ///< Static, and not called dynamic.
  std::size_t static_in_boxes = 0;
  std::size_t kept_in_boxes = 0;  ///< Of those, not called dynamic.
  std::size_t on_border = 0;      ///< Not scored: within the margin of a mask's border.
  std::size_t standing = 0;       ///< Not scored: on a person who stands still.
  std::size_t without_mask = 0;   ///< Not scored: frames without a mask.

  double precision() const;  ///< Of "dynamic", 0..1; NaN where nothing was called dynamic.
  double recall() const;     ///< Of "dynamic", 0..1; NaN where nothing moves.
  double f1() const;         ///< Harmonic mean of both; NaN where neither is defined.
  double keptShare() const;  ///< Static points inside boxes that were kept, 0..1; NaN without any.
};

struct LabelScoreOptions {
  /// Points nearer than this to another class in the mask are not scored (px): at a silhouette the
  /// corner belongs to both. None = the detector's own support, a ring of 3 px radius at the
  /// point's pyramid level (FAST, Rosten and Drummond 2006).
  std::optional<int> margin;
  std::size_t skip_frames = 0;  ///< First frames that are left out.
};

/// Reads keypoints.csv of hmcdyn_slam, with or without its last column, `size`.
/// @throws std::runtime_error naming file and line.
std::vector<LabelledPoint> readLabelledPoints(const std::filesystem::path& file);

/// Scores labels against the masks of a rendered sequence: 0 static, 128 a person standing still,
/// 255 moving.
/// @param sequence folder with mask/TIMESTAMP.png and boxes.txt.
/// @throws std::runtime_error naming the file that is missing or malformed, or when no point has a
/// mask.
LabelScore scoreLabels(const std::vector<LabelledPoint>& points,
                       const std::filesystem::path& sequence,
                       const LabelScoreOptions& options = {});

}  // namespace hmcdyn::evaluate
