# SPDX-License-Identifier: BSD-3-Clause
# Doxygen's filter for our Markdown, which is written for a forge's page: links go to files of the source
# tree and to headings by their names. Here they become Doxygen's references; a file that is neither
# a document nor a public header is linked as files/PATH, where cmake/HmcdynDocs.cmake copies it.
#
# awk -v root=SOURCE_TREE -f doxygen_markdown.awk FILE; with -v list=1 it writes the paths of these
# files instead.

function stem(path) { sub(/.*\//, "", path); sub(/\.md$/, "", path); return tolower(path) }

# As the forges name a heading: small letters, no punctuation, "-" for a blank.
function slug(heading) {
  heading = tolower(heading)
  gsub(/[^a-z0-9 _-]/, "", heading)
  gsub(/ /, "-", heading)
  return heading
}

# The path from the source tree's root of a link in the document at hand.
function resolve(link, path) {
  path = folder link
  while (sub(/[^\/]+\/\.\.\//, "", path)) {}
  return path
}

# What stands for the target of a Markdown link.
function target(link, path, hash) {
  if (link ~ /^(https?:|mailto:|@)/) return link
  hash = ""
  if (match(link, /#.*/)) { hash = substr(link, RSTART + 1); link = substr(link, 1, RSTART - 1) }
  path = link == "" ? document : resolve(link)
  if (path ~ /\.md$/) return "@ref " stem(path) "_" (hash == "" ? "page" : hash)
  if (path ~ /^include\/hmcdyn\/((steps|votes|peers)\/)?[^\/]*\.hpp$/) return "@ref " path
  if (path ~ /^docs\/pictures\//) { sub(/^docs\//, "", path); return path }
  if (list) print path
  return "files/" path
}

function links(line, out, parts, text, link) {
  out = ""
  while (match(line, /!?\[[^\]]*\]\([^) ]+\)/)) {
    out = out substr(line, 1, RSTART - 1)
    text = substr(line, RSTART, RLENGTH)
    line = substr(line, RSTART + RLENGTH)
    parts = index(text, "](")
    link = target(substr(text, parts + 2, length(text) - parts - 2))
    if (text ~ /^!/) out = out "<img src=\"" link "\" alt=\"" substr(text, 3, parts - 3) "\" style=\"max-width: 40em; width: 100%\">"
    else if (link ~ /^files\//) out = out "<a href=\"" link "\">" substr(text, 2, parts - 2) "</a>"
    else {
      gsub(/`/, "", text)  # would show as such within a reference
      out = out substr(text, 1, index(text, "](")) "(" link ")"
    }
  }
  return out line
}

FNR == 1 {
  document = FILENAME
  sub("^" root "/", "", document)
  folder = document
  if (!sub(/[^\/]*$/, "", folder)) folder = ""
}
/^ *```/ { fenced = !fenced }
fenced || /^ *```/ { if (!list) print; next }
/^#+ / {
  heading = $0
  sub(/^#+ /, "", heading)
  if (list) next
  print $0 " {#" stem(document) "_" (/^# / ? "page" : slug(heading)) "}"
  next
}
list { links($0); next }
{ print links($0) }
