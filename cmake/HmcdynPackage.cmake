# SPDX-License-Identifier: BSD-3-Clause
# `cpack -G DEB` in the build folder: the Debian packages. hmcdyn-tools: the programs;
# libhmcdyn-core-dev: the headers of core, without OpenCV or Ceres; libhmcdyn-dev: all the rest; where it is built,
# python3-hmcdyn: the Python module.

set(CPACK_PACKAGE_NAME hmcdyn)
set(CPACK_PACKAGE_VENDOR "The hmcdyn authors")
set(HMCDYN_PACKAGE_MAINTAINER "The hmcdyn authors <hmcdyn@localhost>"
    CACHE STRING "Maintainer of the Debian packages: Name <address>; the default reaches nobody")
set(CPACK_PACKAGE_CONTACT "${HMCDYN_PACKAGE_MAINTAINER}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL core_dev)
if(HMCDYN_WITH_VISION OR HMCDYN_WITH_OPTIMIZATION)
  list(APPEND CPACK_COMPONENTS_ALL dev)
endif()
if(HMCDYN_BUILD_EXAMPLES AND HMCDYN_COMPLETE)
  list(APPEND CPACK_COMPONENTS_ALL tools)
endif()

if(TARGET hmcdyn_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()

set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)

set(CPACK_COMPONENT_CORE_DEV_DESCRIPTION "Headers of hmcdyn's core")
set(CPACK_DEBIAN_CORE_DEV_PACKAGE_NAME libhmcdyn-core-dev)
set(CPACK_DEBIAN_CORE_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_CORE_DEV_PACKAGE_DEPENDS "libeigen3-dev (>= 3.3), libnanoflann-dev (>= 1.3)")

set(dev_depends "libhmcdyn-core-dev (= ${PROJECT_VERSION})")
if(HMCDYN_WITH_VISION)
  string(APPEND dev_depends ", libopencv-dev (>= 4.2)")
endif()
if(HMCDYN_WITH_OPTIMIZATION)
  string(APPEND dev_depends ", libceres-dev (>= 1.14)")
endif()
set(CPACK_COMPONENT_DEV_DESCRIPTION "hmcdyn's vision and optimization: libraries and headers")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libhmcdyn-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "${dev_depends}")

set(CPACK_COMPONENT_TOOLS_DESCRIPTION "RGB-D SLAM, its evaluation and rendered sequences")
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME hmcdyn-tools)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOLS_PACKAGE_SHLIBDEPS ON)

set(CPACK_COMPONENT_PYTHON_DESCRIPTION "hmcdyn's Python module")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-hmcdyn)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/packaging/debian/python/postinst"
                                              "${PROJECT_SOURCE_DIR}/packaging/debian/python/prerm")
if(TARGET hmcdyn_python)
  string(REPLACE "." ";" version "${HMCDYN_PYTHON_VERSION}")
  list(GET version 0 major)
  list(GET version 1 minor)
  math(EXPR next "${minor} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= ${major}.${minor}~), python3 (<< ${major}.${next}~), python3-numpy")
endif()

include(CPack)
