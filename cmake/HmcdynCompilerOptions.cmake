# SPDX-License-Identifier: BSD-3-Clause
# Flags for our own translation units. Nothing here reaches a user of the library.

# Programs and tests are half of what is compiled and little of what runs: sanitized builds do not optimise
# them, but for the few that compute for long (target property HMCDYN_OPTIMISED).
set(HMCDYN_EXECUTABLE_COMPILE_OPTIONS "" CACHE STRING
    "Compile options for programs and tests, after the build type's, e.g. -O0")
separate_arguments(HMCDYN_EXECUTABLE_COMPILE_OPTIONS)

set(is_program "$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>")
set(is_optimised "$<BOOL:$<TARGET_PROPERTY:HMCDYN_OPTIMISED>>")
add_library(hmcdyn_warnings INTERFACE)
target_compile_options(
  hmcdyn_warnings
  INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
            $<$<BOOL:${HMCDYN_WARNINGS_AS_ERRORS}>:-Werror>
            "$<$<AND:${is_program},$<NOT:${is_optimised}>>:${HMCDYN_EXECUTABLE_COMPILE_OPTIONS}>")

# What is compiled and linked stays the same; what the caller has chosen stays, too.
option(HMCDYN_QUICK_BUILD
       "Use mold (tests) and ccache where installed; g++ takes 1.5 GB instead of collecting garbage" OFF)
if(HMCDYN_QUICK_BUILD)
  include(CheckLinkerFlag)
  check_linker_flag(CXX -fuse-ld=mold HMCDYN_HAS_MOLD) # g++ knows it from version 12 on
  if(HMCDYN_HAS_MOLD)
    # Not for what users build: mold does not mind the order of libraries, their linker may.
    set(HMCDYN_TEST_LINK_OPTIONS -fuse-ld=mold)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options("SHELL:--param ggc-min-heapsize=2000000")
  endif()
  find_program(HMCDYN_CCACHE ccache)
  if(HMCDYN_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    # It asks more of whoever uses precompiled headers: the build presets' environment, and of clang this.
    set(CMAKE_CXX_COMPILER_LAUNCHER "${HMCDYN_CCACHE}")
    if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
      add_compile_options("SHELL:-Xclang -fno-pch-timestamp")
    endif()
  endif()
endif()

if(HMCDYN_SANITIZE)
  if(HMCDYN_SANITIZE MATCHES "thread" AND HMCDYN_SANITIZE MATCHES "address")
    message(FATAL_ERROR "HMCDYN_SANITIZE=${HMCDYN_SANITIZE}: thread and address exclude each other")
  endif()
  add_compile_options(-fsanitize=${HMCDYN_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${HMCDYN_SANITIZE})
  # With these checks, one before every access, compiling takes half as long again, and AddressSanitizer finds
  # most of what they find. The fuzzers, and what they test, have them all (hmcdyn_fuzzed).
  set(HMCDYN_COSTLY_CHECKS null,alignment,object-size,vptr)
  if(HMCDYN_SANITIZE MATCHES "undefined")
    add_compile_options(-fno-sanitize=${HMCDYN_COSTLY_CHECKS})
  endif()
endif()
