# SPDX-License-Identifier: BSD-3-Clause
# Runs the vcpkg port with stand-ins for vcpkg's functions, which do the same with CMake: the options exist,
# what the port moves and copies is where it says. Core alone, which is headers only.
cmake_policy(VERSION 3.22)
set(PORT hmcdyn)
set(FEATURES core)
set(CURRENT_PACKAGES_DIR "${SCRATCH}/package")
file(REMOVE_RECURSE "${SCRATCH}")

macro(vcpkg_check_features)
  cmake_parse_arguments(check "" "OUT_FEATURE_OPTIONS" "FEATURES" ${ARGN})
  set(${check_OUT_FEATURE_OPTIONS})
  set(names ${check_FEATURES})
  while(names)
    list(POP_FRONT names feature option)
    set(value OFF)
    if(feature IN_LIST FEATURES)
      set(value ON)
    endif()
    list(APPEND ${check_OUT_FEATURE_OPTIONS} -D${option}=${value})
  endwhile()
endmacro()

function(vcpkg_cmake_configure)
  cmake_parse_arguments(configure "" "SOURCE_PATH" "OPTIONS" ${ARGN})
  execute_process(
    COMMAND
      ${CMAKE_COMMAND} -S "${configure_SOURCE_PATH}" -B "${SCRATCH}/build" -G "${GENERATOR}"
      -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_INSTALL_PREFIX=${CURRENT_PACKAGES_DIR}
      -DCMAKE_INSTALL_LIBDIR=lib ${configure_OPTIONS} COMMAND_ERROR_IS_FATAL ANY
    ERROR_VARIABLE warnings)
  if(warnings MATCHES "not used by the project")
    message(FATAL_ERROR "the port gives an option that there is not: ${warnings}")
  endif()
endfunction()

function(vcpkg_cmake_install)
  execute_process(COMMAND ${CMAKE_COMMAND} --build "${SCRATCH}/build" --target install
                          COMMAND_ERROR_IS_FATAL ANY)
endfunction()

function(vcpkg_cmake_config_fixup)
  cmake_parse_arguments(fixup "" "PACKAGE_NAME;CONFIG_PATH" "" ${ARGN})
  file(MAKE_DIRECTORY "${CURRENT_PACKAGES_DIR}/share")
  file(RENAME "${CURRENT_PACKAGES_DIR}/${fixup_CONFIG_PATH}"
       "${CURRENT_PACKAGES_DIR}/share/${fixup_PACKAGE_NAME}")
endfunction()

function(vcpkg_fixup_pkgconfig)
  if(NOT EXISTS "${CURRENT_PACKAGES_DIR}/lib/pkgconfig/hmcdyn-core.pc")
    message(FATAL_ERROR "no pkg-config file where vcpkg looks for it")
  endif()
endfunction()

function(vcpkg_install_copyright)
  cmake_parse_arguments(copyright "" "" "FILE_LIST" ${ARGN})
  file(COPY_FILE "${copyright_FILE_LIST}" "${CURRENT_PACKAGES_DIR}/share/${PORT}/copyright")
endfunction()

include("${SOURCE}/packaging/vcpkg/ports/hmcdyn/portfile.cmake")

foreach(file IN ITEMS include/hmcdyn/filter_stage.hpp share/hmcdyn/hmcdynConfig.cmake
                      share/hmcdyn/copyright share/hmcdyn/usage)
  if(NOT EXISTS "${CURRENT_PACKAGES_DIR}/${file}")
    message(FATAL_ERROR "the port did not install ${file}")
  endif()
endforeach()
if(EXISTS "${CURRENT_PACKAGES_DIR}/include/hmcdyn/hmcdyn.hpp")
  message(FATAL_ERROR "core alone installed hmcdyn.hpp, which needs OpenCV and Ceres")
endif()
