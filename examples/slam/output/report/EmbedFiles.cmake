# SPDX-License-Identifier: BSD-3-Clause
# cmake -DOUTPUT=FILE.cpp -DFOLDER=DIR -P EmbedFiles.cmake
# Writes the bytes of the report's files as C++, as hexadecimal numbers: no text can break them.
set(functions pageCss pageJs uplotCss uplotJs uplotLicence)
set(files page/page.css page/page.js third_party/uplot/uPlot.min.css
          third_party/uplot/uPlot.iife.min.js third_party/uplot/LICENSE)
set(text "// Written by EmbedFiles.cmake.\n#include \"slam/output/report/assets.hpp\"\n\n")
string(APPEND text "namespace hmcdyn::slam::assets {\n")
foreach(function file IN ZIP_LISTS functions files)
  file(READ "${FOLDER}/${file}" bytes HEX)
  string(REGEX REPLACE "(..)" "'\\\\x\\1'," bytes "${bytes}")
  string(APPEND text "\n// ${file}\nstd::string_view ${function}() noexcept {\n"
                     "  static constexpr char kBytes[] = {${bytes}};\n"
                     "  return {kBytes, sizeof kBytes};\n}\n")
endforeach()
string(APPEND text "\n}  // namespace hmcdyn::slam::assets\n")
file(WRITE "${OUTPUT}" "${text}")
