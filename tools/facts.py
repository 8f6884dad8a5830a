#!/usr/bin/env python3
"""Makes C++ of the tables of facts: what errors and notes say, apart from any sentence.

    tools/facts.py types NAMESPACE OUT TABLE…    a header for each table, and OUT/facts.cpp
    tools/facts.py texts OUT.inc TEXTS TABLE…    a face's own texts of facts
    tools/facts.py list TABLE…                   docs/facts.md, to standard output

A table is a file LAYER/facts.json. It maps the name of a type of fact to its row:

    {"code": "input", "problem": "vertex {vertex} is …", "remedy": "Name …", "fields": {"vertex": "integer"}}

"code" is one of ErrorCode's names. A note has no code, and "note" in place of "problem". "remedy" is optional. The
id of the fact is "layer.name". A file of texts maps ids to {"problem" or "note", "remedy"} in the words of one
interface; what a row leaves out is worded as in the table.

A field is a number, a text from the user's data (a name, a path, a word of a file), or a word of a closed list. The
table's entry "words" holds the lists, with the library's English for each word:

    "words": {"action": {"read": "read", "write": "written"}}

A field of the kind "action" is one of these words, an enumeration facts::LAYER::Action in C++. Texts get the English
for it; programs, and interfaces with words of their own, read the word itself.
"""

import json
import re
import string
import sys
from pathlib import Path

KINDS = {"integer": "Integer", "number": "Number", "text": "Text", "integers": "Integers", "numbers": "Numbers",
         "texts": "Texts"}
CODES = ("usage", "input", "unsolvable", "io", "memory", "cancelled", "internal")
SAMPLE = {"integer": 3, "number": 0.5, "text": "text", "integers": "1, 2", "numbers": "0.5, 1.5", "texts": "a, b"}


class Filler(string.Formatter):
    """Fills in as meshgraft::fill_in does: "{n:face|faces}" is "1 face" or "3 faces"."""

    def format_field(self, value, spec):
        if isinstance(value, int) and "|" in spec:
            return f"{value} {spec.split('|')[value != 1]}"
        return super().format_field(value, spec)


def camel_case(name):
    return "".join(word.capitalize() for word in name.split("_"))


class WordList:
    """A closed list of words that a field may have, with the library's English for each."""

    def __init__(self, layer, name, words):
        self.layer, self.name, self.words = layer, name, words
        for word, text in words.items():
            if not re.fullmatch(r"[a-z][a-z0-9_]*", word) or not text:
                sys.exit(f"facts.py: the list {layer}.{name} has '{word}', which is no identifier with a text")

    @property
    def type_name(self):
        return camel_case(self.name)

    @property
    def table(self):
        return f"{self.layer}_{self.name}_words"


class Row:
    def __init__(self, layer, name, row, lists):
        self.layer, self.name, self.id, self.lists = layer, name, f"{layer}.{name}", lists
        self.code, self.fields = row.get("code"), row.get("fields", {})
        self.text = row.get("problem") if self.code else row.get("note")
        self.remedy = row.get("remedy", "")
        unknown = set(row) - {"code", "problem", "note", "remedy", "fields"}
        self.require(not unknown, f"has no {', '.join(unknown)}")
        self.require(self.code is None or self.code in CODES, f"has the code {self.code}, which does not exist")
        self.require(self.text, "lacks its text: \"problem\" with a code, \"note\" without one")
        for field, kind in self.fields.items():
            self.require(kind in KINDS or kind in lists, f"has a field {field} of the kind {kind}, which does not exist")
        self.check(self.text, self.remedy)

    def require(self, condition, problem):
        if not condition:
            sys.exit(f"facts.py: {self.id} {problem}")

    def check(self, text, remedy):
        """The texts name fields that exist, in formats that fit them, and end as sentences do in messages."""
        for sentence in (text, remedy):
            for _, field, _, _ in string.Formatter().parse(sentence):
                self.require(field is None or field in self.fields, f"names a field '{field}', which it does not have")
            Filler().vformat(sentence, (), {field: SAMPLE.get(kind, "text") for field, kind in self.fields.items()})
        self.require(not text.endswith("."), "has a problem that ends with a full stop")
        self.require(not remedy or remedy[-1] in ".?", "has a remedy that does not end as a sentence does")

    @property
    def type_name(self):
        return camel_case(self.name)

    def member_type(self, kind):
        return KINDS.get(kind) or f"Word<{self.lists[kind].type_name}>"

    def field_type(self, field, kind):
        """The initialiser of the field's FieldType."""
        values = f"FieldKind::{kind}" if kind in KINDS else f"FieldKind::word, {self.lists[kind].table}"
        return f"{{{literal(field)}, {values}}}"

    def field_value(self, field, kind):
        """The field's value as a FieldValue."""
        if kind in KINDS:
            return f"{field}.value"
        return f"std::string({self.lists[kind].table}[static_cast<std::size_t>({field}.value)].name)"


def layer_of(table):
    return Path(table).resolve().parent.name


def read(paths):
    """Returns the rows of tables."""
    rows = []
    for path in paths:
        table, layer = json.loads(Path(path).read_text()), layer_of(path)
        lists = {name: WordList(layer, name, words) for name, words in table.pop("words", {}).items()}
        for name in lists:
            if name in KINDS or name in table or not any(name in row.get("fields", {}).values() for row in table.values()):
                sys.exit(f"facts.py: the list of words {layer}.{name} has no use, or the name of something else")
        rows += [Row(layer, name, row, lists) for name, row in sorted(table.items())]
    return rows


