// SPDX-License-Identifier: BSD-3-Clause
#include "synthesize/behaviour.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "synthesize/pi.hpp"
#include "synthesize/random.hpp"

namespace hmcdyn::synthesize {
namespace {

constexpr double kRate = 120.0;   // samples a second
constexpr double kBefore = 0.25;  // seconds kept before the first frame, for its motion blur

double wrapped(double angle) { return std::remainder(angle, 2.0 * kPi); }

double towards(double value, double goal, double change) {
  return value + std::clamp(goal - value, -change, change);
}

double smooth(double x) {
  const double c = std::clamp(x, 0.0, 1.0);
  return c * c * (3.0 - 2.0 * c);
}

/// Way of a gait cycle at a speed (m): faster people make longer steps.
double cycleLength(double speed) { return 0.45 + 0.82 * speed; }

/// Slow wandering between -1 and 1: a few sines of unrelated frequencies.
class Wander {
 public:
  Wander(Random& random, double frequency) {
    for (auto& term : terms_) {
      term = {2.0 * kPi * frequency * random.uniform(0.6, 1.6), random.uniform(0.0, 2.0 * kPi)};
    }
  }
  double at(double time) const {
    double sum = 0.0;
    for (const auto& [rate, phase] : terms_) {
      sum += std::sin(rate * time + phase);
    }
    return sum / static_cast<double>(terms_.size());
  }

 private:
  std::array<std::pair<double, double>, 3> terms_;
};

/// Plays the actions forward in small steps.
class Player {
 public:
  explicit Player(const Behaviour& behaviour)
      : behaviour_(behaviour),
        random_(behaviour.seed, 17),
        breath_(random_, 0.3),
        glance_(random_, 0.25),
        nod_(random_, 0.6),
        rock_(random_, 0.2),
        left_(random_, 0.55),
        right_(random_, 0.6),
        left_hand_(random_, 0.9),
        right_hand_(random_, 0.8),
        liveliness_(random_, 0.15) {
    // NOLINTBEGIN(cppcoreguidelines-prefer-member-initializer): drawn after the wandering
    position_ = behaviour.start;
    heading_ = behaviour.heading;
    sitting_ = behaviour.starts_seated ? 1.0 : 0.0;
    carry_ = behaviour.actions.front().carry;
    phase_ = random_.uniform();
    // NOLINTEND(cppcoreguidelines-prefer-member-initializer)
  }

  Posture step(double dt) {
    const Action& action = behaviour_.actions[index_];
    double wanted_speed = 0.0;
    double wanted_heading = action.heading;
    bool wants_seat = action.kind == Action::Kind::kSit;
    bool done = false;
    elapsed_ += dt;
    if (action.kind == Action::Kind::kWalk) {
      const Action& next = behaviour_.actions[(index_ + 1) % behaviour_.actions.size()];
      const bool stops = next.kind != Action::Kind::kWalk;
      const Eigen::Vector2d way = action.target - position_;
      const double distance = way.norm();
      wanted_heading = std::atan2(way.y(), way.x());
      const double aim = std::max(0.0, std::cos(wrapped(wanted_heading - heading_)));
      wanted_speed = action.speed * (0.12 + 0.88 * aim * aim);
      if (stops) {
        wanted_speed = std::min(wanted_speed, 0.08 + 1.3 * distance);
      }
      done = distance < (stops ? 0.06 : 0.3);
    } else {
      done = elapsed_ > action.seconds;
    }
    // Nobody walks or turns on a chair.
    sitting_ = towards(sitting_, wants_seat && speed_ < 0.05 ? 1.0 : 0.0, dt / 1.5);
    const bool upright = sitting_ < 0.02;
    move(dt, upright ? wanted_speed : 0.0, upright ? wanted_heading : heading_);
    gesture_ = towards(gesture_, action.kind == Action::Kind::kWalk ? 0.0 : action.gesture, dt);
    carry_ = towards(carry_, action.carry, 1.5 * dt);
    if (done) {
      index_ = (index_ + 1) % behaviour_.actions.size();
      elapsed_ = 0.0;
    }
    time_ += dt;
    return posture();
  }
  std::size_t action() const { return index_; }

 private:
  void move(double dt, double wanted_speed, double wanted_heading) {
    const double turn_goal = std::clamp(3.0 * wrapped(wanted_heading - heading_), -2.4, 2.4);
    turn_rate_ = towards(turn_rate_, turn_goal, 9.0 * dt);
    heading_ += turn_rate_ * dt;
    speed_ = towards(speed_, wanted_speed, 1.4 * dt);
    position_ += speed_ * dt * Eigen::Vector2d(std::cos(heading_), std::sin(heading_));
    const double stepping =
        std::clamp(std::max(speed_ / 0.4, std::abs(turn_rate_) / 1.2), 0.0, 1.0);
    swing_ = towards(swing_, stepping < 0.05 ? 0.0 : stepping, 3.0 * dt);
    phase_ +=
        dt * std::max(speed_ / cycleLength(speed_), 0.6 * std::min(1.0, std::abs(turn_rate_)));
  }

