// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

#include <hmcdyn/steps/optical_flow.hpp>

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
  require(options.guess_max_level >= 0, "guess_max_level", options.guess_max_level, "a level >= 0");
  require(options.max_difference > 0.0f, "max_difference", options.max_difference,
          "a value > 0 (gray levels)");
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

/// The points that take part, and where each is looked for.
struct FlowStarts {
  std::vector<std::size_t> source;  ///< Which key point each is.
  std::vector<cv::Point2f> start;
  std::vector<cv::Point2f> guess;  ///< Where the search starts; empty without any.
};

/// False for NaN, too.
bool isInside(const cv::Size& size, float u, float v) {
  return u >= 0.0f && u <= static_cast<float>(size.width - 1) && v >= 0.0f &&
         v <= static_cast<float>(size.height - 1);
}

FlowStarts collectStarts(const cv::Size& size, const KeyPointsView& points,
                         const FlowMatches& guess) {
  FlowStarts starts;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!isInside(size, points.u[i], points.v[i])) {
      continue;
    }
    starts.source.push_back(i);
    starts.start.emplace_back(points.u[i], points.v[i]);
    if (!guess.u.empty()) {
      starts.guess.push_back(isInside(size, guess.u[i], guess.v[i])
                                 ? cv::Point2f(guess.u[i], guess.v[i])
                                 : starts.start.back());
    }
  }
  return starts;
}

/// What one pass of pyramidal Lucas-Kanade finds.
struct FlowPass {
  std::vector<cv::Point2f> to;
  std::vector<std::uint8_t> found;
  std::vector<float> difference;
};

/// @param start where the search starts; empty = at `from`.
FlowPass followPoints(const FlowPyramid& source, const FlowPyramid& target,
                      const std::vector<cv::Point2f>& from, std::vector<cv::Point2f> start,
                      const OpticalFlowOptions& options) {
  const cv::TermCriteria until(cv::TermCriteria::COUNT | cv::TermCriteria::EPS,
                               options.max_iterations, options.epsilon);
  const bool guessed = !start.empty();
  FlowPass pass;
  pass.to = std::move(start);
  cv::calcOpticalFlowPyrLK(
      source, target, from, pass.to, pass.found, pass.difference,
      cv::Size(options.window, options.window),
      guessed ? std::min(options.guess_max_level, options.max_level) : options.max_level, until,
      guessed ? static_cast<int>(cv::OPTFLOW_USE_INITIAL_FLOW) : 0);
  return pass;
}

/// 1 for each match that leads back to its start. Where the way back was guessed, the way forth is
/// searched from the same motion: without, what a guess found beyond the window would be lost here.
std::vector<std::uint8_t> checkForth(const FlowPyramid& current, const FlowPyramid& earlier,
                                     const FlowStarts& starts, const std::vector<cv::Point2f>& back,
                                     const OpticalFlowOptions& options) {
  std::vector<cv::Point2f> guess;
  for (std::size_t k = 0; k < starts.guess.size(); ++k) {
    guess.push_back(back[k] + (starts.start[k] - starts.guess[k]));
  }
  FlowPass forth = followPoints(earlier, current, back, std::move(guess), options);
  for (std::size_t k = 0; k < forth.to.size(); ++k) {
    const cv::Point2f loop = forth.to[k] - starts.start[k];
    const bool returned = std::hypot(loop.x, loop.y) <= options.max_forward_backward_error;
    forth.found[k] = forth.found[k] != 0 && returned ? 1 : 0;
  }
  return forth.found;
}

}  // namespace

FlowPyramid buildFlowPyramid(const cv::Mat& gray, const OpticalFlowOptions& options,
                             FlowPyramid reuse) {
  checkOptions(options);
  if (gray.empty() || gray.type() != CV_8UC1) {
    throw std::invalid_argument("buildFlowPyramid: image is " +
                                (gray.empty() ? "empty" : cv::typeToString(gray.type())) +
                                "; expected 8-bit gray (CV_8UC1)");
  }
  // A part of a larger image could serve without a copy, but would take its border, and every later
  // change, from the caller's pixels.
  constexpr bool kWithDerivatives = true;
  constexpr bool kReuseInput = false;
  cv::buildOpticalFlowPyramid(gray, reuse, cv::Size(options.window, options.window),
                              options.max_level, kWithDerivatives, cv::BORDER_REFLECT_101,
                              cv::BORDER_CONSTANT, kReuseInput);
  return reuse;
}

FlowMatches trackIntoEarlierFrame(const FlowPyramid& current, const FlowPyramid& earlier,
                                  const KeyPointsView& points, const OpticalFlowOptions& options,
                                  const FlowMatches& guess) {
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
  const bool guesses_fit = (guess.u.empty() && guess.v.empty()) ||
                           (guess.u.size() == points.size() && guess.v.size() == points.size());
  if (!guesses_fit) {
    throw std::invalid_argument("trackIntoEarlierFrame: " + std::to_string(points.size()) +
                                " key points, but guesses for " + std::to_string(guess.u.size()) +
                                " columns and " + std::to_string(guess.v.size()) +
                                " rows; expected equal sizes, or none");
  }
  const cv::Size size = current.front().size();
  FlowMatches matches;
  matches.u.assign(points.size(), kNaN);
  matches.v.assign(points.size(), kNaN);
  const FlowStarts starts = collectStarts(size, points, guess);
  if (starts.start.empty()) {
    return matches;
  }

  const FlowPass back = followPoints(current, earlier, starts.start, starts.guess, options);
  const std::vector<std::uint8_t> returned =
      options.forward_backward ? checkForth(current, earlier, starts, back.to, options)
                               : back.found;
  for (std::size_t k = 0; k < starts.start.size(); ++k) {
    const cv::Point2f& match = back.to[k];
    if (back.found[k] != 0 && returned[k] != 0 && back.difference[k] <= options.max_difference &&
        isInside(size, match.x, match.y)) {
      matches.u[starts.source[k]] = match.x;
      matches.v[starts.source[k]] = match.y;
      ++matches.found;
    }
  }
  return matches;
}

}  // namespace hmcdyn
