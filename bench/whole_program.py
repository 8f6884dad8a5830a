#!/usr/bin/env python3
"""Measures the program as a user runs it: wall-clock time, its parts, and peak memory of whole processes.

    bench/whole_program.py PROGRAM [VERTICES…]       default 50,000, 250,000 and 1,000,000 vertices
    bench/whole_program.py PROGRAM --small-region    3,000 free vertices of a mesh of 5 million
    bench/whole_program.py PROGRAM --against OTHER … both programs, in turn
    bench/whole_program.py PROGRAM --proxy N …       solves proxies of about so many vertices

Prints a Markdown table. Each row runs `meshgraft deform` on a bumpy square sheet: two rings of its border are fixed,
and a disc in its middle is rotated by 45° out of the plane. The region of --small-region is a ball around a point of a
torus. The time is that from the start of the process to its end, with reading, checks, measures of quality and
writing; the median of the runs. `measure` is the report's stage of that name; `picture` is what a run with --picture
takes longer. `share` is both over all other time. The memory is the largest resident set of the process, and nothing
is subtracted.
"""

import argparse
import json
import math
import os
import statistics
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

METHODS = ("corotational", "ft05")


@dataclass
class Runs:
    """The runs of one program on one edit: seconds with and without a picture, seconds of measuring, bytes."""

    plain: list = field(default_factory=list)
    pictured: list = field(default_factory=list)
    measured: list = field(default_factory=list)
    memory: list = field(default_factory=list)
    solver: str = ""

    def row(self, compared=None):
        wall = statistics.median(self.plain)
        measure = statistics.median(self.measured)
        picture = max(0.0, statistics.median(self.pictured) - wall)
        cells = [self.solver, f"{wall:.1f}", f"{measure:.2f}", f"{picture:.2f}",
                 f"{(measure + picture) / (wall - measure):.2f}", f"{max(self.memory) / 1e9:.2f}"]
        if compared is not None:
            cells.append(f"{wall / statistics.median(compared.plain):.2f}×")
        return cells


def run(arguments):
    """Runs a command. Returns its wall-clock seconds and its peak memory in bytes."""
    start = time.monotonic()
    pid = os.posix_spawn(arguments[0], arguments, os.environ,
                         file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)])
    _, status, usage = os.wait4(pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(arguments)}: exit status {os.waitstatus_to_exitcode(status)}")
    return time.monotonic() - start, 1024 * usage.ru_maxrss


def make_sample(folder, program, sample, resolution):
    """Writes a built-in model, and returns its path and the number of its vertices."""
    mesh = folder / f"{sample}_{resolution}.ply"
    run([program, "sample", sample, "--resolution", str(resolution), "-o", str(mesh)])
    with mesh.open("rb") as file:
        header = file.read(2000).split(b"end_header")[0].decode()
    return mesh, int(next(line for line in header.splitlines() if line.startswith("element vertex")).split()[2])


def write_edit(mesh, step):
    """Writes an edit of one deform step beside its mesh, and returns its path."""
    path = mesh.with_suffix(".json")
    path.write_text(json.dumps({
        "format": "meshgraft-edit",
        "version": 2,
        "inputs": {"model": {"file": mesh.name}},
        "steps": [{"kind": "deform", "mesh": "model"} | step],
    }))
    return path


def make_sheet(folder, program, vertices):
    mesh, count = make_sample(folder, program, "bumpy_plane", round(math.sqrt(vertices)))
    return write_edit(mesh, {
        "region": "all",
        "fixed": {"grow": {"of": {"loop": 0}, "rings": 1}},
        "handles": [{
            "name": "disc",
            "select": {"sphere": {"centre": [0, 0, 0], "radius": 0.1}},
            "pose": {"rotate": {"axis": [1, 0, 0], "angle_deg": 45}},
        }],
    }), count


def make_small_region(folder, program):
    mesh, count = make_sample(folder, program, "torus", 2240)
    centre = [1.4, 0, 0.4]
    return write_edit(mesh, {
        "region": {"sphere": {"centre": centre, "radius": 0.068}},
        "handles": [{
            "name": "tip",
            "select": {"sphere": {"centre": centre, "radius": 0.01}},
            "pose": {"translate": [0.02, 0, 0]},
        }],
    }), count


def measure_edit(programs, edit, method, arguments, folder):
    """Runs an edit by each program in turn."""
    results = [Runs() for _ in programs]
    report = folder / "report.json"
    for _ in range(arguments.runs):
        for program, runs in zip(programs, results):
            command = [program, "deform", str(edit), "-o", str(folder / "out.ply"), "--force", "--method", method,
                       "--report", str(report)]
            if arguments.proxy:
                command += ["--proxy", str(arguments.proxy)]
            seconds, memory = run(command)
            runs.plain.append(seconds)
            runs.memory.append(memory)
            step = json.loads(report.read_text())["steps"][0]
            runs.measured.append(step["seconds"]["measure"])
            runs.solver = step["solver"]["backend"] + (" on a proxy" if step.get("proxy") else "")
            runs.pictured.append(run([*command, "--picture", str(folder / "picture.png")])[0])
    return results


def main(arguments):
    programs = [os.path.abspath(program) for program in (arguments.program, arguments.against) if program]
    columns = ["vertices", "method", "solved by", "wall-clock, s", "measure, s", "picture, s", "share",
               "peak memory, GB"]
    if arguments.against:
        columns = ["program", *columns, "wall-clock over the other's"]
    print("| " + " | ".join(columns) + " |\n|" + "---|" * len(columns))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for size in [None] if arguments.small_region else arguments.vertices:
            edit, count = make_small_region(folder, programs[0]) if size is None else make_sheet(folder, programs[0],
                                                                                              size)
            for method in arguments.methods:
                results = measure_edit(programs, edit, method, arguments, folder)
                for k, runs in enumerate(results):
                    cells = [f"{count:,}", f"`{method}`", *runs.row(results[1 - k] if arguments.against else None)]
                    if arguments.against:
                        cells.insert(0, ("this", "other")[k])
                    print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("vertices", nargs="*", type=lambda text: int(text.replace(",", "")),
                        default=[50_000, 250_000, 1_000_000])
    parser.add_argument("--small-region", action="store_true")
    parser.add_argument("--against", metavar="OTHER")
    parser.add_argument("--proxy", type=int, default=0, metavar="N")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--methods", nargs="+", default=METHODS)
    main(parser.parse_args())
