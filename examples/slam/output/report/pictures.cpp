// SPDX-License-Identifier: BSD-3-Clause
#include "slam/output/report/pictures.hpp"

#include <cmath>
#include <iterator>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace hmcdyn::slam {
namespace {

std::optional<std::size_t> worstFrame(const std::vector<ReportFrame>& frames) {
  std::optional<std::size_t> worst;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (std::isfinite(frames[i].error) && (!worst || frames[i].error > frames[*worst].error)) {
      worst = i;
    }
  }
  return worst;
}

std::size_t nearestPicture(const std::vector<FramePicture>& pictures, std::size_t frame) {
  const auto gap = [&](std::size_t i) {
    return pictures[i].frame > frame ? pictures[i].frame - frame : frame - pictures[i].frame;
  };
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    nearest = gap(i) < gap(nearest) ? i : nearest;
  }
  return nearest;
}

std::string caption(std::size_t index, const std::vector<ReportFrame>& frames, bool is_worst) {
  if (index >= frames.size()) {
    return fmt::format("Frame {}", index);
  }
  const ReportFrame& frame = frames[index];
  std::string text = fmt::format("Frame {}", frame.number.value_or(index));
  text += fmt::format(", {:.2f} s", frame.timestamp - frames.front().timestamp);
  if (std::isfinite(frame.error)) {
    text += fmt::format(", error {:.1f} mm", 1e3 * frame.error);
  }
  if (!frame.failure.empty()) {
    text += ", lost: " + frame.failure;
  }
  return text + (is_worst ? " (nearest to the largest error)" : "");
}

}  // namespace

std::string encodeJpeg(const cv::Mat& bgr, int max_width, int quality) {
  if (bgr.empty() || bgr.type() != CV_8UC3 || max_width < 1 || quality < 1 || quality > 100) {
    throw std::invalid_argument(fmt::format(
        "JPEG: picture of {}x{}, type {}, width {}, quality {}; expected CV_8UC3 with pixels, a "
        "width above 0 and a quality in 1..100",
        bgr.cols, bgr.rows, bgr.type(), max_width, quality));
  }
  cv::Mat picture = bgr;
  if (bgr.cols > max_width) {
    const double scale = static_cast<double>(max_width) / bgr.cols;
    const int rows = std::max(1, cvRound(bgr.rows * scale));
    cv::resize(bgr, picture, cv::Size(max_width, rows), 0, 0, cv::INTER_AREA);
  }
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality})) {
    throw std::runtime_error("JPEG: OpenCV cannot encode the picture");
  }
  return {bytes.begin(), bytes.end()};
}

PictureReel::PictureReel(std::size_t capacity) : capacity_(capacity) {
  if (capacity < 2) {
    throw std::invalid_argument(
        fmt::format("pictures: capacity {}; expected at least 2", capacity));
  }
}

void PictureReel::add(std::size_t frame, std::string jpeg) {
  if (!wants(frame)) {
    return;
  }
  pictures_.push_back({frame, std::move(jpeg)});
  while (pictures_.size() > capacity_) {
    stride_ *= 2;
    std::vector<FramePicture> kept;
    for (FramePicture& picture : pictures_) {
      if (wants(picture.frame)) {
        kept.push_back(std::move(picture));
      }
    }
    pictures_ = std::move(kept);
  }
}

std::vector<ReportPicture> choosePictures(const std::vector<FramePicture>& pictures,
                                          const std::vector<ReportFrame>& frames,
                                          std::size_t count) {
  std::set<std::size_t> chosen;
  std::optional<std::size_t> worst;
  if (const auto frame = worstFrame(frames); frame && !pictures.empty() && count > 0) {
    worst = nearestPicture(pictures, *frame);
    chosen.insert(*worst);
  }
  const std::size_t left = std::min(count, pictures.size()) - chosen.size();
  // Middle of each of `left` equal parts of the pictures that are still free.
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (chosen.count(i) == 0) {
      free.push_back(i);
    }
  }
  for (std::size_t i = 0; i < left; ++i) {
    chosen.insert(free[(2 * i + 1) * free.size() / (2 * left)]);
  }
  std::vector<ReportPicture> result;
  result.reserve(chosen.size());
  for (const std::size_t i : chosen) {
    result.push_back({caption(pictures[i].frame, frames, worst == i), pictures[i].jpeg});
  }
  return result;
}

}  // namespace hmcdyn::slam
