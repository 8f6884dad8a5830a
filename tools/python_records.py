#!/usr/bin/env python3
"""Makes the Python package's records of the public headers.

    tools/python_records.py INCLUDE_DIR OUT_DIR

Reads the plain structs, the enumerations and the comments of functions in INCLUDE_DIR/meshgraft and writes to OUT_DIR:
  _records.py  a frozen dataclass for each struct in RECORDS, a Literal for each enumeration, a TypedDict for each
               struct in KEYWORDS
  _docs.py     the headers' comments on functions and classes, in the words of Python
  records.h    tables of the same fields and words, for the casters of the extension module
The names and types of Python are decided here. What the fields mean stands in the headers, and in DOCS where those take
a C++ type or name to say it.
"""

import re
import sys
import textwrap
from pathlib import Path

# Structs that become dataclasses, in the order of their dependence.
RECORDS = (
    "TopologySummary", "Finding", "Diagnostics", "RepairOptions", "RepairChange", "RepairResult", "CutOptions",
    "CutPin", "CutResult",
    "OperatorOptions", "SolverStatistics", "DeformerOptions", "DeformerSummary", "EvaluationReport", "ProxySummary",
    "Quality", "Orientation", "OrientationGuess", "Match", "StartCandidate", "Reach", "MergeFeature", "SeamOptions",
    "MergeOptions", "Similarity", "SeamFaults", "SeamReport", "RetryReport", "PairReport", "ShapeReport", "BaseReport",
    "MergeReport", "MergeIntersections",
    "DeformSettings", "StageSeconds", "DeformCounts", "ProxyReport",
    "SymmetryReport", "MergeOutcome", "CutOutcome", "RepairOutcome", "SculptOutcome", "StepReport", "EditReport::Input", "EditReport",
    "SampleInfo", "WriteResult", "HandleBuffers", "StencilNodes",
)

# Structs whose fields become keywords of functions: Python's name, the structs, and fields that have another name there
# or none.
KEYWORDS = {
    "DeformKeywords": (("DeformSettings", "DeformerOptions", "OperatorOptions"),
                       {"deformer": None, "refine_boundary": None, "proxy": None, "weld": None, "operators": None,
                        "opposite_pairs": None, "soften_coarse": None, "vertices_represented": None, "coarse_start": None}),
    "OperatorKeywords": (("OperatorOptions",), {}),
    "SeamKeywords": (("SeamOptions",), {"target_rings": "band", "source_rings": None}),
    "RepairKeywords": (("RepairOptions",), {}),
    "CutKeywords": (("CutOptions",), {}),
    "ReducedFramesKeywords": (("ReducedFramesOptions",), {}),
    "OverrideKeywords": (("SettingsOverrides",), {}),
}

# Structs that only the extension module reads, by the same tables.
READ_ONLY_BY_MODULE = ("ReducedFramesOptions", "QualityOptions", "SettingsOverrides")

# C++ type: Python's annotation. Templates are below.
TYPES = {
    "bool": "bool", "Index": "int", "int": "int", "std::int64_t": "int", "std::uint64_t": "int", "std::size_t": "int",
    "double": "float", "std::string": "str", "std::string_view": "str", "std::filesystem::path": "Path",
    "Mesh": "Mesh", "Note": "Note", "Method": "str", "IndexMap": "IndexArray", "Points": "FloatArray",
    "Eigen::Vector3d": "FloatArray", "Eigen::RowVector3d": "FloatArray", "Eigen::Matrix3d": "FloatArray",
    "Eigen::Affine3d": "FloatArray", "Flags": "FlagArray", "Rows<3>": "Float32Array", "Rows<9>": "Float32Array",
    "Rows<Eigen::Dynamic>": "Float32Array", "std::vector<EdgePoint>": "EdgePoints",
}
ARRAYS = {"Index": "IndexArray", "double": "FloatArray", "std::int8_t": "SideArray"}
SHAPES = {"Eigen::Matrix3d": "(3, 3)", "Eigen::Affine3d": "(4, 4)", "IndexMap": "(n,)"}

