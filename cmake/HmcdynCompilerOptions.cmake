# SPDX-License-Identifier: BSD-3-Clause
# Flags for our own translation units. Nothing here reaches a user of the library.

add_library(hmcdyn_warnings INTERFACE)
target_compile_options(
  hmcdyn_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                            $<$<BOOL:${HMCDYN_WARNINGS_AS_ERRORS}>:-Werror>)

if(HMCDYN_SANITIZE)
  if(HMCDYN_SANITIZE MATCHES "thread" AND HMCDYN_SANITIZE MATCHES "address")
    message(FATAL_ERROR "HMCDYN_SANITIZE=${HMCDYN_SANITIZE}: thread and address exclude each other")
  endif()
  add_compile_options(-fsanitize=${HMCDYN_SANITIZE} -fno-omit-frame-pointer
                      -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${HMCDYN_SANITIZE})
  # g++ takes far longer to compile with these checks, one before every access, and AddressSanitizer finds
  # most of what they find. clang++ is quick at them: the fuzzers have them all.
  if(HMCDYN_SANITIZE MATCHES "undefined" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-fno-sanitize=null,alignment,object-size,vptr)
  endif()
endif()

# What a fuzzer tests tells it which branches were taken.
if(HMCDYN_BUILD_FUZZERS)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()
