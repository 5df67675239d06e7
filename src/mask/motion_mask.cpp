// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <hmcdyn/motion_mask.hpp>

#include "image_text.hpp"
#include "mask/coupling.hpp"
#include "mask/depth_history.hpp"
#include "mask/evidence.hpp"
#include "mask/model.hpp"
#include "mask/named.hpp"
#include "mask/small_frame.hpp"
#include "mask/smoothing.hpp"
#include "mask/thing_motion.hpp"
#include "mask/things.hpp"
#include "mask/whole_mask.hpp"

namespace hmcdyn {
namespace {

using namespace internal;  // NOLINT(google-build-using-namespace): the parts of this one class

constexpr int kSmallestSide = 16;  // (px)

[[noreturn]] void refuse(const char* name, const cv::Mat& image, const std::string& expected) {
  throw std::invalid_argument(std::string("MotionMaskFrame::") + name + " is " + imageText(image) +
                              "; expected " + expected);
}

void checkFrame(const MotionMaskFrame& frame) {
  if (frame.depth.type() != CV_32FC1 || frame.depth.cols < kSmallestSide ||
      frame.depth.rows < kSmallestSide) {
    refuse("depth", frame.depth, "CV_32FC1 (m) of 16 x 16 px or more");
  }
  // texts only where they are needed: good frames allocate nothing
  if (!frame.gray.empty() &&
      (frame.gray.type() != CV_8UC1 || frame.gray.size() != frame.depth.size())) {
    refuse("gray", frame.gray, "CV_8UC1 of the depth's size, " + imageText(frame.depth));
  }
  const int type = frame.regions.labels.empty() ? CV_8UC1 : frame.regions.labels.type();
  if (!frame.regions.labels.empty() && ((type != CV_8UC1 && type != CV_16UC1 && type != CV_32SC1) ||
                                        frame.regions.labels.size() != frame.depth.size())) {
    refuse("labels", frame.regions.labels,
           "CV_8UC1, CV_16UC1 or CV_32SC1 of the depth's size, " + imageText(frame.depth));
  }
  checkKeyPoints(frame.points);
  if (frame.verdicts.size() != frame.points.size()) {
    throw std::invalid_argument("MotionMaskFrame::verdicts has " +
                                std::to_string(frame.verdicts.size()) + " elements; expected " +
                                std::to_string(frame.points.size()) + ", one a key point");
  }
}

}  // namespace

struct MotionMaskEstimator::State {
  PinholeCamera camera;
  internal::MaskModel model;
  DepthHistory history;
  MotionMask mask;
  cv::Size size;
  MaskState restart = MaskState::kFirstFrame;
  int next_number = 1;
  // workspace
  EvidenceImage evidence;
  Couplings couplings;
  SmoothingWorkspace smoothing;
  ThingsWorkspace things;
  ReduceWorkspace reducing;
  std::vector<std::uint8_t> named;
  std::vector<std::uint8_t> holes;
  std::vector<float> depths;
  std::vector<const SmallFrame*> earlier;

