// SPDX-License-Identifier: BSD-3-Clause
#include "slam/detect/frame_mask.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <string>

#include <opencv2/imgproc.hpp>

namespace hmcdyn::slam {
namespace {

constexpr int kLeastPixels = 64;

/// What hangs together under one label.
struct Piece {
  int label = 0;   ///< Value in the label image.
  int area = 0;    ///< Pixels.
  int number = 0;  ///< Of its region, from 1.
};

/// The pieces of an image in the order of their first pixels, and which one each pixel is of.
/// In one pass, however many labels there are.
template <class Label>
class Pieces {
 public:
  explicit Pieces(const cv::Mat& labels) : of_pixel_(labels.size(), CV_32SC1, cv::Scalar(-1)) {
    for (int row = 0; row < labels.rows; ++row) {
      joinRow(labels, row);
    }
    std::vector<int> piece_of(sets_.size(), -1);  // of each set's root
    for (int row = 0; row < labels.rows; ++row) {
      int* const own = of_pixel_.ptr<int>(row);
      for (int column = 0; column < labels.cols; ++column) {
        if (own[column] >= 0) {
          own[column] = addPixel(labels.ptr<Label>(row)[column], own[column], piece_of);
        }
      }
    }
  }

  std::vector<Piece> pieces;
  const cv::Mat& ofPixel() const noexcept { return of_pixel_; }

 private:
  /// Gives each pixel the set of a neighbour before it that has its label, or a new one.
  void joinRow(const cv::Mat& labels, int row) {
    const Label* const label = labels.ptr<Label>(row);
    int* const own = of_pixel_.ptr<int>(row);
    for (int column = 0; column < labels.cols; ++column) {
      if (label[column] == 0) {
        continue;
      }
      int joined = column > 0 && label[column - 1] == label[column] ? own[column - 1] : -1;
      for (int above = std::max(column - 1, 0);
           row > 0 && above <= std::min(column + 1, labels.cols - 1); ++above) {
        if (labels.ptr<Label>(row - 1)[above] == label[column]) {
          const int other = of_pixel_.ptr<int>(row - 1)[above];
          joined = joined < 0 ? other : unite(joined, other);
        }
      }
      if (joined < 0) {
        joined = static_cast<int>(sets_.size());
        sets_.push_back(joined);
      }
      own[column] = joined;
    }
  }

  int rootOf(int set) {
    while (sets_[static_cast<std::size_t>(set)] != set) {
      int& parent = sets_[static_cast<std::size_t>(set)];
      parent = sets_[static_cast<std::size_t>(parent)];
      set = parent;
    }
    return set;
  }

  int unite(int a, int b) {
    a = rootOf(a);
    b = rootOf(b);
    sets_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    return std::min(a, b);
  }

  int addPixel(Label label, int set, std::vector<int>& piece_of) {
    int& piece = piece_of[static_cast<std::size_t>(rootOf(set))];
    if (piece < 0) {
      piece = static_cast<int>(pieces.size());
      pieces.push_back({static_cast<int>(label), 0, 0});
    }
    ++pieces[static_cast<std::size_t>(piece)].area;
    return piece;
  }

  cv::Mat of_pixel_;       ///< CV_32SC1; -1 = background. Sets at first, pieces at last.
  std::vector<int> sets_;  ///< Each one's parent; a root is its own.
};

/// Numbers the regions. @return how many there are.
int numberPieces(std::vector<Piece>& pieces) {
  std::vector<std::size_t> by_label(pieces.size());
  std::iota(by_label.begin(), by_label.end(), std::size_t{0});
  std::stable_sort(by_label.begin(), by_label.end(),
                   [&](std::size_t a, std::size_t b) { return pieces[a].label < pieces[b].label; });
  int regions = 0;
  for (auto first = by_label.begin(); first != by_label.end();) {
    const auto last = std::find_if(first, by_label.end(), [&](std::size_t piece) {
      return pieces[piece].label != pieces[*first].label;
    });
    const std::size_t largest = *std::max_element(
        first, last, [&](std::size_t a, std::size_t b) { return pieces[a].area < pieces[b].area; });
    for (auto piece = first; piece != last; ++piece) {
      if (*piece == largest || pieces[*piece].area >= kLeastPixels) {
        pieces[*piece].number = ++regions;
      }
    }
    for (; first != last; ++first) {
      Piece& piece = pieces[*first];
      piece.number = piece.number == 0 ? pieces[largest].number : piece.number;
    }
  }
  return regions;
}

/// An image of the regions' numbers, CV_32SC1. @return how many there are.
template <class Label>
int numberRegions(const cv::Mat& labels, cv::Mat& numbered) {
  Pieces<Label> found(labels);
  const int regions = numberPieces(found.pieces);
  numbered = cv::Mat::zeros(labels.size(), CV_32SC1);
  for (int row = 0; row < labels.rows; ++row) {
    const int* const piece = found.ofPixel().template ptr<int>(row);
    int* const out = numbered.ptr<int>(row);
    for (int column = 0; column < labels.cols; ++column) {
      out[column] =
          piece[column] < 0 ? 0 : found.pieces[static_cast<std::size_t>(piece[column])].number;
    }
  }
  return regions;
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
  const int regions = labels.type() == CV_8UC1 ? numberRegions<std::uint8_t>(labels, mask.labels)
                                               : numberRegions<std::uint16_t>(labels, mask.labels);
  for (int number = 1; number <= regions; ++number) {
    mask.regions.push_back({number, class_id, 1.0f});
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
