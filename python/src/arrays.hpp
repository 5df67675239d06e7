// SPDX-License-Identifier: BSD-3-Clause
// numpy's arrays and the library's views and vectors: without a copy where the layout allows.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <hmcdyn/pose.hpp>
#include <hmcdyn/regions.hpp>
#include <hmcdyn/span.hpp>
#include <hmcdyn/types.hpp>

namespace hmcdyn::python {

namespace py = pybind11;

inline bool isAnything(PyObject* /*object*/) { return true; }

/// An argument that this code turns into an array itself, so that errors name the argument.
struct ArrayLike : py::object {
  PYBIND11_OBJECT_DEFAULT(ArrayLike, py::object, isAnything)
};
/// The same where None is an answer, too.
struct ArrayOrNone : ArrayLike {
  PYBIND11_OBJECT_DEFAULT(ArrayOrNone, ArrayLike, isAnything)
};
/// Boxes: a sequence of DetectionBox, or an array of M rows x_min, y_min, x_max, y_max, perhaps
/// score, perhaps class.
struct BoxesLike : py::object {
  PYBIND11_OBJECT_DEFAULT(BoxesLike, py::object, isAnything)
};

/// A sequence of LabelRegion.
struct RegionsLike : py::object {
  PYBIND11_OBJECT_DEFAULT(RegionsLike, py::object, isAnything)
};

/// Numbers that somebody else owns; holds on to their array.
template <class T>
struct Column {
  py::array array;
  Span<const T> values;
};

/// An argument as a one-dimensional array: without a copy where it is one of this type, contiguous.
/// @param name of the argument. None gives no values.
/// @throws std::invalid_argument for another shape, or for what are no real numbers.
template <class T>
Column<T> column(const py::object& argument, const char* name);

extern template Column<float> column<float>(const py::object&, const char*);
extern template Column<double> column<double>(const py::object&, const char*);
extern template Column<int> column<int>(const py::object&, const char*);
extern template Column<std::uint8_t> column<std::uint8_t>(const py::object&, const char*);
extern template Column<std::uint32_t> column<std::uint32_t>(const py::object&, const char*);

/// An argument as rows of `width` numbers, (N, width); copied.
std::vector<float> rowsOf(const py::object& argument, const char* name, std::size_t width);

/// A gray image: uint8, (H, W). Borrowed; holds on to its array. None gives an empty image.
struct Image {
  py::array array;
  cv::Mat mat;
};
Image grayImage(const py::object& argument, const char* name);
/// A depth image in metres: float32, (H, W); float64 and float16 are converted.
/// @throws std::invalid_argument also for integers, which are no metres.
Image depthImage(const py::object& argument, const char* name);
/// Labels: uint8, uint16, int32 or bool, (H, W).
Image labelImage(const py::object& argument, const char* name);

/// What BoxesLike says.
std::vector<DetectionBox> boxesOf(const BoxesLike& argument);

/// What RegionsLike says; None gives none.
std::vector<LabelRegion> regionsOf(const RegionsLike& argument);

/// A rigid motion: an array (4, 4) or (3, 4).
/// @throws std::invalid_argument for another shape, or what is no number.
Eigen::Isometry3d motionOf(const py::object& argument, const char* name);

/// Three by three, row by row.
Eigen::Matrix3d matrix3Of(const py::object& argument, const char* name);

/// (4, 4).
py::array_t<double> toNumpy(const Pose& pose);

template <int kRows, int kColumns>
py::array_t<double> toNumpy(const PlainMatrix<kRows, kColumns>& matrix) {
  return py::array_t<double>({kRows, kColumns}, matrix.values.data());
}

/// The element type by which numpy knows a vector's: flags are bool, enumerations their numbers.
template <class T>
py::dtype elementType() {
  if constexpr (std::is_same_v<T, std::uint8_t>) {
    return py::dtype::of<bool>();
  } else if constexpr (std::is_enum_v<T>) {
    return py::dtype::of<std::underlying_type_t<T>>();
  } else {
    return py::dtype::of<T>();
  }
}

/// An array that takes a vector's memory over.
template <class T>
py::array toNumpy(std::vector<T> values) {
  auto owner = std::make_unique<std::vector<T>>(std::move(values));
  const auto size = static_cast<py::ssize_t>(owner->size());
  const T* const data = owner->data();
  const py::capsule base(owner.release(), [](void* vector) {
    delete static_cast<std::vector<T>*>(vector);  // NOLINT(cppcoreguidelines-owning-memory)
  });
  return py::array(elementType<T>(), {size}, {}, data, base);
}

/// An array that looks at a vector, and keeps its owner alive.
template <class T>
py::array viewOf(const std::vector<T>& values, py::handle owner) {
  return py::array(elementType<T>(), {static_cast<py::ssize_t>(values.size())}, {}, values.data(),
                   owner);
}

/// The same of an image, CV_8UC1 or CV_32FC1. @param owner null = a copy.
py::array viewOf(const cv::Mat& image, py::handle owner);
inline py::array toNumpy(const cv::Mat& image) { return viewOf(image, {}); }

/// Computes without Python's lock.
template <class Work>
auto unlocked(const Work& work) {
  const py::gil_scoped_release release;
  return work();
}

}  // namespace hmcdyn::python

namespace pybind11::detail {
// NOLINTBEGIN(readability-identifier-naming): pybind11 asks for the name
template <>
struct handle_type_name<hmcdyn::python::ArrayLike> {
  static constexpr auto name = const_name("numpy.typing.ArrayLike");
};
template <>
struct handle_type_name<hmcdyn::python::ArrayOrNone> {
  static constexpr auto name = const_name("Optional[numpy.typing.ArrayLike]");
};
template <>
struct handle_type_name<hmcdyn::python::BoxesLike> {
  static constexpr auto name = const_name("Boxes");
};
template <>
struct handle_type_name<hmcdyn::python::RegionsLike> {
  static constexpr auto name = const_name("Regions");
};
// NOLINTEND(readability-identifier-naming)
}  // namespace pybind11::detail
