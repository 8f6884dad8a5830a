"""Makes the wheel, looks into it, and uses it in an environment that has NumPy and no compiler.

MESHGRAFT_WHEEL names a wheel that was made before.
"""

import base64
import csv
import hashlib
import os
import re
import resource
import signal
import struct
import subprocess
import sys
import tempfile
import unittest
import urllib.request
import zipfile
from email import message_from_string
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tools"), str(ROOT / "tests/editor")]
import check_licences  # noqa: E402
from engine_client import Engine  # noqa: E402

LARGEST = 40e6
LATEST_GLIBC = (2, 36)  # of Debian 12
OF_THE_SYSTEM = {"libstdc++", "libgcc_s", "libgomp", "libc", "libm", "libpthread"}


def make_wheel():
    if "MESHGRAFT_WHEEL" in os.environ:
        return Path(os.environ["MESHGRAFT_WHEEL"])
    made = subprocess.run([sys.executable, ROOT / "tools/make_wheel.py", "--to", ROOT / "build/wheel/tested"],
                          capture_output=True, text=True)
    if made.returncode != 0:
        raise RuntimeError(made.stdout + made.stderr)
    return Path(made.stdout.strip())


def setUpModule():
    global WHEEL, ARCHIVE
    WHEEL = make_wheel()
    ARCHIVE = zipfile.ZipFile(WHEEL)
    unittest.addModuleCleanup(ARCHIVE.close)


def section_names(elf):
    """Names of the sections of a 64-bit ELF file."""
    headers, = struct.unpack_from("<Q", elf, 40)
    size, count, names = struct.unpack_from("<HHH", elf, 58)
    begin, = struct.unpack_from("<Q", elf, headers + names * size + 24)
    for section in range(count):
        at, = struct.unpack_from("<I", elf, headers + section * size)
        yield elf[begin + at:elf.index(b"\0", begin + at)].decode()


def binaries():
    return {name: content for name in ARCHIVE.namelist() if (content := ARCHIVE.read(name)).startswith(b"\x7fELF")}


def bundled():
    """The libraries in the wheel: names as in THIRD_PARTY.md, and those of their files."""
    files = [name for name in ARCHIVE.namelist() if name.startswith("meshgraft.libs/") and ".so" in name]
    return {re.sub(r"-[0-9a-f]{8}$", "", re.sub(r"\.so\b.*$", "", Path(name).name)): name for name in files}


def metadata_file(name):
    return next(ARCHIVE.read(file).decode() for file in ARCHIVE.namelist() if file.endswith(f".dist-info/{name}"))


