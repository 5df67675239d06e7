// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "slam/map/map_point.hpp"

namespace hmcdyn::slam {

/// Map points by number. Numbers count up and are never given again, since other threads may hold
/// old ones; the memory of a removed point is, and only 4 bytes of it stay.
class PointTable {
 public:
  /// @return the point's number.
  int add(MapPoint point);

  /// The point's memory is free for another. Nothing for one that is removed already.
  void remove(int point);

  /// Numbers given so far: those of removed points, too.
  std::size_t size() const noexcept { return slot_of_.size(); }
  /// Points that are not removed.
  std::size_t held() const noexcept { return slots_.size() - free_.size(); }

  /// A removed point is one without observations, whose flag says so.
  const MapPoint& operator[](std::size_t point) const noexcept {
    return slot_of_[point] == kGone ? gone_ : slots_[slot_of_[point]];
  }
  /// Null for a removed point. Valid until the next add().
  MapPoint* find(int point) noexcept {
    const std::uint32_t slot = slot_of_[static_cast<std::size_t>(point)];
    return slot == kGone ? nullptr : &slots_[slot];
  }

  /// Calls visit(MapPoint&) for each point that is not removed, in no special order.
  template <class Visit>
  void forEach(const Visit& visit) {
    for (MapPoint& point : slots_) {
      if (!point.removed) {
        visit(point);
      }
    }
  }

  /// Numbers of the points that wanted(const MapPoint&) holds for, ascending.
  template <class Wanted>
  std::vector<int> where(const Wanted& wanted) const {
    std::vector<int> found;
    for (std::size_t slot = 0; slot < slots_.size(); ++slot) {
      if (!slots_[slot].removed && wanted(slots_[slot])) {
        found.push_back(number_[slot]);
      }
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  /// All points by number, removed ones among them.
  class Iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = MapPoint;
    using difference_type = std::ptrdiff_t;
    using pointer = const MapPoint*;
    using reference = const MapPoint&;

    Iterator(const PointTable& table, std::size_t point) : table_(&table), point_(point) {}
    reference operator*() const { return (*table_)[point_]; }
    pointer operator->() const { return &(*table_)[point_]; }
    Iterator& operator++() {
      ++point_;
      return *this;
    }
    Iterator operator+(std::size_t points) const { return {*table_, point_ + points}; }
    bool operator==(const Iterator& other) const { return point_ == other.point_; }
    bool operator!=(const Iterator& other) const { return point_ != other.point_; }

   private:
    const PointTable* table_;
    std::size_t point_;
  };
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size()}; }

 private:
  static constexpr std::uint32_t kGone = UINT32_MAX;
  static MapPoint gone() {
    MapPoint point;
    point.removed = true;
    return point;
  }

  std::vector<MapPoint> slots_;         ///< Free ones are gone().
  std::vector<int> number_;             ///< Of the point in each slot.
  std::vector<std::uint32_t> free_;     ///< Slots, the last one is taken next.
  std::vector<std::uint32_t> slot_of_;  ///< By number.
  MapPoint gone_ = gone();
};

inline int PointTable::add(MapPoint point) {
  std::uint32_t slot = static_cast<std::uint32_t>(slots_.size());
  if (free_.empty()) {
    slots_.push_back(std::move(point));
    number_.push_back(0);
  } else {
    slot = free_.back();
    free_.pop_back();
    slots_[slot] = std::move(point);
  }
  number_[slot] = static_cast<int>(slot_of_.size());
  slot_of_.push_back(slot);
  return number_[slot];
}

inline void PointTable::remove(int point) {
  std::uint32_t& slot = slot_of_[static_cast<std::size_t>(point)];
  if (slot != kGone) {
    slots_[slot] = gone();
    free_.push_back(slot);
    slot = kGone;
  }
}

}  // namespace hmcdyn::slam