# Names that differ in Python: functions, and words of the comments.
NAMES = {
    "check_mesh": "check", "merge_meshes": "merge", "drop_source": "drop", "read_mesh": "read", "write_mesh": "write",
    "make_sample": "sample", "sample_list": "samples", "measure_quality": "quality", "run_edit": "Edit.run",
}
ENUM_WORDS = {"automatic": "auto"}
ENUM_NAMES = {"Ordering": {"minimum_degree": "amd", "nested_dissection": "metis", "mesh_dissection": "dissection"}}

# Docstrings of records, by class, and of their fields, where the headers have none.
DOCS = {
    "RepairResult": "A repaired mesh, what was changed, and where its n vertices and m faces come from in the given mesh.",
    "RepairResult.mesh": "The repaired mesh, in the type of the given one.",
    "RepairResult.vertex": "Per vertex of the given mesh: its index in `mesh`, or -1 where it was removed. Several may map "
                           "to one; one with several copies maps to the first of them.",
    "RepairResult.face": "Per face of the given mesh: its index in `mesh`, or -1 where it was removed. One with several "
                         "pieces maps to the first of them.",
    "RepairResult.vertex_origin": "Per vertex of `mesh`: its index in the given mesh; -1 in the filling of a hole. (n,)",
    "RepairResult.face_origin": "Per face of `mesh`: its index in the given mesh; -1 in the filling of a hole. (m,)",
    "CutResult": "A cut mesh of n vertices and m faces, where these come from in the uncut mesh, and the boundary loops that "
                 "the cut made.",
    "CutResult.vertex": "Per vertex of the uncut mesh: its index in `mesh`, or -1 where it was removed. A vertex on the cut "
                        "maps to its first copy.",
    "CutResult.origin": "Per vertex of `mesh`: its location on an edge of the uncut mesh; -1 in pins and holes. `start`, `end` and "
                        "`t` are (n,).",
    "CutResult.face_parent": "Per face of `mesh`: the uncut face that it is a piece of; -1 in a cap. (m,)",
    "CutResult.face_side": "Per face of `mesh`: 1 above, -1 below, 0 where the cut separates nothing. (m,)",
    "CutResult.loops": "The boundary loops that the cut made: for each, its vertices in `mesh`, in order. Caps close them.",
    "CutResult.pins": "The pins that the cut made, each with a hole that takes it.",
    "CutPin.centre": "The middle of its foot, on the cap. (3,)",
    "CutPin.diameter": "Diameter, model units.",
    "CutPin.length": "How far it stands out, model units.",
    "CutPin.clearance": "By how much the hole is wider, all round, and deeper, model units.",
    "CutOptions.pin_count": "Pins on each cap, 1 to 32. Absent: two.",
    "CutOptions.pin_diameter": "Their diameter, model units. Absent: 0.8 × the radius of equal circles that fit the cap, one for "
                               "each pin.",
    "CutOptions.pin_length": "How far they stand out, model units. Absent: 1.5 × the diameter.",
    "CutOptions.pin_clearance": "By how much a hole is wider, all round, and deeper, model units. Absent: 0.05 × the diameter.",
    "CutOutcome.pins": "The pins that the cut made.",
    "MergeReport": "Measures of a merge: its loops, the shape of the grafted source, the seam, and the times of its stages. "
                   "Angles are in degrees, times in seconds; names with _rel are relative, as they say.",
    "MergeReport.pairs": "One report for each pair of loops that met, in the order of the pairs.",
    "MergeReport.shape": "How much the source was deformed.",
    "MergeReport.seam": "Topology and shape of the seam.",
    "MergeReport.evaluation": "Figures of the solve.",
    "MergeReport.source_vertices_added": "Vertices that refinement added to the source.",
    "MergeReport.target_vertices_added": "Vertices that refinement added to the target.",
    "MergeReport.notes": "What a user should know of the result.",
    "MergeReport.match_seconds": "Time to match the loops.",
    "MergeReport.assemble_seconds": "Time to assemble the systems of the solve.",
    "MergeReport.factorise_seconds": "Time to factorise them.",
    "MergeReport.solve_seconds": "Time of the rest of the solve.",
    "MergeReport.seam_seconds": "Time to make the seam.",
    "MergeReport.retry": "Further grafts, where the first one had faults at its seams.",
    "MergeReport.retry_seconds": "Time of these further grafts; the times above are of the first one.",
    "MergeReport.total_seconds": "Time of the whole merge.",
    "SampleInfo": "A built-in model, which `meshgraft.sample` makes.",
    "SampleInfo.name": 'The name that `meshgraft.sample` takes: "octopus", "head", …',
    "SampleInfo.description": "One line on what it is.",
    "SampleInfo.default_resolution": "The resolution unless another is asked for: about the square root of the number of "
                                     "vertices.",
    "WriteResult": "What `meshgraft.write` wrote, and what it had to leave out.",
    "WriteResult.files": "Paths of the files that were written: the mesh, then those that it refers to.",
    "WriteResult.notes": "Data of the mesh that the format cannot store, one note for each kind.",
}

