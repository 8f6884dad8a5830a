"""Tests tools/python_records.py on a made-up header, and on the public headers."""

import ast
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import python_records  # noqa: E402

HEADER = """
namespace meshgraft {

/// Kinds of bends.
enum class Bend {
  automatic,  ///< the better one
  very_soft,  ///< hardly any
};

/// What a bend reports. Throws Error(input) never.
struct BendReport {
  Index count = 0;  ///< number of bends
  double low = 1, high = 2.5;
  /// Where it
  /// bends, n×3.
  Points places;
  std::optional<double> limit{};
  std::vector<std::vector<Index>> loops;
  Bend bend = Bend::very_soft;

  bool any() const { return count > 0; }
  double sum(double scale) const;
  struct Part {
    std::string name;
  };
};

/// Bends a mesh. Throws Error(unsolvable).
BendReport bend_mesh(const Points& points);

/// A bender.
class Bender {
 public:
  /// Bends once more.
  void bend(int times);
};

}  // namespace meshgraft
"""


class Records(unittest.TestCase):
    def headers(self, text):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = Path(folder.name) / "meshgraft"
        path.mkdir()
        (path / "bend.h").write_text(text, encoding="utf-8")
        return python_records.Headers(path)

    def test_fields_have_types_defaults_and_comments(self):
        headers = self.headers(HEADER)
        fields = headers.structs["BendReport"].fields
        self.assertEqual([field.name for field in fields],
                         ["count", "low", "high", "places", "limit", "loops", "bend"])
        python = python_records.Python(headers)
        self.assertEqual([python.annotation(field.cpp_type) for field in fields],
                         ["int", "float", "float", "FloatArray", "float | None", "tuple[IndexArray, ...]", "Bend"])
        self.assertEqual([python.default(field) for field in fields],
                         ["0", "1", "2.5", None, "None", None, '"very-soft"'])
        self.assertEqual([fields[0].doc, fields[3].doc], ["number of bends", "Where it bends, n×3."])
        self.assertEqual(headers.structs["BendReport::Part"].fields[0].name, "name")
        self.assertFalse(python.is_plain("BendReport"))

    def test_words_and_comments_are_pythons(self):
        headers = self.headers(HEADER)
        bend = headers.enums["Bend"]
        self.assertEqual([bend.word(value) for value, _ in bend.values], ["auto", "very-soft"])
        self.assertEqual(python_records.text_of(headers.docs["bend_mesh"]), "Bends a mesh. Raises UnsolvableError.")
        self.assertEqual(headers.docs["Bender.bend"], ["Bends once more."])

    def test_an_unknown_type_is_an_error(self):
        headers = self.headers(HEADER.replace("Points places", "Sculpture places"))
        with self.assertRaisesRegex(SystemExit, "Sculpture"):
            python_records.Python(headers).annotation("Sculpture")

    def test_the_public_headers_become_python(self):
        python = python_records.Python(python_records.Headers(ROOT / "include/meshgraft"))
        tree = ast.parse(python.records())
        classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        for name in python_records.RECORDS:
            struct = python.headers.structs[name]
            fields = [node.target.id for node in classes[struct.python_name].body if isinstance(node, ast.AnnAssign)]
            self.assertEqual(fields, [field.name for field in struct.fields], name)
            self.assertTrue(fields, name)
        ast.parse(python.docs())
        self.assertIn('visit("free_vertices", record.free_vertices);', python.tables())

    def test_sentences_for_python_are_of_records_and_fields_that_exist(self):
        python = python_records.Python(python_records.Headers(ROOT / "include/meshgraft"))
        structs = [python.headers.structs[name] for name in python_records.RECORDS]
        names = {struct.python_name for struct in structs}
        names |= {f"{struct.python_name}.{field.name}" for struct in structs for field in struct.fields}
        self.assertLessEqual(python_records.DOCS.keys(), names)
        tree = ast.parse(python.records())
        for record in ("CutResult", "MergeReport", "RepairResult", "SampleInfo", "WriteResult"):
            body = next(node.body for node in tree.body if isinstance(node, ast.ClassDef) and node.name == record)
            self.assertGreater(len(body[0].value.value.split()), 5, record)
            for field, doc in zip(body[1:], [*body[2:], None]):
                if isinstance(field, ast.AnnAssign) and field.target.id not in ("mesh", "changes", "notes"):
                    self.assertIsInstance(doc, ast.Expr, f"{record}.{field.target.id}")

    def test_keywords_are_the_settings_of_edit_files(self):
        """What `meshgraft.deform` takes is what a deform step's settings take."""
        python = python_records.Python(python_records.Headers(ROOT / "include/meshgraft"))
        tree = ast.parse(python.records())
        keywords = {node.name: {entry.target.id for entry in node.body if isinstance(entry, ast.AnnAssign)}
                    for node in tree.body if isinstance(node, ast.ClassDef)}
        parts = (ROOT / "src/script/parse_parts.h").read_text(encoding="utf-8")
        fields = set(ast.literal_eval("[" + parts.split("deformer_fields = {")[1].split("}")[0] + "]"))
        self.assertEqual(keywords["DeformKeywords"], fields)


if __name__ == "__main__":
    unittest.main()
