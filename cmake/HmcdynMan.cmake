# SPDX-License-Identifier: BSD-3-Clause
# Target `man`: a manual page for each program, from its own --help, built with everything else and
# installed with the tools. The same for completion, which asks --help at run time.
include(GNUInstallDirs)
find_program(HMCDYN_AWK awk)

set(HMCDYN_MAN_PAGES)
# hmcdyn_man_page(PROGRAM SUMMARY [COMMAND])
function(hmcdyn_man_page program summary)
  set(name ${program})
  if(ARGN)
    set(name ${program}-${ARGN})
  endif()
  set(page "${PROJECT_BINARY_DIR}/man/${name}.1")
  add_custom_command(
    OUTPUT "${page}"
    COMMAND
      ${CMAKE_COMMAND} -DPROGRAM=$<TARGET_FILE:${program}> "-DCOMMAND=${ARGN}" -DNAME=${name}
      "-DSUMMARY=${summary}" -DVERSION=${PROJECT_VERSION} -DAWK=${HMCDYN_AWK}
      "-DSCRIPT=${PROJECT_SOURCE_DIR}/cmake/help_to_man.awk" "-DOUTPUT=${page}" -P
      "${PROJECT_SOURCE_DIR}/cmake/WriteManPage.cmake"
    DEPENDS ${program} "${PROJECT_SOURCE_DIR}/cmake/help_to_man.awk"
            "${PROJECT_SOURCE_DIR}/cmake/WriteManPage.cmake"
    VERBATIM)
  set(HMCDYN_MAN_PAGES ${HMCDYN_MAN_PAGES} "${page}" PARENT_SCOPE)
endfunction()

if(HMCDYN_AWK AND NOT CMAKE_CROSSCOMPILING)
  hmcdyn_man_page(hmcdyn_slam "RGB-D SLAM for dynamic scenes")
  hmcdyn_man_page(hmcdyn_evaluate "compare camera trajectories with the ground truth")
  hmcdyn_man_page(hmcdyn_evaluate "absolute trajectory error" ate)
  hmcdyn_man_page(hmcdyn_evaluate "relative pose error" rpe)
  hmcdyn_man_page(hmcdyn_evaluate "both errors and the tracking rate" summary)
  hmcdyn_man_page(hmcdyn_synthesize "render dynamic RGB-D sequences with exact ground truth")
  hmcdyn_man_page(hmcdyn_label_score "score labels of key points against masks")
  hmcdyn_man_page(hmcdyn_mask "write masks of what moves for an RGB-D recording")
  hmcdyn_man_page(hmcdyn_mask_score "score masks of what moves against true ones")
  hmcdyn_man_page(hmcdyn_map_score "score a dense map against a rendered sequence")
  hmcdyn_man_page(hmcdyn_tables "write the tables of the HMC-SLAM paper from runs")
  hmcdyn_man_page(hmcdyn_calibrate_depth "measure how wrong a depth camera is")
  add_custom_target(man ALL DEPENDS ${HMCDYN_MAN_PAGES})
else()
  message(STATUS "hmcdyn: no manual pages, since awk was not found or the programs do not run here")
endif()

if(HMCDYN_INSTALL)
  install(FILES ${HMCDYN_MAN_PAGES} DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT tools)
  # bash-completion loads a file by the name of the program.
  foreach(tool IN ITEMS slam evaluate synthesize label_score map_score tables
                  calibrate_depth)
    install(
      FILES "${PROJECT_SOURCE_DIR}/packaging/bash-completion/hmcdyn"
      DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions"
      RENAME hmcdyn_${tool}
      COMPONENT tools)
  endforeach()
endif()
