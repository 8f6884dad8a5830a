#!/usr/bin/env python3
"""Makes the pictures of the defects in docs/files.md with the built program (tools/docs_pictures.sh calls it).

    tools/defect_pictures.py build/release/meshgraft docs/images

Each picture is a small patch of surface with one defect in red, larger than life.
"""

import math
import subprocess
import sys
import tempfile
from pathlib import Path

GREY, RED = (205, 200, 190), (214, 60, 46)


class Drawing:
    """Coloured polygons, each with vertices of its own."""

    def __init__(self):
        self.polygons = []

    def face(self, points, colour=GREY):
        self.polygons.append((points, colour))

    def ball(self, centre, radius=0.11, colour=RED):
        """An octahedron, split once."""
        x, y, z = centre
        tips = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
        corner = lambda p: tuple(c + radius * q / math.hypot(*p) for c, q in zip((x, y, z), p))
        for a in (0, 1):
            for b in (2, 3):
                for c in (4, 5):
                    turn = (a + b + c) % 2 == 0
                    p, q, r = tips[a], tips[b], tips[c]
                    pq, qr, rp = (tuple(s + t for s, t in zip(u, v)) for u, v in ((p, q), (q, r), (r, p)))
                    for triangle in ((p, pq, rp), (pq, q, qr), (rp, qr, r), (pq, qr, rp)):
                        ordered = triangle if turn else triangle[::-1]
                        self.face([corner(t) for t in ordered], colour)

    def line(self, a, b, radius=0.035, colour=RED):
        """A triangular tube."""
        along = [q - p for p, q in zip(a, b)]
        up = (0, 0, 1) if abs(along[2]) < 0.9 * math.hypot(*along) else (1, 0, 0)
        cross = lambda u, v: (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        unit = lambda u: tuple(c / math.hypot(*u) for c in u)
        s = unit(cross(along, up))
        t = unit(cross(s, along))
        ring = [(math.cos(k * 2 * math.pi / 3), math.sin(k * 2 * math.pi / 3)) for k in range(3)]
        place = lambda p, r: tuple(p[i] + radius * (r[0] * s[i] + r[1] * t[i]) for i in range(3))
        for k in range(3):
            r, q = ring[k], ring[(k + 1) % 3]
            self.face([place(a, r), place(b, r), place(b, q), place(a, q)], colour)

    def write(self, path):
        points = [(p, colour) for polygon, colour in self.polygons for p in polygon]
        lines = ["ply", "format ascii 1.0", f"element vertex {len(points)}"]
        lines += [f"property float {axis}" for axis in "xyz"]
        lines += [f"property uchar {name}" for name in ("red", "green", "blue")]
        lines += [f"element face {len(self.polygons)}", "property list uchar int vertex_indices", "end_header"]
        lines += ["{:.5f} {:.5f} {:.5f} {} {} {}".format(*p, *colour) for p, colour in points]
        first = 0
        for polygon, _ in self.polygons:
            lines.append(" ".join(map(str, [len(polygon), *range(first, first + len(polygon))])))
            first += len(polygon)
        path.write_text("\n".join(lines) + "\n")


def place(i, j):
    """A grid point of the patch: gently curved."""
    x, y = i - 3, j - 2
    return (x, y, 0.25 * math.cos(0.5 * x) * math.cos(0.5 * y))


def lifted(point, by=0.02):
    return (point[0], point[1], point[2] + by)


def patch(drawing, colour=lambda i, j, half: GREY, at=place, columns=range(6), skip=()):
    for i in columns:
        for j in range(4):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            for half, triangle in enumerate(([a, b, c], [a, c, d])):
                if (i, j, half) not in skip:
                    drawing.face(triangle, colour(i, j, half))


def non_finite(d):
    star = {(2, 1, 0), (2, 1, 1), (3, 2, 0), (3, 2, 1), (2, 2, 0), (3, 1, 1)}
    at = lambda i, j: (0.4, 0.3, 3.2) if (i, j) == (3, 2) else place(i, j)
    patch(d, lambda i, j, half: RED if (i, j, half) in star else GREY, at)


def outlying_vertex(d):
    star = {(2, 1, 0), (2, 1, 1), (3, 2, 0), (3, 2, 1), (2, 2, 0), (3, 1, 1)}
    at = lambda i, j: (9.5, 6.5, 4.5) if (i, j) == (3, 2) else place(i, j)
    patch(d, lambda i, j, half: RED if (i, j, half) in star else GREY, at)
    d.ball((9.5, 6.5, 4.5))


def index_out_of_range(d):
    patch(d)
    d.face([place(2, 2), place(3, 2), (-0.5, 2.2, 2.3)], RED)
    d.face([place(3, 2), place(2, 2), (-0.5, 2.2, 2.3)], RED)


def degenerate_face(d):
    patch(d)
    d.line(lifted(place(2, 2)), lifted(place(3, 2)))
    d.ball(place(2, 2))


def zero_area_face(d):
    patch(d)
    ends = place(2, 2), place(3, 2)
    middle = tuple((p + q) / 2 for p, q in zip(*ends))
    d.line(lifted(ends[0]), lifted(ends[1]))
    for point in (*ends, middle):
        d.ball(point)


def isolated_vertex(d):
    patch(d)
    for point in ((-1.2, 0.4, 1.2), (0.9, -0.3, 1.6), (1.8, 1.1, 0.9)):
        d.ball(point)


def duplicate_vertex(d):
    left = lambda i, j: tuple(c - s for c, s in zip(place(i, j), (0.16, 0, 0)))
    right = lambda i, j: tuple(c + s for c, s in zip(place(i, j), (0.16, 0, 0)))
    patch(d, at=left, columns=range(3))
    patch(d, at=right, columns=range(3, 6))
    for j in range(5):
        d.ball(left(3, j))
        d.ball(right(3, j))


def non_manifold_edge(d):
    patch(d)
    a, b = place(2, 2), place(3, 2)
    top = (a[0] + 0.5, a[1], 1.3)
    d.face([a, b, top], RED)
    d.face([b, a, top], RED)
    d.line(lifted(a), lifted(b))


def non_manifold_vertex(d):
    patch(d)
    tip = place(3, 2)
    ring = [(0.8 * math.cos(k * math.pi / 3), 0.8 * math.sin(k * math.pi / 3), 1.2) for k in range(6)]
    for k in range(6):
        p, q = ([t + c for t, c in zip(tip, ring[m % 6])] for m in (k, k + 1))
        d.face([tip, p, q])
        d.face([tip, q, p])
    d.ball(tip, 0.12)


def duplicate_face(d):
    patch(d)
    for i, j, half in ((2, 1, 0), (3, 2, 1), (2, 2, 1)):
        a, b, c, e = place(i, j), place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)
        d.face([lifted(p, 0.12) for p in ([a, b, c], [a, c, e])[half]], RED)