  const MotionMask& update(const MotionMaskFrame& frame);
  void startAnew(MaskState why);
  std::optional<MaskState> reasonToStartAnew(const SmallFrame& small) const;
  const MotionMask& unknown(MaskState why);
  void judge(const MotionMaskFrame& frame, int reduction, SmallFrame& small);
  void believe(SmallFrame& small);
  void labelPixels(const MotionMaskFrame& frame, int reduction, const SmallFrame& small);
  void measureThings(const ThingsInput& input, SmallFrame& small);
};

void MotionMaskEstimator::State::startAnew(MaskState why) {
  history.clear();
  restart = why;
}

/// The mask of a frame that cannot be judged.
const MotionMask& MotionMaskEstimator::State::unknown(MaskState why) {
  mask.state = why;
  mask.label.setTo(static_cast<std::uint8_t>(MaskLabel::kUnknown));
  mask.belief.setTo(0.0f);
  mask.instances.clear();
  mask.moving_share = 0.0f;
  return mask;
}

std::optional<MaskState> MotionMaskEstimator::State::reasonToStartAnew(
    const SmallFrame& small) const {
  if (history.empty()) {
    return std::nullopt;
  }
  const SmallFrame& before = history.youngest();
  const double gap = small.timestamp - before.timestamp;
  if (!(gap > 0.0) || gap > model.options.max_gap) {
    return MaskState::kTimeJump;
  }
  const PoseStep step = stepBetween(before.camera_from_world, small.camera_from_world);
  if (step.distance > model.history.max_step || step.angle > model.history.max_turn) {
    return MaskState::kCameraJump;
  }
  return std::nullopt;
}

/// Beliefs of the pixels from the sums of evidence.
void MotionMaskEstimator::State::believe(SmallFrame& small) {
  for (std::size_t i = 0; i < small.size(); ++i) {
    const float belief = small.depth[i] > 0.0f ? beliefOf(evidence.evidence[i]) : 0.0f;
    small.cells[i].belief = belief;
    mask.belief.ptr<float>(0)[i] = belief;
  }
}

void MotionMaskEstimator::State::measureThings(const ThingsInput& input, SmallFrame& small) {
  for (std::size_t k = 0; k < mask.instances.size(); ++k) {
    MaskInstance& thing = mask.instances[k];
    const std::uint32_t* begin = things.pixels.data() + things.first[things.order[k]];
    const std::uint32_t* end = things.pixels.data() + things.first[things.order[k] + 1];
    for (const auto* pixel = begin; pixel != end; ++pixel) {
      small.cells[*pixel].thing = static_cast<std::int16_t>(thing.number);
    }
    if (thing.moves) {
      const ThingMotion motion = motionOfThing(input, begin, end);
      thing.has_velocity = motion.found;
      thing.velocity = motion.velocity;
    }
  }
}

void MotionMaskEstimator::State::labelPixels(const MotionMaskFrame& frame, int reduction,
                                             const SmallFrame& small) {
  std::vector<std::uint8_t>& label = things.label;
  std::size_t moving = 0;
  std::size_t measured = 0;
  for (std::size_t i = 0; i < small.size(); ++i) {
    moving += label[i] == static_cast<std::uint8_t>(MaskLabel::kMoving) ? 1 : 0;
    measured += small.depth[i] > 0.0f ? 1 : 0;
    if (label[i] != static_cast<std::uint8_t>(MaskLabel::kStatic)) {
      continue;
    }
    if (!named.empty() && named[i] == kNamed) {
      label[i] = static_cast<std::uint8_t>(MaskLabel::kStanding);
    } else if (!isKnown(evidence.evidence[i]) || small.depth[i] > model.options.max_depth ||
               (!named.empty() && named[i] == kInBox &&
                (evidence.comparisons[i].same & evidence.proof) == 0)) {
      label[i] = static_cast<std::uint8_t>(MaskLabel::kUnknown);
    }
  }
  labelHoles(small, label, holes);
  labelWholeImage(frame.depth, small, reduction, label, holes, mask.label);
  const auto least = static_cast<float>(measured) * model.options.max_moving_share;
  mask.state = static_cast<float>(moving) > least ? MaskState::kTooLarge : MaskState::kGood;
  mask.moving_share = static_cast<float>(moving) / static_cast<float>(small.size());
}

void MotionMaskEstimator::State::judge(const MotionMaskFrame& frame, int reduction,
                                       SmallFrame& small) {
  const SmallCamera reduced = smallCamera(camera, reduction);
  addPoints(frame, reduction, small, model.evidence.dynamic_point_weight, evidence.evidence);
  // with boxes creases made the camera's path worse: docs/masks.md
  couplings = coupleNeighbours(small, model, named.empty(), std::move(couplings));
  spreadAlongSurfaces(couplings, small.width, evidence.evidence, smoothing);
  believe(small);
  const ThingsInput input{small, reduced, evidence, named, earlier, model, reduction};
  mask.instances = findThings(input, next_number, things, std::move(mask.instances));
  measureThings(input, small);
  labelPixels(frame, reduction, small);
}

const MotionMask& MotionMaskEstimator::State::update(const MotionMaskFrame& frame) {
  const int reduction = reductionOf(frame.depth.cols, model.options.working_width);
  if (frame.depth.size() != size) {
    startAnew(MaskState::kFirstFrame);
    size = frame.depth.size();
    mask.label.create(size, CV_8UC1);
    mask.belief.create(size.height / reduction, size.width / reduction, CV_32FC1);
  }
  if (!frame.pose_is_known || !isFinite(frame.camera_from_world) ||
      !std::isfinite(frame.timestamp)) {
    return unknown(MaskState::kMotionUnknown);
  }
  SmallFrame small = reduceFrame(frame, reduction, history.spare(), reducing);
  if (small.depth_share < model.min_depth_share) {
    history.giveBack(std::move(small));
    return unknown(MaskState::kNoDepth);
  }
  if (const std::optional<MaskState> why = reasonToStartAnew(small)) {
    startAnew(*why);
  }
  if (history.empty()) {
    history.push(std::move(small), model.options.max_age);
    return unknown(std::exchange(restart, MaskState::kFirstFrame));
  }
  named = namedPixels(frame, small, reduction, model.segment.box_depth, std::move(named), depths);
  earlier = history.select(frame.timestamp, std::move(earlier));
  evidence = compareWithEarlier(small, smallCamera(camera, reduction), earlier, named, model,
                                std::move(evidence));
  mask.agreement = evidence.agreement;
  if (evidence.agreement < model.history.min_agreement) {
    startAnew(MaskState::kMotionDoubtful);
    history.push(std::move(small), model.options.max_age);
    return unknown(std::exchange(restart, MaskState::kFirstFrame));
  }
  judge(frame, reduction, small);
  history.push(std::move(small), model.options.max_age);
  return mask;
}

MotionMaskEstimator::MotionMaskEstimator(const PinholeCamera& camera,
                                         const MotionMaskOptions& options) {
  if (!(camera.fx > 0.0) || !(camera.fy > 0.0)) {
    throw std::invalid_argument("MotionMaskEstimator: fx, fy are " + std::to_string(camera.fx) +
                                ", " + std::to_string(camera.fy) + "; expected above 0 (px)");
  }
  checkOptions(options);
  state_ = std::make_unique<State>();
  state_->camera = camera;
  state_->model.options = options;
}

MotionMaskEstimator::~MotionMaskEstimator() = default;
MotionMaskEstimator::MotionMaskEstimator(MotionMaskEstimator&& other) noexcept = default;
MotionMaskEstimator& MotionMaskEstimator::operator=(MotionMaskEstimator&& other) noexcept = default;

const MotionMask& MotionMaskEstimator::update(const MotionMaskFrame& frame) {
  checkFrame(frame);
  return state_->update(frame);
}

void MotionMaskEstimator::setPose(double timestamp, const Pose& camera_from_world) {
  if (isFinite(camera_from_world)) {
    state_->history.setPose(timestamp, camera_from_world);
  }
}

void MotionMaskEstimator::reset() { state_->startAnew(MaskState::kFirstFrame); }

cv::Mat staticDepth(const cv::Mat& depth, const cv::Mat& label, bool keep_standing) {
  if (depth.type() != CV_32FC1 || label.type() != CV_8UC1 || depth.size() != label.size()) {
    throw std::invalid_argument("staticDepth: depth is " + imageText(depth) + ", label " +
                                imageText(label) +
                                "; expected CV_32FC1 (m) and CV_8UC1 of one size");
  }
  cv::Mat result = depth.clone();
  const auto least =
      static_cast<std::uint8_t>(keep_standing ? MaskLabel::kMoving : MaskLabel::kStanding);
  for (int row = 0; row < depth.rows; ++row) {
    auto* z = result.ptr<float>(row);
    const std::uint8_t* l = label.ptr(row);
    for (int column = 0; column < depth.cols; ++column) {
      z[column] = l[column] >= least ? 0.0f : z[column];
    }
  }
  return result;
}

}  // namespace hmcdyn
