// SPDX-License-Identifier: BSD-3-Clause
// Step 1: where the current frame's key points were in an earlier frame. [OpenCV]
#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include <hmcdyn/detail/requirements.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn {

/// Pyramidal Lucas-Kanade (Bouguet 2001), and two ways to tell a wrong match: what its window looks
/// like, and a forward-backward check (Kalal, Mikolajczyk, Matas 2010) for twice the time. On
/// rendered scenes both leave the same labels; docs/parameters.md has the figures.
struct OpticalFlowOptions {
  int window = 11;          ///< Side of the square window (px), odd, at least 3.
  int max_level = 2;        ///< Coarsest pyramid level, 0 = the image itself.
  int guess_max_level = 1;  ///< The same where a guess is given; at most max_level counts.
  int max_iterations = 10;  ///< A level.
  float epsilon = 0.03f;    ///< A level's iterations end below this step (px).
  /// A match whose window differs by more than this is dropped (mean absolute gray level).
  float max_difference = 12.0f;
  bool forward_backward = false;            ///< Also tracks forth again.
  float max_forward_backward_error = 0.5f;  ///< Farther from its start, a match is dropped (px).
};

/// The pyramid that both ends of a match need; keep the current frame's for the next call.
using FlowPyramid = std::vector<cv::Mat>;

/// @param gray 8-bit, one channel; copied. @param reuse a pyramid whose memory is taken over.
/// @throws std::invalid_argument for an empty image or one of another type, or a bad option.
FlowPyramid buildFlowPyramid(const cv::Mat& gray, const OpticalFlowOptions& options = {},
                             FlowPyramid reuse = {});

/// The N key points in the earlier frame; NaN where the match was lost.
struct FlowMatches {
  std::vector<float> u;   ///< Columns (px).
  std::vector<float> v;   ///< Rows (px).
  std::size_t found = 0;  ///< Points that are not NaN.
};

/// Tracks the current frame's key points back into the earlier frame, so that every key point of
/// the current frame gets its own match. Key points outside the image or not finite are lost, not
/// an error; so are those whose match would lie outside the earlier image.
/// @param guess where the N points may have been (px), e.g. the motion since a younger frame,
/// prolonged; NaN, or a pixel outside the image = none for this point, which is looked for where it
/// is now, from the same pyramid level as the others; empty = none for any.
/// @throws std::invalid_argument for an empty pyramid, pyramids of different image sizes, unequal
/// arrays, a window larger than a pyramid was built for, or another bad option.
FlowMatches trackIntoEarlierFrame(const FlowPyramid& current, const FlowPyramid& earlier,
                                  const KeyPointsView& points,
                                  const OpticalFlowOptions& options = {},
                                  const FlowMatches& guess = {});

}  // namespace hmcdyn
