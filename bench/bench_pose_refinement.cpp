// SPDX-License-Identifier: BSD-3-Clause
// One weighted, robust pose refinement (eq. 9-10) against what a user would write: Ceres with one
// residual block a point, ceres::TinySolver over all residuals, cv::solvePnPRefineLM.
//
// 256 inputs in rotation: points all over the image, 1 px of noise, 10 % outliers, a third with
// soft weights. Everyone starts from the same pose and stops within 1e-6 of the lowest cost of its
// own objective, on every input: at start-up each contender is given the loosest tolerance, in half
// powers of ten, that achieves this, and the program ends with a message where none does. The
// objective is eq. 10 with Huber's loss; solvePnPRefineLM knows neither weights nor loss and
// minimises the plain sum; `solvepnp_lm_default` is as users call it, with OpenCV's own criteria.
// All of them solve once, so `hmcdyn` runs with rounds = 1;
// `hmcdyn_rounds` is the default: four rounds with outlier tests, as the SLAM calls it, to the
// default tolerances; `hmcdyn_rounds_ceres_problem` is the same by PoseSolver::kCeresProblem.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <benchmark/benchmark.h>

#include <hmcdyn/pose_refinement.hpp>

#include "pose_contenders.hpp"

namespace {

using hmcdyn::PoseRefinementOptions;
using hmcdyn::bench::PoseInput;

constexpr std::size_t kInputs = 256;
constexpr double kWithin = 1e-6;  // of the lowest cost
const double kHalfDecade = std::sqrt(0.1);

PoseInput makeInput(std::mt19937& random, std::size_t points) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  const auto gaussian = [&](double deviation) {
    const double a = normal(random);
    const double b = normal(random);
    return Eigen::Vector3d(deviation * a, deviation * b, deviation * normal(random));
  };
  const auto motion = [&](double radians, double metres) {
    const Eigen::Vector3d rotation = gaussian(radians);
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::AngleAxisd(rotation.norm(), rotation.normalized()).toRotationMatrix();
    pose.translation() = gaussian(metres);
    return pose;
  };
  PoseInput input;
  const Eigen::Isometry3d truth = motion(0.5, 1.0);
  input.initial = motion(0.01, 0.02) * truth;  // a motion model's error
  for (std::size_t i = 0; i < points; ++i) {
    const double u = 640.0 * uniform(random);
    const double v = 480.0 * uniform(random);
    const double depth = 1.0 + 4.0 * uniform(random);
    const Eigen::Vector3d world = truth.inverse() * input.camera.unproject(u, v, depth);
    const bool outlier = uniform(random) < 0.1;
    input.x.push_back(static_cast<float>(world.x()));
    input.y.push_back(static_cast<float>(world.y()));
    input.z.push_back(static_cast<float>(world.z()));
    input.u.push_back(static_cast<float>(outlier ? 640.0 * uniform(random) : u + normal(random)));
    input.v.push_back(static_cast<float>(outlier ? 480.0 * uniform(random) : v + normal(random)));
    input.weight.push_back(
        uniform(random) < 1.0 / 3.0 ? static_cast<float>(0.1 + 0.9 * uniform(random)) : 1.0f);
  }
  return input;
}

std::vector<PoseInput> makeInputs(std::size_t points) {
  std::mt19937 random(static_cast<unsigned>(points));
  std::vector<PoseInput> inputs;
  for (std::size_t k = 0; k < kInputs; ++k) {
    inputs.push_back(makeInput(random, points));
  }
  return inputs;
}

/// With the workspace that a caller keeps who refines every frame.
class RefineOnce {
 public:
  Eigen::Isometry3d operator()(const PoseInput& input, double tolerance) const {
    PoseRefinementOptions options;
    options.rounds = 1;
    options.plain_rounds = 0;
    options.function_tolerance = tolerance;
    return refinePose(input.view(), input.camera, input.initial, options, *workspace_)
        .camera_from_world;
  }

 private:
  std::shared_ptr<hmcdyn::PoseRefinementWorkspace> workspace_ =
      std::make_shared<hmcdyn::PoseRefinementWorkspace>();
};

/// The cost at a pose of the objective with Huber's loss, or of plain least squares.
using Cost = std::function<double(const PoseInput&, const Eigen::Isometry3d&)>;
/// A pose from an input, stopping at a relative change of the cost.
using Solve = std::function<Eigen::Isometry3d(const PoseInput&, double tolerance)>;

struct Contender {
  const char* name;
  Solve solve;
  Cost cost;
};

