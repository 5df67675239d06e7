# SPDX-License-Identifier: BSD-3-Clause
# The library's targets. Dependencies run downwards only: core <- vision, core <- optimization.

set(HMCDYN_INCLUDE_DIR "${PROJECT_SOURCE_DIR}/include")

# In the order in which a frame's data flows.
set(HMCDYN_CORE_HEADERS
    version.hpp
    span.hpp
    types.hpp
    plain_matrix.hpp
    pose.hpp
    steps/epipolar.hpp
    steps/ego_motion.hpp
    steps/box_dynamism.hpp
    regions.hpp
    steps/clustering.hpp
    steps/cluster_filter.hpp
    steps/weights.hpp
    peers/peer_rules.hpp
    filter_stage.hpp
    depth_error.hpp
    votes/surface_depth.hpp
    votes/motion_belief.hpp
    votes/belief_verdict.hpp
    detail/bit_set_clusters.hpp
    detail/bits.hpp
    detail/clustering_result.hpp
    detail/grid.hpp
    detail/grid_clusters.hpp
    detail/kd_tree.hpp
    detail/kd_tree_clusters.hpp
    detail/laned_sum.hpp
    detail/minkowski.hpp
    detail/planar_points.hpp
    detail/requirements.hpp
    detail/union_find.hpp)
set(HMCDYN_VISION_HEADERS
    steps/box_carrier.hpp
    steps/optical_flow.hpp
    steps/fundamental.hpp
    label_image.hpp
    motion_mask.hpp
    dynamic_feature_filter.hpp
    compact.hpp
    frame_filter.hpp)
set(HMCDYN_OPTIMIZATION_HEADERS pose_refinement.hpp)

# The compiled components see Eigen by another name: no function of theirs that works on Eigen's types has the
# name of one in a user's program, where the linker would take the user's copy for both. That one may have been
# compiled with other flags, under which Eigen expects another alignment and frees memory in another way. Nothing
# in the interface of these components is Eigen's. Tests of what lies below it need the name, too.
set(HMCDYN_EIGEN_OF_THE_LIBRARY Eigen=hmcdyn_eigen)

# hmcdyn_component(NAME TARGET): what every component's target shares, built or installed.
function(hmcdyn_component name target)
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  add_library(hmcdyn::${name} ALIAS ${target})
  get_target_property(type ${target} TYPE)
  if(NOT type STREQUAL "INTERFACE_LIBRARY")
    # While the version is 0.x, every minor version may break the binary interface.
    set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON VERSION ${PROJECT_VERSION}
                          SOVERSION "${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")
  endif()
endfunction()

add_library(hmcdyn_core INTERFACE)
target_include_directories(hmcdyn_core INTERFACE "$<BUILD_INTERFACE:${HMCDYN_INCLUDE_DIR}>"
                                                 "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
target_link_libraries(hmcdyn_core INTERFACE Eigen3::Eigen nanoflann::nanoflann)
target_compile_features(hmcdyn_core INTERFACE cxx_std_17)
hmcdyn_component(core hmcdyn_core)
set(HMCDYN_COMPONENTS core)

if(HMCDYN_WITH_VISION)
  add_library(
    hmcdyn_vision
    src/flow/optical_flow.cpp src/flow/flow_selection.cpp
    src/two_view/eight_point.cpp src/two_view/fundamental.cpp src/two_view/camera_motion.cpp
    src/regions/label_image.cpp src/regions/frame_regions.cpp
    src/mask/coupling.cpp src/mask/departure.cpp src/mask/depth_history.cpp src/mask/evidence.cpp
    src/mask/motion_mask.cpp src/mask/named.cpp src/mask/options.cpp src/mask/small_frame.cpp
    src/mask/smoothing.cpp src/mask/surface_tolerance.cpp src/mask/thing_motion.cpp
    src/mask/things.cpp src/mask/whole_mask.cpp
    src/frame_filter/box_carrier.cpp src/frame_filter/comparison.cpp
    src/frame_filter/decision.cpp src/frame_filter/dynamic_feature_filter.cpp
    src/frame_filter/features.cpp src/frame_filter/filter_steps.cpp
    src/frame_filter/frame_camera.cpp src/frame_filter/frame_filter.cpp
    src/frame_filter/history.cpp src/frame_filter/input.cpp src/frame_filter/mask_verdict.cpp
    src/frame_filter/memory.cpp src/frame_filter/options.cpp)
  target_include_directories(hmcdyn_vision PRIVATE "${PROJECT_SOURCE_DIR}/src")
  target_link_libraries(
    hmcdyn_vision
    PUBLIC hmcdyn_core opencv_core
    PRIVATE opencv_imgproc opencv_video opencv_calib3d $<BUILD_INTERFACE:hmcdyn_warnings>)
  target_compile_definitions(hmcdyn_vision PRIVATE ${HMCDYN_EIGEN_OF_THE_LIBRARY})
  hmcdyn_component(vision hmcdyn_vision)
  list(APPEND HMCDYN_COMPONENTS vision)
endif()

if(HMCDYN_WITH_OPTIMIZATION)
  add_library(
    hmcdyn_optimization
    src/pose/pose_refinement.cpp src/pose/collapsed.cpp src/pose/input.cpp
    src/pose/kernel.cpp src/pose/plain.cpp src/pose/solver.cpp)
  # The square root as one instruction: errno is not read. Sums keep the order that is written.
  set_source_files_properties(
    src/pose/collapsed.cpp src/pose/kernel.cpp
    PROPERTIES COMPILE_OPTIONS -fno-math-errno)
  target_link_libraries(
    hmcdyn_optimization
    PUBLIC hmcdyn_core
    PRIVATE ${CERES_LIBRARIES} $<BUILD_INTERFACE:hmcdyn_warnings>)
  target_include_directories(hmcdyn_optimization PRIVATE "${PROJECT_SOURCE_DIR}/src")
  target_compile_definitions(hmcdyn_optimization PRIVATE ${HMCDYN_EIGEN_OF_THE_LIBRARY})
  hmcdyn_component(optimization hmcdyn_optimization)
  list(APPEND HMCDYN_COMPONENTS optimization)
endif()

# All that was built; hmcdyn.hpp includes all there is, and so needs every component.
add_library(hmcdyn INTERFACE)
foreach(component IN LISTS HMCDYN_COMPONENTS)
  target_link_libraries(hmcdyn INTERFACE hmcdyn_${component})
endforeach()
hmcdyn_component(hmcdyn hmcdyn)
