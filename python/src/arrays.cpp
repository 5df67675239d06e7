// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"

#include <cmath>
#include <stdexcept>

namespace hmcdyn::python {
namespace {

std::string shapeOf(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    text += (i == 0 ? "" : ", ") + std::to_string(array.shape(i));
  }
  return text + (array.ndim() == 1 ? ",)" : ")");
}

std::string typeOf(const py::array& array) {
  return py::str(static_cast<py::handle>(array.dtype())).cast<std::string>();
}

[[noreturn]] void refuse(const char* name, const py::array& array, const std::string& expected) {
  throw std::invalid_argument(std::string(name) + " is an array of " + typeOf(array) + ", shape " +
                              shapeOf(array) + "; expected " + expected);
}

/// What numpy makes of an argument.
py::array asArray(const py::object& argument, const char* name) {
  py::array array = py::array::ensure(argument);
  if (!array) {
    throw std::invalid_argument(
        std::string(name) + " is " +
        py::str(py::type::handle_of(argument).attr("__name__")).cast<std::string>() +
        "; expected an array");
  }
  return array;
}

bool isReal(const py::array& array) {
  const char kind = array.dtype().kind();
  return kind == 'f' || kind == 'i' || kind == 'u' || kind == 'b';
}

/// Compared by value: an array that was pickled has a type object of its own.
template <class T>
bool holds(const py::array& array, char kind) {
  const py::dtype type = array.dtype();
  return type.kind() == kind && type.itemsize() == static_cast<py::ssize_t>(sizeof(T)) &&
         (type.byteorder() == '=' || type.byteorder() == '|');
}

template <class T>
py::array converted(const py::array& array, const char* name, const std::string& expected) {
  if (!isReal(array)) {
    refuse(name, array, expected);
  }
  return py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(array);
}

/// A border of an image into which OpenCV can look, copied where its pixels do not lie side by
/// side.
Image borrowed(py::array array, int type, py::ssize_t pixel) {
  const bool fits = array.strides(1) == pixel && array.strides(0) >= array.shape(1) * pixel;
  if (!fits) {
    array = py::array::ensure(array, py::array::c_style);
  }
  // OpenCV has no view of what must not be written; the library does not write to its input.
  void* const data =
      const_cast<void*>(array.data());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  const auto step = array.shape(0) > 1 ? static_cast<std::size_t>(array.strides(0))
                                       : static_cast<std::size_t>(array.shape(1) * pixel);
  cv::Mat mat(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)), type, data, step);
  return {std::move(array), std::move(mat)};
}

/// @throws std::invalid_argument unless it has two dimensions, and pixels.
void requireImage(const char* name, const py::array& array, const char* expected) {
  if (array.ndim() != 2 || array.size() == 0) {
    refuse(name, array, std::string(expected) + " of shape (height, width)");
  }
}

float numberAt(const std::vector<float>& row, std::size_t i, float otherwise) {
  return row.size() > i ? row[i] : otherwise;
}

DetectionBox boxOf(const std::vector<float>& row) {
  DetectionBox box{row[0], row[1], row[2], row[3]};
  box.score = numberAt(row, 4, box.score);
  const float class_id = numberAt(row, 5, static_cast<float>(box.class_id));
  if (!(std::abs(class_id) < 1e6f)) {
    throw std::invalid_argument("boxes: a class is " + std::to_string(class_id) +
                                "; expected a number below 1e6");
  }
  box.class_id = static_cast<int>(class_id);
  return box;
}

constexpr const char* kBoxesExpected =
    "DetectionBoxes, or rows of x_min, y_min, x_max, y_max, perhaps score, perhaps class";

