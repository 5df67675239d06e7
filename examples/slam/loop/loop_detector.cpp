// SPDX-License-Identifier: BSD-3-Clause
#include "slam/loop/loop_detector.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace hmcdyn::slam {
namespace {

LoopConstraint constraintOf(const LoopKeyFrame& from, const LoopKeyFrame& to,
                            const LoopVerification& verification) {
  LoopConstraint constraint;
  constraint.from = from.id;
  constraint.to = to.id;
  constraint.to_from = verification.to_from;
  constraint.information = verification.information;
  constraint.inliers = verification.inliers;
  constraint.key_points = verification.key_points;
  for (const auto& [i, j] : verification.key_points) {
    const int a = from.map_point[static_cast<std::size_t>(i)];
    const int b = to.map_point[static_cast<std::size_t>(j)];
    if (a >= 0 && b >= 0 && a != b) {
      constraint.map_points.emplace_back(a, b);
    }
  }
  return constraint;
}

}  // namespace

LoopDetector::LoopDetector(const PinholeCamera& camera, const LoopDetectorOptions& options)
    : camera_(camera), options_(options), index_(options.place) {
  if (options.min_consistent < 1) {
    throw std::invalid_argument("options.min_consistent is " +
                                std::to_string(options.min_consistent) + ", expected at least 1");
  }
  if (options.place_size < 1) {
    throw std::invalid_argument("options.place_size is 0, expected at least 1");
  }
}

std::vector<LoopCandidate> LoopDetector::candidatesOf(const LoopKeyFrame& key_frame) const {
  std::set<std::size_t> neighbours;
  for (const auto& [id, shared] : key_frame.covisible) {
    neighbours.insert(id);
  }
  const auto isRecent = [this](std::size_t id) {
    return order_.at(id) + options_.min_gap > processed_;
  };
  const std::vector<PlaceCandidate> alike = index_.query(key_frame.descriptors, index_.size());
  double reference = 0.0;
  for (const PlaceCandidate& place : alike) {
    // Without any covisibility the key frames just before stand in.
    const bool sees_the_same =
        neighbours.empty() ? isRecent(place.id) : neighbours.count(place.id) != 0;
    reference = sees_the_same ? std::max(reference, place.score) : reference;
  }
  std::vector<LoopCandidate> good;
  std::vector<LoopCandidate> low;
  for (const PlaceCandidate& place : alike) {
    if (isRecent(place.id) || neighbours.count(place.id) != 0) {
      continue;
    }
    LoopCandidate candidate;
    candidate.id = place.id;
    candidate.score = place.score;
    candidate.reference_score = reference;
    const bool is_good =
        place.score >= std::max(options_.min_score, options_.min_relative_score * reference);
    candidate.verification.verdict = is_good ? LoopVerdict::kInconsistent : LoopVerdict::kLowScore;
    (is_good ? good : low).push_back(candidate);
  }
  std::vector<LoopCandidate> candidates = placesAmong(good);
  candidates.insert(candidates.end(), low.begin(), low.end());
  candidates.resize(std::min(candidates.size(), options_.max_candidates));
  return candidates;
}

/// @param alike best score first. @return the best of each place, best place first.
std::vector<LoopCandidate> LoopDetector::placesAmong(
    const std::vector<LoopCandidate>& alike) const {
  std::map<std::size_t, std::size_t> rank;
  for (std::size_t i = 0; i < alike.size(); ++i) {
    rank[alike[i].id] = i;
  }
  std::map<std::size_t, double> score_of;  // of a place, by rank of its best candidate
  for (const LoopCandidate& candidate : alike) {
    std::set<std::size_t> members;  // ranks: those that look most alike come first
    for (const std::size_t id : groupOf(candidate.id).members) {
      const auto found = rank.find(id);
      if (found != rank.end()) {
        members.insert(found->second);
      }
    }
    double sum = 0.0;
    std::size_t taken = 0;
    for (auto member = members.begin(); member != members.end() && taken < options_.place_size;
         ++member, ++taken) {
      sum += alike[*member].score;
    }
    double& best = score_of[*members.begin()];
    best = std::max(best, sum);
  }
  std::vector<LoopCandidate> places;
  double best = 0.0;
  for (const auto& [first, score] : score_of) {
    places.push_back(alike[first]);
    places.back().place_score = score;
    best = std::max(best, score);
  }
  places.erase(std::remove_if(places.begin(), places.end(),
                              [&](const LoopCandidate& place) {
                                return place.place_score < options_.min_relative_place * best;
                              }),
               places.end());
  std::stable_sort(
      places.begin(), places.end(),
      [](const LoopCandidate& a, const LoopCandidate& b) { return a.place_score > b.place_score; });
  return places;
}

