// SPDX-License-Identifier: BSD-3-Clause
// The library's structs as classes of Python: options with keywords, results to read.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "comments.hpp"
#include "enumerations.hpp"
#include "fields.inc"  // made by the build

namespace hmcdyn::python {

/// Sets fields by name; a dict sets fields of the struct that the field is.
/// @throws py::type_error that names the fields there are where one is unknown.
void setFields(const py::object& target, const py::dict& fields);

/// "ClusteringOptions(depth_scale=1.0, ...)".
std::string textOf(const py::object& target);

inline std::string nameOfType(const py::handle& type) {
  return type.attr("__name__").cast<std::string>();
}

/// A function's argument for options: a struct, or None.
template <class Options>
struct OptionsOf : py::object {
  PYBIND11_OBJECT_DEFAULT(OptionsOf, py::object, isAnything)
};

/// A function's options: a struct, or nothing for the defaults, and then single fields by name.
template <class Options>
Options optionsFrom(const py::object& options, const py::kwargs& fields) {
  if (options.is_none() && fields.empty()) {
    return {};
  }
  if (!options.is_none() && !py::isinstance<Options>(options)) {
    throw py::type_error("options is " + nameOfType(py::type::of(options)) + "; expected " +
                         nameOfType(py::type::of<Options>()));
  }
  Options own = options.is_none() ? Options{} : options.cast<Options>();
  if (!fields.empty()) {
    setFields(py::cast(&own, py::return_value_policy::reference), fields);
  }
  return own;
}

/// Whether a vector's elements are numbers, which become an array, or structs, which make a list.
template <class T>
inline constexpr bool kIsNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// How signatures and type stubs name what read() makes of a field.
template <class T>
struct PythonType {
  static constexpr auto kName = py::detail::make_caster<T>::name;
};
template <>
struct PythonType<Pose> {
  static constexpr auto kName = py::detail::const_name("numpy.ndarray[numpy.float64]");
};
template <int kRows, int kColumns>
struct PythonType<PlainMatrix<kRows, kColumns>> : PythonType<Pose> {};
template <>
struct PythonType<Eigen::Vector3d> : PythonType<Pose> {};
template <>
struct PythonType<std::vector<Eigen::Vector3d>> : PythonType<Pose> {};
template <>
struct PythonType<cv::Mat> {
  static constexpr auto kName = py::detail::const_name("numpy.ndarray");
};
template <std::size_t kSize>
struct PythonType<std::array<float, kSize>> {
  static constexpr auto kName = py::detail::const_name("numpy.ndarray[numpy.float32]");
};
template <>
struct PythonType<cv::Rect> {
  static constexpr auto kName = py::detail::const_name("Tuple[int, int, int, int]");
};
template <class T>
struct PythonType<std::optional<T>> {
  static constexpr auto kName =
      py::detail::const_name("Optional[") + PythonType<T>::kName + py::detail::const_name("]");
};
template <class T>
constexpr auto nameOfVector() {
  using py::detail::const_name;
  if constexpr (std::is_same_v<T, std::uint8_t>) {
    return const_name("numpy.ndarray[numpy.bool_]");
  } else if constexpr (std::is_enum_v<T>) {
    return const_name("numpy.ndarray[numpy.uint8]");
  } else if constexpr (kIsNumber<T>) {
    return const_name("numpy.ndarray[") + py::detail::npy_format_descriptor<T>::name +
           const_name("]");
  } else {
    return const_name("List[") + PythonType<T>::kName + const_name("]");
  }
}
template <class T>
struct PythonType<std::vector<T>> {
  static constexpr auto kName = nameOfVector<T>();
};

/// An object of which the signature says what it is.
template <class T>
struct Typed : py::object {
  explicit Typed(py::object value) : py::object(std::move(value)) {}
};

/// What Python sees of a field. @param owner keeps the memory that an array looks at.
template <class T>
py::object read(const T& value, py::handle owner) {
  if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, std::string>) {
    return py::cast(value);
  } else {
    return py::cast(&value, py::return_value_policy::reference_internal, owner);
  }
}
inline py::object read(const Pose& pose, py::handle /*owner*/) { return toNumpy(pose); }
template <int kRows, int kColumns>
py::object read(const PlainMatrix<kRows, kColumns>& matrix, py::handle /*owner*/) {
  return toNumpy(matrix);
}
inline py::object read(const cv::Mat& image, py::handle owner) { return viewOf(image, owner); }
inline py::object read(const cv::Rect& box, py::handle /*owner*/) {
  return py::make_tuple(box.x, box.y, box.width, box.height);
}
template <std::size_t kSize>
py::object read(const std::array<float, kSize>& values, py::handle /*owner*/) {
  return py::array_t<float>(kSize, values.data());
}
template <class T>
py::object read(const std::optional<T>& value, py::handle owner) {
  return value ? read(*value, owner) : py::none();
}
inline py::object read(const Eigen::Vector3d& vector, py::handle /*owner*/) {
  return py::array_t<double>(3, vector.data());
}
inline py::object read(const std::vector<Eigen::Vector3d>& vectors, py::handle /*owner*/) {
  py::array_t<double> rows({static_cast<py::ssize_t>(vectors.size()), py::ssize_t{3}});
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      rows.mutable_at(static_cast<py::ssize_t>(i), k) = vectors[i](k);
    }
  }
  return rows;
}
template <class T>
py::object read(const std::vector<T>& values, py::handle owner) {
  if constexpr (kIsNumber<T>) {
    return viewOf(values, owner);
  } else {
    py::list list;
    for (const T& value : values) {
      list.append(read(value, owner));
    }
    return std::move(list);
  }
}

