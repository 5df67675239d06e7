// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nlohmann/json.hpp>

#include "slam/output/report/report.hpp"

namespace hmcdyn::slam {

/// What the page's script draws: a column a quantity, an element a frame, null where a value is
/// missing. Lengths are rounded to 0.1 mm, times to 1 us.
///
///   t                       s since the first frame
///   x_is_frame              true where the stamps do not increase: charts go by frame number
///   p, truth                [x, y, z]; truth null without a ground truth
///   error, max_error        null without a ground truth
///   stages                  [{name, ms}]
///   labels                  {static, suspect, dynamic, unmatched}
///   boxes, dynamic_boxes
///   models, model           names, and a frame's index in them, -1 = none; so failures, failure
///   key                     1 for a key frame
///   loops                   accepted ones, as pairs of frame indices whose positions are known
nlohmann::json chartData(const ReportInput& input);

}  // namespace hmcdyn::slam