def inconsistent_winding(d):
    turned = {(i, j) for i in (2, 3) for j in (1, 2)}
    patch(d, lambda i, j, half: RED if (i, j) in turned else GREY)
    arrow(d, place(1, 1), 1)
    arrow(d, tuple((p + q) / 2 for p, q in zip(place(3, 2), place(4, 2))), -1)
    arrow(d, place(5, 3), 1)


def arrow(d, foot, side):
    colour = (60, 60, 60) if side > 0 else RED
    start, end = (0.05, 0.7) if side > 0 else (0.75, 0.1)
    d.line(lifted(foot, start), lifted(foot, end), 0.03, colour)
    tip, base = (end + 0.3, end) if side > 0 else (end, end + 0.3)
    ring = [(foot[0] + 0.11 * math.cos(k * math.pi / 3), foot[1] + 0.11 * math.sin(k * math.pi / 3), foot[2] + base)
            for k in range(6)]
    for k in range(6):
        d.face([ring[k], ring[(k + 1) % 6], lifted(foot, tip)], colour)
        d.face([ring[(k + 1) % 6], ring[k], lifted(foot, tip)], colour)


def inward_facing_component(d):
    for x, colour in ((-1.5, GREY), (1.5, RED)):
        rings = [[(x + 1.1 * math.sin(t) * math.cos(p), 1.1 * math.sin(t) * math.sin(p), 1.1 * math.cos(t))
                  for p in (2 * math.pi * k / 14 for k in range(14))] for t in (math.pi * m / 9 for m in range(10))]
        for low, high in zip(rings[1:], rings[:-1]):
            for k in range(14):
                d.face([low[k], low[(k + 1) % 14], high[(k + 1) % 14], high[k]], colour)
        arrow(d, (x, 0, 1.1), 1 if colour == GREY else -1)


def polygon(d):
    hexagon = [(2, 1), (3, 1), (4, 2), (4, 3), (3, 3), (2, 2)]
    inside = {(2, 1, 0), (2, 1, 1), (3, 1, 1), (3, 2, 0), (3, 2, 1), (2, 2, 0)}
    patch(d, skip=inside)
    d.face([place(*corner) for corner in hexagon], RED)


DEFECTS = [non_finite, outlying_vertex, index_out_of_range, degenerate_face, zero_area_face, isolated_vertex,
           duplicate_vertex, non_manifold_edge, non_manifold_vertex, duplicate_face, inconsistent_winding,
           inward_facing_component, polygon]


def main(program, folder):
    with tempfile.TemporaryDirectory() as scratch:
        for defect in DEFECTS:
            drawing = Drawing()
            defect(drawing)
            mesh = Path(scratch) / "defect.ply"
            drawing.write(mesh)
            picture = Path(folder) / f"defect_{defect.__name__}.png"
            subprocess.run([program, "render", mesh, "-o", picture, "--width", "360", "--height", "240",
                            "--wireframe", "--flat", "--no-ground", "--up", "0", "0", "1", "--from", "0.25", "-1", "0.8"],
                           check=True, stdout=subprocess.DEVNULL)
            print(picture)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
