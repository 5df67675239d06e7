# SPDX-License-Identifier: BSD-3-Clause
# Every manifest has the version of include/hmcdyn/version.hpp, and is JSON; so has the citation, which is YAML.
foreach(manifest IN ITEMS vcpkg.json packaging/vcpkg/ports/hmcdyn/vcpkg.json)
  file(READ "${SOURCE}/${manifest}" text)
  string(JSON version GET "${text}" version)
  if(NOT version STREQUAL VERSION)
    message(FATAL_ERROR "${manifest} has the version ${version}; expected ${VERSION}")
  endif()
endforeach()

file(STRINGS "${SOURCE}/CITATION.cff" line REGEX "^version: ")
if(NOT line STREQUAL "version: ${VERSION}")
  message(FATAL_ERROR "CITATION.cff has the line '${line}'; expected 'version: ${VERSION}'")
endif()
