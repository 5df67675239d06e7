# SPDX-License-Identifier: BSD-3-Clause
# hmcdyn-core.pc, hmcdyn-vision.pc, hmcdyn-optimization.pc. The prefix follows the file. OpenCV and
# Ceres seldom bring pkg-config files of their own, so that their folders and libraries, as CMake found
# them, are written out.

# hmcdyn_flags_of(TARGET OUT_CFLAGS OUT_LIBS): what a compiler needs to use an imported target.
function(hmcdyn_flags_of target out_cflags out_libs)
  set(cflags)
  set(libs)
  set(queue ${target})
  set(seen)
  while(queue)
    list(POP_FRONT queue item)
    string(REGEX REPLACE "^\\$<LINK_ONLY:(.*)>$" "\\1" item "${item}")
    if(item IN_LIST seen)
      continue()
    endif()
    list(APPEND seen "${item}")
    if(TARGET "${item}")
      get_target_property(type "${item}" TYPE)
      if(NOT type STREQUAL "INTERFACE_LIBRARY")
        foreach(property IN ITEMS IMPORTED_LOCATION_RELEASE IMPORTED_LOCATION_NONE
                                  IMPORTED_LOCATION_RELWITHDEBINFO IMPORTED_LOCATION)
          get_target_property(location "${item}" ${property})
          if(location)
            # libX.so, where it is there, outlives an update of libX.so.4.6.0.
            string(REGEX REPLACE "\\.so(\\.[0-9]+)+$" ".so" unversioned "${location}")
            if(EXISTS "${unversioned}")
              set(location "${unversioned}")
            endif()
            list(APPEND libs "${location}")
            break()
          endif()
        endforeach()
      endif()
      get_target_property(folders "${item}" INTERFACE_INCLUDE_DIRECTORIES)
      get_target_property(links "${item}" INTERFACE_LINK_LIBRARIES)
      # A shared library brings its own dependencies along.
      if(links AND NOT type STREQUAL "SHARED_LIBRARY")
        list(APPEND queue ${links})
      endif()
      foreach(folder IN LISTS folders)
        if(folder AND NOT folder MATCHES "\\$<" AND NOT folder STREQUAL "/usr/include")
          list(APPEND cflags "-I${folder}")
        endif()
      endforeach()
    elseif(item MATCHES "^/|^-")
      list(APPEND libs "${item}")
    elseif(NOT item MATCHES "\\$<|::")
      list(APPEND libs "-l${item}")
    endif()
  endwhile()
  list(REMOVE_DUPLICATES cflags)
  list(REMOVE_DUPLICATES libs)
  set(${out_cflags} "${cflags}" PARENT_SCOPE)
  set(${out_libs} "${libs}" PARENT_SCOPE)
endfunction()

# hmcdyn_write_pc(COMPONENT DESCRIPTION PART OWN_LIBS TARGETS...)
function(hmcdyn_write_pc component description part own_libs)
  set(all_cflags)
  set(all_libs)
  foreach(target IN LISTS ARGN)
    hmcdyn_flags_of(${target} cflags libs)
    list(APPEND all_cflags ${cflags})
    list(APPEND all_libs ${libs})
  endforeach()
  list(REMOVE_DUPLICATES all_cflags)
  list(REMOVE_DUPLICATES all_libs)
  list(JOIN all_cflags " " cflags)
  list(JOIN all_libs " " libs)
  set(requires "hmcdyn-core = ${PROJECT_VERSION}")
  if(component STREQUAL "core")
    set(requires "eigen3 >= 3.3")
  endif()
  # A shared library of ours knows its own; a static one needs them on the command line.
  set(public_libs "${own_libs} ${libs}")
  set(private_libs "")
  if(BUILD_SHARED_LIBS)
    set(public_libs "${own_libs}")
    set(private_libs "${libs}")
  endif()
  file(
    CONFIGURE
    OUTPUT "${PROJECT_BINARY_DIR}/pkgconfig/hmcdyn-${component}.pc"
    CONTENT
      [[prefix=${pcfiledir}/@up@
includedir=${prefix}/@CMAKE_INSTALL_INCLUDEDIR@
libdir=${prefix}/@CMAKE_INSTALL_LIBDIR@

Name: hmcdyn-@component@
Description: @description@
Version: @PROJECT_VERSION@
Requires: @requires@
Cflags: -I${includedir} @cflags@
Libs: @public_libs@
Libs.private: @private_libs@
]]
    @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/pkgconfig/hmcdyn-${component}.pc"
          DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT ${part})
endfunction()

# From lib/<triplet>/pkgconfig up to the prefix.
file(RELATIVE_PATH up "/p/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/p")
string(REGEX REPLACE "/$" "" up "${up}")

hmcdyn_write_pc(core "Which key points lie on moving things: headers only" core_dev ""
                nanoflann::nanoflann)
if(HMCDYN_WITH_VISION)
  set(opencv_targets opencv_calib3d opencv_video opencv_imgproc opencv_core)
  hmcdyn_write_pc(vision "Optical flow, camera motion and the whole filter, on OpenCV" dev
                  "-L\${libdir} -lhmcdyn_vision" ${opencv_targets})
endif()
if(HMCDYN_WITH_OPTIMIZATION)
  hmcdyn_write_pc(optimization "Weighted pose refinement, on Ceres" dev
                  "-L\${libdir} -lhmcdyn_optimization" ${CERES_LIBRARIES})
endif()
