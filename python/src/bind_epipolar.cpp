// SPDX-License-Identifier: BSD-3-Clause
// epipolar.hpp, ego_motion.hpp
#include <hmcdyn/steps/ego_motion.hpp>
#include <hmcdyn/steps/epipolar.hpp>

#include "bindings.hpp"
#include "key_points.hpp"
#include "structs.hpp"

namespace hmcdyn::python {

void bindEpipolar(py::module_& module) {
  HMCDYN_BIND_RESULT(module, TwoViewModel);
  HMCDYN_BIND_OPTIONS(module, EgoMotionOptions);

  module.def(
      "fundamental_of_motion",
      [](const PinholeCamera& camera, const ArrayLike& current_from_earlier) {
        const Eigen::Isometry3d motion = motionOf(current_from_earlier, "current_from_earlier");
        return toNumpy(PlainMatrix<3, 3>(fundamentalOfMotion(camera, motion)));
      },
      py::arg("camera"), py::arg("current_from_earlier"), commentOf("fundamentalOfMotion"));
  module.def(
      "model_of_motion",
      [](const PinholeCamera& camera, const ArrayLike& current_from_earlier, double min_parallax) {
        return modelOfMotion(camera, motionOf(current_from_earlier, "current_from_earlier"),
                             min_parallax);
      },
      py::arg("camera"), py::arg("current_from_earlier"), py::arg("min_parallax") = 0.1,
      commentOf("modelOfMotion"));
  module.def(
      "epipolar_distances",
      [](const ArrayLike& fundamental, const ArrayLike& earlier_u, const ArrayLike& earlier_v,
         const ArrayLike& current_u, const ArrayLike& current_v) {
        const Eigen::Matrix3d matrix = matrix3Of(fundamental, "fundamental");
        const PairColumns pairs(earlier_u, earlier_v, current_u, current_v);
        return toNumpy(unlocked([&] { return epipolarDistances(matrix, pairs.view()); }));
      },
      py::arg("fundamental"), py::arg("earlier_u"), py::arg("earlier_v"), py::arg("current_u"),
      py::arg("current_v"), commentOf("epipolarDistances"));
  module.def(
      "transfer_distances",
      [](const ArrayLike& homography, const ArrayLike& earlier_u, const ArrayLike& earlier_v,
         const ArrayLike& current_u, const ArrayLike& current_v) {
        const Eigen::Matrix3d matrix = matrix3Of(homography, "homography");
        const PairColumns pairs(earlier_u, earlier_v, current_u, current_v);
        return toNumpy(unlocked([&] { return transferDistances(matrix, pairs.view()); }));
      },
      py::arg("homography"), py::arg("earlier_u"), py::arg("earlier_v"), py::arg("current_u"),
      py::arg("current_v"), commentOf("transferDistances"));
  module.def(
      "model_distances",
      [](const TwoViewModel& model, const ArrayLike& earlier_u, const ArrayLike& earlier_v,
         const ArrayLike& current_u, const ArrayLike& current_v) {
        const PairColumns pairs(earlier_u, earlier_v, current_u, current_v);
        return toNumpy(unlocked([&] { return modelDistances(model, pairs.view()); }));
      },
      py::arg("model"), py::arg("earlier_u"), py::arg("earlier_v"), py::arg("current_u"),
      py::arg("current_v"), commentOf("modelDistances"));
  module.def(
      "ego_motion_distances",
      [](const PinholeCamera& camera, const ArrayLike& current_from_earlier,
         const ArrayLike& earlier_u, const ArrayLike& earlier_v, const ArrayLike& current_u,
         const ArrayLike& current_v, const ArrayLike& earlier_depth, const ArrayLike& current_depth,
         const OptionsOf<EgoMotionOptions>& options, const py::kwargs& fields) {
        const Eigen::Isometry3d motion = motionOf(current_from_earlier, "current_from_earlier");
        const PairColumns pairs(earlier_u, earlier_v, current_u, current_v);
        const auto before = column<float>(earlier_depth, "earlier_depth");
        const auto now = column<float>(current_depth, "current_depth");
        const auto own = optionsFrom<EgoMotionOptions>(options, fields);
        return toNumpy(unlocked([&] {
          return egoMotionDistances(camera, motion, pairs.view(), before.values, now.values, own);
        }));
      },
      py::arg("camera"), py::arg("current_from_earlier"), py::arg("earlier_u"),
      py::arg("earlier_v"), py::arg("current_u"), py::arg("current_v"), py::arg("earlier_depth"),
      py::arg("current_depth"), py::arg("options") = py::none(), commentOf("egoMotionDistances"));
}

}  // namespace hmcdyn::python
