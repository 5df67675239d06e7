# SPDX-License-Identifier: BSD-3-Clause
# awk -f count_tests.awk results=CTEST_FILE folder=FOLDER [FOLDER/NAME.xml...] CTEST_FILE
# Prints "passed failed skipped" and, on standard error, what was skipped and why. ctest's file (JUnit) says what
# became of each test; a test that is a program of many cases has a file of its own, GoogleTest's NAME.xml, whose
# cases are counted in its place. One that failed after its cases had passed (a leak, say) adds a failure; one
# that left no file, since it crashed, is one failure.
function value(name) {
  return match($0, " " name "=\"[^\"]*\"") ? substr($0, RSTART + length(name) + 3, RLENGTH - length(name) - 4) : ""
}
function skip(name, reason) {
  ++skipped
  gsub(/&#x0A;|&#10;/, " ", reason)
  print "skipped: " name (reason ? ": " reason : "") >"/dev/stderr"
}
FILENAME != results {
  if (/^ *<testcase /) {
    name = value("classname") "." value("name")
    ++cases[FILENAME]
    state = value("result")
    if (state == "suppressed") skip(name, "disabled")
    has_failed = 0
  } else if (/^ *<skipped/) {
    skip(name, value("message"))
  } else if (/^ *<failure/ && !has_failed) {
    has_failed = 1
    ++broken[FILENAME]
  }
  next
}
/<testcase / {
  name = value("name")
  status = value("status")
  file = folder "/" name ".xml"
  if (file in cases) {
    total += cases[file]
    failed += broken[file]
    if (status == "fail" && !broken[file]) {
      ++total
      ++failed
    }
  } else {
    ++total
    if (status == "fail") ++failed
    reading = status == "notrun" || status == "disabled"
    reason = ""
  }
  next
}
!reading { next }
# The reason is what the test said; of a case of GoogleTest, what it said between these two lines.
/<\/testcase>|^\[  SKIPPED/ { skip(name, reason); reading = 0; next }
/^\[ RUN/ { reason = ""; next }
/<system-out>/ { sub(/.*<system-out>/, ""); reason = "" }
{ sub(/<\/system-out>/, "") }
$0 != "" { reason = reason (reason ? " " : "") $0 }
END { print total - failed - skipped, failed + 0, skipped + 0 }
