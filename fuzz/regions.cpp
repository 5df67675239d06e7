// SPDX-License-Identifier: BSD-3-Clause
// Label images in place of boxes: which point lies in which region, and the filter call on them.
#include <algorithm>
#include <stdexcept>
#include <vector>

#include <hmcdyn/filter_stage.hpp>
#include <hmcdyn/regions.hpp>

#include "fuzz_input.hpp"

namespace {

using hmcdyn::fuzz::require;

template <class Label>
void filterByMask(FuzzedDataProvider& data) {
  const int width = data.ConsumeIntegralInRange<int>(0, 40);
  const int height = data.ConsumeIntegralInRange<int>(0, 40);
  const auto stride =
      static_cast<std::size_t>(std::max(0, width + data.ConsumeIntegralInRange<int>(-1, 3)));
  const std::vector<Label> pixels =
      hmcdyn::fuzz::anyLabels<Label>(data, stride * static_cast<std::size_t>(height));
  const std::vector<hmcdyn::LabelRegion> regions = hmcdyn::fuzz::anyRegions(data);
  const hmcdyn::KeyPoints points = hmcdyn::fuzz::anyPoints(data, 100);
  const std::vector<float> distance = hmcdyn::fuzz::anyFloats(data, points.size(), 0.0f, 4.0f);
  const hmcdyn::LabelImageView<Label> image{pixels.data(), width, height, stride};

  const std::vector<int> region = regionsOfPoints(points.view(), image, regions);
  const std::vector<hmcdyn::DetectionBox> boxes = boundingBoxes(image, regions);
  require(region.size() == points.size() && boxes.size() == regions.size(),
          "a region a point, a box a region");
  std::size_t inside = 0;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region[i] == hmcdyn::kNoRegion) {
      continue;
    }
    ++inside;
    // The box ends at the centres of its outer pixels; a point is nearest to a pixel up to half a
    // pixel away.
    hmcdyn::DetectionBox box = boxes[static_cast<std::size_t>(region[i])];
    box.x_min -= 0.5f;
    box.y_min -= 0.5f;
    box.x_max += 0.5f;
    box.y_max += 0.5f;
    require(box.contains(points.u[i], points.v[i]), "a point of a region lies in its box");
  }
  const hmcdyn::BoxMembership membership = hmcdyn::assignToRegions(region, regions.size());
  require(membership.indices.size() == inside, "each point in the one region it lies in");
  hmcdyn::FilterStageWorkspace workspace;
  const hmcdyn::FilterStageResult& result =
      filterKeyPoints(points.view(), distance, boxes, membership, {}, workspace);
  for (std::size_t i = 0; i < region.size(); ++i) {
    require(region[i] != hmcdyn::kNoRegion || result.label[i] == hmcdyn::PointLabel::kStatic,
            "what is in no region is static");
    require(result.weight[i] >= 0.0f && result.weight[i] <= 1.0f, "weights in [0, 1]");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider data(bytes, size);
  try {
    switch (data.ConsumeIntegralInRange<int>(0, 2)) {
      case 0:
        filterByMask<std::uint8_t>(data);
        break;
      case 1:
        filterByMask<std::uint16_t>(data);
        break;
      default:
        filterByMask<std::int32_t>(data);
        break;
    }
  } catch (const std::invalid_argument&) {  // as documented
  }
  return 0;
}
