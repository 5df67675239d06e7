# SPDX-License-Identifier: BSD-3-Clause
"""Writes what the Python module takes from C++ headers, so that nothing stands twice: comments and fields.

    extract_comments.py COMMENTS.inc FIELDS.inc HEADER...

A line of COMMENTS.inc is {"NAME", "TEXT"},; NAME is a function, a type, or TYPE::MEMBER. Of overloads the first
one that has a comment counts. FIELDS.inc has a macro a struct, HMCDYN_FIELDS_TYPE(F), which is
F(TYPE, FIELD) for each of its data members that has a comment. The headers are those of this project, in its
format (clang-format): one declaration a line, comments as `///` above it or `///<` behind it.
"""
import re
import sys

TYPE = re.compile(r"^(?:class|struct|enum class) (\w+)[^;]*$")
FIELD = re.compile(r"^  [\w:<>,&*\s]+?\b(\w+)(?: = .*|\{.*\})?[;,{]?\s*(?:///<.*)?$")
FUNCTION = re.compile(r"^ *[\w:<>,&*\s]*?\b(\w+)\(")


def plain(text):
    """A comment as a docstring has it: C++ names as they are, references to exceptions as in Python."""
    text = re.sub(r"@param (\w+)", r"\n\1:", text)
    text = text.replace("@return", "\nReturns")
    text = re.sub(r"@throws std::(?:invalid_argument|runtime_error)", "\nValueError", text)
    text = re.sub(r"@tparam [^\n]*", "", text)
    text = text.replace("std::nullopt", "None").replace("[OpenCV]", "")
    lines = [re.sub(r"[ \t]+", " ", line).strip() for line in text.split("\n")]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).strip()


def comments_of(header):
    """(name, text, whether it is a data member) of one header."""
    found = []
    above, owner, last, begun = [], None, None, ""
    with open(header, encoding="utf-8") as file:
        for line in file:
            line = begun + " " + line.strip() if begun else line.rstrip("\n")
            begun = ""
            if line.endswith(" ="):  # its value stands on the next line
                begun = line
                continue
            text = line.strip()
            if text.startswith("///<"):  # goes on from the line before
                if last is not None:
                    name, comment, is_field = found[last]
                    found[last] = (name, comment + "\n" + text[4:].strip(), is_field)
                continue
            if text.startswith("///"):
                above.append(text[3:].strip())
                continue
            behind = text.split("///<", 1)[1].strip() if "///<" in text else ""
            comment = "\n".join(above + ([behind] if behind else []))
            name, is_field = None, False
            if match := TYPE.match(text):
                owner = name = match.group(1)
            elif text.startswith("}"):
                owner = owner if line.startswith("  ") else None
            elif match := FUNCTION.match(line.split("///<")[0].rstrip()):
                name = match.group(1) if owner is None else f"{owner}::{match.group(1)}"
            elif owner is not None and (match := FIELD.match(line.split("///<")[0].rstrip())):
                name, is_field = f"{owner}::{match.group(1)}", True
            last = None
            if name and comment:
                last = len(found)
                found.append((name, comment, is_field))
            if not text.startswith("template") and not text.startswith("// NOLINT"):
                above = []
    return found


def main(comments_file, fields_file, *headers):
    comments, fields = {}, {}
    for header in headers:
        for name, text, is_field in comments_of(header):
            comments.setdefault(name, plain(text))
            if is_field:
                owner, field = name.split("::")
                if field not in fields.setdefault(owner, []):
                    fields[owner].append(field)
    with open(comments_file, "w", encoding="utf-8") as file:
        for name, text in sorted(comments.items()):
            escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
            file.write(f'{{"{name}", "{escaped}"}},\n')
    with open(fields_file, "w", encoding="utf-8") as file:
        for owner, names in sorted(fields.items()):
            file.write(f"#define HMCDYN_FIELDS_{owner}(F)")
            file.write("".join(f" F({owner}, {name})" for name in names) + "\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
