// SPDX-License-Identifier: BSD-3-Clause
// examples/evaluate: trajectory errors as the TUM RGB-D benchmark defines them
#include <stdexcept>

#include "bindings.hpp"
#include "evaluate/absolute_trajectory_error.hpp"
#include "evaluate/relative_pose_error.hpp"
#include "evaluate/trajectory.hpp"
#include "structs.hpp"

namespace hmcdyn::python {

/// A file in TUM's format, or (N, 8): timestamp tx ty tz qx qy qz qw.
struct TrajectoryLike : py::object {
  PYBIND11_OBJECT_DEFAULT(TrajectoryLike, py::object, isAnything)
};
/// The name of a file, or what os.fspath() takes.
struct PathLike : py::object {
  PYBIND11_OBJECT_DEFAULT(PathLike, py::object, isAnything)
};

}  // namespace hmcdyn::python

namespace pybind11::detail {
// NOLINTBEGIN(readability-identifier-naming): pybind11 asks for the name
template <>
struct handle_type_name<hmcdyn::python::TrajectoryLike> {
  static constexpr auto name = const_name("Trajectory");
};
template <>
struct handle_type_name<hmcdyn::python::PathLike> {
  static constexpr auto name = const_name("Path");
};
// NOLINTEND(readability-identifier-naming)
}  // namespace pybind11::detail

namespace hmcdyn::python {
namespace {

using evaluate::Alignment;
using evaluate::AteOptions;
using evaluate::AteResult;
using evaluate::RpeOptions;
using evaluate::RpeResult;
using evaluate::StampedPose;
using evaluate::Statistics;
using evaluate::Trajectory;

constexpr std::size_t kWidth = 8;  // timestamp tx ty tz qx qy qz qw

Trajectory readFile(const py::object& file) {
  return evaluate::readTrajectory(
      py::module_::import("os").attr("fspath")(file).cast<std::string>());
}

Trajectory trajectoryOf(const TrajectoryLike& argument, const char* name) {
  const bool is_path = py::isinstance<py::str>(argument) || py::hasattr(argument, "__fspath__");
  if (is_path) {
    return readFile(argument);
  }
  const auto rows =
      py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(argument);
  if (!rows || rows.ndim() != 2 || rows.shape(1) != static_cast<py::ssize_t>(kWidth)) {
    PyErr_Clear();
    throw std::invalid_argument(std::string(name) +
                                " is neither a file nor an array; expected a TUM trajectory, or "
                                "rows of timestamp tx ty tz qx qy qz qw, shape (N, 8)");
  }
  Trajectory trajectory;
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    const double* const row = rows.data(i, 0);
    const Eigen::Quaterniond turn(row[7], row[4], row[5], row[6]);
    if (!(turn.norm() > 0.0)) {
      throw std::invalid_argument(std::string(name) + "[" + std::to_string(i) +
                                  "] has no quaternion; expected qx qy qz qw");
    }
    StampedPose stamped;
    stamped.timestamp = row[0];
    stamped.pose.linear() = turn.normalized().toRotationMatrix();
    stamped.pose.translation() = Eigen::Vector3d(row[1], row[2], row[3]);
    trajectory.push_back(stamped);
  }
  return trajectory;
}

/// What is wrong with a trajectory is a ValueError, be it the caller's or a file's mistake.
template <class Work>
auto asValueError(const Work& work) {
  try {
    return work();
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const std::runtime_error& error) {
    throw std::invalid_argument(error.what());
  }
}

AteResult ate(const TrajectoryLike& groundtruth, const TrajectoryLike& estimate, double tolerance,
              double offset, evaluate::AlignmentModel alignment) {
  return asValueError([&] {
    const Trajectory truth = trajectoryOf(groundtruth, "groundtruth");
    const Trajectory own = trajectoryOf(estimate, "estimate");
    return unlocked([&] {
      return evaluate::absoluteTrajectoryError(truth, own, {{tolerance, offset}, alignment});
    });
  });
}

RpeResult rpe(const TrajectoryLike& groundtruth, const TrajectoryLike& estimate, double delta,
              evaluate::DeltaUnit delta_unit, double offset, double scale,
              std::optional<double> tolerance) {
  return asValueError([&] {
    const Trajectory truth = trajectoryOf(groundtruth, "groundtruth");
    const Trajectory own = trajectoryOf(estimate, "estimate");
    return unlocked([&] {
      return evaluate::relativePoseError(truth, own, {delta, delta_unit, offset, scale, tolerance});
    });
  });
}

py::array_t<double> rowsOfFile(const PathLike& file) {
  const Trajectory trajectory = asValueError([&] { return readFile(file); });
  py::array_t<double> rows({trajectory.size(), kWidth});
  double* row = rows.mutable_data();
  for (const StampedPose& stamped : trajectory) {
    const Eigen::Quaterniond turn(stamped.pose.linear());
    const Eigen::Vector3d& shift = stamped.pose.translation();
    for (const double value : {stamped.timestamp, shift.x(), shift.y(), shift.z(), turn.x(),
                               turn.y(), turn.z(), turn.w()}) {
      *row++ = value;
    }
  }
  return rows;
}

}  // namespace

void bindEvaluation(py::module_& module) {
  HMCDYN_BIND_RESULT(module, Statistics);
  {
    py::class_<Alignment> type(module, "Alignment", commentOf("Alignment"));
    HMCDYN_FIELDS_Alignment(HMCDYN_READ_ONLY);
    type.def_property_readonly(
        "rotation", [](const Alignment& self) { return toNumpy(PlainMatrix<3, 3>(self.rotation)); },
        "Rotation, (3, 3).");
  }
  HMCDYN_BIND_RESULT(module, AteResult);
  {
    py::class_<RpeResult> type(module, "RpeResult", commentOf("RpeResult"));
    HMCDYN_FIELDS_RpeResult(HMCDYN_READ_ONLY);
  }
  const AteOptions ate_defaults;
  const RpeOptions rpe_defaults;
  module.def("ate", &ate, py::arg("groundtruth"), py::arg("estimate"),
             py::arg("tolerance") = ate_defaults.association.tolerance,
             py::arg("offset") = ate_defaults.association.offset,
             py::arg("alignment") = ate_defaults.alignment, commentOf("absoluteTrajectoryError"));
  module.def("rpe", &rpe, py::arg("groundtruth"), py::arg("estimate"),
             py::arg("delta") = rpe_defaults.delta, py::arg("delta_unit") = rpe_defaults.delta_unit,
             py::arg("offset") = rpe_defaults.offset, py::arg("scale") = rpe_defaults.scale,
             py::arg("tolerance") = py::none(), commentOf("relativePoseError"));
  module.def("read_trajectory", &rowsOfFile, py::arg("file"), commentOf("readNotedTrajectory"));
}

}  // namespace hmcdyn::python