class Contents(unittest.TestCase):
    def test_its_name_says_on_which_systems_it_runs(self):
        name = re.fullmatch(r"meshgraft-([\d.]+)-(cp3\d+)-(cp3\d+|abi3)-manylinux_2_(\d+)_\w+\.whl", WHEEL.name)
        self.assertIsNotNone(name, WHEEL.name)
        self.assertEqual(name[1], (ROOT / "VERSION").read_text(encoding="utf-8").strip())
        self.assertLessEqual((2, int(name[4])), LATEST_GLIBC)

    def test_it_is_small(self):
        self.assertLessEqual(WHEEL.stat().st_size, LARGEST)

    def test_binaries_are_stripped(self):
        found = binaries()
        self.assertGreaterEqual(len(found), 10)
        for name, content in found.items():
            self.assertNotIn(".symtab", list(section_names(content)), name)

    def test_libraries_are_in_the_table_with_a_licence_that_allows_it(self):
        rows = check_licences.read_table((ROOT / "THIRD_PARTY.md").read_text(encoding="utf-8"))
        found = bundled()
        self.assertGreaterEqual(len(found), 10)
        for library in found:
            self.assertNotIn(library, OF_THE_SYSTEM)
            row = next((row for row in rows if library in row.libraries), None)
            self.assertIsNotNone(row, library)
            self.assertIn("in the wheel", row.where, library)
        for row in rows:
            if "in the wheel" in row.where:
                self.assertTrue(row.libraries & set(found), row.project)

    def test_licence_files_are_inside(self):
        metadata = message_from_string(metadata_file("METADATA"))
        self.assertEqual(metadata["Requires-Python"], ">=3.10")
        self.assertIn("numpy", " ".join(metadata.get_all("Requires-Dist")))
        self.assertTrue(metadata["Summary"])
        files = metadata.get_all("License-File")
        self.assertEqual(sorted(files), ["LICENSE", "NOTICES.txt", "THIRD_PARTY.md"])
        for file in files:
            self.assertGreater(len(metadata_file(f"licenses/{file}")), 1000, file)

    def test_notices_are_those_of_all_that_is_inside(self):
        notices = metadata_file("licenses/NOTICES.txt")
        for words in ("METIS", "OpenBLAS", "Threading Building Blocks|tbb", "3MF", "libzip", "OpenSSL", "bzip2",
                      "fmt", "meshoptimizer", "libpng", "util-linux", "SuiteSparse", "eigen", "nlohmann", "nanoflann",
                      "CLI11", "Boost Software License", "Wenzel Jakob", "Goetghebuer-Planchon", "Apache License"):
            self.assertTrue(re.search(words, notices, re.IGNORECASE), words)

    def test_types_are_inside(self):
        for name in ("py.typed", "_core.pyi", "_records.py", "_docs.py", "__main__.py"):
            self.assertIn(f"meshgraft/{name}", ARCHIVE.namelist())

    def test_its_list_of_files_has_their_hashes(self):
        listed = {row[0]: row[1] for row in csv.reader(metadata_file("RECORD").splitlines())}
        for name in ARCHIVE.namelist():
            if name.endswith(("/", "/RECORD")):
                continue
            digest = base64.urlsafe_b64encode(hashlib.sha256(ARCHIVE.read(name)).digest()).rstrip(b"=").decode()
            self.assertEqual(listed[name], f"sha256={digest}", name)