std::vector<Contender> contenders() {
  namespace bench = hmcdyn::bench;
  return {{"hmcdyn", RefineOnce(), bench::robustCost},
          {"ceres_full", bench::solveWithCeres, bench::robustCost},
          {"ceres_autodiff", bench::solveWithCeresAutoDiff, bench::robustCost},
          {"tiny_solver", bench::TinySolverOverAllResiduals(), bench::robustCost},
          {"solvepnp_lm",
           [](const PoseInput& input, double tolerance) {
             return bench::solveWithOpenCv(input, tolerance);
           },
           bench::plainCost}};
}

/// The loosest tolerance that is within kWithin of the lowest cost on every input; ends the
/// program where there is none.
double looseTolerance(const Contender& contender, const std::vector<PoseInput>& inputs,
                      const std::vector<double>& lowest) {
  for (double tolerance = 1e-3; tolerance > 1e-13; tolerance *= kHalfDecade) {
    bool all = true;
    for (std::size_t k = 0; k < inputs.size() && all; ++k) {
      const double cost = contender.cost(inputs[k], contender.solve(inputs[k], tolerance));
      all = cost <= (1.0 + kWithin) * lowest[k];
    }
    if (all) {
      return tolerance;
    }
  }
  std::fprintf(stderr, "%s with %zu points: not within %g of the lowest cost at any tolerance\n",
               contender.name, inputs.front().x.size(), kWithin);
  std::exit(EXIT_FAILURE);
}

/// The lowest cost each input can reach: by the yardstick, to the last digits.
std::vector<double> lowestCosts(const std::vector<PoseInput>& inputs, bool robust) {
  PoseRefinementOptions options;
  options.solver = hmcdyn::PoseSolver::kCeresProblem;
  options.loss = robust ? hmcdyn::RobustLoss::kHuber : hmcdyn::RobustLoss::kNone;
  options.rounds = 1;
  options.plain_rounds = 0;
  options.max_iterations = 200;
  options.function_tolerance = 1e-15;
  std::vector<double> lowest;
  for (const PoseInput& input : inputs) {
    hmcdyn::PoseObservations observations = input.view();
    if (!robust) {
      observations.weight = {};
    }
    const auto result = refinePose(observations, input.camera, input.initial, options);
    lowest.push_back(robust ? hmcdyn::bench::robustCost(input, result.camera_from_world)
                            : hmcdyn::bench::plainCost(input, result.camera_from_world));
  }
  return lowest;
}

void registerAll(std::size_t points) {
  const auto inputs = std::make_shared<const std::vector<PoseInput>>(makeInputs(points));
  const std::vector<double> lowest = lowestCosts(*inputs, true);
  const std::vector<double> lowest_plain = lowestCosts(*inputs, false);
  const std::string prefix = "pose/" + std::to_string(points) + "/";
  const auto add = [&](const char* name, auto&& call, const std::string& label) {
    benchmark::RegisterBenchmark((prefix + name).c_str(), [=](benchmark::State& state) {
      std::size_t k = 0;
      for (auto _ : state) {
        benchmark::DoNotOptimize(call((*inputs)[k++ % kInputs]));
      }
      state.SetLabel(label);
    })->Unit(benchmark::kMicrosecond);
  };
  for (const Contender& contender : contenders()) {
    const bool plain = std::string(contender.name) == "solvepnp_lm";
    const double tolerance = looseTolerance(contender, *inputs, plain ? lowest_plain : lowest);
    std::array<char, 32> label{};
    std::snprintf(label.data(), label.size(), "tolerance %.0e", tolerance);
    const Solve solve = contender.solve;
    add(
        contender.name,
        [solve, tolerance](const PoseInput& input) { return solve(input, tolerance); },
        label.data());
  }
  add("solvepnp_lm_default", hmcdyn::bench::solveWithOpenCvDefaults, "OpenCV's own criteria");
  const auto workspace = std::make_shared<hmcdyn::PoseRefinementWorkspace>();
  for (const bool plain : {false, true}) {
    PoseRefinementOptions options;
    options.solver = plain ? hmcdyn::PoseSolver::kCeresProblem : hmcdyn::PoseSolver::kCollapsed;
    add(
        plain ? "hmcdyn_rounds_ceres_problem" : "hmcdyn_rounds",
        [workspace, options](const PoseInput& input) {
          return refinePose(input.view(), input.camera, input.initial, options, *workspace)
              .camera_from_world;
        },
        "four rounds");
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) {
    return EXIT_FAILURE;
  }
  for (const std::size_t points : {50U, 200U, 1000U}) {
    registerAll(points);
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return EXIT_SUCCESS;
}