/// "lambda" is no name in Python.
inline std::string pythonName(const char* field) {
  return std::string(field) == "lambda" ? "lambda_" : field;
}

/// A field of a result.
template <class T, class Field>
void bindReadOnly(py::class_<T>& type, Field T::*field, const char* name, const char* comment) {
  type.def_property_readonly(
      pythonName(name).c_str(),
      [field](const py::object& self) {
        return Typed<Field>(read(self.cast<const T&>().*field, self));
      },
      comment);
}

/// A struct of options, made with keywords.
template <class T>
py::class_<T> optionsClass(py::module_& module, const char* name, const char* comment) {
  py::class_<T> type(module, name, comment);
  type.def(py::init([](const py::kwargs& fields) { return optionsFrom<T>(py::none(), fields); }));
  type.def("__repr__", [](const py::object& self) { return textOf(self); });
  type.def("__copy__", [](const T& self) { return T(self); });
  type.def("__deepcopy__", [](const T& self, const py::dict& /*memo*/) { return T(self); });
  return type;
}

// NOLINTBEGIN(cppcoreguidelines-macro-usage): they make names of the program, and text of names
#define HMCDYN_COMMENT_OF(Type, field) commentOf(#Type "::" #field)
#define HMCDYN_OPTION(Type, field) \
  type.def_readwrite(#field, &Type::field, HMCDYN_COMMENT_OF(Type, field));
#define HMCDYN_READ_ONLY(Type, field) \
  bindReadOnly(type, &Type::field, #field, HMCDYN_COMMENT_OF(Type, field));

/// Binds a struct of options with all its fields, which the build takes from the header.
#define HMCDYN_BIND_OPTIONS(module, Type)                            \
  {                                                                  \
    auto type = optionsClass<Type>(module, #Type, commentOf(#Type)); \
    HMCDYN_FIELDS_##Type(HMCDYN_OPTION)                              \
  }
/// Binds a struct of results: its fields are read, arrays without a copy.
#define HMCDYN_BIND_RESULT(module, Type)                                           \
  {                                                                                \
    py::class_<Type> type(module, #Type, commentOf(#Type));                        \
    HMCDYN_FIELDS_##Type(HMCDYN_READ_ONLY)                                         \
        type.def("__repr__", [](const py::object& self) { return textOf(self); }); \
  }

// NOLINTEND(cppcoreguidelines-macro-usage)

}  // namespace hmcdyn::python

namespace pybind11::detail {
// NOLINTBEGIN(readability-identifier-naming): pybind11 asks for the name
template <class T>
struct handle_type_name<hmcdyn::python::Typed<T>> {
  static constexpr auto name = hmcdyn::python::PythonType<T>::kName;
};
template <class T>
struct handle_type_name<hmcdyn::python::OptionsOf<T>> {
  static constexpr auto name = const_name("Optional[") + make_caster<T>::name + const_name("]");
};
// NOLINTEND(readability-identifier-naming)
}  // namespace pybind11::detail