class Use(unittest.TestCase):
    """In an environment with NumPy and no compiler."""

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        cls.venv = cls.folder / "venv"
        subprocess.run([sys.executable, "-m", "venv", cls.venv], check=True)
        # NumPy as it is installed here: tests use no network.
        import numpy

        packages = Path(numpy.__file__).resolve().parents[1]
        (cls.folder / "others").mkdir()
        for name in ("numpy", "numpy.libs"):
            if (packages / name).exists():
                (cls.folder / "others" / name).symlink_to(packages / name)
        cls.environment = {"PATH": str(cls.venv / "bin"), "HOME": str(cls.folder), "PYTHONDONTWRITEBYTECODE": "1",
                           "PYTHONPATH": str(cls.folder / "others")}
        cls.before = cls.files()
        cls.call("python", "-m", "pip", "install", "-q", "--no-index", "--no-deps", "--no-compile", WHEEL)

    @classmethod
    def files(cls):
        return {path for path in cls.venv.rglob("*") if "__pycache__" not in path.parts}

    @classmethod
    def call(cls, program, *arguments, status=0, **more):
        done = subprocess.run([str(cls.venv / "bin" / program), *map(str, arguments)], cwd=cls.folder,
                              env={**cls.environment, **more}, capture_output=True, text=True)
        if done.returncode != status:
            raise AssertionError(f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout + done.stderr

    def python(self, code, **more):
        return self.call("python", "-c", code, **more)

    def test_the_program_starts(self):
        version = f"meshgraft {(ROOT / 'VERSION').read_text(encoding='utf-8').strip()}"
        self.assertEqual(self.call("meshgraft", "--version").strip(), version)
        self.assertEqual(self.call("python", "-m", "meshgraft", "--version").strip(), version)

    def test_the_program_keeps_its_exit_status_and_name(self):
        self.assertIn("meshgraft: error: nothing.ply", self.call("meshgraft", "info", "nothing.ply", status=5))
        self.call("python", "-m", "meshgraft", "info", "nothing.ply", status=5)

    def test_module_and_program_deform_alike(self):
        self.python("import meshgraft as mg\n"
                    "bar = mg.sample('bar', 16)\n"
                    "edit = mg.Edit().input('bar', bar)\n"
                    "edit.deform('bar', handles={'top': mg.select.half_space((0, 0, 3.7), 'z')},\n"
                    "            fixed=mg.select.half_space((0, 0, 0.3), (0, 0, -1)),\n"
                    "            poses={'top': mg.Pose(rotate=('y', 40))})\n"
                    "edit.save('edit.json')\n"
                    "mg.write(edit.run().mesh, 'module.ply')\n"
                    "mg.write(bar, 'rest.ply')\n")
        self.call("meshgraft", "run", "edit.json", "-o", "program.ply")
        rest, module, program = ((self.folder / f"{name}.ply").read_bytes() for name in ("rest", "module", "program"))
        self.assertEqual(module, program)
        self.assertNotEqual(module, rest)

    def test_pictures_and_all_formats(self):
        said = self.python("import meshgraft as mg\n"
                           "bar = mg.sample('bar', 8)\n"
                           "for kind in ('ply', 'obj', 'off', 'stl', 'glb', '3mf'):\n"
                           "    mg.write(bar, f'bar.{kind}')\n"
                           "    assert len(mg.read(f'bar.{kind}').faces) == len(bar.faces), kind\n"
                           "print(mg.picture(bar, width=64, height=48).shape)\n")
        self.assertIn("(48, 64, 3)", said)
        self.call("meshgraft", "render", "bar.3mf", "--width", "64", "--height", "48", "-o", "program.png")
        self.assertEqual((self.folder / "program.png").read_bytes()[:8], b"\x89PNG\r\n\x1a\n")

    def test_the_program_short_of_memory_says_so(self):
        self.python("import meshgraft as mg\n"
                    "octopus = mg.sample('octopus', 64)\n"
                    "tip = mg.select.nearest((0.65, -1.49, 0.35)).grow(length=0.5)\n"
                    "edit = mg.Edit().input('octopus', octopus)\n"
                    "edit.deform('octopus', region=tip.grow(length=1.25), handles={'tip': tip},\n"
                    "            poses={'tip': mg.Pose(rotate=('z', 40))})\n"
                    "edit.save('short.json')\n")
        statuses = set()
        for megabytes in range(100, 420, 20):
            def limit():
                resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))

            done = subprocess.run([self.venv / "bin/meshgraft", "run", "short.json", "-o", "short.ply"],
                                  cwd=self.folder, env=self.environment, preexec_fn=limit, capture_output=True,
                                  text=True)
            self.assertIn(done.returncode, (0, 6), f"{megabytes} MB: {done.stdout}{done.stderr}")
            statuses.add(done.returncode)
        self.assertEqual(statuses, {0, 6})

    def test_it_chooses_kernels_for_the_processor(self):
        said = self.python("import meshgraft._core", OPENBLAS_VERBOSE="2")
        chosen = re.search(r"Core: (\w+)", said)
        self.assertIsNotNone(chosen, said)
        flags = Path("/proc/cpuinfo").read_text(encoding="utf-8").split()
        if "avx512vl" in flags:
            self.assertIn(chosen[1], ("SkylakeX", "Cooperlake", "SapphireRapids", "Zen"))
        elif "avx2" in flags:
            self.assertIn(chosen[1], ("Haswell", "Zen"))

    def test_the_editor_serves_its_page_and_ends_at_a_signal(self):
        with Engine(str(self.venv / "bin/meshgraft"), cwd=self.folder, env=self.environment) as engine:
            page = urllib.request.urlopen(engine.url, timeout=60).read().decode()
            self.assertIn("<script", page)
            address = re.sub(r"\?.*", "licences.txt", engine.url)
            self.assertIn("three", urllib.request.urlopen(address, timeout=60).read().decode())
            self.assertEqual(engine.end(signal.SIGTERM, 60), 0)

    def test_uninstalling_leaves_nothing(self):
        self.call("python", "-m", "pip", "uninstall", "-q", "-y", "meshgraft")
        try:
            self.assertEqual(self.files(), self.before)
        finally:
            self.call("python", "-m", "pip", "install", "-q", "--no-index", "--no-deps", "--no-compile", WHEEL)


if __name__ == "__main__":
    unittest.main()
