# SPDX-License-Identifier: BSD-3-Clause
# The names of the types that public headers define in namespace hmcdyn, one a line. Types within types and
# templates are seen through those that hold them.
FNR == 1 { hidden = 0; template = 0 }
/^namespace [a-z:]*detail \{/ { hidden = 1 }
/^}  \/\/ namespace [a-z:]*detail/ || (/^}$/ && before ~ /^class .*;$/) { hidden = 0 }
/^template/ { template = 1; next }
/^(struct|class|enum class) [A-Za-z0-9_]+[^;]*\{/ {
  name = $2
  if ($1 == "enum") name = $3
  if (!hidden && !template) print name
}
{ template = 0; before = $0 }