WITHOUT_WORDS = ("FieldKind", "ErrorCode", "Kind", "SelRole", "Baseline")  # enumerations that Python does not see

COMMENT = re.compile(r"\s*///(<?) ?(.*)")


class Field:
    def __init__(self, cpp_type, name, default, doc):
        self.cpp_type, self.name, self.default, self.doc = cpp_type, name, default, doc


class Struct:
    def __init__(self, name, doc):
        self.name, self.doc, self.fields = name, doc, []

    @property
    def python_name(self):
        return self.name.replace("::", "")


class Enum:
    def __init__(self, name, doc):
        self.name, self.doc, self.values = name, doc, []

    def word(self, value):
        own = ENUM_NAMES.get(self.name, {}).get(value)
        return own or ENUM_WORDS.get(value, value.replace("_", "-"))


def split_outside(text, separator):
    """Splits at separators that are in no bracket."""
    parts, depth, start = [], 0, 0
    for i, char in enumerate(text):
        depth += (char in "<({[") - (char in ">)}]")
        if char == separator and depth == 0:
            parts.append(text[start:i])
            start = i + 1
    return [*parts, text[start:]]


class Headers:
    """What the headers declare."""

    def __init__(self, folder):
        self.structs, self.enums, self.docs, self.files = {}, {}, {}, {}
        for path in sorted(folder.rglob("*.h")):
            if path.name == "distributed.h":  # needs MPI, and is not in the Python package
                continue
            self.read(path.read_text(encoding="utf-8").splitlines(), path.relative_to(folder.parent))

    def read(self, lines, path):
        doc, i = [], 0
        while i < len(lines):
            comment = COMMENT.fullmatch(lines[i])
            if comment and not comment[1]:
                doc.append(comment[2])
            elif match := re.fullmatch(r"struct (\w+) \{", lines[i]):
                i = self.read_struct(lines, i + 1, Struct(match[1], doc), path, "};")
                doc = []
            elif match := re.match(r"enum class (\w+)[^;{]*\{", lines[i]):
                self.files[match[1]] = path
                i = self.read_enum(lines, i, Enum(match[1], doc))
                doc = []
            elif match := re.fullmatch(r"class (\w+)[^;]*\{", lines[i]):
                self.docs.setdefault(match[1], doc)
                i = self.read_class(lines, i + 1, match[1])
                doc = []
            else:
                if doc and (match := re.match(r"[\w:<>,&* ]+?\b(\w+)\(", lines[i])):
                    self.docs.setdefault(match[1], doc)
                if lines[i].strip() == "" or lines[i].endswith((";", "}")):
                    doc = []
            i += 1

    def read_class(self, lines, i, name):
        """Reads the comments on a class's own functions."""
        doc, depth = [], 1
        while depth > 0:
            comment = COMMENT.fullmatch(lines[i])
            if comment and not comment[1]:
                doc.append(comment[2])
            else:
                match = re.match(r"  (?:explicit |virtual |static )?[\w:<>,&* ]*?\b(\w+)\(", lines[i])
                if doc and match and depth == 1:
                    self.docs.setdefault(f"{name}.{match[1]}", doc)
                doc = []
            depth += lines[i].count("{") - lines[i].count("}")
            i += 1
        return i - 1

    def read_enum(self, lines, i, enum):
        body = lines[i][lines[i].index("{") + 1:]
        doc = []
        while True:
            comment = COMMENT.fullmatch(body)
            if comment:
                doc.append(comment[2])
            else:
                code, _, trailing = body.partition("///<")
                for name in re.findall(r"\w+", code.split("}")[0]):
                    enum.values.append((name, " ".join([*doc, trailing.strip()]).strip()))
                    doc = []
                if "}" in code:
                    break
            i += 1
            body = lines[i]
        self.enums[enum.name] = enum
        return i

    def read_struct(self, lines, i, struct, path, end):
        """Reads fields up to the line `end`; functions are passed over."""
        self.structs[struct.name], self.files[struct.name] = struct, path
        doc, code, trailing = [], "", []
        indent = end[:len(end) - len(end.lstrip())] + "  "
        while lines[i] != end:
            line = lines[i]
            comment = COMMENT.fullmatch(line)
            if comment and comment[1]:
                trailing.append(comment[2])
                struct.fields[-1].doc = " ".join([struct.fields[-1].doc, comment[2]]).strip()
            elif comment:
                doc.append(comment[2])
            elif match := re.fullmatch(rf"{indent}struct (\w+) \{{", line):
                i = self.read_struct(lines, i + 1, Struct(f"{struct.name}::{match[1]}", doc), path, indent + "};")
                doc = []
            elif line.strip() == "" or line.strip().startswith("//"):
                doc = [] if not code else doc
            else:
                text, _, after = line.partition("///<")
                code += " " + text.strip()
                if code.count("{") == code.count("}") and code.rstrip().endswith((";", "}")):
                    self.add_fields(struct, code.strip(), " ".join([*doc, after.strip()]).strip())
                    code = ""
                    # A comment may stand above several declarations of one kind only if it is repeated.
                    doc = []
            i += 1
        return i

    def add_fields(self, struct, code, doc):
        if not code.endswith(";") or re.match(r"(friend|using|template|explicit|virtual|static|constexpr)\b", code):
            return
        code = code[:-1]
        head = re.match(r"((?:const )?[\w:]+(?:<.*?>+)?[&*]?) (\w.*)", code)
        if head is None:
            return
        if "(" in re.sub(r"[{=].*", "", code) and not head[1].startswith("std::function"):
            return  # a function
        for part in split_outside(head[2], ","):
            match = re.fullmatch(r"\s*(\w+)\s*(?:=\s*(.*)|(\{.*\}))?", part)
            if match is None:
                return  # nothing that a record has
            struct.fields.append(Field(head[1], match[1], match[2] or match[3], doc))


