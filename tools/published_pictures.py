#!/usr/bin/env python3
"""Makes the pictures of docs/method.md that show the paper's figures 3 to 8 with the built-in models: each edit as
published and by default, side by side, or in two pictures where a figure has several edits (tools/docs_pictures.sh
calls it).

    tools/published_pictures.py build/release/meshgraft docs/images
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path


def deform(sample, **step):
    return {"format": "meshgraft-edit", "version": 2, "inputs": {"mesh": {"sample": sample}},
            "steps": [{"kind": "deform", "mesh": "mesh", **step}]}


def handle(select, **pose):
    return [{"name": "handle", "select": select, "pose": pose}]


def sphere(centre, radius):
    return {"sphere": {"centre": centre, "radius": radius}}


def half_space(point, normal):
    return {"half_space": {"point": point, "normal": normal}}


# Figure 3: a head moved, turned, scaled, and all of these. The horse's is the dinosaur's here.
NECK = half_space([-0.8, 0, 1.6], [-0.6, 0, 0.8])
HEAD = sphere([-2.0, 0, 3.35], 0.52)
PIVOT = [-1.35, 0, 2.4]
HEAD_EDITS = {
    "moved": {"translate": [-0.5, 0, 0.5]},
    "turned": {"rotate": {"axis": [0, 0.25, 1], "angle_deg": 75}, "pivot": PIVOT},
    "scaled": {"scale": 1.7},
    "all three": {"translate": [-0.3, 0, 0.4], "rotate": {"axis": [0, 0.25, 1], "angle_deg": 75}, "scale": 1.5, "pivot": PIVOT},
}

# Figure 5: a head that follows what is done to the loop of its neck alone.
LOOP = {"loop": 0}


def figures(examples):
    """Name of the picture: edits by name, and the view."""
    def example(name):
        return json.loads(Path(examples, name + ".json").read_text())

    def neck_moved(**pose):
        return deform("head", fixed={"indices": []}, handles=handle(LOOP, **pose))

    return {
        "published_3": ({name: deform("dinosaur", region=NECK, handles=handle(HEAD, **pose))
                         for name, pose in HEAD_EDITS.items()}, ["--from", "-0.4", "-1", "0.25"]),
        "published_4": ({"arms": example("octopus_wave")}, ["--from", "0", "-1", "0.5"]),
        "published_5": ({"turned": neck_moved(rotate={"axis": [1, 0, 0.3], "angle_deg": 40}),
                         "sheared": neck_moved(matrix=[[1.2, 0, 0.4, 0], [0, 0.9, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])},
                        ["--from", "0.5", "-1", "0.3"]),
        "published_6": ({"horns": example("horns")}, ["--from", "0.5", "-1", "0.4"]),
        "published_7": ({"dinosaur on bust": example("dinosaur_bust")}, ["--from", "0.8", "-1", "0.3"]),
        "published_8": ({"bracket on posts": example("bracket_on_posts")}, ["--from", "0.5", "-1", "0.6"]),
    }


WAYS = {"as published": ["--as-published"], "default": []}


def run(program, edit, flags, mesh):
    edit.pop("$schema", None)
    edit_file = mesh.with_name("edit.json")
    edit_file.write_text(json.dumps(edit))
    subprocess.run([program, "run", edit_file, "-o", mesh, *flags], check=True, stdout=subprocess.DEVNULL)
    return mesh


def render(program, meshes, out, width, height, view):
    subprocess.run([program, "render", *meshes, "-o", out, "--width", str(width), "--height", str(height), *view],
                   check=True)


def pictures(program, folder, name, edits, view):
    """One picture of a figure with one edit, else one as published and one by default."""
    with tempfile.TemporaryDirectory() as scratch:
        if len(edits) == 1:
            (edit,) = edits.values()
            meshes = [run(program, edit, flags, Path(scratch, way + ".ply")) for way, flags in WAYS.items()]
            return render(program, meshes, Path(folder, name + ".png"), 420, 420, view)
        for way, flags in WAYS.items():
            meshes = [run(program, edit, flags, Path(scratch, f"{edit_name}, {way}.ply"))
                      for edit_name, edit in edits.items()]
            out = Path(folder, f"{name}_{way.replace(' ', '_')}.png")
            render(program, meshes, out, 300, 260, view)


def main(program, folder):
    examples = Path(__file__).resolve().parent.parent / "examples"
    for name, (edits, view) in figures(examples).items():
        pictures(program, folder, name, edits, view)


if __name__ == "__main__":
    main(*sys.argv[1:])
