"""Tests that tools/run_tests.py counts ctest's results, and counts no test as a success that did not run."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import run_tests  # noqa: E402

CASES = {
    "passed": '<testcase name="a" status="run"/>',
    "failed": '<testcase name="b" status="fail"><failure message="1 != 2"/></testcase>',
    "skipped": '<testcase name="c" status="notrun"><skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/></testcase>',
    "disabled": '<testcase name="e" status="disabled"/>',
    "missing": '<testcase name="d" status="notrun"><skipped message="Unable to find executable"/></testcase>',
}


class RunTests(unittest.TestCase):
    def count(self, *kinds):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "tests.xml"
            path.write_text("<testsuite>" + "".join(CASES[kind] for kind in kinds) + "</testsuite>", encoding="utf-8")
            count = run_tests.read_results(path)
        return count.passed, count.failed, count.skipped

    def test_counts(self):
        self.assertEqual(self.count(), (0, 0, 0))
        self.assertEqual(self.count("passed", "passed", "skipped", "disabled", "failed"), (2, 1, 2))

    def test_what_could_not_be_started_failed(self):
        self.assertEqual(self.count("missing", "passed"), (1, 1, 0))

    def test_failures_are_named_with_a_reason(self):
        gtest = "[ RUN ] A.B\n/a_test.cpp:7: Failure\nValue of: x\n  Actual: 2\n[ FAILED ] A.B\n"
        self.assertEqual(run_tests.find_reason(gtest), "Value of: x Actual: 2")
        self.assertEqual(run_tests.find_reason("Traceback\nValueError: no\nFAILED (1)\n\n"), "ValueError: no")
        self.assertEqual(run_tests.find_reason(""), "no output")
        count = run_tests.Count()
        count.fail("b: 1 != 2")
        self.assertEqual((run_tests.Count(1) + count).failures, ["b: 1 != 2"])

    def test_last_line(self):
        self.assertEqual(str(run_tests.Count(3, 1, 2) + run_tests.Count(1, 0, 0)), "4 passed, 1 failed")

    def test_unknown_configuration(self):
        with self.assertRaises(SystemExit):
            run_tests.main(["debug"])


if __name__ == "__main__":
    unittest.main()
