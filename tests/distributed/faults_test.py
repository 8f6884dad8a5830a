#!/usr/bin/env python3
"""Checks that all ranks of meshgraft-mpi end together, with one message and no half-written output.

    faults_test.py MESHGRAFT MESHGRAFT_MPI MPIRUN [TEST…]
"""

import os
import sys
import tempfile
import time
import unittest
from pathlib import Path

from cluster_scene import MPI_PROGRAM, MPIRUN, Mesh, assert_one_error, kill_a_rank, run, run_ranks, write_edit

INPUT, UNSOLVABLE, IO = 3, 4, 5
DISC = {"sphere": {"centre": [0.5, 0.5, 0], "radius": 0.12}}
LIFTED = {"translate": [0, 0, 0.2]}


class Faults(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.path, self.output = self.folder / "mesh.ply", self.folder / "out.ply"
        self.mesh = Mesh()
        self.mesh.add_sheet(40, 40)

    def edit(self, **step):
        self.mesh.write(self.path)
        step.setdefault("fixed", {"half_space": {"point": [0.1, 0, 0], "normal": [-1, 0, 0]}})
        step.setdefault("handles", [{"name": "disc", "select": DISC, "pose": LIFTED}])
        return write_edit(self.folder / "edit.json", self.path, **step)

    def assert_fails(self, done, status, *words):
        """Checks status and message, and that no file is left beside the inputs."""
        self.assertEqual(done.returncode, status, done.stderr)
        assert_one_error(self, done, *words)
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["edit.json", "mesh.ply"])

    def fail(self, edit, status, *words, **options):
        started = time.monotonic()
        self.assert_fails(run_ranks(4, edit, "-o", self.output, **options), status, *words)
        self.assertLess(time.monotonic() - started, 60)

    def test_a_file_that_ends_early(self):
        edit = self.edit()
        data = self.path.read_bytes()
        self.path.write_bytes(data[:-1000])
        self.fail(edit, INPUT, "too short")

    def test_a_number_that_is_not_finite(self):
        self.mesh.vertices[1500] = (0.9, float("nan"), 0.1)
        self.fail(self.edit(), INPUT, "vertex 1500", "finite")

    def test_a_face_of_no_vertex(self):
        self.mesh.triangles[3000] = (0, 1, 1600)
        self.fail(self.edit(), INPUT, "face 3000", "1600")

    def test_a_missing_file(self):
        edit = self.edit()
        self.path.rename(self.folder / "elsewhere.ply")
        done = run_ranks(3, edit, "-o", self.output)
        (self.folder / "elsewhere.ply").rename(self.path)
        self.assert_fails(done, IO, "mesh.ply")

    def test_no_room(self):
        # No file may be as large as the output. Memory that MPI shares is a file, too, and smaller.
        self.mesh = Mesh()
        self.mesh.add_sheet(300, 300)
        edit = self.edit(region={"box": {"min": [0.3, 0.3, -1], "max": [0.7, 0.7, 1]}}, fixed={"indices": []})
        kilobytes = self.path.stat().st_size // 1024 - 100
        limited = f"trap '' XFSZ; ulimit -f {kilobytes}; exec {MPI_PROGRAM} deform {edit} -o {self.output}"
        self.assert_fails(run(MPIRUN, "-q", "-n", 3, "--oversubscribe", "--mca", "btl", "tcp,self", "bash", "-c", limited,
                              timeout=60), IO, "out.ply", "space")

    def test_nothing_holds_the_surface(self):
        self.fail(self.edit(fixed={"indices": []},
                            handles=[{"name": "disc", "select": DISC, "pose": LIFTED, "constrain": "transform"}]),
                  UNSOLVABLE, "component 1")

    def test_overlapping_handles(self):
        handles = [{"name": name, "select": DISC, "pose": LIFTED} for name in ("one", "two")]
        self.fail(self.edit(handles=handles), INPUT, "handle 'one'")

    def test_what_is_not_distributed(self):
        self.fail(self.edit(features=[{"select": {"sphere": {"centre": [0.8, 0.8, 0], "radius": 0.1}}}]), INPUT,
                  "features", "not distributed")
        self.fail(self.edit(settings={"method": "shell"}), INPUT, "settings.method", "the method shell is not distributed")
        self.fail(self.edit(handles=[{"name": "point", "select": {"nearest": [0.5, 0.5, 0]}, "pose": LIFTED}]), INPUT,
                  "refine_boundary")

    def test_coinciding_boundaries(self):
        self.mesh.vertices += [(x + 0.0, y, z) for x, y, z in self.mesh.vertices]
        count = len(self.mesh.vertices) // 2
        self.mesh.triangles += [(a + count, b + count, c + count) for a, b, c in self.mesh.triangles]
        self.fail(self.edit(), INPUT, "weld")

    def test_inconsistent_faces(self):
        a, b, c = self.mesh.triangles[1500]
        self.mesh.triangles[1500] = (b, a, c)
        self.fail(self.edit(), INPUT, "same direction")

    def test_outputs_that_would_replace_something(self):
        edit = self.edit()
        before = {path: path.read_bytes() for path in (edit, self.path)}
        report, usage = self.folder / "r.json", 2
        for output, given, status, word in (
                (self.output, self.path, usage, "input"), (self.output, edit, usage, "input"),
                (edit, report, INPUT, ".chunks"), (self.output, self.output, usage, "two outputs"),
                (self.path, report, usage, "--force"), (self.folder / "out.obj", report, INPUT, ".obj"),
                (self.output, self.folder / "nowhere" / "r.json", IO, "folder"), (self.folder, report, INPUT, ".ply")):
            with self.subTest(output=output.name, report=given.name):
                self.assert_fails(run_ranks(2, edit, "-o", output, "--report", given), status, word)
                self.assertEqual({path: path.read_bytes() for path in before}, before)

    def test_a_pipe_as_output(self):
        edit = self.edit()
        os.mkfifo(self.output)
        self.addCleanup(self.output.unlink)
        done = run_ranks(2, edit, "-o", self.output)
        self.assertEqual(done.returncode, IO, done.stderr)
        assert_one_error(self, done, "pipe")
        self.assertTrue(self.output.is_fifo())

    def test_a_rank_that_is_killed(self):
        self.mesh = Mesh()
        self.mesh.add_sheet(150, 150)
        edit = self.edit()
        self.assertNotEqual(kill_a_rank(edit, self.output), 0)
        self.assertFalse(self.output.exists())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