def lists_of(rows):
    """Returns the lists of words that the fields of rows are of."""
    return list(dict.fromkeys(words for row in rows for words in row.lists.values()))


def literal(text):
    return json.dumps(text, ensure_ascii=False)


def write(path, content):
    """Leaves a file as it is if it says this already, so that nothing is compiled again in vain."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != content:
        path.write_text(content)


def header(layer, rows):
    lines = [f"// Made from {layer}/facts.json by tools/facts.py.", "#pragma once", "",
             '#include "core/fact_fields.h"', "", f"namespace meshgraft::facts::{layer} {{", ""]
    for words in lists_of(rows):
        lines += [f"enum class {words.type_name} {{ {', '.join(words.words)} }};", ""]
    for row in rows:
        lines += [f"/// {f'Error({row.code})' if row.code else 'Note'}: {row.text}",
                  f"struct {row.type_name} {{",
                  f"  static constexpr std::string_view id = {literal(row.id)};"]
        lines += [f"  {row.member_type(kind)} {field};" for field, kind in row.fields.items()]
        lines += ["  operator Fact() const;", "};", ""]
    return "\n".join(lines + [f"}}  // namespace meshgraft::facts::{layer}", ""])


def source(rows, namespace):
    lines = ["// Made from the tables of facts by tools/facts.py.", "#include <array>", ""]
    lines += [f'#include "{layer}/facts.h"' for layer in dict.fromkeys(row.layer for row in rows)]
    lines += ["", "namespace meshgraft {", "", "namespace {", ""]
    for words in lists_of(rows):
        lines += [f"constexpr FieldWord {words.table}[] = {{"]
        lines += [f"    {{{literal(word)}, {literal(text)}}}," for word, text in words.words.items()] + ["};"]
    for row in rows:
        name = f"{row.layer}_{row.name}"
        fields = "{}"
        if row.fields:
            lines.append(f"constexpr FieldType {name}_fields[] = {{" + ", ".join(
                row.field_type(field, kind) for field, kind in row.fields.items()) + "};")
            fields = f"{name}_fields"
        code = f"ErrorCode::{row.code}" if row.code else "{}"
        lines += [f"constexpr FactType {name}{{{literal(row.id)}, {code}, {fields},",
                  f"    {literal(row.text)},", f"    {literal(row.remedy)}}};"]
    lines += ["", f"constexpr std::array<const FactType*, {len(rows)}> all{{"]
    lines += [f"    &{row.layer}_{row.name}," for row in rows]
    lines += ["};", "", "}  // namespace", ""]
    for row in rows:
        values = ", ".join(row.field_value(field, kind) for field, kind in row.fields.items())
        lines.append(f"facts::{row.layer}::{row.type_name}::operator Fact() const {{ "
                     f"return {{{row.layer}_{row.name}, {{{values}}}}}; }}")
    if namespace != "meshgraft":
        lines += ["", f"namespace {namespace.removeprefix('meshgraft::')} {{", "std::span<const FactType* const> fact_types();"]
    lines += ["", "std::span<const FactType* const> fact_types() { return all; }", ""]
    if namespace != "meshgraft":
        lines.append("}")
    return "\n".join(lines + ["}  // namespace meshgraft", ""])


def texts(path, tables):
    rows = {row.id: row for row in read(tables)}
    lines = [f"// Made from {Path(path).name} by tools/facts.py: id, text, remedy."]
    for id, said in sorted(json.loads(Path(path).read_text()).items()):
        if id not in rows:
            sys.exit(f"facts.py: {path} words {id}, which is in no table")
        row = rows[id]
        text, remedy = said.get("problem" if row.code else "note", row.text), said.get("remedy", row.remedy)
        row.check(text, remedy)
        lines.append(f"{{{literal(id)}, {literal(text)}, {literal(remedy)}}},")
    return "\n".join(lines + [""])


def listed(rows):
    out = ["# Facts", "",
           "Every error and every note has an *id* and *fields*. Programs read these; the sentences are for people, and each",
           "interface words them in its own terms. This page lists the ids, with their fields and the library's sentence. A",
           "field is a number, a text from the user's data, or a word of a list, which stands above the table. The page is",
           "made from the tables `facts.json` of `src`, `cli` and `python` by `tools/facts.py list`.", ""]
    layer = None
    for row in rows:
        if row.layer != layer:
            layer = row.layer
            out += ["", f"## {layer}", ""]
            for words in row.lists.values():
                out.append(f"- *{words.name}*: " + ", ".join(f"`{word}`" for word in words.words))
            out += [""] if row.lists else []
            out += ["| id | kind | fields | sentence |", "|---|---|---|---|"]
        fields = ", ".join(f"`{field}` ({kind})" for field, kind in row.fields.items())
        sentence = f"{row.text}. {row.remedy}".strip().replace("|", "\\|").replace("<", "&lt;")
        out.append(f"| `{row.name}` | {row.code or 'note'} | {fields} | {sentence} |")
    return "\n".join(out + [""])


def main(command, *arguments):
    if command == "types":
        namespace, out, *tables = arguments
        rows = read(tables)
        for table in tables:
            layer = layer_of(table)
            write(Path(out) / layer / "facts.h", header(layer, [row for row in rows if row.layer == layer]))
        write(Path(out) / "facts.cpp", source(rows, namespace))
    elif command == "texts":
        out, path, *tables = arguments
        write(Path(out), texts(path, tables))
    elif command == "list":
        print(listed(read(arguments)), end="")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main(*sys.argv[1:] or ["help"])
