#!/usr/bin/env python3
"""Checks that meshgraft-mpi gives the answer of meshgraft, on any number of ranks.

    same_answer_test.py MESHGRAFT MESHGRAFT_MPI MPIRUN [TEST…]
"""

import json
import re
import struct
import sys
import tempfile
import unittest
from pathlib import Path

from cluster_scene import PROGRAM, Mesh, largest_difference, read_ply, run, run_ranks, write_edit

TIGHT = ("--tolerance", "1e-13")
DISC = {"sphere": {"centre": [0.5, 0.5, 0], "radius": 0.12}}
TURNED = {"translate": [0.05, 0.1, 0.3], "rotate": {"axis": [1, 0.5, 0.2], "angle_deg": 40}, "scale": 1.2}


class Scene(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.mesh = self.folder / "mesh.ply"

    def alone(self, edit):
        """Returns the positions by the direct solver of one machine."""
        output = self.folder / "alone.ply"
        done = run(PROGRAM, "deform", edit, "-o", output)
        self.assertEqual(done.returncode, 0, done.stderr)
        return read_ply(output)

    def together(self, edit, ranks, *arguments, **options):
        output = self.folder / f"together_{ranks}.ply"
        done = run_ranks(ranks, edit, "-o", output, *TIGHT, *arguments, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return read_ply(output)

    def assert_same(self, edit, ranks, bound=1e-9, **options):
        expected = self.alone(edit)
        rest = read_ply(self.mesh)
        self.assertGreater(largest_difference(rest[3], expected[3]), 0.01, "the edit moves something")
        for count in ranks:
            found = self.together(edit, count, **options)
            self.assertLess(largest_difference(expected[3], found[3]), bound, f"{count} ranks")
            self.assertEqual((found[0], found[2]), (rest[0], rest[2]), "all but the vertices stays")


class FiftyThousand(Scene):
    def test_by_several_ranks(self):
        mesh = Mesh()
        mesh.add_sheet(224, 224)
        mesh.write(self.mesh)
        edit = write_edit(self.folder / "edit.json", self.mesh, region={"box": {"min": [0.05, 0.05, -1], "max": [0.95, 0.95, 1]}},
                          handles=[{"name": "disc", "select": DISC, "pose": TURNED}])
        self.assert_same(edit, (1, 2, 4, 7))


class SameAnswer(Scene):
    def test_of_shuffled_components(self):
        mesh = Mesh()
        mesh.add_sheet(40, 40)
        small = mesh.add_sheet(6, 5, (2, 0, 0), seed=3)
        mesh.add_sheet(20, 30, (0, 2, 0.5), seed=4)
        corner = small[0]
        number = mesh.shuffle()
        mesh.write(self.mesh)
        edit = write_edit(
            self.folder / "edit.json", self.mesh,
            fixed={"union": [{"box": {"min": [-1, -1, -1], "max": [3, 0.1, 1]}},
                             {"box": {"min": [-1, 1.9, -1], "max": [3, 2.2, 1]}}]},
            handles=[{"name": "first", "select": DISC, "pose": TURNED},
                     {"name": "third", "select": {"box": {"min": [-1, 3, -1], "max": [3, 4, 1]}},
                      "pose": {"matrix": [[1, 0.2, 0, 0.1], [0, 1, 0, 0], [0, 0, 1, 0.3], [0, 0, 0, 1]]}}],
            targets=[{"vertex": number[corner + 28], "position": [2.6, 0.9, 0.2]}],
            settings={"method": "ft05", "refine_boundary": 0})
        self.assert_same(edit, (2, 7))

    def test_as_published(self):
        mesh = Mesh()
        mesh.add_sheet(60, 60)
        mesh.write(self.mesh)
        edit = write_edit(self.folder / "edit.json", self.mesh,
                          fixed={"grow": {"of": {"loop": 0}, "rings": 2}},
                          handles=[{"name": "disc", "select": DISC, "pose": TURNED}],
                          settings={"preset": "as-published"})
        self.assert_same(edit, (1, 3))

    def test_with_rotations(self):
        made = run(PROGRAM, "sample", "bar", "--resolution", 40, "-o", self.mesh)  # a limb, which twists
        self.assertEqual(made.returncode, 0, made.stderr)
        step = {"fixed": {"half_space": {"point": [0, 0, 0.4], "normal": [0, 0, -1]}},
                "handles": [{"name": "top", "select": {"half_space": {"point": [0, 0, 3.6], "normal": [0, 0, 1]}},
                             "pose": {"rotate": {"axis": [0.1, 0, 1], "angle_deg": 400}, "pivot": [0, 0, 4]}}]}
        for settings in ({"method": "rotation-aware"}, {"method": "corotational", "iterations": 5}):
            edit = write_edit(self.folder / "edit.json", self.mesh, **step, settings=settings)
            self.assert_same(edit, (1, 2, 4), bound=1e-7)

    def test_rotations_of_a_sheet(self):
        mesh = Mesh()
        mesh.add_sheet(60, 60)
        mesh.add_sheet(8, 8, (3, 0, 0), seed=5)
        mesh.write(self.mesh)
        edit = write_edit(self.folder / "edit.json", self.mesh,
                          region={"sphere": {"centre": [0.5, 0.5, 0], "radius": 0.45}},
                          handles=[{"name": "disc", "select": DISC, "pose": TURNED}],
                          settings={"iterations": 4})
        self.assert_same(edit, (3,), bound=1e-7)

    def test_with_anchors(self):
        mesh = Mesh()
        mesh.add_sheet(50, 50)
        mesh.write(self.mesh)
        edit = write_edit(self.folder / "edit.json", self.mesh,
                          fixed={"half_space": {"point": [0.1, 0, 0], "normal": [-1, 0, 0]}},
                          handles=[{"name": "disc", "select": DISC, "pose": TURNED}],
                          anchors=[{"select": {"half_space": {"point": [0.9, 0, 0], "normal": [1, 0, 0]}}, "weight": 2}])
        self.assert_same(edit, (1, 4), bound=1e-8)

    def test_over_sockets(self):
        mesh = Mesh()
        mesh.add_sheet(40, 40)
        mesh.write(self.mesh)
        edit = write_edit(self.folder / "edit.json", self.mesh, fixed={"grow_length": {"of": {"nearest": [0, 0, 0]}, "length": 0.3}},
                          handles=[{"name": "disc", "select": DISC, "pose": TURNED}])
        self.assert_same(edit, (3,), mpi=("--mca", "btl", "tcp,self"))

    def test_where_few_vertices_are_free(self):
        mesh = Mesh()
        mesh.add_sheet(30, 30)
        mesh.write(self.mesh)
        edit = write_edit(self.folder / "edit.json", self.mesh,
                          region={"sphere": {"centre": [0.5, 0.5, 0], "radius": 0.2}}, fixed={"indices": []},
                          handles=[{"name": "most", "select": {"sphere": {"centre": [0.5, 0.5, 0], "radius": 0.16}},
                                    "pose": {"translate": [0, 0, 0.1]}}],
                          settings={"method": "ft05", "refine_boundary": 0})
        self.assert_same(edit, (5,))

    def test_affine_maps_are_followed(self):
        mesh = Mesh()
        mesh.add_sheet(60, 60)
        mesh.write(self.mesh)
        matrix = [[1.3, 0.25, -0.1, 0.4], [-0.15, 0.8, 0.3, -0.2], [0.1, 0.05, 1.1, 0.3], [0, 0, 0, 1]]
        ends = {"union": [{"half_space": {"point": [0.1, 0, 0], "normal": [-1, 0, 0]}},
                          {"half_space": {"point": [0.9, 0, 0], "normal": [1, 0, 0]}}]}
        edit = write_edit(self.folder / "edit.json", self.mesh,
                          handles=[{"name": "ends", "select": ends, "pose": {"matrix": matrix}}])
        mapped = [tuple(sum(row[k] * p[k] for k in range(3)) + row[3] for row in matrix[:3])
                  for p in read_ply(self.mesh)[3]]
        self.assertLess(largest_difference(mapped, self.together(edit, 4)[3]), 1e-9)

    def test_bytes_that_do_not_change_stay(self):
        mesh = Mesh()
        mesh.add_sheet(40, 40)
        mesh.colours = [(v % 256, v // 256, 7) for v in range(len(mesh.vertices))]
        mesh.write(self.mesh, "float")
        edit = write_edit(self.folder / "edit.json", self.mesh, region={"box": {"min": [0.2, 0.2, -1], "max": [0.8, 0.8, 1]}},
                          handles=[{"name": "disc", "select": DISC, "pose": TURNED}])
        before, after = read_ply(self.mesh), self.together(edit, 3)
        self.assertEqual((after[0], after[2]), (before[0], before[2]))
        moved = 0
        for old, new, (x, y, _) in zip(before[1], after[1], before[3], strict=True):
            self.assertEqual(old[12:], new[12:], "colours stay")
            if not (0.2 <= x <= 0.8 and 0.2 <= y <= 0.8):
                self.assertEqual(old, new, "vertices outside the region stay")
            moved += old != new
        self.assertGreater(moved, 300)

    def test_normals_turn(self):
        mesh = Mesh()
        mesh.add_sheet(30, 30)
        mesh.normals = [(0.0, 0.0, 1.0)] * len(mesh.vertices)
        mesh.write(self.mesh)
        edit = write_edit(self.folder / "edit.json", self.mesh, fixed={"half_space": {"point": [0.1, 0, 0], "normal": [-1, 0, 0]}},
                          handles=[{"name": "disc", "select": DISC, "pose": TURNED}])
        alone, together = self.alone(edit), self.together(edit, 3)

        def normals(file):
            return [struct.unpack_from("<3d", record, 24) for record in file[1]]
        self.assertLess(largest_difference(normals(alone), normals(together)), 1e-7)
        self.assertNotEqual(normals(together), mesh.normals)

    def turned_disc(self):
        """Writes an edit of a small sheet: one side is held, and a disc is turned."""
        mesh = Mesh()
        mesh.add_sheet(40, 40)
        mesh.write(self.mesh)
        return write_edit(self.folder / "edit.json", self.mesh, fixed={"half_space": {"point": [0.1, 0, 0], "normal": [-1, 0, 0]}},
                          handles=[{"name": "disc", "select": DISC, "pose": TURNED}])

    def test_other_preconditioners(self):
        edit = self.turned_disc()
        expected = self.alone(edit)[3]
        for name in ("gamg", "hypre", "mumps"):
            found = self.together(edit, 2, "--preconditioner", name)[3]
            self.assertLess(largest_difference(expected, found), 1e-8, name)

    def test_either_solver_of_the_coarse_grid(self):
        edit = self.turned_disc()
        expected = self.alone(edit)[3]
        for options in ((), ("--petsc", "-coarse_pc_type gamg")):
            found = self.together(edit, 3, *options)[3]
            self.assertLess(largest_difference(expected, found), 1e-9, options)

    def test_options_of_petsc(self):
        edit = self.turned_disc()

        def output_of(*options):
            done = run_ranks(2, edit, "-o", self.folder / "out.ply", *options)
            self.assertEqual(done.returncode, 0, done.stderr)
            return done.stdout
        self.assertEqual(output_of(), "")
        found = output_of("--petsc", "-ksp_monitor -log_view -coarse_pc_type gamg -coarse_ksp_max_it 3 "
                                     "-coarse_ksp_converged_reason")
        norms = [float(norm) for norm in re.findall(r"^ *\d+ KSP Residual norm (\S+)", found, re.MULTILINE)]
        self.assertGreater(len(norms), 5)
        self.assertLess(min(norms), 1e-3 * max(norms))
        inner = [int(count) for count in re.findall(r"coarse_ solve .* iterations (\d+)", found)]
        self.assertEqual(max(inner), 3, "the options of a part of the solver have its prefix")
        for stage in ("Set-up", "Fine grid", "Coarse grid"):
            self.assertRegex(found, rf"\d: +{stage}: ")

    def test_report(self):
        mesh = Mesh()
        mesh.add_sheet(40, 40)
        mesh.write(self.mesh)
        edit = write_edit(self.folder / "edit.json", self.mesh, region={"box": {"min": [0.1, 0.1, -1], "max": [0.9, 0.9, 1]}},
                          handles=[{"name": "disc", "select": DISC, "pose": TURNED}])
        mine, theirs = self.folder / "mine.json", self.folder / "theirs.json"
        self.together(edit, 3, "--report", mine)
        run(PROGRAM, "deform", edit, "-o", self.folder / "alone.ply", "--report", theirs)
        mine, theirs = json.loads(mine.read_text()), json.loads(theirs.read_text())
        self.assertEqual(mine["counts"], theirs["counts"])
        self.assertEqual(set(theirs) - set(mine), set())
        self.assertAlmostEqual(mine["max_displacement"], theirs["max_displacement"], places=9)
        self.assertAlmostEqual(mine["max_transform_deviation"], theirs["max_transform_deviation"], places=6)
        self.assertLess(mine["residual"], 1e-6)
        self.assertEqual(mine["distributed"]["ranks"], 3)

    def assert_same_quality(self, mine, theirs):
        """Compares all measures but those that are not distributed, which are null."""
        not_measured = ("width_min", "narrowest_vertex", "new_self_intersections")
        self.assertEqual(set(mine), set(theirs))
        for name, value in theirs.items():
            if name in not_measured:
                self.assertIsNone(mine[name], name)
            elif isinstance(value, dict):
                self.assertEqual(set(mine[name]), set(value))
                for part in value:
                    self.assertAlmostEqual(mine[name][part], value[part], places=6, msg=f"{name} {part}")
            elif value is None:
                self.assertIsNone(mine[name], name)
            else:
                self.assertAlmostEqual(mine[name], value, places=6, msg=name)

    def reports(self, edit, ranks):
        mine, theirs = self.folder / "mine.json", self.folder / "theirs.json"
        self.together(edit, ranks, "--report", mine)
        done = run(PROGRAM, "deform", edit, "-o", self.folder / "alone.ply", "--report", theirs)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(mine.read_text()), json.loads(theirs.read_text())

    def test_quality(self):
        mesh = Mesh()
        mesh.add_sheet(40, 40)
        mesh.add_sheet(8, 8, (3, 0, 0), seed=5)
        mesh.shuffle()
        mesh.write(self.mesh)
        region = {"box": {"min": [0.1, 0.1, -1], "max": [0.9, 0.9, 1]}}
        turned = {"translate": [0.1, 0, 0.1], "rotate": {"axis": [1, 0, 0.2], "angle_deg": 170}}
        edit = write_edit(self.folder / "edit.json", self.mesh, region=region,
                          handles=[{"name": "disc", "select": DISC, "pose": turned}])
        for ranks in (1, 3):
            mine, theirs = self.reports(edit, ranks)
            self.assertGreater(theirs["quality"]["flipped_faces"], 0)
            self.assertGreater(theirs["quality"]["rim_jump_max_deg"], 1)
            self.assertIsNone(theirs["quality"]["volume_ratio"])
            self.assert_same_quality(mine["quality"], theirs["quality"])
            self.assert_same_quality(mine["steps"][0]["quality"], theirs["steps"][0]["quality"])

    def test_quality_of_a_closed_surface(self):
        made = run(PROGRAM, "sample", "bar", "--resolution", 20, "-o", self.mesh)
        self.assertEqual(made.returncode, 0, made.stderr)
        edit = write_edit(self.folder / "edit.json", self.mesh,
                          fixed={"half_space": {"point": [0, 0, 0.4], "normal": [0, 0, -1]}},
                          handles=[{"name": "top", "select": {"half_space": {"point": [0, 0, 3.6], "normal": [0, 0, 1]}},
                                    "pose": {"scale": 1.3, "translate": [0.3, 0, 0.2]}}])
        mine, theirs = self.reports(edit, 4)
        self.assertGreater(theirs["quality"]["volume_ratio"], 1.05)
        self.assert_same_quality(mine["quality"], theirs["quality"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
