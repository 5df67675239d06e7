# SPDX-License-Identifier: BSD-3-Clause
# cmake -DPROGRAM= -DCOMMAND= -DNAME= -DSUMMARY= -DVERSION= -DAWK= -DSCRIPT= -DOUTPUT= -P WriteManPage.cmake
execute_process(
  COMMAND "${PROGRAM}" ${COMMAND} --help
  OUTPUT_VARIABLE help COMMAND_ERROR_IS_FATAL ANY)
file(WRITE "${OUTPUT}.help" "${help}")
execute_process(
  COMMAND "${AWK}" -v "name=${NAME}" -v "version=${VERSION}" -v "summary=${SUMMARY}" -f "${SCRIPT}"
          "${OUTPUT}.help"
  OUTPUT_FILE "${OUTPUT}" COMMAND_ERROR_IS_FATAL ANY)
