#!/usr/bin/env python3
"""Builds and runs the tests in every configuration that counts, and sums up.

    tools/run_tests.py                  all of them
    tools/run_tests.py minimal release  some of them, as `make test` does

While one configuration is tested, the next ones are built: tests wait for pictures, disks and each other, and builds wait
for downloads. The end names each failed test with a line of its output and each test that passed only at a second
attempt, then the seconds of the tests of each configuration. The last line is "N passed, N failed" over all of them;
the exit status is 1 if anything failed. A configuration that does not build counts as one failure and does not stop the
others.
"""

import codecs
import os
import shutil
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# Preset of CMakePresets.json: what it is for. The first is built in seconds, the second with the tests' Python.
CONFIGURATIONS = {
    "minimal": "the solver and all above it without the optional libraries",
    "release": "everything but the few tests on large meshes (make test-long)",
    "asan": "the tests labelled small, with address and undefined-behaviour sanitizers",
    "tsan": "the tests of several threads, with the thread sanitizer",
}

VITEST_PLACE = "❯ "  # before the file, line and column of an error in Vitest's output
SECOND_ATTEMPT = "passed at a second attempt: "  # before such a test's name in the page's tests (page/vitest.config.ts)
OUTPUT_SIZE = 1 << 20  # bytes of a test's output that ctest hands on


class Count:
    """How many tests passed, failed and were skipped, and a line for each that failed or passed at a second attempt."""

    def __init__(self, passed=0, failed=0, skipped=0, failures=(), retries=()):
        self.passed, self.failed, self.skipped = passed, failed, skipped
        self.failures, self.retries = list(failures), list(retries)

    def __add__(self, other):
        return Count(self.passed + other.passed, self.failed + other.failed, self.skipped + other.skipped,
                     self.failures + other.failures, self.retries + other.retries)

    def fail(self, failure):
        self.failed += 1
        self.failures.append(failure)

    def __str__(self):
        return f"{self.passed} passed, {self.failed} failed"


def run(*command, output=None):
    """True if the command succeeds. Its output goes to a file, if one is given."""
    return subprocess.run(command, cwd=ROOT, stdout=output, stderr=subprocess.STDOUT if output else None).returncode == 0


def build(preset, log):
    """True if a configuration could be built. Its output goes to a file. What the system refuses is a failure, too.
    Tests that run meanwhile come first."""
    with log.open("wb") as output:
        try:
            return all(run("nice", *command, output=output) for command in build_commands(preset))
        except OSError as error:
            output.write(f"run_tests.py: {error}\n".encode())
            return False


def follow(path, work):
    """Prints what is written to a file until `work`, a future, is done. Returns the result of `work`."""
    decoder = codecs.getincrementaldecoder("utf-8")("replace")  # what is read may end within a character
    with open(path, "rb") as file:
        while True:
            is_done = work.done()  # before the last reading
            sys.stdout.write(decoder.decode(file.read()))
            sys.stdout.flush()
            if is_done:
                return work.result()
            time.sleep(0.1)


def find_reason(output):
    """The line of a failed test's output that says most: GoogleTest's two after "Failure", Vitest's last error with the
    line of the test, else the last error."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    for number, line in enumerate(lines):
        if line.endswith("Failure"):
            return " ".join(lines[number + 1:number + 3])
    errors = [number for number, line in enumerate(lines) if "error" in line.lower()]
    if not errors:
        return (lines or ["no output"])[-1]
    place = next((line for line in lines[errors[-1]:] if line.startswith(VITEST_PLACE)), None)
    error = lines[errors[-1]]
    return error if place is None else f"{place.removeprefix(VITEST_PLACE)}: {error}"


def read_results(junit):
    """Counts of a JUnit file of ctest's. A test that could not be started has the status "notrun", as a skipped
    one, but no message of a skip."""
    count = Count()
    for case in ElementTree.parse(junit).getroot().iter("testcase"):
        skip = case.find("skipped")
        output = case.findtext("system-out", "")
        failure = f"{case.get('name')}: {find_reason(output)[:160]}"
        count.retries += [line[:200] for line in output.splitlines() if line.startswith(SECOND_ATTEMPT)]
        if case.find("failure") is not None:
            count.fail(failure)
        elif case.get("status") == "disabled" or (skip is not None and skip.get("message", "").startswith("SKIP_")):
            count.skipped += 1
        elif skip is None:
            count.passed += 1
        else:
            count.fail(failure)
    return count


def build_commands(preset):
    configure = ["cmake", "--preset", preset, "-DMESHGRAFT_BUILD_TESTS=ON"]
    build = ["cmake", "--build", "--preset", preset]
    if preset != "release":
        return [configure, build]
    cluster = ["-DMESHGRAFT_WITH_PETSC=ON"] if has_petsc() else []
    return [[str(ROOT / "tools/bootstrap.sh"), "test"], [*configure, "-DMESHGRAFT_BUILD_PYTHON=ON", *cluster], build]


def has_petsc():
    """True if what meshgraft-mpi needs is installed. Otherwise its tests are skipped."""
    programs = shutil.which("pkg-config") and shutil.which("mpirun")
    return bool(programs) and subprocess.run(["pkg-config", "--exists", "PETSc"]).returncode == 0


def test(preset):
    """Runs the tests of a configuration that is built."""
    junit = ROOT / "build" / preset / "tests.xml"
    junit.unlink(missing_ok=True)
    succeeded = run("ctest", "--preset", preset, "--output-junit", str(junit),
                    "--test-output-size-passed", str(OUTPUT_SIZE))
    count = read_results(junit) if junit.exists() else Count()
    if not succeeded and count.failed == 0:
        count.fail("ctest failed without a failed test")
    return count


def main(names):
    unknown = [name for name in names if name not in CONFIGURATIONS]
    if unknown:
        sys.exit(f"run_tests.py: no configuration {', '.join(unknown)}; there are {', '.join(CONFIGURATIONS)}")
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(errors="replace")  # where it is not UTF-8
    os.environ.setdefault("CTEST_PARALLEL_LEVEL", str(os.cpu_count() or 1))
    if shutil.which("ccache"):  # configurations that compile a source alike do it once
        os.environ.setdefault("CMAKE_CXX_COMPILER_LAUNCHER", "ccache")
        os.environ.setdefault("CCACHE_BASEDIR", str(ROOT))  # and clones in other places, too
        os.environ.setdefault("CCACHE_NOHASHDIR", "1")

    names = names or list(CONFIGURATIONS)
    lines, total = [], Count()
    # One builder: a build takes all processors by itself.
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(max_workers=1) as builder:
        logs = {name: Path(folder) / name for name in names}
        builds = {}
        for name, log in logs.items():
            log.touch()
            builds[name] = builder.submit(build, name, log)
        try:
            for name in names:
                print(f"\n== {name}: {CONFIGURATIONS[name]}", flush=True)
                is_built = follow(logs[name], builds[name])
                start = time.monotonic()
                count = test(name) if is_built else Count(failed=1, failures=["does not build"])
                skipped = f", {count.skipped} skipped" if count.skipped else ""
                lines.append(f"{name:<12} {count}{skipped} ({time.monotonic() - start:.0f} s)")
                count.failures = [f"{name}: {failure}" for failure in count.failures]
                count.retries = [f"{name}: {retry}" for retry in count.retries]
                total += count
        finally:
            builder.shutdown(cancel_futures=True)

    print("", *total.failures, *total.retries, *lines, sep="\n")
    if total.skipped:
        print(f"{total.skipped} skipped: see \"Skipped\" above for the reason")
    print(total, flush=True)
    return 1 if total.failed or not total.passed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