class Python:
    """Writes the headers' declarations as Python."""

    def __init__(self, headers):
        self.headers = headers
        self.known = {name.split("::")[-1] if name.startswith("EditReport") else name: name for name in RECORDS}

    def annotation(self, cpp_type):
        if cpp_type in TYPES:
            return TYPES[cpp_type]
        if cpp_type in self.headers.enums:
            return cpp_type
        if cpp_type in self.known:
            return self.known[cpp_type].replace("::", "")
        if match := re.fullmatch(r"std::optional<(.*)>", cpp_type):
            return f"{self.annotation(match[1])} | None"
        if match := re.fullmatch(r"std::vector<(.*)>", cpp_type):
            return ARRAYS.get(match[1]) or f"tuple[{self.annotation(match[1])}, ...]"
        raise SystemExit(f"python_records.py: no Python type for {cpp_type}")

    def default(self, field):
        """Python's text of a default that is a plain number or word, or None."""
        text = field.default
        if text is None or text in ("{}", "{0, 3}"):
            return "None" if field.cpp_type.startswith("std::optional") else None
        text = text.strip()
        if text in ("true", "false"):
            return text.capitalize()
        if re.fullmatch(r"-?[\d'.]+(e-?\d+)?", text):
            return text.replace("'", "_")
        if (match := re.fullmatch(r"(\w+)::(\w+)", text)) and match[1] in self.headers.enums:
            return repr(self.headers.enums[match[1]].word(match[2])).replace("'", '"')
        return None

    def is_plain(self, name):
        """True if no field is an array or a mesh, so that records can be compared with ==."""
        return not any(re.search(r"\w*Array|Mesh\b|EdgePoints", self.annotation(field.cpp_type)) or
                       (field.cpp_type in self.known and not self.is_plain(self.known[field.cpp_type]))
                       for field in self.headers.structs[name].fields)

    def field_doc(self, struct, field):
        shape = SHAPES.get(field.cpp_type)
        doc = DOCS.get(f"{struct.python_name}.{field.name}") or text_of([field.doc])
        return f"{doc} {shape}".strip() if shape and shape not in doc else doc

    def record_doc(self, struct):
        return DOCS.get(struct.python_name) or text_of(struct.doc) or words_of(struct.python_name)

    def records(self):
        out = [RECORDS_HEAD]
        wanted = {field.cpp_type for names in (*RECORDS, *READ_ONLY_BY_MODULE)
                  for field in self.headers.structs[names].fields}
        wanted |= {match[1] for text in list(wanted) if (match := re.fullmatch(r"std::optional<(.*)>", text))}
        for name in sorted(set(self.headers.enums) & wanted | {"FrameAccuracy", "LiveStage", "HandleShape", "Domain"}):
            enum = self.headers.enums[name]
            words = ", ".join(f'"{enum.word(value)}"' for value, _ in enum.values)
            out.append(f"{name}: TypeAlias = Literal[{words}]")
            doc = text_of(enum.doc)
            notes = "; ".join(f'"{enum.word(value)}": {text_of([doc])}' for value, doc in enum.values if doc)
            if doc or notes:
                out.append(literal(" ".join(filter(None, (doc, notes))), ""))
            out.append("")
        for name in RECORDS:
            struct = self.headers.structs[name]
            attributes = [(field.name, doc) for field in struct.fields if (doc := self.field_doc(struct, field))]
            out += ["", f"@dataclass(frozen=True, kw_only=True{'' if self.is_plain(name) else ', eq=False'})",
                    f"class {struct.python_name}:", literal(self.record_doc(struct), "    ", attributes), ""]
            for field in struct.fields:
                default = self.default(field)
                out.append(f"    {field.name}: {self.annotation(field.cpp_type)}" + (f" = {default}" if default else ""))
                if doc := self.field_doc(struct, field):
                    out.append(literal(doc, "    "))
            out.append("")
        for name, (structs, changes) in KEYWORDS.items():
            out += ["", f"class {name}(TypedDict, total=False):"]
            out.append(literal("Keywords of a call. " + " ".join(text_of(self.headers.structs[s].doc) or words_of(s) for s in structs), "    "))
            out.append("")
            for struct in structs:
                header = self.headers.structs[struct]
                for field in header.fields:
                    python_name = changes.get(field.name, field.name)
                    if python_name is None:
                        continue
                    out.append(f"    {python_name}: {self.keyword_annotation(field)}")
                    default = self.default(field)
                    doc = self.field_doc(header, field) + (f" Default: {default}." if default else "")
                    if doc.strip():
                        out.append(literal(doc.strip(), "    "))
            out.append("")
        return "\n".join(out)

    def keyword_annotation(self, field):
        text = self.annotation(field.cpp_type)
        return re.sub(r" \| None$", "", text) if field.name in ("method", "preset") else text

    def docs(self):
        out = ['"""The headers\' comments on functions and classes. Made by tools/python_records.py."""', "",
               "DOCS: dict[str, str] = {"]
        for name, doc in sorted(self.headers.docs.items()):
            out.append(f"    {name!r}: {text_of(doc, keep_lines=True)!r},")
        return "\n".join([*out, "}", ""])

    def tables(self):
        """The C++ header: fields of structs and words of enumerations."""
        names = [*RECORDS, *(name for name in READ_ONLY_BY_MODULE if name not in RECORDS)]
        enums = [enum for enum in self.headers.enums.values() if enum.name not in WITHOUT_WORDS]
        files = sorted({self.headers.files[name].as_posix() for name in (*names, *(enum.name for enum in enums))})
        out = ["// Made by tools/python_records.py.", "#pragma once", "", *(f"#include <{file}>" for file in files), "",
               '#include "record_tables.h"', "", "namespace meshgraft::python {", ""]
        for enum in enums:
            words = ", ".join(f'{{{enum.name}::{value}, "{enum.word(value)}"}}' for value, _ in enum.values)
            out += [f"template <>", f"struct Words<{enum.name}> {{",
                    f"  static constexpr Word<{enum.name}> list[] = {{{words}}};", "};"]
        for name in names:
            struct = self.headers.structs[name]
            out += ["template <>", f"struct Fields<{name}> {{",
                    f'  static constexpr const char* name = "{struct.python_name}";',
                    "  template <class Record, class Visit>", "  static void visit(Record& record, const Visit& visit) {"]
            out += [f'    visit("{field.name}", record.{field.name});' for field in struct.fields]
            out += ["  }", "};"]
        return "\n".join([*out, "", "}  // namespace meshgraft::python", ""])


