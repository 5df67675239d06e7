// SPDX-License-Identifier: BSD-3-Clause
#include "structs.hpp"

namespace hmcdyn::python {
namespace {

/// Fields in the order in which they were bound.
std::vector<std::string> fieldsOf(const py::handle& type) {
  std::vector<std::string> names;
  for (const auto& [name, value] :
       py::reinterpret_borrow<py::dict>(py::dict(type.attr("__dict__")))) {
    if (py::isinstance(value, py::module_::import("builtins").attr("property"))) {
      names.push_back(name.cast<std::string>());
    }
  }
  return names;
}

[[noreturn]] void refuseField(const py::type& type, const std::string& field) {
  std::string known;
  for (const std::string& name : fieldsOf(type)) {
    known.append(known.empty() ? "" : ", ").append(name);
  }
  throw py::type_error(nameOfType(type) + " has no field '" + field + "'; it has " + known);
}

}  // namespace

void setFields(const py::object& target, const py::dict& fields) {
  for (const auto& [name, value] : fields) {
    const auto text = name.cast<std::string>();
    if (!py::hasattr(py::type::of(target), name)) {
      refuseField(py::type::of(target), text);
    }
    if (py::isinstance<py::dict>(value)) {
      setFields(target.attr(name), py::reinterpret_borrow<py::dict>(value));
    } else {
      py::setattr(target, name, value);
    }
  }
}

std::string textOf(const py::object& target) {
  const py::type type = py::type::of(target);
  std::string text = nameOfType(type) + "(";
  bool first = true;
  for (const std::string& field : fieldsOf(type)) {
    const py::object value = target.attr(field.c_str());
    const bool is_array = py::isinstance<py::array>(value);
    text += (first ? "" : ", ") + field + "=" +
            (is_array ? "array" + py::str(value.attr("shape")).cast<std::string>()
                      : py::repr(value).cast<std::string>());
    first = false;
  }
  return text + ")";
}

}  // namespace hmcdyn::python
