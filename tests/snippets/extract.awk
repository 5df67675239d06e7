# SPDX-License-Identifier: BSD-3-Clause
# Writes each ```cpp block of a Markdown file as a source file: awk -v stem=FOLDER/NAME -f extract.awk FILE
# gives NAME_1.cpp, NAME_2.cpp, ... Each includes NAME_<n>.hpp, which declares what the block takes for
# granted; its own #include lines move to the top, the rest into a function.
function finish() {
  printf "%s#include \"%s_%d.hpp\"\n\nvoid snippet();\nvoid snippet() {\n#line %d \"%s\"\n%s}\n", \
    includes, name, number, first, FILENAME, body > (stem "_" number ".cpp")
  close(stem "_" number ".cpp")
}
BEGIN { name = stem; sub(/.*\//, "", name) }
/^ *```cpp$/ { inside = 1; number++; first = FNR + 1; includes = body = ""; next }
/^ *```$/ && inside { inside = 0; finish(); next }
inside && /^ *#include/ { includes = includes $0 "\n"; body = body "\n"; next }
inside { body = body $0 "\n" }
END { if (inside) { print FILENAME ": a block is not closed" > "/dev/stderr"; exit 1 } print number + 0 }
