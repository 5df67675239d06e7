// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include <hmcdyn/detail/requirements.hpp>

namespace hmcdyn {

/// A view of contiguous elements that somebody else owns: the part of C++20's std::span that the
/// C++17 interface needs. Converts from any container with data() and size(), such as std::vector
/// or an Eigen array. Never null-checked: a view of nothing has size 0.
template <class T>
class Span {
 public:
  constexpr Span() noexcept = default;  ///< Of nothing.
  /// Of `size` elements from `data` on.
  constexpr Span(T* data, std::size_t size) noexcept : data_(data), size_(size) {}

  /// Of a whole container, which must outlive the view.
  template <class Container, class = std::enable_if_t<std::is_convertible_v<
                                 decltype(std::declval<Container&>().data()), T*>>>
  // NOLINTNEXTLINE(google-explicit-constructor,hicpp-explicit-conversions): a view, as std::span
  constexpr Span(Container&& container) noexcept
      : data_(container.data()), size_(static_cast<std::size_t>(container.size())) {}

  constexpr T* data() const noexcept { return data_; }           ///< The first element.
  constexpr std::size_t size() const noexcept { return size_; }  ///< Number of elements.
  constexpr bool empty() const noexcept { return size_ == 0; }   ///< True without an element.
  /// Element i, 0 <= i < size(); not checked.
  constexpr T& operator[](std::size_t i) const noexcept { return data_[i]; }
  constexpr T* begin() const noexcept { return data_; }        ///< The first element.
  constexpr T* end() const noexcept { return data_ + size_; }  ///< Behind the last.

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace hmcdyn
