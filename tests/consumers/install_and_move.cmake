# SPDX-License-Identifier: BSD-3-Clause
# Installs the library from BUILD and moves the tree, so that a path written at build time shows.
# Not all of SCRATCH: other tests build in it at the same time.
file(REMOVE_RECURSE "${SCRATCH}/first" "${SCRATCH}/moved")
foreach(component IN ITEMS core_dev dev)
  execute_process(COMMAND ${CMAKE_COMMAND} --install "${BUILD}" --prefix "${SCRATCH}/first"
                          --component ${component} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(RENAME "${SCRATCH}/first" "${SCRATCH}/moved")

file(GLOB_RECURSE texts "${SCRATCH}/moved/*.cmake" "${SCRATCH}/moved/*.pc")
foreach(text IN LISTS texts)
  file(READ "${text}" content)
  string(FIND "${content}" "${BUILD}" where)
  if(NOT where EQUAL -1)
    message(FATAL_ERROR "${text} names the build folder ${BUILD}")
  endif()
endforeach()