std::vector<DetectionBox> boxesOfArray(const py::array& array) {
  if (array.size() == 0) {
    return {};
  }
  if (array.ndim() != 2 || array.shape(1) < 4 || array.shape(1) > 6) {
    refuse("boxes", array, kBoxesExpected);
  }
  const auto width = static_cast<std::size_t>(array.shape(1));
  const std::vector<float> numbers = rowsOf(array, "boxes", width);
  std::vector<DetectionBox> boxes;
  for (std::size_t i = 0; i < numbers.size(); i += width) {
    const auto first = numbers.begin() + static_cast<std::ptrdiff_t>(i);
    boxes.push_back(boxOf({first, first + static_cast<std::ptrdiff_t>(width)}));
  }
  return boxes;
}

Eigen::MatrixXd numbersOf(const py::object& argument, const char* name, const char* expected) {
  const py::array array = asArray(argument, name);
  if (array.ndim() != 2 || !isReal(array)) {
    refuse(name, array, expected);
  }
  const auto numbers =
      py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(array);
  Eigen::MatrixXd matrix(array.shape(0), array.shape(1));
  for (Eigen::Index row = 0; row < matrix.rows(); ++row) {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
      matrix(row, column) = numbers.at(row, column);
    }
  }
  return matrix;
}

}  // namespace

template <class T>
Column<T> column(const py::object& argument, const char* name) {
  if (argument.is_none()) {
    return {};
  }
  const py::array given = asArray(argument, name);
  const std::string expected = "N real numbers, shape (N,)";
  if (given.ndim() != 1) {
    refuse(name, given, expected);
  }
  if (std::is_integral_v<T> && given.dtype().kind() == 'f' && given.size() > 0) {
    refuse(name, given, "N integers, shape (N,)");
  }
  py::array array = converted<T>(given, name, expected);
  const Span<const T> values(static_cast<const T*>(array.data()),
                             static_cast<std::size_t>(array.size()));
  return {std::move(array), values};
}

template Column<float> column<float>(const py::object&, const char*);
template Column<double> column<double>(const py::object&, const char*);
template Column<int> column<int>(const py::object&, const char*);
template Column<std::uint8_t> column<std::uint8_t>(const py::object&, const char*);
template Column<std::uint32_t> column<std::uint32_t>(const py::object&, const char*);

std::vector<float> rowsOf(const py::object& argument, const char* name, std::size_t width) {
  const py::array given = asArray(argument, name);
  const std::string expected = "real numbers of shape (N, " + std::to_string(width) + ")";
  if (given.size() == 0) {
    return {};
  }
  if (given.ndim() != 2 || given.shape(1) != static_cast<py::ssize_t>(width)) {
    refuse(name, given, expected);
  }
  const py::array array = converted<float>(given, name, expected);
  const auto* const data = static_cast<const float*>(array.data());
  return {data, data + array.size()};
}

Image grayImage(const py::object& argument, const char* name) {
  constexpr const char* kExpected = "a gray image of uint8";
  if (argument.is_none()) {
    return {};
  }
  py::array array = asArray(argument, name);
  requireImage(name, array, kExpected);
  if (!holds<std::uint8_t>(array, 'u')) {
    refuse(name, array, std::string(kExpected) + " of shape (height, width)");
  }
  return borrowed(std::move(array), CV_8UC1, 1);
}

Image depthImage(const py::object& argument, const char* name) {
  constexpr const char* kExpected = "depths in metres (float32)";
  if (argument.is_none()) {
    return {};
  }
  py::array array = asArray(argument, name);
  requireImage(name, array, kExpected);
  if (array.dtype().kind() != 'f') {
    refuse(name, array,
           std::string(kExpected) +
               ": divide what the camera's file holds by its factor, such as 5000 for TUM");
  }
  if (!holds<float>(array, 'f')) {
    array = converted<float>(array, name, kExpected);
  }
  return borrowed(std::move(array), CV_32FC1, sizeof(float));
}

