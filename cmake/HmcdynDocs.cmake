# SPDX-License-Identifier: BSD-3-Clause
# Target `docs`: the HTML of the public headers and of docs/, in <build>/docs/html. A warning is an error:
# every public symbol is documented, every link of a document leads somewhere.
find_package(Doxygen 1.9 QUIET)
find_program(HMCDYN_AWK awk)

if(HMCDYN_BUILD_TESTS)
  add_test(NAME docs.parameters COMMAND "${PROJECT_SOURCE_DIR}/tests/docs/parameters_test.sh"
                                        "${PROJECT_SOURCE_DIR}")
  set_tests_properties(docs.parameters PROPERTIES LABELS docs)
endif()

if(NOT DOXYGEN_FOUND OR NOT HMCDYN_AWK)
  message(STATUS "hmcdyn: the target docs builds nothing, since Doxygen (>= 1.9) or awk was not found; "
                 "on Debian: apt-get install doxygen")
  # The target is there and says why it does nothing.
  add_custom_target(
    docs COMMAND ${CMAKE_COMMAND} -E echo "docs: Doxygen (>= 1.9) or awk was not found"
    COMMAND ${CMAKE_COMMAND} -E false
    VERBATIM)
  if(HMCDYN_BUILD_TESTS)
    add_test(NAME docs.html COMMAND ${CMAKE_COMMAND} -E echo
                                    "skipped: Doxygen (>= 1.9) or awk was not found")
    set_tests_properties(docs.html PROPERTIES SKIP_REGULAR_EXPRESSION "skipped" LABELS docs)
  endif()
  return()
endif()

set(HMCDYN_DOCS_DIR "${PROJECT_BINARY_DIR}/docs")
file(GLOB documents CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/docs/*.md")
# A part of benchmarks.md, not a page.
list(REMOVE_ITEM documents "${PROJECT_SOURCE_DIR}/docs/benchmarks_notes.md")
list(PREPEND documents "${PROJECT_SOURCE_DIR}/README.md")
list(APPEND documents "${PROJECT_SOURCE_DIR}/CONTRIBUTING.md" "${PROJECT_SOURCE_DIR}/CHANGELOG.md")
set(public_headers "${PROJECT_SOURCE_DIR}/include/hmcdyn")
file(GLOB headers CONFIGURE_DEPENDS "${public_headers}/*.hpp" "${public_headers}/steps/*.hpp"
     "${public_headers}/votes/*.hpp" "${public_headers}/peers/*.hpp")
list(TRANSFORM documents REPLACE "(.+)" "\"\\1\"" OUTPUT_VARIABLE quoted_documents)
list(TRANSFORM headers REPLACE "(.+)" "\"\\1\"" OUTPUT_VARIABLE quoted_headers)
list(JOIN quoted_documents " " HMCDYN_DOCS_INPUT)
list(JOIN quoted_headers " " quoted_headers)
string(APPEND HMCDYN_DOCS_INPUT " ${quoted_headers}")
configure_file("${PROJECT_SOURCE_DIR}/docs/Doxyfile.in" "${HMCDYN_DOCS_DIR}/Doxyfile" @ONLY)

list(JOIN documents "\n" lines)
file(WRITE "${HMCDYN_DOCS_DIR}/documents.txt" "${lines}\n")
set(build_docs
    ${CMAKE_COMMAND} -DDOXYGEN=${DOXYGEN_EXECUTABLE} -DAWK=${HMCDYN_AWK} -DSOURCE=${PROJECT_SOURCE_DIR}
    -DDOCS=${HMCDYN_DOCS_DIR} -P "${PROJECT_SOURCE_DIR}/cmake/BuildDocs.cmake")
add_custom_target(
  docs
  COMMAND ${build_docs}
  COMMENT "HTML of headers and documents: ${HMCDYN_DOCS_DIR}/html/index.html"
  VERBATIM)
if(HMCDYN_BUILD_TESTS)
  add_test(NAME docs.html COMMAND ${build_docs})
  set_tests_properties(docs.html PROPERTIES LABELS docs)
endif()
