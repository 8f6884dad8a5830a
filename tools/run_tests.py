#!/usr/bin/env python3
"""Builds and runs the tests in every configuration that counts, and sums up.

    tools/run_tests.py               all of them
    tools/run_tests.py release asan  some of them

The end names each failed test with a line of its output. The last line is "N passed, N failed" over all
configurations; the exit status is 1 if anything failed. A configuration that does not build counts as one failure and
does not stop the others.
"""

import os
import shutil
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# Preset of CMakePresets.json: what it is for.
CONFIGURATIONS = {
    "release": "everything but the few tests on large meshes (make test-long)",
    "minimal": "the solver and all above it without the optional libraries",
    "asan": "the tests labelled small, with address and undefined-behaviour sanitizers",
    "tsan": "the tests of several threads, with the thread sanitizer",
}


class Count:
    """How many tests passed, failed and were skipped, and a line for each that failed."""

    def __init__(self, passed=0, failed=0, skipped=0, failures=()):
        self.passed, self.failed, self.skipped, self.failures = passed, failed, skipped, list(failures)

    def __add__(self, other):
        return Count(self.passed + other.passed, self.failed + other.failed, self.skipped + other.skipped,
                     self.failures + other.failures)

    def fail(self, failure):
        self.failed += 1
        self.failures.append(failure)

    def __str__(self):
        return f"{self.passed} passed, {self.failed} failed"


def run(*command):
    """True if the command succeeds."""
    return subprocess.run(command, cwd=ROOT).returncode == 0


def find_reason(output):
    """The line of a failed test's output that says most: GoogleTest's two after "Failure", else the last error."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    for number, line in enumerate(lines):
        if line.endswith("Failure"):
            return " ".join(lines[number + 1:number + 3])
    errors = [line for line in lines if "error" in line.lower()]
    return (errors or lines or ["no output"])[-1]


def read_results(junit):
    """Counts of a JUnit file of ctest's. A test that could not be started has the status "notrun", as a skipped
    one, but no message of a skip."""
    count = Count()
    for case in ElementTree.parse(junit).getroot().iter("testcase"):
        skip = case.find("skipped")
        failure = f"{case.get('name')}: {find_reason(case.findtext('system-out', ''))[:160]}"
        if case.find("failure") is not None:
            count.fail(failure)
        elif case.get("status") == "disabled" or (skip is not None and skip.get("message", "").startswith("SKIP_")):
            count.skipped += 1
        elif skip is None:
            count.passed += 1
        else:
            count.fail(failure)
    return count


def test(preset):
    """Configures, builds and runs one configuration."""
    configure = ["cmake", "--preset", preset, "-DMESHGRAFT_BUILD_TESTS=ON"]
    if preset == "release":
        configure.append("-DMESHGRAFT_BUILD_PYTHON=ON")
    if not run(*configure) or not run("cmake", "--build", "--preset", preset):
        return Count(failed=1, failures=["does not build"])
    junit = ROOT / "build" / preset / "tests.xml"
    junit.unlink(missing_ok=True)
    succeeded = run("ctest", "--preset", preset, "--output-junit", str(junit))
    count = read_results(junit) if junit.exists() else Count()
    if not succeeded and count.failed == 0:
        count.fail("ctest failed without a failed test")
    return count


def main(names):
    unknown = [name for name in names if name not in CONFIGURATIONS]
    if unknown:
        sys.exit(f"run_tests.py: no configuration {', '.join(unknown)}; there are {', '.join(CONFIGURATIONS)}")
    os.environ.setdefault("CTEST_PARALLEL_LEVEL", str(os.cpu_count() or 1))
    if shutil.which("ccache"):  # configurations that compile a source alike do it once
        os.environ.setdefault("CMAKE_CXX_COMPILER_LAUNCHER", "ccache")
        os.environ.setdefault("CCACHE_BASEDIR", str(ROOT))  # and clones in other places, too
        os.environ.setdefault("CCACHE_NOHASHDIR", "1")

    lines, total = [], Count()
    for name in names or CONFIGURATIONS:
        print(f"\n== {name}: {CONFIGURATIONS[name]}", flush=True)
        start = time.monotonic()
        count = test(name)
        skipped = f", {count.skipped} skipped" if count.skipped else ""
        lines.append(f"{name:<12} {count}{skipped} ({time.monotonic() - start:.0f} s)")
        count.failures = [f"{name}: {failure}" for failure in count.failures]
        total += count

    print("", *total.failures, *lines, sep="\n")
    if total.skipped:
        print(f"{total.skipped} skipped: see \"Skipped\" above for the reason")
    print(total, flush=True)
    return 1 if total.failed or not total.passed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