Image labelImage(const py::object& argument, const char* name) {
  constexpr const char* kExpected = "labels of uint8, uint16, int32 or bool";
  if (argument.is_none()) {
    return {};
  }
  py::array array = asArray(argument, name);
  requireImage(name, array, kExpected);
  if (array.dtype().kind() == 'b' || holds<std::uint8_t>(array, 'u')) {
    return borrowed(std::move(array), CV_8UC1, 1);
  }
  if (holds<std::uint16_t>(array, 'u')) {
    return borrowed(std::move(array), CV_16UC1, 2);
  }
  if (!holds<std::int32_t>(array, 'i')) {
    refuse(name, array, std::string(kExpected) + ", shape (height, width)");
  }
  return borrowed(std::move(array), CV_32SC1, 4);
}

std::vector<DetectionBox> boxesOf(const BoxesLike& argument) {
  if (argument.is_none()) {
    return {};
  }
  if (py::isinstance<py::array>(argument)) {
    return boxesOfArray(py::reinterpret_borrow<py::array>(argument));
  }
  if (!py::isinstance<py::sequence>(argument) || py::isinstance<py::str>(argument)) {
    return boxesOfArray(asArray(argument, "boxes"));
  }
  std::vector<DetectionBox> boxes;
  for (const py::handle item : argument) {
    if (py::isinstance<DetectionBox>(item)) {
      boxes.push_back(item.cast<DetectionBox>());
      continue;
    }
    const Column<float> row = column<float>(py::reinterpret_borrow<py::object>(item), "boxes");
    if (row.values.size() < 4 || row.values.size() > 6) {
      refuse("boxes", row.array, kBoxesExpected);
    }
    boxes.push_back(boxOf({row.values.begin(), row.values.end()}));
  }
  return boxes;
}

std::vector<LabelRegion> regionsOf(const RegionsLike& argument) {
  std::vector<LabelRegion> regions;
  if (argument.is_none()) {
    return regions;
  }
  for (const py::handle item : argument) {
    if (!py::isinstance<LabelRegion>(item)) {
      throw std::invalid_argument("regions holds what is no LabelRegion");
    }
    regions.push_back(item.cast<LabelRegion>());
  }
  return regions;
}

Eigen::Isometry3d motionOf(const py::object& argument, const char* name) {
  constexpr const char* kExpected = "a rigid motion [R | t], shape (4, 4) or (3, 4)";
  const Eigen::MatrixXd matrix = numbersOf(argument, name, kExpected);
  if ((matrix.rows() != 4 && matrix.rows() != 3) || matrix.cols() != 4) {
    refuse(name, asArray(argument, name), kExpected);
  }
  if (matrix.rows() == 4 && matrix.row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
    throw std::invalid_argument(std::string(name) +
                                " has another last row than 0, 0, 0, 1; expected a rigid motion");
  }
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.matrix().topRows<3>() = matrix.topRows<3>();
  return motion;
}

Eigen::Matrix3d matrix3Of(const py::object& argument, const char* name) {
  constexpr const char* kExpected = "a matrix of shape (3, 3)";
  const Eigen::MatrixXd matrix = numbersOf(argument, name, kExpected);
  if (matrix.rows() != 3 || matrix.cols() != 3) {
    refuse(name, asArray(argument, name), kExpected);
  }
  return matrix;
}

py::array_t<double> toNumpy(const Pose& pose) {
  py::array_t<double> matrix({4, 4});
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      const double last = column == 3 ? 1.0 : 0.0;
      matrix.mutable_at(row, column) = row < 3 ? pose.matrix(row, column) : last;
    }
  }
  return matrix;
}

py::array viewOf(const cv::Mat& image, py::handle owner) {
  const py::dtype type =
      image.depth() == CV_32F ? py::dtype::of<float>() : py::dtype::of<std::uint8_t>();
  return py::array(type,
                   {static_cast<py::ssize_t>(image.rows), static_cast<py::ssize_t>(image.cols)},
                   {static_cast<py::ssize_t>(image.step[0]), type.itemsize()}, image.data, owner);
}

}  // namespace hmcdyn::python
