// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/loop_closing.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

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
  if (const auto* closure = std::get_if<CloseJob>(&job)) {
    return close(closure->map, options.closer);
  }
  return find(state, options, std::get<RelocalizeJob>(job).frame);
}

LoopClosing::Relocalized LoopClosing::find(State& state, const LoopClosingOptions& options,
                                           const LoopKeyFrame& frame) {
  Relocalized relocalized;
  try {
    const RelocalizationResult found =
        slam::relocalize(frame, state.detector.index(), state.detector.keyFrames(), state.camera,
                         options.relocalizer);
    if (found.camera_from_world) {
      relocalized.key_frame = found.key_frame;
      relocalized.from_key_frame =
          *found.camera_from_world *
          state.detector.keyFrames().at(found.key_frame).camera_from_world.inverse();
    }
  } catch (...) {
    relocalized.error = std::current_exception();  // an answer all the same: to this question
  }
  return relocalized;
}

LoopClosing::Closed LoopClosing::close(const MapCopy& map, const LoopCloserOptions& options) {
  Closed closed;
  try {
    const LoopSnapshot snapshot = toSnapshot(map);
    const LoopClosure closure = closeLoops(snapshot, options);
    closed.refused = closure.refused;
    if (closure.closed) {
      closed.correction = toCorrection(snapshot, closure);
    }
  } catch (...) {
    closed.error = std::current_exception();  // with what it is the error of
  }
  return closed;
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
  copier_.remember(map);
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
    LoopEvent event{timeOf(report.id), timeOf(candidate.id), candidate.score, verification.inliers,
                    toString(verification.verdict)};
    if (verification.verdict == LoopVerdict::kAccepted && report.constraint) {
      event.refusal.clear();
      loops_.push_back({*report.constraint, event, false});
    } else {
      events_.push_back(event);
    }
  }
}

void LoopClosing::submitClosure(const Map& map) {
  std::vector<std::size_t> one_now;
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    if (!loops_[i].closed && !survivingLoop(map, loops_[i].constraint)) {
      one_now.push_back(i);
    }
  }
  forget(one_now, "both ends are one key frame");
  std::vector<LoopConstraint> constraints;
  bool anything_new = false;
  submitted_.clear();
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    if (const auto constraint = survivingLoop(map, loops_[i].constraint)) {
      constraints.push_back(*constraint);
      submitted_.push_back(i);
      anything_new = anything_new || !loops_[i].closed;
    }
  }
  if (anything_new) {
    closing_ = true;
    worker_.submit(CloseJob{copier_.copy(map, std::move(constraints))});
  }
}

/// @param loops places, in ascending order.
void LoopClosing::forget(const std::vector<std::size_t>& loops, const std::string& refusal) {
  for (auto place = loops.rbegin(); place != loops.rend(); ++place) {
    const auto loop = loops_.begin() + static_cast<std::ptrdiff_t>(*place);
    events_.push_back(loop->event);
    events_.back().refusal = refusal;
    loops_.erase(loop);
  }
}

std::optional<MapCorrection> LoopClosing::takeUp(Closed closed) {
  closing_ = false;
  if (closed.correction) {
    for (const std::size_t place : submitted_) {
      if (!std::exchange(loops_[place].closed, true)) {
        events_.push_back(loops_[place].event);
      }
    }
    return std::move(closed.correction);
  }
  std::vector<std::size_t> refused;
  if (closed.refused) {
    refused.push_back(submitted_[*closed.refused]);
    due_ = true;  // for those that are left
  } else {
    std::copy_if(submitted_.begin(), submitted_.end(), std::back_inserter(refused),
                 [this](std::size_t place) { return !loops_[place].closed; });
  }
  forget(refused, closed.refused ? "contradicts the map"
                                 : (closed.error ? "closing failed" : "closing was stopped"));
  if (closed.error) {
    std::rethrow_exception(closed.error);
  }
  return std::nullopt;
}

std::optional<MapCorrection> LoopClosing::takeUp(Answer answer, const Map& map) {
  frames_waited_ = 0;
  if (auto* closed = std::get_if<Closed>(&answer)) {
    return takeUp(std::move(*closed));
  }
  if (const auto* relocalized = std::get_if<Relocalized>(&answer)) {
    relocalized_ = *relocalized;
    return std::nullopt;
  }
  const auto& report = std::get<LoopReport>(answer);
  note(report, map);
  if (report.constraint) {
    if (closing_) {
      due_ = true;
    } else {
      submitClosure(map);
    }
  }
  return std::nullopt;
}

std::size_t LoopClosing::loopsClosed() const noexcept {
  return static_cast<std::size_t>(
      std::count_if(loops_.begin(), loops_.end(), [](const Loop& loop) { return loop.closed; }));
}

void LoopClosing::rethrowKept() {
  if (!kept_errors_.empty()) {
    const std::exception_ptr oldest = std::move(kept_errors_.front());
    kept_errors_.pop_front();
    std::rethrow_exception(oldest);
  }
}

std::optional<MapCorrection> LoopClosing::poll(const Map& map) {
  rethrowKept();
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
  rethrowKept();
  std::optional<MapCorrection> latest;
  while (!latest) {
    if (due_ && !closing_) {
      due_ = false;
      submitClosure(map);
    }
    if (worker_.pending() == 0) {
      break;
    }
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
    try {
      takeUp(worker_.take(), map);
    } catch (...) {
      kept_errors_.push_back(
          std::current_exception());  // of a key frame that waited before the question
    }
  }
  if (relocalized_->error) {
    std::rethrow_exception(relocalized_->error);
  }
  if (closing_ || !relocalized_->from_key_frame) {
    return std::nullopt;
  }
  return *relocalized_->from_key_frame * map.poseOf(static_cast<int>(relocalized_->key_frame));
}

std::vector<LoopEvent> LoopClosing::takeEvents() { return std::exchange(events_, {}); }

}  // namespace hmcdyn::slam
