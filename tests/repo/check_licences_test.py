"""Tests that tools/check_licences.py finds the violations of made-up tables and trees, and no others."""

import json
import shutil
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import check_licences  # noqa: E402

HEAD = "| project | licence | used for | where | libraries and headers |\n|---|---|---|---|---|\n"
FMT = "| [fmt](https://fmt.dev) | MIT | text | library | `libfmt` `fmt/` |\n"
SYSTEM = (
    "| GCC's runtime libraries | GPL-3.0+ with the runtime library exception | the runtime | system | `libgcc_s` |\n"
    "| GNU C library | LGPL-2.1+, linked dynamically | the C library | system | `libc` `libm` `ld-linux-x86-64` `linux-vdso` |\n"
)


class CheckLicences(unittest.TestCase):
    def violations(self, table, files=None, binaries=()):
        """Returns the violations of a table and of a tree given as {path: text}."""
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in {"THIRD_PARTY.md": "# Title\n\n" + table, **(files or {})}.items():
                path = root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return check_licences.check(root, binaries)

    def test_what_stands_in_the_table_is_fine(self):
        source = "#include <fmt/format.h>\n#include <vector>\n#include <sys/stat.h>\n#include <meshgraft/mesh.h>\n"
        self.assertEqual(self.violations(HEAD + FMT + SYSTEM, {"src/a.cpp": source}), [])

    def test_a_header_without_a_row_is_named_with_its_line(self):
        for header in ("cholmod.h", "CGAL/enum.h", "fmtlike/x.h"):
            for folder in ("src/a", "include/meshgraft/a", "cli"):
                found = self.violations(HEAD + FMT, {f"{folder}/b.h": f"\n#include <{header}>\n"})
                self.assertEqual(found, [f"{folder}/b.h:2: THIRD_PARTY.md has no row for <{header}>"])

    def test_tests_may_include_what_they_like(self):
        self.assertEqual(self.violations(HEAD + FMT, {"tests/a.cpp": "#include <CGAL/enum.h>\n"}), [])

    def test_what_only_tests_use_may_not_be_included_by_the_library(self):
        row = "| CGAL | GPL-3.0+ | to compare with | tests only | `CGAL/` |\n"
        self.assertEqual(len(self.violations(HEAD + row, {"src/a.cpp": "#include <CGAL/enum.h>\n"})), 1)
        self.assertEqual(self.violations(HEAD + row), [])

    def test_gpl_is_refused_in_what_is_passed_on(self):
        for licence in ("GPL-2.0+", "GPLv2+", "LGPL-3.0+", "LGPL2.1", "AGPL-3.0", "MIT, GPL-2.0"):
            for where in ("library", "program, optional", "system"):
                row = f"| x | {licence} | y | {where} | `libx` |\n"
                self.assertEqual(len(self.violations(HEAD + row)), 1, (licence, where))
        self.assertEqual(self.violations(HEAD + SYSTEM), [])
        self.assertEqual(self.violations(HEAD + "| x | MIT; a file LGPL-2.1+, linked dynamically | y | library | |\n"), [])

    def test_packages_of_the_page_are_read_from_its_lock_file(self):
        def lock(licence, **more):
            return {"page/package-lock.json": json.dumps(
                {"packages": {"": {}, "node_modules/x": {"license": licence, **more}}})}
        self.assertEqual(self.violations(HEAD + FMT, lock("MIT")), [])
        self.assertEqual(self.violations(HEAD + FMT, lock("GPL-3.0", dev=True)), [])
        self.assertEqual(len(self.violations(HEAD + FMT, lock("GPL-3.0"))), 1)

    def test_a_file_that_is_no_binary_is_named(self):
        found = self.violations(HEAD + FMT, {"text": "text"}, binaries=[__file__])
        self.assertEqual(len(found), 1)
        self.assertIn("ldd cannot read it", found[0])

    def test_a_page_without_a_table_is_refused(self):
        self.assertEqual(self.violations("no table"), ["THIRD_PARTY.md: no table"])

    @unittest.skipUnless(shutil.which("ldd") and Path("/bin/ls").exists(), "needs ldd and a binary")
    def test_a_library_without_a_row_is_named(self):
        linked = set(check_licences.linked_libraries("/bin/ls"))
        self.assertIn("libc", linked)
        found = self.violations(HEAD + FMT, binaries=["/bin/ls"])
        self.assertEqual(len(found), len(linked))
        self.assertTrue(any("no row for libc," in problem for problem in found))
        row = "| all | MIT | y | program | " + " ".join(f"`{name}`" for name in linked) + " |\n"
        self.assertEqual(self.violations(HEAD + row, binaries=["/bin/ls"]), [])


if __name__ == "__main__":
    unittest.main()
