# SPDX-License-Identifier: BSD-3-Clause
# Configures, builds and installs core where CMake can see neither OpenCV nor Ceres.
file(REMOVE_RECURSE "${SCRATCH}/core_only_build" "${SCRATCH}/core_only")
execute_process(
  COMMAND
    ${CMAKE_COMMAND} -S "${SOURCE}" -B "${SCRATCH}/core_only_build" -G "${GENERATOR}"
    -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_DISABLE_FIND_PACKAGE_OpenCV=ON
    -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON -DHMCDYN_WITH_VISION=OFF -DHMCDYN_WITH_OPTIMIZATION=OFF
    -DHMCDYN_BUILD_TESTS=OFF COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build "${SCRATCH}/core_only_build" COMMAND_ERROR_IS_FATAL
                        ANY)
execute_process(COMMAND "${SCRATCH}/core_only_build/bin/01_arrays_in_labels_out"
                        COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --install "${SCRATCH}/core_only_build" --prefix
                        "${SCRATCH}/core_only" COMMAND_ERROR_IS_FATAL ANY)
foreach(header IN ITEMS hmcdyn.hpp steps/optical_flow.hpp pose_refinement.hpp)
  if(EXISTS "${SCRATCH}/core_only/include/hmcdyn/${header}")
    message(FATAL_ERROR "core alone installed ${header}, which it cannot compile")
  endif()
endforeach()
