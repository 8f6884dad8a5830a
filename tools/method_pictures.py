#!/usr/bin/env python3
"""Makes the pictures of docs/method.md and docs/methods.md with the built program (tools/docs_pictures.sh calls it).

    tools/method_pictures.py build/release/meshgraft docs/images
"""

import json
import random
import subprocess
import sys
import tempfile
from pathlib import Path


def irregular_sheet(path, cells=44):
    """A flat square of side 2 with jittered vertices and diagonals either way."""
    random.seed(3)
    lines = []
    for j in range(cells + 1):
        for i in range(cells + 1):
            jitter = 0 if i in (0, cells) or j in (0, cells) else 0.32
            x, y = (2 * (k + random.uniform(-jitter, jitter)) / cells - 1 for k in (i, j))
            lines.append(f"v {x:.6f} {y:.6f} 0")
    for j in range(cells):
        for i in range(cells):
            a, b = j * (cells + 1) + i + 1, j * (cells + 1) + i + 2
            c, d = b + cells + 1, a + cells + 1
            split = [(a, b, c), (a, c, d)] if random.random() < 0.5 else [(a, b, d), (b, c, d)]
            lines += ["f {} {} {}".format(*triangle) for triangle in split]
    path.write_text("\n".join(lines) + "\n")


SHEET_STEP = {
    "region": {"sphere": {"centre": [0, 0, 0], "radius": 0.75}},
    "handles": [{"name": "top", "select": {"sphere": {"centre": [0, 0, 0], "radius": 0.2}},
                 "pose": {"translate": [0, 0, 0.5], "rotate": {"axis": [1, 0, 0], "angle_deg": 20}}}],
}
BAR_STEP = {
    "fixed": {"half_space": {"point": [0, 0, 0.3], "normal": [0, 0, -1]}},
    "handles": [{"name": "top", "select": {"half_space": {"point": [0, 0, 3.7], "normal": [0, 0, 1]}},
                 "pose": {"rotate": {"axis": [0, 0, 1], "angle_deg": 90}}}],
}


def picture(program, out, source, step, variants, view):
    """One picture of an edit under several settings, side by side and named by them."""
    with tempfile.TemporaryDirectory() as folder:
        meshes = []
        for name, settings in variants.items():
            edit = {"format": "meshgraft-edit", "version": 2, "inputs": {"mesh": source},
                    "steps": [{"kind": "deform", "mesh": "mesh", "settings": {"method": "ft05", **settings}, **step}]}
            edit_file, mesh = Path(folder, "edit.json"), Path(folder, name + ".ply")
            edit_file.write_text(json.dumps(edit))
            subprocess.run([program, "deform", edit_file, "-o", mesh], check=True, stdout=subprocess.DEVNULL)
            meshes.append(mesh)
        subprocess.run([program, "render", *meshes, "-o", out, "--flat", "--no-ground", "--up", "0", "0", "1", *view], check=True)


def ends(low, high):
    """The foot below `low` fixed, the top above `high` a handle."""
    return ({"half_space": {"point": [0, 0, low], "normal": [0, 0, -1]}},
            {"half_space": {"point": [0, 0, high], "normal": [0, 0, 1]}})


def turn(sample, low, high, axis, angle_deg, pivot, view):
    fixed, top = ends(low, high)
    pose = {"rotate": {"axis": axis, "angle_deg": angle_deg}, "pivot": pivot}
    return sample, {"fixed": fixed, "handles": [{"name": "top", "select": top, "pose": pose}]}, view


# The four tests of Botsch and Sorkine on samples: name, sample, step, view.
STANDARD_TESTS = {
    "methods_plane": ("bumpy_plane", {
        "fixed": {"minus": ["all", {"box": {"min": [-0.45, -0.45, -1], "max": [0.45, 0.45, 1]}}]},
        "handles": [{"name": "disc", "select": {"sphere": {"centre": [0, 0, 0], "radius": 0.12}},
                     "pose": {"translate": [0, 0, 0.2]}}]}, ["--from", "0.5", "-1", "0.6"]),
    "methods_cylinder": turn("cylinder", 0.4, 3.6, [1, 0, 0], 120, [0, 0, 2], ["--from", "1", "-0.2", "0.2"]),
    "methods_bar": turn("bar", 0.4, 3.6, [0, 0, 1], 135, [0, 0, 2], ["--from", "1", "-0.6", "0.2"]),
    "methods_cactus": turn("cactus", 0.25, 2.45, [-1, 0, 0], 70, [0, 0, 1], ["--from", "1", "-0.5", "0.3"]),
}
# A disc turned within its sheet.
DISC_TURNED = ("bumpy_plane", {
    "fixed": {"minus": ["all", {"box": {"min": [-0.45, -0.45, -1], "max": [0.45, 0.45, 1]}}]},
    "handles": [{"name": "disc", "select": {"sphere": {"centre": [0, 0, 0], "radius": 0.12}},
                 "pose": {"rotate": {"axis": [0, 0, 1], "angle_deg": 150}}}]}, ["--from", "0.2", "-0.5", "1"])
METHODS = "corotational,shell,rotation-aware,ft05,yu-2004,arap-2007"


def comparison(program, out, sample, step, view):
    """One picture of a sample and of what several methods make of an edit of it."""
    with tempfile.TemporaryDirectory() as folder:
        edit = {"format": "meshgraft-edit", "version": 2, "inputs": {"mesh": {"sample": sample}},
                "steps": [{"kind": "deform", "mesh": "mesh", **step}]}
        edit_file, result = Path(folder, "edit.json"), Path(folder, "compared")
        edit_file.write_text(json.dumps(edit))
        subprocess.run([program, "compare", edit_file, "--methods", METHODS, "-o", result, "--width", "420",
                        "--height", "420", *view], check=True, stdout=subprocess.DEVNULL)
        Path(out).write_bytes(Path(result, "compare.png").read_bytes())


def main(program, folder):
    for name, test in (STANDARD_TESTS | {"methods_disc": DISC_TURNED}).items():
        comparison(program, Path(folder, name + ".png"), *test)
    with tempfile.TemporaryDirectory() as scratch:
        sheet = Path(scratch, "sheet.obj")
        irregular_sheet(sheet)
        picture(program, Path(folder, "laplacian_weight.png"), {"file": str(sheet)}, SHEET_STEP,
                {f"{treatment}, weight {weight}": {"degenerate": treatment, "laplacian_weight": weight}
                 for treatment in ("apex", "ft05-noise") for weight in (1, 20)},
                ["--width", "640", "--height", "480", "--from", "0.3", "-1", "0.6"])
    picture(program, Path(folder, "degenerate.png"), {"sample": "bar", "resolution": 60}, BAR_STEP,
            {treatment: {"degenerate": treatment} for treatment in ("apex", "ft05-noise")},
            ["--width", "500", "--height", "640", "--from", "1", "-0.6", "0.2"])


if __name__ == "__main__":
    main(*sys.argv[1:])
