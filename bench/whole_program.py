#!/usr/bin/env python3
"""Measures the program as a user runs it: wall-clock time and peak memory of whole processes.

    bench/whole_program.py PROGRAM [VERTICES…]   a Markdown table; default 50,000, 250,000 and 1,000,000 vertices

Each row runs `meshgraft deform` on a bumpy square sheet: two rings of its border are fixed, and a disc in its middle is
rotated by 45° out of the plane. The time is that from the start of the process to its end, with reading, checks,
measures of quality and writing; the median of three runs. The memory is the largest resident set of the process,
and nothing is subtracted.
"""

import json
import math
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

METHODS = ("corotational", "ft05")
RUNS = 3


def run(arguments):
    """Runs a command. Returns its wall-clock seconds and its peak memory in bytes."""
    start = time.monotonic()
    pid = os.posix_spawn(arguments[0], arguments, os.environ,
                         file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)])
    _, status, usage = os.wait4(pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(arguments)}: exit status {os.waitstatus_to_exitcode(status)}")
    return time.monotonic() - start, 1024 * usage.ru_maxrss


def make_edit(folder, program, vertices):
    """Writes the sheet and its edit, and returns the edit's path and the number of vertices."""
    side = round(math.sqrt(vertices))
    mesh = folder / f"sheet_{side}.ply"
    run([program, "sample", "bumpy_plane", "--resolution", str(side), "-o", str(mesh)])
    header = mesh.read_bytes()[:2000].split(b"end_header")[0].decode()
    count = int(next(line for line in header.splitlines() if line.startswith("element vertex")).split()[2])
    edit = {
        "format": "meshgraft-edit",
        "version": 2,
        "inputs": {"sheet": {"file": mesh.name}},
        "steps": [{
            "kind": "deform",
            "mesh": "sheet",
            "region": "all",
            "fixed": {"grow": {"of": {"loop": 0}, "rings": 1}},
            "handles": [{
                "name": "disc",
                "select": {"sphere": {"centre": [0, 0, 0], "radius": 0.1}},
                "pose": {"rotate": {"axis": [1, 0, 0], "angle_deg": 45}},
            }],
        }],
    }
    path = folder / f"edit_{side}.json"
    path.write_text(json.dumps(edit))
    return path, count


def main(program, sizes):
    print("| vertices | method | solved by | wall-clock, s | peak memory, GB |\n|---:|---|---|---:|---:|")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for size in sizes:
            edit, count = make_edit(folder, program, size)
            for method in METHODS:
                report = folder / "report.json"
                runs = [run([program, "deform", str(edit), "-o", str(folder / "out.ply"), "--force", "--method", method,
                             "--report", str(report)]) for _ in range(RUNS)]
                step = json.loads(report.read_text())["steps"][0]
                solved = step["solver"]["backend"] + (" on a proxy" if step.get("proxy") else "")
                print(f"| {count:,} | `{method}` | {solved} | {statistics.median(s for s, _ in runs):.1f} | "
                      f"{max(b for _, b in runs) / 1e9:.2f} |", flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(os.path.abspath(sys.argv[1]), [int(size.replace(",", "")) for size in sys.argv[2:]] or [50_000, 250_000, 1_000_000])
