// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

#include <hmcdyn/optical_flow.hpp>

namespace hmcdyn {
namespace {

void checkOptions(const OpticalFlowOptions& options) {
  const auto require = [](bool good, const char* name, double value, const char* expected) {
    if (!good) {
      throw std::invalid_argument(std::string("OpticalFlowOptions::") + name + " is " +
                                  std::to_string(value) + "; expected " + expected);
    }
  };
  require(options.window >= 3 && options.window % 2 == 1, "window", options.window,
          "an odd number of pixels >= 3");
  require(options.max_level >= 0, "max_level", options.max_level, "a level >= 0");
  require(options.max_iterations >= 1, "max_iterations", options.max_iterations, "a count >= 1");
  require(options.epsilon > 0.0f, "epsilon", options.epsilon, "a value > 0 (px)");
  require(options.max_forward_backward_error > 0.0f, "max_forward_backward_error",
          options.max_forward_backward_error, "a value > 0 (px)");
}

/// Width of the border around the image that the pyramid was built with (px): its largest window.
int borderOf(const FlowPyramid& pyramid) {
  cv::Size whole;
  cv::Point offset;
  pyramid.front().locateROI(whole, offset);
  return std::min({offset.x, offset.y, whole.width - offset.x - pyramid.front().cols,
                   whole.height - offset.y - pyramid.front().rows});
}

/// False for NaN, too.
bool isInside(const cv::Size& size, float u, float v) {
  return u >= 0.0f && u <= static_cast<float>(size.width - 1) && v >= 0.0f &&
         v <= static_cast<float>(size.height - 1);
}

}  // namespace

FlowPyramid buildFlowPyramid(const cv::Mat& gray, const OpticalFlowOptions& options) {
  checkOptions(options);
  if (gray.empty() || gray.type() != CV_8UC1) {
    throw std::invalid_argument("buildFlowPyramid: image is " +
                                (gray.empty() ? "empty" : cv::typeToString(gray.type())) +
                                "; expected 8-bit gray (CV_8UC1)");
  }
  FlowPyramid pyramid;
  // A part of a larger image could serve without a copy, but would take its border, and every later
  // change, from the caller's pixels.
  constexpr bool kWithDerivatives = true;
  constexpr bool kReuseInput = false;
  cv::buildOpticalFlowPyramid(gray, pyramid, cv::Size(options.window, options.window),
                              options.max_level, kWithDerivatives, cv::BORDER_REFLECT_101,
                              cv::BORDER_CONSTANT, kReuseInput);
  return pyramid;
}

FlowMatches trackIntoEarlierFrame(const FlowPyramid& current, const FlowPyramid& earlier,
                                  const KeyPointsView& points, const OpticalFlowOptions& options) {
  checkOptions(options);
  checkKeyPoints(points);
  if (current.empty() || earlier.empty() || current.front().size() != earlier.front().size()) {
    throw std::invalid_argument(
        "trackIntoEarlierFrame: expected two pyramids of one image size, as buildFlowPyramid "
        "makes");
  }
  const int border = std::min(borderOf(current), borderOf(earlier));
  if (border < options.window) {
    throw std::invalid_argument("trackIntoEarlierFrame: window is " +
                                std::to_string(options.window) + ", but a pyramid was built for " +
                                std::to_string(border) + "; expected at most that");
  }
  const cv::Size size = current.front().size();

  FlowMatches matches;
  matches.u.assign(points.size(), kNaN);
  matches.v.assign(points.size(), kNaN);
  std::vector<std::size_t> source;  // which key point each tracked point is
  std::vector<cv::Point2f> start;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (isInside(size, points.u[i], points.v[i])) {
      source.push_back(i);
      start.emplace_back(points.u[i], points.v[i]);
    }
  }
  if (start.empty()) {
    return matches;
  }

  const cv::Size window(options.window, options.window);
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS,
                               options.max_iterations, options.epsilon);
  std::vector<cv::Point2f> back;
  std::vector<cv::Point2f> forth;
  std::vector<std::uint8_t> found_back;
  std::vector<std::uint8_t> found_forth;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(current, earlier, start, back, found_back, error, window,
                           options.max_level, until);
  cv::calcOpticalFlowPyrLK(earlier, current, back, forth, found_forth, error, window,
                           options.max_level, until);
  for (std::size_t k = 0; k < start.size(); ++k) {
    const cv::Point2f loop = forth[k] - start[k];
    if (found_back[k] != 0 && found_forth[k] != 0 && isInside(size, back[k].x, back[k].y) &&
        std::hypot(loop.x, loop.y) <= options.max_forward_backward_error) {
      matches.u[source[k]] = back[k].x;
      matches.v[source[k]] = back[k].y;
      ++matches.found;
    }
  }
  return matches;
}

}  // namespace hmcdyn
