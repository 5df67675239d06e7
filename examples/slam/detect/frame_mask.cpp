// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/frame_mask.hpp"

#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

#include <hmcdyn/label_image.hpp>

namespace hmcdyn::slam {
namespace {

constexpr int kLeastPixels = 64;

/// Numbers the pieces of one label from `next` on and writes them into `numbered`.
/// @return how many numbers were used.
int numberPieces(const cv::Mat& of_label, int next, cv::Mat& numbered) {
  const cv::Rect where = cv::boundingRect(of_label);
  cv::Mat pieces;
  cv::Mat statistics;
  cv::Mat centres;
  const int count =
      cv::connectedComponentsWithStats(of_label(where), pieces, statistics, centres, 8, CV_32S);
  int largest = 1;
  for (int piece = 2; piece < count; ++piece) {
    if (statistics.at<int>(piece, cv::CC_STAT_AREA) >
        statistics.at<int>(largest, cv::CC_STAT_AREA)) {
      largest = piece;
    }
  }
  std::vector<int> number(static_cast<std::size_t>(count), 0);
  int used = 0;
  for (int piece = 1; piece < count; ++piece) {
    if (piece == largest || statistics.at<int>(piece, cv::CC_STAT_AREA) >= kLeastPixels) {
      number[static_cast<std::size_t>(piece)] = next + used++;
    }
  }
  for (int& own : number) {
    own = own == 0 ? number[static_cast<std::size_t>(largest)] : own;
  }
  number[0] = 0;
  for (int row = 0; row < pieces.rows; ++row) {
    const int* piece = pieces.ptr<int>(row);
    int* out = numbered.ptr<int>(where.y + row) + where.x;
    for (int column = 0; column < pieces.cols; ++column) {
      if (piece[column] != 0) {
        out[column] = number[static_cast<std::size_t>(piece[column])];
      }
    }
  }
  return used;
}

/// Regions take up the background next to them; where two meet, the higher number does.
void grow(cv::Mat& numbered, int margin) {
  cv::Mat wide;
  numbered.convertTo(wide, CV_32FC1);  // exact, and a type that cv::dilate knows
  const int side = 2 * margin + 1;
  cv::dilate(wide, wide, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  cv::Mat grown;
  wide.convertTo(grown, CV_32SC1);
  grown.copyTo(numbered, numbered == 0);
}

}  // namespace

FrameMask makeFrameMask(const cv::Mat& labels, int margin, int class_id) {
  if (labels.empty() || (labels.type() != CV_8UC1 && labels.type() != CV_16UC1)) {
    throw std::invalid_argument("makeFrameMask: labels is " +
                                (labels.empty() ? "empty" : cv::typeToString(labels.type())) +
                                "; expected an image of CV_8UC1 or CV_16UC1");
  }
  if (margin < 0) {
    throw std::invalid_argument("makeFrameMask: margin is " + std::to_string(margin) +
                                " px; expected 0 or more");
  }
  FrameMask mask;
  mask.labels = cv::Mat::zeros(labels.size(), CV_32SC1);
  for (const LabelRegion& label : regionsIn(labels)) {
    const auto next = static_cast<int>(mask.regions.size()) + 1;
    const int used = numberPieces(labels == label.label, next, mask.labels);
    for (int i = 0; i < used; ++i) {
      mask.regions.push_back({next + i, class_id, 1.0f});
    }
  }
  grow(mask.labels, margin);
  return mask;
}

double coveredShare(const FrameMask& mask) {
  return mask.empty() ? 0.0
                      : static_cast<double>(cv::countNonZero(mask.labels)) /
                            static_cast<double>(mask.labels.total());
}

}  // namespace hmcdyn::slam
