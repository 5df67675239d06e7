# SPDX-License-Identifier: BSD-3-Clause
# What `cmake --install` writes: headers, libraries, CMake and pkg-config files, and the programs.
# Installation components: core_dev (headers only), dev (the compiled rest), tools.
include(CMakePackageConfigHelpers)

set(HMCDYN_CMAKE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/hmcdyn")

# Headers of components that were not built stay out.
set(left_out)
if(NOT HMCDYN_WITH_VISION)
  list(APPEND left_out ${HMCDYN_VISION_HEADERS} hmcdyn.hpp)
endif()
if(NOT HMCDYN_WITH_OPTIMIZATION)
  list(APPEND left_out ${HMCDYN_OPTIMIZATION_HEADERS} hmcdyn.hpp)
endif()
set(not_core)
foreach(header IN LISTS HMCDYN_VISION_HEADERS HMCDYN_OPTIMIZATION_HEADERS ITEMS hmcdyn.hpp)
  list(APPEND not_core PATTERN "${header}" EXCLUDE)
  if(NOT header IN_LIST left_out)
    get_filename_component(folder "${header}" DIRECTORY)
    install(FILES "${HMCDYN_INCLUDE_DIR}/hmcdyn/${header}"
            DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/hmcdyn/${folder}" COMPONENT dev)
  endif()
endforeach()
install(
  DIRECTORY "${HMCDYN_INCLUDE_DIR}/hmcdyn"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}"
  COMPONENT core_dev
  FILES_MATCHING
  PATTERN "*.hpp"
  ${not_core})

# One export file a component, so that a package with core alone is whole.
foreach(component IN LISTS HMCDYN_COMPONENTS)
  set(part dev)
  if(component STREQUAL "core")
    set(part core_dev)
  endif()
  install(
    TARGETS hmcdyn_${component}
    EXPORT hmcdyn-${component}
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT ${part}
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT ${part})
  install(
    EXPORT hmcdyn-${component}
    NAMESPACE hmcdyn::
    FILE hmcdyn-${component}-targets.cmake
    DESTINATION "${HMCDYN_CMAKE_DIR}"
    COMPONENT ${part})
endforeach()

configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/cmake/hmcdynConfig.cmake.in" "${PROJECT_BINARY_DIR}/hmcdynConfig.cmake"
  INSTALL_DESTINATION "${HMCDYN_CMAKE_DIR}"
  NO_SET_AND_CHECK_MACRO)
# ARCH_INDEPENDENT: with core alone there is nothing compiled.
set(arch_independent)
if(HMCDYN_COMPONENTS STREQUAL "core")
  set(arch_independent ARCH_INDEPENDENT)
endif()
write_basic_package_version_file("${PROJECT_BINARY_DIR}/hmcdynConfigVersion.cmake"
                                 COMPATIBILITY SameMinorVersion ${arch_independent})
install(
  FILES "${PROJECT_BINARY_DIR}/hmcdynConfig.cmake" "${PROJECT_BINARY_DIR}/hmcdynConfigVersion.cmake"
  DESTINATION "${HMCDYN_CMAKE_DIR}"
  COMPONENT core_dev)

include(HmcdynPkgConfig)

install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/README.md"
        DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/hmcdyn" COMPONENT core_dev)

set(HMCDYN_TOOLS hmcdyn_slam hmcdyn_evaluate hmcdyn_synthesize hmcdyn_label_score hmcdyn_mask
                 hmcdyn_mask_score hmcdyn_map_score hmcdyn_tables hmcdyn_calibrate_depth)
if(HMCDYN_BUILD_EXAMPLES AND HMCDYN_COMPLETE)
  install(TARGETS ${HMCDYN_TOOLS} RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT tools)
endif()

if(HMCDYN_TOP_LEVEL)
  include(HmcdynPackage)
endif()