  Posture posture() const {
    Posture p;
    p.x = position_.x();
    p.y = position_.y();
    p.heading = heading_;
    p.phase = phase_;
    p.swing = swing_;
    p.step = 0.6 * cycleLength(speed_) * swing_ * std::clamp(speed_ / 0.3, 0.0, 1.0);
    p.sit = smooth(sitting_);
    const double rising = std::sin(kPi * p.sit);
    const double lively = gesture_ * smooth(0.5 + 1.2 * liveliness_.at(time_));
    p.lean = 0.55 * rising + 0.0012 * breath_.at(time_) +
             0.12 * gesture_ * (0.4 + 0.6 * rock_.at(time_)) * p.sit;
    p.sway = 0.0008 * rock_.at(0.7 * time_) + 0.04 * gesture_ * rock_.at(time_);
    p.twist = 0.1 * lively * glance_.at(time_);
    const double awake = std::max(gesture_, swing_);
    p.head_yaw = 0.55 * awake * glance_.at(time_);
    p.head_pitch = 0.08 + 0.12 * gesture_ * nod_.at(time_);
    // Hands rest on the thighs or a desk while sitting, and rise to talk.
    p.left_raise = 0.45 * p.sit + lively * (0.45 + 0.4 * left_.at(time_));
    p.right_raise = 0.45 * p.sit + lively * (0.5 + 0.45 * right_.at(time_));
    p.left_elbow = 0.95 * p.sit + lively * (0.9 + 0.5 * left_hand_.at(time_)) * (1.0 - 0.6 * p.sit);
    p.right_elbow =
        0.95 * p.sit + lively * (1.0 + 0.5 * right_hand_.at(time_)) * (1.0 - 0.6 * p.sit);
    // The hands do not swing; they are as far apart as the elbows.
    p.left_raise += 0.3 * carry_;
    p.right_raise += 0.3 * carry_;
    p.left_elbow += 1.1 * carry_;
    p.right_elbow += 1.1 * carry_;
    p.left_spread = 0.25 * lively * (0.5 + 0.5 * left_hand_.at(0.6 * time_));
    p.right_spread = 0.25 * lively * (0.5 + 0.5 * right_hand_.at(0.7 * time_));
    return p;
  }

  const Behaviour& behaviour_;
  Random random_;
  Wander breath_, glance_, nod_, rock_, left_, right_, left_hand_, right_hand_, liveliness_;
  Eigen::Vector2d position_;
  double heading_ = 0.0;
  double turn_rate_ = 0.0;
  double speed_ = 0.0;
  double phase_ = 0.0;
  double swing_ = 0.0;
  double sitting_ = 0.0;
  double gesture_ = 0.0;
  double carry_ = 0.0;
  double elapsed_ = 0.0;
  double time_ = 0.0;
  std::size_t index_ = 0;
};

double mixed(double a, double b, double t) { return a + (b - a) * t; }

}  // namespace

Action walkTo(double x, double y, double speed) {
  return {Action::Kind::kWalk, {x, y}, speed, 0.0, 0.0, 0.0, 0.0};
}

Action standFor(double seconds, double heading, double gesture) {
  return {Action::Kind::kStand, Eigen::Vector2d::Zero(), 0.0, seconds, heading, gesture, 0.0};
}

Action sitFor(double seconds, double heading, double gesture) {
  return {Action::Kind::kSit, Eigen::Vector2d::Zero(), 0.0, seconds, heading, gesture, 0.0};
}

Action carrying(Action action) {
  action.carry = 1.0;
  return action;
}

Performance::Performance(const Behaviour& behaviour, double seconds) {
  if (behaviour.actions.empty() || !(seconds > 0.0)) {
    throw std::invalid_argument("Performance: " + std::to_string(behaviour.actions.size()) +
                                " actions over " + std::to_string(seconds) +
                                " s, expected at least one and a positive time");
  }
  Player player(behaviour);
  const double lead = std::max(0.0, behaviour.lag - kBefore);
  for (double t = 0.0; t < lead; t += 1.0 / kRate) {
    player.step(1.0 / kRate);
  }
  const auto count = static_cast<std::size_t>((seconds + 2.0 * kBefore) * kRate) + 2;
  samples_.reserve(count);
  starts_.assign(behaviour.actions.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < count; ++i) {
    double& start = starts_[player.action()];
    start = std::min(start, static_cast<double>(i) / kRate - kBefore);
    samples_.push_back(player.step(1.0 / kRate));
  }
}

Posture Performance::at(double time) const {
  const double place =
      std::clamp((time + kBefore) * kRate, 0.0, static_cast<double>(samples_.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(place), samples_.size() - 2);
  const double t = place - static_cast<double>(i);
  const Posture& a = samples_[i];
  const Posture& b = samples_[i + 1];
  Posture p;
  for (double Posture::*member :
       {&Posture::x, &Posture::y, &Posture::heading, &Posture::phase, &Posture::step,
        &Posture::swing, &Posture::sit, &Posture::lean, &Posture::sway, &Posture::twist,
        &Posture::head_yaw, &Posture::head_pitch, &Posture::left_raise, &Posture::right_raise,
        &Posture::left_elbow, &Posture::right_elbow, &Posture::left_spread,
        &Posture::right_spread}) {
    p.*member = mixed(a.*member, b.*member, t);
  }
  return p;
}

}  // namespace hmcdyn::synthesize