def text_of(lines, keep_lines=False):
    """A comment in the words of Python."""
    text = ("\n" if keep_lines else " ").join(lines).strip()
    text = re.sub(r"\bThrows\b", "Raises", text)
    text = re.sub(r"\bthrows\b", "raises", text)
    text = re.sub(r"\bError\((\w+)\)", lambda match: ERRORS.get(match[1], match[0]), text)
    for name, python in NAMES.items():
        text = re.sub(rf"\b{name}\b", python, text)
    text = re.sub(r"\b(\w+)::(\w+)\b", r"\1.\2", text)
    return text


def words_of(name):
    """A sentence for a struct without a comment: "Cut options." """
    return re.sub(r"(?<!^)([A-Z])", lambda match: " " + match[1].lower(), name) + "."


ERRORS = {"usage": "UsageError", "input": "InputError", "unsolvable": "UnsolvableError", "io": "FileError",
          "memory": "OutOfMemoryError", "cancelled": "Cancelled", "internal": "Error"}


def escaped(text):
    return text.replace("\\", "\\\\").replace('"""', "'''")


def literal(text, indent, attributes=()):
    """A docstring, wrapped. A section tells of the attributes, which help() does not find elsewhere."""
    words, lines, line = escaped(text).split(), [], indent + '"""'
    for word in words:
        if len(line) + len(word) + 1 > 116:
            lines.append(line)
            line = indent + word
        else:
            line += word if line.endswith('"""') and not line.strip('" ') else " " + word
    if attributes:
        lines += [line, "", f"{indent}Attributes:"]
        for name, doc in attributes:
            lines += textwrap.wrap(escaped(f"{name}: {doc}"), 116, initial_indent=indent + "    ",
                                   subsequent_indent=indent + "        ", break_long_words=False)
        line = indent
    elif line.endswith('"'):
        line += " "
    return "\n".join([*lines, line + '"""'])


RECORDS_HEAD = '''"""What functions report, what they take, and the words of closed lists. Made by tools/python_records.py."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypedDict

import numpy as np
from numpy.typing import NDArray

from meshgraft._facts import Note

if TYPE_CHECKING:
    from meshgraft._mesh import Mesh

FloatArray: TypeAlias = NDArray[np.float64]
Float32Array: TypeAlias = NDArray[np.float32]
IndexArray: TypeAlias = NDArray[np.int32]
SideArray: TypeAlias = NDArray[np.int8]
FlagArray: TypeAlias = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True, eq=False)
class EdgePoints:
    """The origins of elements of a new mesh between two old ones: (1 - t) * start + t * end. Arrays of equal length."""

    start: IndexArray
    end: IndexArray
    t: FloatArray

'''


def main(arguments):
    include, out = Path(arguments[0]) / "meshgraft", Path(arguments[1])
    python = Python(Headers(include))
    out.mkdir(parents=True, exist_ok=True)
    for name, text in (("_records.py", python.records()), ("_docs.py", python.docs()), ("records.h", python.tables())):
        path = out / name
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
