# SPDX-License-Identifier: BSD-3-Clause
# Dependencies of the library itself; examples, tests and benches ask for theirs where they use them.
# The same versions stand in hmcdynConfig.cmake.in, which asks for them in a user's project.

# Without a version: asked for 3.3, Eigen 5 says that it is another major version, and its headers do.
find_package(Eigen3 REQUIRED NO_MODULE)
if(Eigen3_VERSION VERSION_LESS 3.3)
  message(FATAL_ERROR "hmcdyn: Eigen ${Eigen3_VERSION} in ${Eigen3_DIR} is older than 3.3")
endif()
find_package(nanoflann 1.3 REQUIRED)

# hmcdyn_require(OPTION PACKAGE ARGUMENTS...): a package that one component needs, and the option that
# leaves the component out. A macro, since find_package sets variables that the caller reads.
macro(hmcdyn_require option package)
  find_package(${package} ${ARGN})
  if(NOT ${package}_FOUND)
    message(FATAL_ERROR "hmcdyn: ${package} (${ARGN}) was not found. Install it, name its folder with "
                        "-D${package}_DIR=..., or build without what needs it: -D${option}=OFF")
  endif()
endmacro()

if(HMCDYN_WITH_VISION)
  hmcdyn_require(HMCDYN_WITH_VISION OpenCV 4.2 COMPONENTS core imgproc video calib3d)
endif()
if(HMCDYN_WITH_OPTIMIZATION)
  hmcdyn_require(HMCDYN_WITH_OPTIMIZATION Ceres)
  if(Ceres_VERSION VERSION_LESS 1.14)
    message(FATAL_ERROR "hmcdyn: Ceres ${Ceres_VERSION} is older than 1.14")
  endif()
  # Conan's files for Ceres give the target, but not Ceres' own variable.
  if(NOT CERES_LIBRARIES AND TARGET Ceres::ceres)
    set(CERES_LIBRARIES Ceres::ceres)
  endif()
endif()
