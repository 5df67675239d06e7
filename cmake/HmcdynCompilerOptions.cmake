# SPDX-License-Identifier: BSD-3-Clause
# Flags for our own translation units. Nothing here reaches a user of the library.

# Programs and tests are half of what is compiled and little of what runs: sanitized builds do not optimise
# them.
set(HMCDYN_EXECUTABLE_COMPILE_OPTIONS "" CACHE STRING
    "Compile options for programs and tests, after the build type's, e.g. -O0")
separate_arguments(HMCDYN_EXECUTABLE_COMPILE_OPTIONS)

add_library(hmcdyn_warnings INTERFACE)
target_compile_options(
  hmcdyn_warnings
  INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
            $<$<BOOL:${HMCDYN_WARNINGS_AS_ERRORS}>:-Werror>
            "$<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:${HMCDYN_EXECUTABLE_COMPILE_OPTIONS}>")

if(HMCDYN_SANITIZE)
  if(HMCDYN_SANITIZE MATCHES "thread" AND HMCDYN_SANITIZE MATCHES "address")
    message(FATAL_ERROR "HMCDYN_SANITIZE=${HMCDYN_SANITIZE}: thread and address exclude each other")
  endif()
  add_compile_options(-fsanitize=${HMCDYN_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${HMCDYN_SANITIZE})
  # With these checks, one before every access, compiling takes half as long again, and AddressSanitizer finds
  # most of what they find. The fuzzers have them all.
  if(HMCDYN_SANITIZE MATCHES "undefined" AND NOT HMCDYN_BUILD_FUZZERS)
    add_compile_options(-fno-sanitize=null,alignment,object-size,vptr)
  endif()
endif()

# What a fuzzer tests tells it which branches were taken.
if(HMCDYN_BUILD_FUZZERS)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()
