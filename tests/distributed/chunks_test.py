#!/usr/bin/env python3
"""Checks meshes in chunks: conversions, the answer of an edit, and faults.

    chunks_test.py MESHGRAFT MESHGRAFT_MPI MPIRUN [TEST…]
"""

import json
import shutil
import struct
import sys
import tempfile
import unittest
from pathlib import Path

from cluster_scene import (Mesh, assert_one_error, convert, kill_a_rank, largest_difference, read_chunks, read_ply, run_ranks,
                           write_chunks, write_edit)

USAGE, INPUT, IO = 2, 3, 5
DISC = {"sphere": {"centre": [0.5, 0.5, 0], "radius": 0.12}}
STEP = {"fixed": {"half_space": {"point": [0.1, 0, 0], "normal": [-1, 0, 0]}},
        "handles": [{"name": "disc", "select": DISC, "pose": {"translate": [0.1, 0, 0.2], "rotate": {"axis": [0, 0, 1], "angle_deg": 30}}}]}


class Chunks(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.ply, self.chunks, self.output = (self.folder / name for name in ("mesh.ply", "mesh.chunks", "out.chunks"))
        self.mesh = Mesh()
        self.mesh.add_sheet(30, 30)

    def edit(self, mesh):
        return write_edit(self.folder / "edit.json", mesh, **STEP)

    def assert_done(self, done):
        self.assertEqual(done.returncode, 0, done.stderr)

    def assert_fails(self, done, status, *words):
        self.assertEqual(done.returncode, status, done.stderr)
        assert_one_error(self, done, *words)
        left = [path.name for path in self.folder.iterdir() if path.name.startswith("out")]
        self.assertEqual(left, [], "no output is left")

    def test_there_and_back(self):
        self.mesh.colours = [(v % 256, v // 256, 7) for v in range(len(self.mesh.vertices))]
        self.mesh.normals = [(0.0, 0.6, 0.8)] * len(self.mesh.vertices)
        self.mesh.write(self.ply, "float")
        back = self.folder / "back.ply"
        for ranks, per_file in ((1, 10000), (3, 170)):
            self.assert_done(convert(ranks, self.ply, self.chunks, "--records-per-file", per_file))
            index = json.loads((self.chunks / "mesh.json").read_text())
            self.assertEqual(len(index["vertex"]["files"]), -(-900 // per_file))
            self.assertEqual(sorted(path.name for path in self.chunks.iterdir()),
                             sorted(["mesh.json"] + [part["file"] for table in ("vertex", "triangle") for part in index[table]["files"]]))
            self.assert_done(convert(2, self.chunks, back, "--force"))
            self.assertEqual(back.read_bytes(), self.ply.read_bytes(), "all bytes come back")
            shutil.rmtree(self.chunks)

    def test_indices_of_64_bits(self):
        write_chunks(self.chunks, self.mesh, label_type="uint")
        self.assert_done(convert(3, self.chunks, self.folder / "mesh.ply"))
        _, records, faces, _ = read_ply(self.folder / "mesh.ply")
        self.assertEqual([struct.unpack_from("<3d", record, 2) for record in records], self.mesh.vertices)
        self.assertEqual([struct.unpack_from("<IB3i", faces, 17 * t) for t in range(len(self.mesh.triangles))],
                         [(t % 5, 3, *corners) for t, corners in enumerate(self.mesh.triangles)])

    def test_an_edit_gives_the_answer_of_ply(self):
        self.mesh.write(self.ply)
        self.assert_done(run_ranks(2, self.edit(self.ply), "-o", self.folder / "moved.ply", "--tolerance", "1e-13"))
        expected = read_ply(self.folder / "moved.ply")[3]
        index = write_chunks(self.chunks, self.mesh, files=5)
        before = read_chunks(self.chunks)
        self.assert_done(run_ranks(3, self.edit(self.chunks), "-o", self.output, "--tolerance", "1e-13"))
        self.assertEqual(json.loads((self.output / "mesh.json").read_text()), index)
        vertices, triangles = read_chunks(self.output)
        self.assertEqual(triangles, before[1])
        size, moved, found = 26, 0, []
        for v, (x, _, _) in enumerate(self.mesh.vertices):
            old, new = before[0][v * size:(v + 1) * size], vertices[v * size:(v + 1) * size]
            self.assertEqual(old[:2], new[:2], "other properties stay")
            if x <= 0.1:
                self.assertEqual(old, new, "fixed vertices stay")
            moved += old != new
            found.append(struct.unpack_from("<3d", new, 2))
        self.assertGreater(moved, 300)
        self.assertLess(largest_difference(expected, found), 1e-9)

    def change(self, change):
        """Writes chunks, and changes the index."""
        index = write_chunks(self.chunks, self.mesh)
        change(index)
        (self.chunks / "mesh.json").write_text(json.dumps(index))

    def refuse(self, status, *words):
        """Checks that neither an edit nor a conversion begins."""
        self.assert_fails(run_ranks(3, self.edit(self.chunks), "-o", self.output), status, *words)
        self.assert_fails(convert(2, self.chunks, self.output), status, *words)

    def test_a_missing_file(self):
        self.change(lambda index: None)
        (self.chunks / "t1").unlink()
        self.refuse(IO, "mesh.chunks/t1")

    def test_a_missing_index(self):
        self.chunks.mkdir()
        self.refuse(IO, "mesh.chunks/mesh.json")

    def test_a_short_file(self):
        self.change(lambda index: None)
        (self.chunks / "v2").write_bytes((self.chunks / "v2").read_bytes()[:-30])
        self.refuse(INPUT, "mesh.chunks/v2", "298 whole records of 26 bytes", "300")

    def test_counts_that_disagree(self):
        self.change(lambda index: index["triangle"].update(count=7))
        self.refuse(INPUT, "triangle.files", "1682 records", "7")

    def test_an_unknown_type(self):
        self.change(lambda index: index["vertex"]["properties"][2].update(type="float16"))
        self.refuse(INPUT, "vertex.properties[2].type", "float16", "int64")

    def test_a_coordinate_of_64_bits(self):
        self.change(lambda index: index["vertex"]["properties"][3].update(type="int64"))
        self.refuse(INPUT, "'z'", "int64")

    def test_a_file_elsewhere(self):
        self.change(lambda index: index["vertex"]["files"][0].update(file="../mesh.ply"))
        self.refuse(INPUT, "vertex.files[0].file", "../mesh.ply")

    def test_a_file_that_is_listed_twice(self):
        self.change(lambda index: index["vertex"]["files"][1].update(file="v0"))
        self.refuse(INPUT, "vertex.files[1].file", "'v0'", "twice")

    def test_an_index_out_of_range(self):
        for wrong in (900, -1, 2 ** 40):
            self.mesh.triangles[1000] = (0, 1, wrong)
            self.change(lambda index: None)
            self.refuse(INPUT, "mesh.chunks/t1", "face 1000, record 440 of the file", "900")
            shutil.rmtree(self.chunks)

    def test_a_rank_that_is_killed(self):
        self.mesh = Mesh()
        self.mesh.add_sheet(150, 150)
        self.change(lambda index: None)
        self.assertNotEqual(kill_a_rank(self.edit(self.chunks), self.output), 0)
        self.assertFalse(self.output.exists())

    def test_nothing_is_replaced(self):
        self.change(lambda index: None)
        other = self.folder / "there.chunks"
        shutil.copytree(self.chunks, other)
        for done in (run_ranks(2, self.edit(self.chunks), "-o", other), convert(2, self.chunks, other),
                     convert(2, self.chunks, str(other) + "/")):
            self.assert_fails(done, USAGE, "there.chunks", "replace")
        self.assertEqual(read_chunks(other), read_chunks(self.chunks))

    def test_what_a_format_does_not_hold(self):
        self.change(lambda index: None)
        self.assert_fails(convert(2, self.chunks, self.folder / "out.ply"), INPUT, "'label'", "uint64")
        self.assert_fails(convert(2, self.chunks, self.folder / "out.obj"), INPUT, ".obj", ".chunks")
        self.assert_fails(run_ranks(2, self.edit(self.chunks), "-o", self.folder / "out.ply"), USAGE, "format")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
