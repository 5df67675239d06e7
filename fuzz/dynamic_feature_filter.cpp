// SPDX-License-Identifier: BSD-3-Clause
// The whole filter, from images to labels: boxes or a mask, one or two earlier frames, depth and
// memory or none.
#include <cmath>
#include <optional>
#include <stdexcept>
#include <vector>

#include <opencv2/core.hpp>

#include <hmcdyn/dynamic_feature_filter.hpp>

#include "fuzz_input.hpp"

namespace {

using hmcdyn::fuzz::anyFloat;
using hmcdyn::fuzz::require;
using hmcdyn::fuzz::same;

/// Up to four rectangles of the input.
template <class Value>
void paintBlocks(FuzzedDataProvider& data, cv::Mat& image, Value value) {
  const cv::Rect whole({0, 0}, image.size());
  for (int block = data.ConsumeIntegralInRange<int>(0, 4); block > 0; --block) {
    const cv::Rect area(data.ConsumeIntegralInRange<int>(0, image.cols - 1),
                        data.ConsumeIntegralInRange<int>(0, image.rows - 1),
                        data.ConsumeIntegralInRange<int>(1, image.cols),
                        data.ConsumeIntegralInRange<int>(1, image.rows));
    image(area & whole).setTo(value());
  }
}

/// How the scene looks in one frame: a texture whose bands of eight rows stand at different depths,
/// so that a camera that moves shifts them by different amounts, and something that moves itself.
struct View {
  int shift_x = 0;  ///< Of all (px).
  int shift_y = 0;
  int parallax = 0;  ///< What the nearest band shifts more (px).
  int own_x = 0;     ///< Where the moving thing stands (px).
  int own_y = 0;
};

View anyView(FuzzedDataProvider& data) {
  const auto pixels = [&data] { return data.ConsumeIntegralInRange<int>(-5, 5); };
  return {pixels(), pixels(), pixels(), pixels(), pixels()};
}

constexpr int kLargestWidth = 128;
constexpr int kLargestHeight = 96;
constexpr int kMargin = 16;  ///< Of the texture around the image, for the shifts (px).

/// Smooth enough for optical flow.
const cv::Mat& texture() {
  static const cv::Mat image = [] {
    cv::Mat gray(2 * kLargestHeight, kLargestWidth + 2 * kMargin, CV_8UC1);
    for (int row = 0; row < gray.rows; ++row) {
      for (int column = 0; column < gray.cols; ++column) {
        gray.at<std::uint8_t>(row, column) =
            cv::saturate_cast<std::uint8_t>(127.5 + 60.0 * std::sin(0.61 * column + 0.29 * row) +
                                            60.0 * std::sin(0.23 * column - 0.53 * row));
      }
    }
    return gray;
  }();
  return image;
}

/// A frame of the scene, with blocks of the input painted over it.
cv::Mat anyImage(FuzzedDataProvider& data, const cv::Size& size, const View& view) {
  cv::Mat image(size, CV_8UC1);
  for (int row = 0; row < size.height; ++row) {
    const int shift = view.shift_x + view.parallax * (row / 8 * 5 % 7) / 6;
    texture()
        .row(row + kMargin - view.shift_y)
        .colRange(kMargin - shift, kMargin - shift + size.width)
        .copyTo(image.row(row));
  }
  const cv::Rect mover(view.own_x + size.width / 3, view.own_y + size.height / 3, size.width / 3,
                       size.height / 3);
  const cv::Rect seen = mover & cv::Rect({0, 0}, size);
  if (!seen.empty()) {
    texture()(cv::Rect(seen.tl() - mover.tl() + cv::Point(0, kLargestHeight), seen.size()))
        .copyTo(image(seen));
  }
  paintBlocks(data, image, [&] { return cv::Scalar(data.ConsumeIntegral<std::uint8_t>()); });
  return image;
}

hmcdyn::DynamicFeatureFilterOptions anyOptions(FuzzedDataProvider& data) {
  hmcdyn::DynamicFeatureFilterOptions options;
  options.two_view.max_iterations = 50;  // so that a run is short
  options.two_view.min_background_matches = data.ConsumeIntegralInRange<int>(8, 40);
  if (data.ConsumeBool()) {
    options.distance = static_cast<hmcdyn::DistanceKind>(data.ConsumeIntegralInRange<int>(0, 2));
    options.stage.rule = data.PickValueInArray(hmcdyn::kFilterRules);
    options.use_belief = data.ConsumeBool();
    options.flow_margin = anyFloat(data, 0.0f, 50.0f);
    options.flow_in_boxes = data.ConsumeIntegralInRange<int>(-1, 40);
    options.flow_background = data.ConsumeIntegralInRange<int>(-1, 40);
    options.max_median_distance = anyFloat(data, 0.0f, 5.0f);
    options.flow.window = data.ConsumeIntegralInRange<int>(2, 15);
    options.flow.max_level = data.ConsumeIntegralInRange<int>(-1, 4);
    options.flow.forward_backward = data.ConsumeBool();
    options.two_view.seed = data.ConsumeIntegral<std::uint8_t>();
    options.ego_motion.baseline_fx = anyFloat(data, 0.0f, 60.0f);
  }
  return options;
}

cv::Mat anyDepth(FuzzedDataProvider& data, const cv::Size& size) {
  cv::Mat depth(size, CV_32FC1, cv::Scalar(2.0));
  paintBlocks(data, depth, [&] { return cv::Scalar(anyFloat(data, 0.0f, 6.0f)); });
  return depth;
}

cv::Mat anyMask(FuzzedDataProvider& data, const cv::Size& size) {
  const int types[] = {CV_8UC1, CV_16UC1, CV_32SC1, CV_32FC1};  // the last is refused
  cv::Mat labels(size, data.PickValueInArray(types), cv::Scalar(0));
  paintBlocks(data, labels, [&] { return cv::Scalar(data.ConsumeIntegralInRange<int>(0, 3)); });
  return labels;
}

/// Points on a grid over the image, and some anywhere.
hmcdyn::KeyPoints anyPointsIn(FuzzedDataProvider& data, const cv::Size& size) {
  hmcdyn::KeyPoints points = hmcdyn::fuzz::anyPoints(data, 20);
  const int step = data.ConsumeIntegralInRange<int>(4, 24);
  const float depths[] = {anyFloat(data, 0.0f, 6.0f), anyFloat(data, 0.0f, 6.0f),
                          anyFloat(data, 0.0f, 6.0f)};
  for (int row = step / 2; row < size.height; row += step) {
    for (int column = step / 2; column < size.width; column += step) {
      points.push_back(static_cast<float>(column), static_cast<float>(row),
                       depths[(row + column) / step % 3]);
    }
  }
  return points;
}

void checkResult(const hmcdyn::DynamicFeatureFilterResult& result, std::size_t n) {
  require(result.distance.size() == n && result.stage.label.size() == n &&
              result.stage.weight.size() == n && result.stage.cluster.size() == n,
          "N distances, labels, weights and clusters");
  std::size_t dynamic = 0;
  for (std::size_t i = 0; i < n; ++i) {
    require(!(result.distance[i] < 0.0f) && !std::isinf(result.distance[i]),
            "a distance is finite and >= 0, or NaN");
    require(result.stage.weight[i] >= 0.0f && result.stage.weight[i] <= 1.0f, "weights in [0, 1]");
    const bool is_dynamic = result.stage.label[i] == hmcdyn::PointLabel::kDynamic;
    require(!is_dynamic || result.stage.weight[i] == 0.0f, "dynamic points weigh nothing");
    dynamic += is_dynamic ? 1 : 0;
  }
  require(result.stage.frame.dynamic == dynamic, "the frame's count of dynamic points");
  checkBelief(result.belief, "the next frame's memory");
}

/// What input points to, so that it lives as long.
struct Frame {
  hmcdyn::FlowPyramid current;
  std::vector<hmcdyn::FlowPyramid> pyramids;
  std::vector<hmcdyn::EarlierFrame> earlier;
  cv::Mat depth;
  std::vector<hmcdyn::DetectionBox> boxes;
  std::vector<hmcdyn::LabelRegion> regions;
  hmcdyn::MotionBelief memory;
  hmcdyn::KeyPoints points;
};

void addEarlierFrames(FuzzedDataProvider& data, const cv::Size& size,
                      const hmcdyn::OpticalFlowOptions& options, Frame& frame) {
  const auto n = data.ConsumeIntegralInRange<std::size_t>(0, 2);
  for (std::size_t k = 0; k < n; ++k) {
    const View view = anyView(data);
    frame.pyramids.push_back(buildFlowPyramid(anyImage(data, size, view), options));
  }
  for (std::size_t k = 0; k < n; ++k) {
    hmcdyn::EarlierFrame earlier;
    earlier.pyramid = &frame.pyramids[k];
    earlier.age = static_cast<double>(anyFloat(data, 0.0f, 0.2f));
    if (data.ConsumeBool()) {
      earlier.depth = anyDepth(data, size);
      Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
      motion.translation().x() = static_cast<double>(anyFloat(data, -0.1f, 0.1f));
      earlier.current_from_earlier = motion;
    }
    frame.earlier.push_back(earlier);
  }
}

hmcdyn::DynamicFeatureFilterInput anyInput(FuzzedDataProvider& data,
                                           const hmcdyn::OpticalFlowOptions& options,
                                           Frame& frame) {
  const cv::Size size(data.ConsumeIntegralInRange<int>(1, kLargestWidth),
                      data.ConsumeIntegralInRange<int>(1, kLargestHeight));
  frame.current = buildFlowPyramid(anyImage(data, size, {}), options);
  addEarlierFrames(data, size, options, frame);
  hmcdyn::DynamicFeatureFilterInput input;
  input.camera = {100.0, 100.0, 48.0, 48.0};
  input.pyramid = &frame.current;
  input.earlier = frame.earlier;
  if (data.ConsumeBool()) {
    input.regions.labels = anyMask(data, size);
    frame.regions = hmcdyn::fuzz::anyRegions(data);
    input.regions.labelled = frame.regions;
  } else {
    frame.boxes = hmcdyn::fuzz::anyBoxes(data, 3);
    input.regions.boxes = frame.boxes;
  }
  if (data.ConsumeBool()) {
    frame.depth = anyDepth(data, size);
    input.depth = {frame.depth.ptr<float>(), size.width, size.height, frame.depth.step1()};
  }
  if (data.ConsumeBool()) {
    frame.memory = hmcdyn::fuzz::anyMemory(data);
    input.memory = &frame.memory;
  }
  frame.points = anyPointsIn(data, size);
  input.points = frame.points.view();
  return input;
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  cv::setNumThreads(1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  const hmcdyn::DynamicFeatureFilterOptions options = anyOptions(data);
  static hmcdyn::DynamicFeatureFilterWorkspace used;  // what it holds must not matter
  hmcdyn::DynamicFeatureFilterWorkspace fresh;
  std::optional<hmcdyn::DynamicFeatureFilterResult> result;
  try {
    Frame frame;
    const hmcdyn::DynamicFeatureFilterInput input = anyInput(data, options.flow, frame);
    result = filterDynamicFeatures(input, options, fresh);
    const hmcdyn::DynamicFeatureFilterResult again = filterDynamicFeatures(input, options, used);
    require(same(again.distance, result->distance) && again.stage.label == result->stage.label &&
                same(again.stage.weight, result->stage.weight) &&
                same(again.belief.belief, result->belief.belief),
            "the same input gives the same result");
    checkResult(*result, frame.points.size());
  } catch (const std::invalid_argument& error) {  // as documented, but for the result's check
    require(!result, error.what());
  }
  return 0;
}
