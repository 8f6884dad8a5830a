"""Tests that tools/run_tests.py counts ctest's results, and counts no test as a success that did not run."""

import contextlib
import io
import sys
import tempfile
import threading
import unittest
from pathlib import Path
from unittest import mock

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
        vitest = " FAIL  a.test.ts > it\nTimeoutError: 60 s\nCall log:\n ❯ a.test.ts:7:9\n 5| x\nTests 1 failed\n"
        self.assertEqual(run_tests.find_reason(vitest), "a.test.ts:7:9: TimeoutError: 60 s")
        self.assertEqual(run_tests.find_reason(""), "no output")
        count = run_tests.Count()
        count.fail("b: 1 != 2")
        self.assertEqual((run_tests.Count(1) + count).failures, ["b: 1 != 2"])

    def test_second_attempts_are_named(self):
        line = "passed at a second attempt: e2e/a.test.ts:7: opens: TimeoutError: 60 s"
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "tests.xml"
            path.write_text(f'<testsuite><testcase name="page/e2e/a" status="run"><system-out>ok\n{line}\nok'
                            "</system-out></testcase></testsuite>", encoding="utf-8")
            count = run_tests.read_results(path)
        self.assertEqual((count.passed, count.retries), (1, [line]))
        self.assertEqual((run_tests.Count(1) + count).retries, [line])

    def test_last_line(self):
        self.assertEqual(str(run_tests.Count(3, 1, 2) + run_tests.Count(1, 0, 0)), "4 passed, 1 failed")

    def run_with(self, build, test):
        """Exit status and output of a run of all configurations, with these functions in place of its own."""
        said = io.StringIO()
        with mock.patch.multiple(run_tests, build=build, test=test), contextlib.redirect_stdout(said):
            status = run_tests.main([])
        return status, said.getvalue()

    def test_builds_a_configuration_while_the_one_before_is_tested(self):
        names = list(run_tests.CONFIGURATIONS)
        built = {name: threading.Event() for name in names}

        def build(name, log):
            log.write_text(f"builds {name}\n", encoding="utf-8")
            built[name].set()
            return True

        def test(name):
            following = names[names.index(name) + 1:]
            return run_tests.Count(passed=all(built[other].wait(60) for other in [name, *following]))

        status, said = self.run_with(build, test)
        self.assertEqual(status, 0, said)
        self.assertEqual([line for line in said.splitlines() if line.startswith("builds")],
                         [f"builds {name}" for name in names])
        self.assertTrue(said.endswith(f"\n{len(names)} passed, 0 failed\n"), said)

    def test_what_does_not_build_failed_and_stops_no_other(self):
        tested = []

        def test(name):
            tested.append(name)
            return run_tests.Count(passed=1)

        status, said = self.run_with(lambda name, log: name != "release", test)
        self.assertEqual(tested, [name for name in run_tests.CONFIGURATIONS if name != "release"])
        self.assertEqual(status, 1)
        self.assertIn("release: does not build", said)
        self.assertTrue(said.endswith(f"\n{len(tested)} passed, 1 failed\n"), said)

    def test_a_build_ends_with_the_first_command_that_fails(self):
        with tempfile.TemporaryDirectory() as folder:
            log, after = Path(folder) / "log", Path(folder) / "after"
            for middle, is_built in ("true", True), ("false", False):
                commands = [["echo", "begun"], [middle], ["touch", str(after)]]
                after.unlink(missing_ok=True)
                with mock.patch.object(run_tests, "build_commands", lambda _, commands=commands: commands):
                    self.assertEqual(run_tests.build("release", log), is_built)
                self.assertEqual((log.read_text(encoding="utf-8"), after.exists()), ("begun\n", is_built))

    def test_unknown_configuration(self):
        with self.assertRaises(SystemExit):
            run_tests.main(["debug"])


if __name__ == "__main__":
    unittest.main()
