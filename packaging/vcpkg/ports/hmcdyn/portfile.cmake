# SPDX-License-Identifier: BSD-3-Clause
# An overlay port: it builds the source tree that it lies in. A registry's port names an archive instead
# (vcpkg_from_github) and is the same from there on.
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../../../.." ABSOLUTE)

vcpkg_check_features(
  OUT_FEATURE_OPTIONS FEATURE_OPTIONS
  FEATURES vision HMCDYN_WITH_VISION
           optimization HMCDYN_WITH_OPTIMIZATION)

# Core alone is headers only.
if(NOT "vision" IN_LIST FEATURES AND NOT "optimization" IN_LIST FEATURES)
  set(VCPKG_BUILD_TYPE release)
endif()

vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS ${FEATURE_OPTIONS}
          -DHMCDYN_BUILD_EXAMPLES=OFF
          -DHMCDYN_BUILD_TESTS=OFF
          -DHMCDYN_BUILD_BENCHMARKS=OFF
          -DHMCDYN_INSTALL=ON)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(PACKAGE_NAME hmcdyn CONFIG_PATH lib/cmake/hmcdyn)
vcpkg_fixup_pkgconfig()

file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share"
     "${CURRENT_PACKAGES_DIR}/share/doc")
file(INSTALL "${CMAKE_CURRENT_LIST_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
