#!/usr/bin/env python3
"""Runs the same edits by meshgraft and by ARAP of libigl, Open3D and CGAL.

    beside.py [--vertices N…] [--runs N] [--cgal PROGRAM] [--picture PNG] [--json FILE]

Prints a Markdown table: seconds of the set-up and of a frame, the distortion (RMS of the relative change of the edges'
lengths, %), the roughness (99th percentile of the change of dihedral angles, degrees) and the product of both. Times are
medians of processor time, on one thread each, so that other work on the machine matters little. Libraries that are missing
are left out. `--cgal`: the program meshgraft_cgal_edit of the preset `bench`.

A set-up is all that depends on neither the pose nor earlier frames. A frame starts from rest. ARAP runs so many iterations:
Open3D's tutorial takes 50, and the others get as many. Open3D has no set-up apart from its frames.
"""

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "IGL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"

import numpy as np  # noqa: E402

import meshgraft as mg  # noqa: E402

ITERATIONS = 50


class Edit:
    """A mesh, what is fixed, a handle, and its pose: a translation, an axis and an angle about the handle's centre."""

    def __init__(self, name, mesh, fixed, handle, pose):
        self.name, self.mesh = name, mesh
        self.fixed, self.handle = fixed(mesh), handle(mesh)
        self.matrix = motion(*pose, mesh.vertices[self.handle].mean(axis=0))
        held = mesh.vertices[self.handle] @ self.matrix[:3, :3].T + self.matrix[:3, 3]
        self.held = np.concatenate([self.fixed, self.handle])
        self.goals = np.concatenate([mesh.vertices[self.fixed], held])


