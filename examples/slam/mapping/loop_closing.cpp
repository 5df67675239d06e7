// SPDX-License-Identifier: BSD-3-Clause
#include "slam/mapping/loop_closing.hpp"

#include <utility>

#include "slam/mapping/map_snapshot.hpp"

namespace hmcdyn::slam {
namespace {

constexpr std::size_t kQueue = 8;  // key frames that wait while a loop is being closed

}  // namespace

struct LoopClosing::State {
  PinholeCamera camera;
  LoopDetector detector;
};

LoopClosing::LoopClosing(const PinholeCamera& camera, const LoopClosingOptions& options)
    : options_(options),
      worker_(
          [state = std::make_shared<State>(State{camera, LoopDetector(camera, options.detector)}),
           options](Job job) { return run(*state, options, std::move(job)); },
          kQueue) {}

LoopClosing::Answer LoopClosing::run(State& state, const LoopClosingOptions& options, Job job) {
  if (auto* detect = std::get_if<DetectJob>(&job)) {
    for (const std::size_t id : detect->culled) {
      state.detector.remove(id);
    }
    return state.detector.process(std::move(detect->key_frame));
  }
  if (const auto* close = std::get_if<CloseJob>(&job)) {
    return toCorrection(*close->snapshot, closeLoops(*close->snapshot, options.closer));
  }
  const RelocalizationResult found =
      slam::relocalize(std::get<RelocalizeJob>(job).frame, state.detector.index(),
                       state.detector.keyFrames(), state.camera, options.relocalizer);
  Relocalized relocalized;
  if (found.camera_from_world) {
    relocalized.key_frame = found.key_frame;
    relocalized.from_key_frame =
        *found.camera_from_world *
        state.detector.keyFrames().at(found.key_frame).camera_from_world.inverse();
  }
  return relocalized;
}

std::vector<std::size_t> LoopClosing::newlyCulled(const Map& map) {
  forgotten_.resize(map.keyFrames().size(), false);
  std::vector<std::size_t> culled;
  for (std::size_t k = 0; k < map.keyFrames().size(); ++k) {
    if (map.keyFrames()[k].removed && !forgotten_[k]) {
      forgotten_[k] = true;
      culled.push_back(k);
    }
  }
  return culled;
}

void LoopClosing::process(const Map& map) {
  if (!options_.enabled) {
    return;
  }
  if (worker_.pending() >= kQueue) {
    ++left_out_;
    return;
  }
  if (worker_.pending() == 0) {
    frames_waited_ = 0;
  }
  worker_.submit(DetectJob{makeLoopKeyFrame(map, static_cast<int>(map.keyFrames().size()) - 1),
                           newlyCulled(map)});
}

void LoopClosing::note(const LoopReport& report, const Map& map) {
  const auto timeOf = [&](std::size_t id) { return map.keyFrames()[id].frame.timestamp; };
  for (const LoopCandidate& candidate : report.candidates) {
    const LoopVerification& verification = candidate.verification;
    events_.push_back(
        {timeOf(report.id), timeOf(candidate.id), candidate.score, verification.inliers,
         verification.verdict == LoopVerdict::kAccepted ? "" : toString(verification.verdict)});
  }
}

void LoopClosing::submitClosure(const Map& map) {
  closing_ = true;
  worker_.submit(CloseJob{std::make_shared<const LoopSnapshot>(makeLoopSnapshot(map, loops_))});
}

std::optional<MapCorrection> LoopClosing::takeUp(Answer answer, const Map& map) {
  frames_waited_ = 0;
  if (auto* correction = std::get_if<MapCorrection>(&answer)) {
    closing_ = false;
    return std::move(*correction);
  }
  if (const auto* relocalized = std::get_if<Relocalized>(&answer)) {
    relocalized_ = *relocalized;
    return std::nullopt;
  }
  const auto& report = std::get<LoopReport>(answer);
  note(report, map);
  if (report.constraint) {
    loops_.push_back(*report.constraint);
    if (closing_) {
      due_ = true;
    } else {
      submitClosure(map);
    }
  }
  return std::nullopt;
}

std::optional<MapCorrection> LoopClosing::poll(const Map& map) {
  if (due_ && !closing_) {  // the correction before it has been applied by now
    due_ = false;
    submitClosure(map);
  }
  if (worker_.pending() == 0) {
    return std::nullopt;
  }
  if (options_.delay == 0) {
    std::optional<Answer> answer = worker_.tryTake();
    return answer ? takeUp(std::move(*answer), map) : std::nullopt;
  }
  if (++frames_waited_ < options_.delay) {
    return std::nullopt;
  }
  return finish(map);
}

std::optional<MapCorrection> LoopClosing::finish(const Map& map) {
  if (due_ && !closing_) {
    due_ = false;
    submitClosure(map);
  }
  std::optional<MapCorrection> latest;
  while (worker_.pending() > 0 && !latest) {
    latest = takeUp(worker_.take(), map);
  }
  return latest;
}

std::optional<Eigen::Isometry3d> LoopClosing::relocalize(const Frame& frame, const Map& map) {
  // A correction on its way would change the map under the answer; the frame after may ask again.
  if (!options_.enabled || closing_) {
    return std::nullopt;
  }
  relocalized_.reset();
  worker_.submit(RelocalizeJob{makeLoopKeyFrame(frame)});
  while (!relocalized_) {
    takeUp(worker_.take(), map);
  }
  if (closing_ || !relocalized_->from_key_frame) {
    return std::nullopt;
  }
  return *relocalized_->from_key_frame * map.poseOf(static_cast<int>(relocalized_->key_frame));
}

std::vector<LoopEvent> LoopClosing::takeEvents() { return std::exchange(events_, {}); }

}  // namespace hmcdyn::slam
