// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <set>
#include <stdexcept>
#include <string>

#include <opencv2/core.hpp>

#include <hmcdyn/label_image.hpp>

namespace hmcdyn {
namespace {

/// Calls `use` with a view of the image's own element type.
template <class Use>
auto withView(const char* caller, const cv::Mat& labels, Use use) {
  const auto view = [&](auto label) {
    return LabelImageView<decltype(label)>{labels.ptr<decltype(label)>(), labels.cols, labels.rows,
                                           labels.step1()};
  };
  if (!labels.empty() && labels.dims == 2) {
    switch (labels.type()) {
      case CV_8UC1:
        return use(view(std::uint8_t{}));
      case CV_16UC1:
        return use(view(std::uint16_t{}));
      case CV_32SC1:
        return use(view(std::int32_t{}));
      default:
        break;
    }
  }
  throw std::invalid_argument(std::string(caller) + ": labels is " +
                              (labels.empty() ? "empty" : cv::typeToString(labels.type())) +
                              "; expected an image of CV_8UC1, CV_16UC1 or CV_32SC1");
}

}  // namespace

std::vector<LabelRegion> regionsIn(const cv::Mat& labels, int background, int class_id) {
  return withView("regionsIn", labels, [&](const auto& view) {
    std::set<int> values;
    int last = background;
    for (int row = 0; row < view.height; ++row) {
      for (int column = 0; column < view.width; ++column) {
        const auto value = static_cast<int>(view.at(column, row));
        if (value != last) {  // most pixels have their neighbour's label
          values.insert(value);
          last = value;
        }
      }
    }
    values.erase(background);
    std::vector<LabelRegion> regions;
    regions.reserve(values.size());
    for (const int value : values) {
      regions.push_back({value, class_id, 1.0f});
    }
    return regions;
  });
}

std::vector<int> regionsOfPoints(const KeyPointsView& points, const cv::Mat& labels,
                                 Span<const LabelRegion> regions) {
  return withView("regionsOfPoints", labels,
                  [&](const auto& view) { return regionsOfPoints(points, view, regions); });
}

std::vector<DetectionBox> boundingBoxes(const cv::Mat& labels, Span<const LabelRegion> regions) {
  return withView("boundingBoxes", labels,
                  [&](const auto& view) { return boundingBoxes(view, regions); });
}

}  // namespace hmcdyn
