# SPDX-License-Identifier: BSD-3-Clause
# The library's targets. Dependencies run downwards only: core <- vision, core <- optimization.

set(HMCDYN_INCLUDE_DIR "${PROJECT_SOURCE_DIR}/include")

# In the order in which a frame's data flows.
set(HMCDYN_CORE_HEADERS span.hpp types.hpp)
set(HMCDYN_VISION_HEADERS)
set(HMCDYN_OPTIMIZATION_HEADERS pose_refinement.hpp)

add_library(hmcdyn_core INTERFACE)
target_include_directories(hmcdyn_core INTERFACE "$<BUILD_INTERFACE:${HMCDYN_INCLUDE_DIR}>")
target_link_libraries(hmcdyn_core INTERFACE Eigen3::Eigen nanoflann::nanoflann)
target_compile_features(hmcdyn_core INTERFACE cxx_std_17)
add_library(hmcdyn::core ALIAS hmcdyn_core)

add_library(hmcdyn_optimization src/pose_refinement.cpp src/pose_refinement_input.cpp
                                src/pose_refinement_solver.cpp)
target_link_libraries(hmcdyn_optimization PUBLIC hmcdyn::core
                                          PRIVATE ${CERES_LIBRARIES} hmcdyn_warnings)
add_library(hmcdyn::optimization ALIAS hmcdyn_optimization)
