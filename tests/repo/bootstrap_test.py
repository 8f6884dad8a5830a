"""Tests tools/bootstrap.sh on made-up systems: folders with only the commands that such a system has."""

import os
import shutil
import stat
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BASICS = ("bash", "env", "awk", "sed", "grep", "dirname", "cat")


def packages(*groups):
    lines = (ROOT / "tools/packages.txt").read_text(encoding="utf-8").splitlines()
    fields = [line.split() for line in lines if line and not line.startswith("#")]
    return list(dict.fromkeys(name for group, name, *_ in fields if group in groups))


class Bootstrap(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.bin = Path(folder.name)
        for name in BASICS:
            (self.bin / name).symlink_to(shutil.which(name))
        self.calls = self.bin / "calls"
        self.calls.touch()
        self.venv = self.bin / "venv"  # one that is there and current
        self.venv.mkdir()
        (self.venv / "requirements.txt").write_bytes((ROOT / "python/requirements.txt").read_bytes())

    def command(self, name, script=""):
        """Adds a command that notes its call and then runs `script`."""
        path = self.bin / name
        path.write_text(f'#!/usr/bin/env bash\necho "{name} $*" >> "{self.calls}"\n{script}\n', encoding="utf-8")
        path.chmod(path.stat().st_mode | stat.S_IXUSR)

    def debian(self, installed, user=0, sudo=True, apt="exit 0"):
        table = self.bin / "installed"
        table.write_text("".join(f"installed {name}\n" for name in installed), encoding="utf-8")
        self.command("dpkg-query", f'cat "{table}"')
        self.command("apt-get", apt)
        self.command("id", f"echo {user}")
        if sudo:
            self.command("sudo", '"$@"')

    def run_for(self, *groups, **variables):
        # bash by its full path: PATH here is the made-up system's
        result = subprocess.run([shutil.which("bash"), ROOT / "tools/bootstrap.sh", *groups], text=True,
                                capture_output=True, env={"PATH": str(self.bin), "MESHGRAFT_VENV": str(self.venv), **variables})
        calls = [line for line in self.calls.read_text().splitlines() if not line.startswith(("dpkg-query", "id"))]
        return result, calls

    def test_silent_where_all_is_there(self):
        self.debian(packages("build", "test"))
        result, calls = self.run_for("build", "test")
        self.assertEqual((result.returncode, result.stdout, result.stderr, calls), (0, "", "", []))

    def test_takes_node_and_npm_from_elsewhere(self):
        self.debian([name for name in packages("build") if name not in ("nodejs", "npm")])
        self.command("node")
        self.command("npm")
        result, calls = self.run_for("build")
        self.assertEqual((result.returncode, result.stdout, calls), (0, "", []))

    def test_installs_only_what_is_missing_and_says_why(self):
        self.debian([name for name in packages("build") if name not in ("libtbb-dev", "libpng-dev")])
        result, calls = self.run_for("build")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertRegex(result.stdout, r"libtbb-dev +threads")
        self.assertNotIn("libeigen3-dev", result.stdout)
        self.assertEqual(calls, ["apt-get update -qq",
                                 "apt-get install -y -qq --no-install-recommends libtbb-dev libpng-dev"])

    def test_asks_for_root_through_sudo(self):
        self.debian([], user=1000)
        result, calls = self.run_for("test")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(calls[0], "sudo apt-get update -qq")
        self.assertTrue(calls[2].startswith("sudo env DEBIAN_FRONTEND=noninteractive apt-get install"), calls)

    def test_neither_root_nor_sudo(self):
        self.debian([], user=1000, sudo=False)
        result, calls = self.run_for("test")
        self.assertEqual((result.returncode, calls), (1, []))
        self.assertIn("apt-get install " + " ".join(packages("test")), result.stderr)

    def test_update_may_fail_install_may_not(self):
        self.debian([], apt='[ "$1" = install ]')
        self.assertEqual(self.run_for("test")[0].returncode, 0)
        self.debian([], apt='[ "$1" = update ]')
        result, _ = self.run_for("test")
        self.assertEqual(result.returncode, 1)
        self.assertIn("by hand", result.stderr)

    def test_system_without_apt_gets_the_list(self):
        result, _ = self.run_for("build")
        self.assertEqual(result.returncode, 1)
        for name in packages("build"):
            self.assertIn(name, result.stderr)

    def test_system_without_apt_that_has_the_tools_goes_on(self):
        for name in ("g++", "cmake", "ninja"):
            self.command(name)
        self.assertEqual(self.run_for("build")[0].returncode, 0)

    def test_switched_off(self):
        self.assertEqual(self.run_for("build", MESHGRAFT_BOOTSTRAP="off")[0].returncode, 0)

    def python(self, status=0):
        """A Python that makes an environment with a Python that notes its call, too."""
        self.command("made", f"exit {status}")
        self.command("python", f'mkdir -p "$3/bin"; cp "{self.bin}/made" "$3/bin/python"')
        (self.bin / "mkdir").symlink_to(shutil.which("mkdir"))
        (self.bin / "cp").symlink_to(shutil.which("cp"))
        return str(self.bin / "python")

    def test_makes_the_environment_where_requirements_have_changed(self):
        self.debian(packages("build", "test"))
        python = self.python()
        (self.venv / "requirements.txt").write_text("numpy==1.0\n")
        result, calls = self.run_for("test", MESHGRAFT_PYTHON=python)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(calls, [f"python -m venv {self.venv}", "made -m pip install -q -r python/requirements.txt"])
        self.assertEqual(self.run_for("test", MESHGRAFT_PYTHON=python)[0].stdout, "")
        self.assertEqual(self.run_for("build", MESHGRAFT_PYTHON=python, MESHGRAFT_VENV="/nowhere")[0].returncode, 0)

    def test_makes_no_environment_where_none_is_wanted(self):
        self.debian(packages("build", "test"))
        result, calls = self.run_for("build", "test", MESHGRAFT_PYTHON=self.python(), MESHGRAFT_VENV="none")
        self.assertEqual((result.returncode, result.stdout, calls), (0, "", []))

    def test_says_so_where_the_environment_cannot_be_made(self):
        self.debian(packages("build", "test"))
        result, _ = self.run_for("test", MESHGRAFT_PYTHON=self.python(status=1), MESHGRAFT_VENV=str(self.bin / "other"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("python/requirements.txt", result.stderr)
        self.assertFalse((self.bin / "other/requirements.txt").exists())

    def test_unknown_group(self):
        self.debian([])
        result, calls = self.run_for("built")
        self.assertEqual((result.returncode, calls), (2, []))


if __name__ == "__main__":
    unittest.main()
