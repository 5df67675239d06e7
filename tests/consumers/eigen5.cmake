# SPDX-License-Identifier: BSD-3-Clause
# Configures the library and a user of it where CMake finds an Eigen that says it is 5.0, as Eigen 5 does: not
# compatible with whoever asks for 3.3. And one that says it is 3.2, which is refused with a sentence.
# EIGEN_INCLUDE: folder of the Eigen at hand, whose headers stand in.
file(REMOVE_RECURSE "${SCRATCH}/eigen5")

# write_eigen(VERSION): Eigen3Config.cmake of that version in SCRATCH/eigen5/VERSION.
function(write_eigen version)
  set(folder "${SCRATCH}/eigen5/${version}")
  file(
    WRITE "${folder}/Eigen3Config.cmake"
    "add_library(Eigen3::Eigen INTERFACE IMPORTED)\n"
    "set_target_properties(Eigen3::Eigen PROPERTIES INTERFACE_INCLUDE_DIRECTORIES \"${EIGEN_INCLUDE}\")\n")
  include(CMakePackageConfigHelpers)
  write_basic_package_version_file("${folder}/Eigen3ConfigVersion.cmake" VERSION ${version}
                                   COMPATIBILITY SameMajorVersion ARCH_INDEPENDENT)
endfunction()
write_eigen(5.0.0)
write_eigen(3.2.10)

set(core_alone -DHMCDYN_WITH_VISION=OFF -DHMCDYN_WITH_OPTIMIZATION=OFF -DHMCDYN_BUILD_TESTS=OFF
               -DHMCDYN_BUILD_EXAMPLES=OFF)
set(common -G "${GENERATOR}" -DCMAKE_CXX_COMPILER=${COMPILER})

# took_five(OUT BUILD): whether the Eigen that BUILD was configured with is the stand-in; CMake takes another one
# that it finds where a version does not suit.
function(took_five out build)
  file(STRINGS "${build}/CMakeCache.txt" line REGEX "^Eigen3_DIR:")
  string(FIND "${line}" "${SCRATCH}/eigen5/5.0.0" where)
  if(where EQUAL -1)
    set(${out} FALSE PARENT_SCOPE)
  else()
    set(${out} TRUE PARENT_SCOPE)
  endif()
endfunction()

# The stand-in refuses who asks for 3.3; else this test would show nothing.
file(WRITE "${SCRATCH}/eigen5/asks/CMakeLists.txt"
     "cmake_minimum_required(VERSION 3.22)\nproject(asks LANGUAGES NONE)\nfind_package(Eigen3 3.3 NO_MODULE)\n")
execute_process(
  COMMAND ${CMAKE_COMMAND} -S "${SCRATCH}/eigen5/asks" -B "${SCRATCH}/eigen5/asks_build" -G "${GENERATOR}"
          -DEigen3_DIR=${SCRATCH}/eigen5/5.0.0 OUTPUT_QUIET ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
took_five(five "${SCRATCH}/eigen5/asks_build")
if(five)
  message(FATAL_ERROR "the stand-in for Eigen 5 takes who asks for 3.3")
endif()

# takes_five(FOLDER BUILD OPTION...)
function(takes_five folder build)
  execute_process(COMMAND ${CMAKE_COMMAND} -S "${folder}" -B "${build}" ${common} ${ARGN}
                          -DEigen3_DIR=${SCRATCH}/eigen5/5.0.0 COMMAND_ERROR_IS_FATAL ANY)
  took_five(five "${build}")
  if(NOT five)
    message(FATAL_ERROR "${folder} did not take Eigen 5")
  endif()
endfunction()
takes_five("${SOURCE}" "${SCRATCH}/eigen5/build" ${core_alone})
execute_process(COMMAND ${CMAKE_COMMAND} --install "${SCRATCH}/eigen5/build" --prefix
                        "${SCRATCH}/eigen5/installed" COMMAND_ERROR_IS_FATAL ANY)
takes_five("${CMAKE_CURRENT_LIST_DIR}/core" "${SCRATCH}/eigen5/user"
           -DCMAKE_PREFIX_PATH=${SCRATCH}/eigen5/installed)

# too_old(FOLDER OPTION...): configuring fails and says why.
function(too_old folder)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -S "${folder}" -B "${SCRATCH}/eigen5/old_build" ${common} ${ARGN}
            -DEigen3_DIR=${SCRATCH}/eigen5/3.2.10
    RESULT_VARIABLE failed ERROR_VARIABLE error OUTPUT_QUIET)
  file(REMOVE_RECURSE "${SCRATCH}/eigen5/old_build")
  if(NOT failed OR NOT error MATCHES "older[ \n]+than[ \n]+3\\.3")
    message(FATAL_ERROR "${folder} with Eigen 3.2.10: exit ${failed}, ${error}")
  endif()
endfunction()
too_old("${SOURCE}" ${core_alone})
too_old("${CMAKE_CURRENT_LIST_DIR}/core" -DCMAKE_PREFIX_PATH=${SCRATCH}/eigen5/installed)