def motion(translate, axis, angle_deg, pivot):
    """Returns the 4x4 matrix of a rotation about an axis through a point, and a translation."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(angle_deg)
    matrix = np.eye(4)
    matrix[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    matrix[:3, 3] = pivot + translate - matrix[:3, :3] @ pivot
    return matrix


def edits(vertices):
    """Makes the edits on meshes of about so many vertices: a bar that is bent to a quarter of a circle, its length kept,
    and a dinosaur that turns its head, its rear half fixed."""
    half = mg.select.half_space
    for name, fixed, handle, pose in (
            ("bar", half((0, 0, 0.3), (0, 0, -1)), half((0, 0, 3.7), "z"), ((2.3145, 0, -1.3855), (0, 1, 0), 90)),
            ("dinosaur", half((0.4, 0, 0), "x"), mg.select.box((-9, -9, 3), (-1.7, 9, 9)),
             ((0.3, -0.4, -0.6), (0.2, 0, 1), 60))):
        resolution = vertices ** 0.5
        for _ in range(3):  # the number of vertices is not just the square of the resolution
            mesh = mg.sample(name, round(resolution))
            resolution *= (vertices / len(mesh)) ** 0.5
        yield Edit(name, mesh, fixed, handle, pose)


def by_meshgraft(method):
    def run(edit):
        start = time.process_time()
        deformer = mg.Deformer(edit.mesh, fixed=edit.fixed, handles={"handle": edit.handle}, method=method, threads=1)
        ready = time.process_time()
        positions = deformer.positions(handle=edit.matrix)
        return ready - start, time.process_time() - ready, positions

    return run


def by_libigl(edit):
    import igl

    vertices, faces = np.asarray(edit.mesh.vertices), edit.mesh.faces.astype(np.int64)
    data = igl.ARAPData()
    data.max_iter = ITERATIONS
    start = time.process_time()
    igl.arap_precomputation(vertices, faces, 3, edit.held.astype(np.int32), data)
    ready = time.process_time()
    positions = igl.arap_solve(np.ascontiguousarray(edit.goals), data, vertices.copy())
    return ready - start, time.process_time() - ready, positions


def by_open3d(edit):
    import open3d

    mesh = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(np.array(edit.mesh.vertices)),
                                        open3d.utility.Vector3iVector(np.array(edit.mesh.faces)))
    held, goals = open3d.utility.IntVector(edit.held), open3d.utility.Vector3dVector(edit.goals)
    start = time.process_time()
    moved = mesh.deform_as_rigid_as_possible(held, goals, ITERATIONS)
    return None, time.process_time() - start, np.asarray(moved.vertices)


def by_cgal(program, method):
    def run(edit):
        counts = [len(edit.mesh), len(edit.mesh.faces), len(edit.fixed), len(edit.handle)]
        parts = [np.array(counts, np.int64), edit.mesh.vertices, edit.mesh.faces, edit.fixed.astype(np.int32),
                 edit.handle.astype(np.int32), edit.matrix.astype(np.float64)]
        text = b"".join(np.ascontiguousarray(part).tobytes() for part in parts)
        answer = subprocess.run([program, method, str(ITERATIONS)], input=text, capture_output=True, check=True).stdout
        numbers = np.frombuffer(answer)
        return numbers[0] + numbers[1], numbers[2], numbers[3:].reshape(-1, 3)

    return run


def methods(cgal):
    yield "meshgraft, corotational", by_meshgraft("corotational")
    yield "meshgraft, ft05", by_meshgraft("ft05")
    for name, run in (("igl", by_libigl), ("open3d", by_open3d)):
        try:
            __import__(name)
        except ImportError:
            print(f"no {name}", file=sys.stderr)
            continue
        yield {"igl": "libigl, ARAP", "open3d": "Open3D, ARAP"}[name], run
    if cgal is not None:
        yield "CGAL, spokes and rims", by_cgal(cgal, "rims")
        yield "CGAL, SR-ARAP", by_cgal(cgal, "sre")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--vertices", type=int, nargs="+", default=[5_000, 50_000, 250_000])
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--cgal", help="the program meshgraft_cgal_edit")
    parser.add_argument("--picture", help="a PNG of the results on the smallest meshes")
    parser.add_argument("--json", help="a file for the figures, written after each row")
    arguments = parser.parse_args()
    rows, pictures = [], {}
    print(f"{platform.machine()}, {os.cpu_count()} threads, load {os.getloadavg()[0]:.1f}\n")
    print("| edit | vertices | by | set-up, s | frame, s | distortion | roughness | product |")
    print("|---|---|---|---|---|---|---|---|", flush=True)
    for vertices in arguments.vertices:
        for edit in edits(vertices):
            free = np.setdiff1d(np.arange(len(edit.mesh)), edit.held)
            for name, run in methods(arguments.cgal):
                set_ups, frames = [], []
                for _ in range(arguments.runs):
                    set_up, frame, positions = run(edit)
                    set_ups.append(set_up)
                    frames.append(frame)
                quality = mg.quality(edit.mesh, positions, free=free, self_intersections=False)
                row = {"edit": edit.name, "vertices": len(edit.mesh), "by": name,
                       "set_up": None if set_ups[0] is None else statistics.median(set_ups),
                       "frame": statistics.median(frames), "distortion": quality.edge_rms,
                       "roughness_deg": quality.dihedral_p99_deg, "load": os.getloadavg()[0]}
                rows.append(row)
                set_up = "–" if row["set_up"] is None else f"{row['set_up']:.3f}"
                product = 100 * quality.edge_rms * quality.dihedral_p99_deg
                print(f"| {edit.name} | {len(edit.mesh):,} | {name} | {set_up} | {row['frame']:.3f} | "
                      f"{100 * quality.edge_rms:.1f} % | {quality.dihedral_p99_deg:.1f}° | {product:.0f} |", flush=True)
                if vertices == arguments.vertices[0]:
                    pictures.setdefault(edit.name, []).append((name, mg.Mesh(positions, edit.mesh.faces)))
                if arguments.json:
                    Path(arguments.json).write_text(json.dumps(rows, indent=1), encoding="utf-8")
    if arguments.picture:
        draw(pictures, arguments.picture)


def draw(pictures, path):
    """Draws the results of each edit in a row."""
    strips = []
    for meshes in pictures.values():
        picture = mg.picture(*(mesh for _, mesh in meshes), beside=True, width=300, height=300,
                             captions=[name for name, _ in meshes])
        strips.append(np.asarray(picture))
    np.concatenate(strips).view(mg.Picture).save(path)


if __name__ == "__main__":
    main()
