#!/usr/bin/env python3
"""Measures meshgraft-mpi for docs/scale.md: seconds, memory, halos, iterations and messages.

    cluster_scale.py MESHGRAFT_MPI SIDE RANKS… [--folder FOLDER]

Makes an irregular sheet with bumps of SIDE × SIDE vertices as a binary PLY file in the folder, unless it is there. Turns a
disc in its middle by 45°, with two rings of the border fixed. Prints a row of a Markdown table for each number of ranks.
"""

import argparse
import array
import json
import math
import os
import random
import re
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path


def write_sheet(path, side):
    chance = random.Random(1)
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {side * side}",
             *(f"property double {name}" for name in "xyz"), f"element face {2 * (side - 1) ** 2}",
             "property list int int vertex_indices", "end_header"]
    with open(path, "wb") as file:
        file.write(("\n".join(lines) + "\n").encode())
        for j in range(side):
            row = array.array("d")
            for i in range(side):
                x, y = ((k + 0.3 * (chance.random() - 0.5)) / side for k in (i, j))
                row.extend((x, y, 0.04 * math.sin(9 * x) * math.cos(7 * y)))
            file.write(row.tobytes())
        for j in range(side - 1):
            row = array.array("i")
            for i in range(side - 1):
                a = j * side + i
                b, c, d = a + 1, a + side, a + side + 1
                row.extend((3, a, b, d, 3, a, d, c) if chance.random() < 0.5 else (3, a, b, c, 3, b, d, c))
            file.write(row.tobytes())


def write_edit(path, mesh, settings):
    step = {"kind": "deform", "mesh": "mesh", "region": "all",
            "fixed": {"grow": {"of": {"loop": 0}, "rings": 1}},
            "handles": [{"name": "disc", "select": {"sphere": {"centre": [0.5, 0.5, 0], "radius": 0.1}},
                         "pose": {"rotate": {"axis": [1, 0, 0], "angle_deg": 45}, "translate": [0, 0, 0.2]}}],
            "settings": settings}
    path.write_text(json.dumps({"format": "meshgraft-edit", "version": 2, "inputs": {"mesh": {"file": mesh.name}},
                                "steps": [step]}))


class PeakMemory(threading.Thread):
    """Samples the largest resident set of each process of the program."""

    def __init__(self, name):
        super().__init__(daemon=True)
        self.name_, self.peaks, self.ends = name, {}, False

    def run(self):
        while not self.ends:
            for process in Path("/proc").iterdir():
                if process.name.isdigit():
                    try:
                        text = (process / "status").read_text()
                    except OSError:
                        continue
                    found = re.search(r"VmHWM:\s+(\d+)", text)
                    if found and text.startswith(f"Name:\t{self.name_[:15]}\n"):
                        self.peaks[process.name] = int(found[1]) * 1024
            time.sleep(0.05)


def measure(arguments, mesh, edit, ranks):
    report, output = mesh.with_suffix(".json"), mesh.with_suffix(".out.ply")
    environment = os.environ | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                                "OMPI_MCA_btl_vader_single_copy_mechanism": "none", "OMP_NUM_THREADS": "1",
                                "OMPI_MCA_mpi_yield_when_idle": "1"}
    memory = PeakMemory(Path(arguments.program).name)
    memory.start()
    done = subprocess.run(["mpirun", "-q", "-n", str(ranks), "--oversubscribe", arguments.program, "deform", str(edit), "-o",
                           str(output), "--report", str(report), "--petsc", "-log_view " + arguments.petsc,
                           *(["--preconditioner", arguments.preconditioner])],
                          capture_output=True, text=True, env=environment)
    memory.ends = True
    memory.join()
    if done.returncode != 0:
        sys.exit(done.stderr)
    facts = json.loads(report.read_text())
    output.unlink()
    seconds, own = facts["seconds"], facts["distributed"]
    messages = re.search(r"MPI Msg Count:\s+\S+\s+\S+\s+(\S+)\s+(\S+)", done.stdout)
    vertices = facts["counts"]["vertices"]
    peak = max(memory.peaks.values())
    row = [f"{vertices:,}", ranks, f"{seconds['assemble'] - own['partition_seconds']:.1f}", f"{own['partition_seconds']:.1f}",
           f"{seconds['factorise']:.1f}", f"{seconds['solve']:.1f}", f"{seconds['total']:.1f}", own["iterations"],
           f"{peak / 1e6:,.0f}", f"{peak * ranks / vertices:,.0f}", f"{own['largest_part']:,}",
           f"{own['largest_halo']:,}", own["most_neighbours"], f"{float(messages[1]):,.0f}" if messages else ""]
    print("| " + " | ".join(map(str, row)) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("side", type=int)
    parser.add_argument("ranks", type=int, nargs="+")
    parser.add_argument("--settings", default='{"method": "ft05", "refine_boundary": 0}')
    parser.add_argument("--petsc", default="")
    parser.add_argument("--preconditioner", default="blended")
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()))
    arguments = parser.parse_args()
    mesh, edit = arguments.folder / f"sheet_{arguments.side}.ply", arguments.folder / f"sheet_{arguments.side}_edit.json"
    if not mesh.exists():
        write_sheet(mesh, arguments.side)
    write_edit(edit, mesh, json.loads(arguments.settings))
    print("| vertices | ranks | assemble, s | divide, s | preconditioner, s | solve, s | total, s | iterations | memory of the "
          "largest rank, MB | bytes per vertex | largest part | largest halo | neighbours | messages per rank |")
    print("|" + "---:|" * 14)
    for ranks in arguments.ranks:
        measure(arguments, mesh, edit, ranks)


if __name__ == "__main__":
    main()