LoopDetector::Group LoopDetector::groupOf(std::size_t id) const {
  Group group;
  const auto found = covisible_.find(id);
  if (found != covisible_.end()) {
    group.members = found->second;
  }
  group.members.insert(id);
  return group;
}

int LoopDetector::consistencyOf(const Group& group) const {
  int length = 1;
  for (const Group& before : groups_) {
    const bool overlap = std::any_of(group.members.begin(), group.members.end(),
                                     [&](std::size_t id) { return before.members.count(id) != 0; });
    length = overlap ? std::max(length, before.length + 1) : length;
  }
  return length;
}

std::optional<LoopConstraint> LoopDetector::choose(const LoopKeyFrame& key_frame,
                                                   std::vector<LoopCandidate>& candidates) const {
  LoopCandidate* best = nullptr;
  for (LoopCandidate& candidate : candidates) {
    if (candidate.verification.verdict == LoopVerdict::kLowScore ||
        candidate.consistent < options_.min_consistent) {
      continue;
    }
    candidate.verification =
        verifyLoop(key_frames_.at(candidate.id), key_frame, camera_, options_.verification);
    if (candidate.verification.verdict != LoopVerdict::kAccepted) {
      continue;
    }
    if (best != nullptr && best->verification.inliers >= candidate.verification.inliers) {
      candidate.verification.verdict = LoopVerdict::kOutvoted;
      continue;
    }
    if (best != nullptr) {
      best->verification.verdict = LoopVerdict::kOutvoted;
    }
    best = &candidate;
  }
  if (best == nullptr) {
    return std::nullopt;
  }
  return constraintOf(key_frames_.at(best->id), key_frame, best->verification);
}

void LoopDetector::insert(LoopKeyFrame key_frame) {
  const std::size_t id = key_frame.id;
  index_.add(id, key_frame.descriptors);
  order_[id] = processed_;
  for (const auto& [other, shared] : key_frame.covisible) {
    if (key_frames_.count(other) != 0) {
      covisible_[id].insert(other);
      covisible_[other].insert(id);
    }
  }
  key_frames_[id] = std::move(key_frame);
}

LoopReport LoopDetector::process(LoopKeyFrame key_frame) {
  checkLoopKeyFrame(key_frame, "key_frame");
  if (key_frames_.count(key_frame.id) != 0) {
    throw std::invalid_argument("key_frame.id is " + std::to_string(key_frame.id) +
                                ", expected one that is not known yet");
  }
  LoopReport report;
  report.id = key_frame.id;
  const bool resting = last_loop_ && processed_ - *last_loop_ <= options_.cooldown;
  std::vector<Group> groups;
  if (!resting) {
    report.candidates = candidatesOf(key_frame);
    for (LoopCandidate& candidate : report.candidates) {
      if (candidate.verification.verdict != LoopVerdict::kLowScore) {
        Group group = groupOf(candidate.id);
        group.length = consistencyOf(group);
        candidate.consistent = group.length;
        groups.push_back(std::move(group));
      }
    }
    report.constraint = choose(key_frame, report.candidates);
  }
  if (report.constraint) {
    last_loop_ = processed_;
    groups.clear();
  }
  groups_ = std::move(groups);
  insert(std::move(key_frame));
  ++processed_;
  return report;
}

bool LoopDetector::remove(std::size_t id) {
  if (key_frames_.erase(id) == 0) {
    return false;
  }
  index_.remove(id);
  order_.erase(id);
  for (const std::size_t other : covisible_[id]) {
    covisible_[other].erase(id);
  }
  covisible_.erase(id);
  return true;
}

}  // namespace hmcdyn::slam
