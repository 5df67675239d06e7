# SPDX-License-Identifier: BSD-3-Clause
# A manual page from a program's --help, as CLI11 writes it:
# PROGRAM --help | awk -v name=PROGRAM -v version=0.1.0 -v summary='what it is' -f help_to_man.awk

function escape(text) {
  gsub(/\\/, "\\e", text)
  gsub(/-/, "\\-", text)
  if (text ~ /^[.']/) text = "\\&" text
  return text
}
function verbatim(on) {
  if (on != as_it_is) print on ? ".nf" : ".fi"
  as_it_is = on
}
BEGIN {
  printf ".TH %s 1 \"\" \"hmcdyn %s\" \"User Commands\"\n.SH NAME\n%s \\- %s\n", toupper(name), version, escape(name),
    escape(summary)
}
# The description stands before the usage in a help, behind it in a manual page.
!usage && /^Usage: / {
  usage = 1
  sub(/^Usage: +([^ ]*\/)?/, "")
  print ".SH SYNOPSIS\n.nf\n" escape($0) "\n.fi\n.SH DESCRIPTION\n.nf\n" description ".fi"
  next
}
!usage { description = description escape($0) "\n"; next }
/^[A-Z][A-Za-z]*:$/ {
  verbatim(0)
  heading = toupper(substr($0, 1, length($0) - 1))
  print ".SH " heading
  # What follows a footer's own headings is text as it stands.
  listed = heading !~ /^EXAMPLE/
  next
}
# "  --name TYPE=default   Text", in a list of options, positionals or commands.
listed && /^  [^ ]/ {
  verbatim(0)
  entry = substr($0, 3)
  gap = match(entry, /   *[^ ]/)
  print ".TP\n.B " escape(gap ? substr(entry, 1, RSTART - 1) : entry)
  if (gap) { text = substr(entry, RSTART); sub(/^ */, "", text); print escape(text) }
  next
}
listed && /^      / { sub(/^ */, ""); print escape($0); next }
/^ *$/ { if (as_it_is) print ""; next }
{
  if (listed) { listed = 0; print ".SH NOTES" }
  verbatim(1)
  print escape($0)
}
END { verbatim(0) }
