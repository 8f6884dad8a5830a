"""Tests tools/facts.py on small made-up tables and on the tables of the repository."""

import contextlib
import io
import json
import re
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import facts  # noqa: E402

CUT = {"code": "input", "problem": "{n:face is|faces are} cut at {x:.2g}", "remedy": "Cut elsewhere.",
       "fields": {"n": "integer", "x": "number"}}
STRING = re.compile(r'"((?:\\.|[^"\\])*)"')
COMMAND = re.compile(r"(^|[\s'(])--[a-z]|\bmeshgraft (check|compare|cut|deform|edit|info|merge|render|repair|run|sample)\b")


class Facts(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.out = Path(self.folder.name)

    def table(self, **rows):
        path = self.out / "mesh" / "facts.json"
        path.parent.mkdir(exist_ok=True)
        path.write_text(json.dumps(rows))
        return str(path)

    def assert_refused(self, words, *command):
        with self.assertRaises(SystemExit) as refused:
            facts.main(*command)
        self.assertIn(words, str(refused.exception))

    def test_makes_a_record_of_each_row(self):
        facts.main("types", "meshgraft", str(self.out), self.table(plane_cuts=CUT, left_open={"note": "a hole is left"}))
        header = (self.out / "mesh/facts.h").read_text()
        self.assertIn('struct PlaneCuts {\n  static constexpr std::string_view id = "mesh.plane_cuts";\n  Integer n;\n'
                      "  Number x;", header)
        self.assertIn("struct LeftOpen", header)
        self.assertIn("ErrorCode::input", (self.out / "facts.cpp").read_text())

    def test_makes_an_enumeration_of_a_list_of_words(self):
        row = {"note": "cannot be {action}", "fields": {"action": "action"}}
        table = self.table(failed=row, words={"action": {"read": "read", "write": "written"}})
        facts.main("types", "meshgraft", str(self.out), table)
        self.assertIn("enum class Action { read, write };", (self.out / "mesh/facts.h").read_text())
        self.assertIn("  Word<Action> action;\n", (self.out / "mesh/facts.h").read_text())
        self.assertIn('{"write", "written"}', (self.out / "facts.cpp").read_text())
        for words in [{"write": "written", "No": "no"}, {"write": ""}]:
            self.assert_refused("no identifier with a text", "types", "meshgraft", str(self.out),
                                self.table(failed=row, words={"action": words}))
        for lists in [{"action": {"read": "read"}, "shape": {"line": "line"}}, {"integer": {"read": "read"}}]:
            self.assert_refused("has no use", "types", "meshgraft", str(self.out), self.table(failed=row, words=lists))
        self.assert_refused("of the kind action", "types", "meshgraft", str(self.out), self.table(failed=row))

    def test_leaves_files_that_say_the_same_untouched(self):
        table = self.table(plane_cuts=CUT)
        facts.main("types", "meshgraft", str(self.out), table)
        before = (self.out / "mesh/facts.h").stat().st_mtime_ns
        facts.main("types", "meshgraft", str(self.out), table)
        self.assertEqual((self.out / "mesh/facts.h").stat().st_mtime_ns, before)

    def test_refuses_rows_that_make_no_sense(self):
        for words, change in [("names a field 'm'", {"problem": "{m} faces"}), ("full stop", {"problem": "Cut."}),
                              ("does not end", {"remedy": "Cut it"}), ("has the code", {"code": "odd"}),
                              ("of the kind", {"fields": {"n": "complex"}}), ("lacks its text", {"problem": ""}),
                              ("has no odd", {"odd": 1})]:
            self.assert_refused(words, "types", "meshgraft", str(self.out), self.table(plane_cuts={**CUT, **change}))

    def test_words_of_an_interface_are_of_rows_that_exist(self):
        texts = self.out / "texts.json"
        texts.write_text(json.dumps({"mesh.plane_cuts": {"remedy": "Give another --plane than {x}."}}))
        facts.main("texts", str(self.out / "texts.inc"), str(texts), self.table(plane_cuts=CUT))
        self.assertIn('"Give another --plane than {x}."}', (self.out / "texts.inc").read_text())
        texts.write_text(json.dumps({"mesh.no_such": {"remedy": "Go."}}))
        self.assert_refused("mesh.no_such", "texts", str(self.out / "texts.inc"), str(texts), self.table(plane_cuts=CUT))


class Repository(unittest.TestCase):
    def test_the_list_of_facts_is_that_of_the_tables(self):
        tables = sorted(map(str, [*ROOT.glob("src/*/facts.json"), *ROOT.glob("src/io/*/facts.json")]))
        listed = io.StringIO()
        with contextlib.redirect_stdout(listed):
            facts.main("list", *tables, str(ROOT / "cli/facts.json"), str(ROOT / "python/facts.json"))
        self.assertTrue(listed.getvalue() == (ROOT / "docs/facts.md").read_text(),
                        "docs/facts.md is not that of the tables: make facts")

    def test_the_library_names_no_flag_and_no_command(self):
        for path in sorted((ROOT / "src").rglob("*")):
            if path.suffix not in (".h", ".cpp", ".json"):
                continue
            for number, line in enumerate(path.read_text().splitlines(), start=1):
                if line.lstrip().startswith("//"):
                    continue
                for string in STRING.findall(line):
                    self.assertIsNone(COMMAND.search(string), f"{path}:{number}: {string}")


if __name__ == "__main__":
    unittest.main()
