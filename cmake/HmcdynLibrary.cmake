# SPDX-License-Identifier: BSD-3-Clause
# The library's targets. Dependencies run downwards only: core <- vision, core <- optimization.

set(HMCDYN_INCLUDE_DIR "${PROJECT_SOURCE_DIR}/include")

# In the order in which a frame's data flows.
set(HMCDYN_CORE_HEADERS
    span.hpp
    types.hpp
    epipolar.hpp
    ego_motion.hpp
    box_dynamism.hpp
    clustering.hpp
    cluster_filter.hpp
    weights.hpp
    peer_rules.hpp
    filter_stage.hpp
    surface_depth.hpp
    motion_belief.hpp
    detail/bit_set_clusters.hpp
    detail/bits.hpp
    detail/clustering_result.hpp
    detail/grid.hpp
    detail/grid_clusters.hpp
    detail/kd_tree.hpp
    detail/kd_tree_clusters.hpp
    detail/minkowski.hpp
    detail/planar_points.hpp
    detail/union_find.hpp)
set(HMCDYN_VISION_HEADERS optical_flow.hpp fundamental.hpp dynamic_feature_filter.hpp)
set(HMCDYN_OPTIMIZATION_HEADERS pose_refinement.hpp)

add_library(hmcdyn_core INTERFACE)
target_include_directories(hmcdyn_core INTERFACE "$<BUILD_INTERFACE:${HMCDYN_INCLUDE_DIR}>")
target_link_libraries(hmcdyn_core INTERFACE Eigen3::Eigen nanoflann::nanoflann)
target_compile_features(hmcdyn_core INTERFACE cxx_std_17)
add_library(hmcdyn::core ALIAS hmcdyn_core)

add_library(hmcdyn_vision src/optical_flow.cpp src/eight_point.cpp src/flow_selection.cpp src/fundamental.cpp
                          src/dynamic_feature_filter.cpp)
target_link_libraries(
  hmcdyn_vision
  PUBLIC hmcdyn_core opencv_core
  PRIVATE opencv_imgproc opencv_video opencv_calib3d hmcdyn_warnings)
add_library(hmcdyn::vision ALIAS hmcdyn_vision)

add_library(
  hmcdyn_optimization
  src/pose_refinement.cpp src/pose_refinement_collapsed.cpp src/pose_refinement_input.cpp
  src/pose_refinement_kernel.cpp src/pose_refinement_plain.cpp src/pose_refinement_solver.cpp)
# The square root as one instruction: errno is not read. Sums keep the order that is written.
set_source_files_properties(src/pose_refinement_kernel.cpp PROPERTIES COMPILE_OPTIONS -fno-math-errno)
target_link_libraries(hmcdyn_optimization PUBLIC hmcdyn::core
                                          PRIVATE ${CERES_LIBRARIES} hmcdyn_warnings)
add_library(hmcdyn::optimization ALIAS hmcdyn_optimization)

# The whole library; hmcdyn.hpp includes all of it.
add_library(hmcdyn INTERFACE)
target_link_libraries(hmcdyn INTERFACE hmcdyn_core hmcdyn_vision hmcdyn_optimization)
add_library(hmcdyn::hmcdyn ALIAS hmcdyn)
