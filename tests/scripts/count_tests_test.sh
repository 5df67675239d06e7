#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# count_tests_test.sh SOURCE: scripts/count_tests.awk counts cases of programs in place of programs, and no
# failure and no skip is lost.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/cases"

# What GoogleTest writes: one case passes, one skips, one fails twice, one is disabled.
cat >"$folder/cases/fails.xml" <<'XML'
<testsuites tests="4" failures="1" disabled="1" errors="0" name="AllTests">
  <testsuite name="A" tests="4" failures="1" disabled="1" skipped="1" errors="0">
    <testcase name="Passes" file="t.cpp" line="4" status="run" result="completed" classname="A" />
    <testcase name="Skips" file="t.cpp" line="5" status="run" result="skipped" classname="A">
      <skipped message="t.cpp:5&#x0A;no data"><![CDATA[t.cpp:5
no data]]></skipped>
    </testcase>
    <testcase name="Fails" file="t.cpp" line="7" status="run" result="completed" classname="A">
      <failure message="1 is not 2" type=""><![CDATA[1 is not 2]]></failure>
      <failure message="1 is not 3" type=""><![CDATA[1 is not 3]]></failure>
    </testcase>
    <testcase name="DISABLED_Off" file="t.cpp" line="6" status="notrun" result="suppressed" classname="A" />
  </testsuite>
</testsuites>
XML
# Two cases that passed, after which the program failed: a leak.
cat >"$folder/cases/leaks.xml" <<'XML'
<testsuites tests="2" failures="0" disabled="0" errors="0" name="AllTests">
  <testsuite name="B" tests="2" failures="0" disabled="0" skipped="0" errors="0">
    <testcase name="One" status="run" result="completed" classname="B" />
    <testcase name="Two" status="run" result="completed" classname="B" />
  </testsuite>
</testsuites>
XML
# What ctest writes: those two; a crash, which left no file; tests of one case each.
cat >"$folder/results.xml" <<'XML'
<testsuite name="Linux-c++" tests="7" failures="3" disabled="0" skipped="2">
	<testcase name="fails" classname="fails" time="0.1" status="fail">
		<failure message=""/>
		<system-out>[  SKIPPED ] A.Skips (0 ms)
</system-out>
	</testcase>
	<testcase name="leaks" classname="leaks" time="0.1" status="fail">
		<failure message=""/>
	</testcase>
	<testcase name="crashes" classname="crashes" time="0.1" status="fail">
		<failure message=""/>
	</testcase>
	<testcase name="C.Passes" classname="C.Passes" time="0.1" status="run">
		<system-out>[       OK ] C.Passes (0 ms)
</system-out>
	</testcase>
	<testcase name="C.Skips" classname="C.Skips" time="0.1" status="notrun">
		<skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/>
		<system-out>Note: Google Test filter = C.Skips
[ RUN      ] C.Skips
t.cpp:9: Skipped
no model
[  SKIPPED ] C.Skips (0 ms)
[  PASSED  ] 0 tests.
</system-out>
	</testcase>
	<testcase name="script" classname="script" time="0.1" status="notrun">
		<skipped message="SKIP_RETURN_CODE=77"/>
		<system-out>no pkg-config here
</system-out>
	</testcase>
</testsuite>
XML

counted=$(awk -f "$1/scripts/count_tests.awk" results="$folder/results.xml" folder="$folder/cases" \
  "$folder"/cases/*.xml "$folder/results.xml" 2>"$folder/skipped")
# Passed: A.Passes, B.One, B.Two, C.Passes. Failed: A.Fails, the leak, the crash.
expected="4 3 4"
if [[ $counted != "$expected" ]]; then
  echo "passed, failed and skipped are '$counted'; expected '$expected'" >&2
  exit 1
fi
diff - "$folder/skipped" <<'TEXT'
skipped: A.Skips: t.cpp:5 no data
skipped: A.DISABLED_Off: disabled
skipped: C.Skips: t.cpp:9: Skipped no model
skipped: script: no pkg-config here
TEXT
