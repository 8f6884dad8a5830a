#!/usr/bin/env python3
"""Makes the picture of the fills in docs/repair.md with the built program (tools/docs_pictures.sh calls it).

    tools/repair_pictures.py build/release/meshgraft docs/images
"""

import math
import subprocess
import sys
import tempfile
from pathlib import Path

CENTRE, RADIUS = (0.35, -0.45, 0.95), 0.36  # of the hole in the head
FRAME = 0.75  # as far from the hole's middle faces are shown


class Surface:
    """Vertices and faces of an OBJ file, without colours."""

    def __init__(self, path):
        lines = [line.split() for line in path.read_text().splitlines()]
        self.points = [tuple(map(float, words[1:4])) for words in lines if words[:1] == ["v"]]
        self.faces = [[int(word.split("/")[0]) - 1 for word in words[1:]] for words in lines if words[:1] == ["f"]]

    def write(self, path, keep):
        """Writes the faces whose corners' distances from the hole's middle, the smallest first, are to be kept."""
        distances = [math.dist(CENTRE, point) for point in self.points]
        faces = [face for face in self.faces if keep(sorted(distances[k] for k in face))]
        used = sorted({k for face in faces for k in face})
        number = {k: str(n) for n, k in enumerate(used, 1)}
        lines = ["v {} {} {}".format(*self.points[k]) for k in used]
        lines += [" ".join(["f", *(number[k] for k in face)]) for face in faces]
        path.write_text("\n".join(lines) + "\n")


def main(program, folder):
    run = lambda *words: subprocess.run([program, *words], check=True, stdout=subprocess.DEVNULL)
    with tempfile.TemporaryDirectory() as scratch:
        whole, holed, mended = (Path(scratch) / f"{name}.obj" for name in ("whole", "holed", "mended"))
        run("sample", "head", "--resolution", "90", "-o", whole)
        Surface(whole).write(holed, lambda distances: distances[0] > RADIUS)
        shown = [Path(scratch) / f"{name}.obj" for name in ("open", "plain", "refined", "faired")]
        for path in shown:
            if path.stem == "open":
                Surface(holed).write(path, lambda distances: distances[-1] < FRAME)
                continue
            run("repair", holed, "-o", mended, "--force", "--fill-holes", "400", "--hole-fill", path.stem)
            Surface(mended).write(path, lambda distances: distances[-1] < FRAME)
        picture = Path(folder) / "repair_holes.png"
        run("render", *shown, "-o", picture, "--width", "480", "--height", "480", "--wireframe", "--no-ground",
            "--up", "0", "0", "1")
        print(picture)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
