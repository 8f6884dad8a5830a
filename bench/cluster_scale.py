#!/usr/bin/env python3
"""Measures meshgraft-mpi for docs/scale.md: seconds, memory, halos, iterations, messages and bytes.

    cluster_scale.py MESHGRAFT_MPI SIDE RANKS… [--shape torus] [--records FILE]
    cluster_scale.py MESHGRAFT_MPI 64 1 2 4 8 --per-rank

Makes an irregular mesh of SIDE × SIDE vertices (of each rank with --per-rank) as a binary PLY file in the folder, unless
it is there: a sheet with bumps, or a torus with bumps. Turns a disc by 45°, with two rings of the sheet's border or a tenth
of the torus fixed. Prints a row of a Markdown table for each number of ranks, and appends a record with all figures,
those of PETSc's log among them, to the file of records. The log is written for a few ranks alone: its ranks send every
event as a message of its own, which took seven minutes at 64 ranks.

Ranks of Open MPI that wait keep polling. With more ranks than cores that keeps others from their core, so that
they sleep here instead, for which a C compiler (cc) is needed.
"""

import argparse
import array
import json
import math
import os
import random
import re
import resource
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

SET_UP, FINE, COARSE = "Set-up", "Fine grid", "Coarse grid"
# Bytes of memory traffic per flop. A product reads 12 bytes per entry of the matrix; on the fine grid it multiplies three
# columns by it. Vectors move 12 bytes per flop, as in y + a x.
TRAFFIC = {FINE: {"MatMult": 2, "MatMultAdd": 2, "MatMultTranspose": 2, "MatMultTrAdd": 2},
           COARSE: {"MatMult": 6, "MatMultAdd": 6, "MatMultTranspose": 6, "MatSolve": 6}}
VECTOR_TRAFFIC = 12
COLUMNS = 3  # x, y and z, which the coarse grid takes one after another
SOLVES = 2  # with the residual correction
MOST_LOGGED = 16  # ranks
TABLES = {
    "counts": ("vertices", "ranks", "iterations", "coarse_cycles", "largest_part", "largest_halo", "neighbours",
               "messages", "kilobytes", "reductions", "memory_mb", "bytes_per_vertex"),
    "seconds": ("vertices", "ranks", "preconditioner", "assemble", "divide", "set_up", "solve", "total",
                "processor_seconds", "iterations", "memory_mb", "bytes_per_vertex"),
}


def write_mesh(path, columns, rows, position, is_closed):
    """Writes a grid of columns × rows vertices; `position` is of (column, row) in units of the grid, jittered."""
    chance = random.Random(1)
    wide, high = (columns, rows) if is_closed else (columns - 1, rows - 1)
    lines = ["ply", "format binary_little_endian 1.0", f"element vertex {columns * rows}",
             *(f"property double {name}" for name in "xyz"), f"element face {2 * wide * high}",
             "property list int int vertex_indices", "end_header"]
    with open(path, "wb") as file:
        file.write(("\n".join(lines) + "\n").encode())
        for j in range(rows):
            row = array.array("d")
            for i in range(columns):
                row.extend(position(*(k + 0.3 * (chance.random() - 0.5) for k in (i, j))))
            file.write(row.tobytes())
        for j in range(high):
            row = array.array("i")
            above = (j + 1) % rows * columns
            for i in range(wide):
                right = (i + 1) % columns
                a, b, c, d = j * columns + i, j * columns + right, above + i, above + right
                row.extend((3, a, b, d, 3, a, d, c) if chance.random() < 0.5 else (3, a, b, c, 3, b, d, c))
            file.write(row.tobytes())


def write_sheet(path, side):
    def position(i, j):
        x, y = i / side, j / side
        return x, y, 0.04 * math.sin(9 * x) * math.cos(7 * y)
    write_mesh(path, side, side, position, is_closed=False)


def write_torus(path, side):
    """Writes a torus of radii 1 and 0.4 with bumps, twice as many vertices around the hole as around the tube."""
    around = 2 * round(side / math.sqrt(2))
    tube = round(side * side / around)

    def position(i, j):
        u, v = 2 * math.pi * i / around, 2 * math.pi * j / tube
        radius = 0.4 + 0.03 * math.sin(7 * u) * math.sin(3 * v)
        return (1 + radius * math.cos(v)) * math.cos(u), (1 + radius * math.cos(v)) * math.sin(u), radius * math.sin(v)
    write_mesh(path, around, tube, position, is_closed=True)


SHAPES = {
    "sheet": (write_sheet, {"grow": {"of": {"loop": 0}, "rings": 1}}, {"sphere": {"centre": [0.5, 0.5, 0], "radius": 0.1}}),
    "torus": (write_torus, {"half_space": {"point": [-1.1, 0, 0], "normal": [-1, 0, 0]}},
              {"sphere": {"centre": [1.4, 0, 0], "radius": 0.25}}),
}


def write_edit(path, mesh, shape, settings):
    _, fixed, handle = SHAPES[shape]
    step = {"kind": "deform", "mesh": "mesh", "region": "all", "fixed": fixed,
            "handles": [{"name": "disc", "select": handle,
                         "pose": {"rotate": {"axis": [1, 0, 0], "angle_deg": 45}, "translate": [0, 0, 0.2]}}],
            "settings": settings}
    path.write_text(json.dumps({"format": "meshgraft-edit", "version": 2, "inputs": {"mesh": {"file": mesh.name}},
                                "steps": [step]}))


def patient_ranks(folder, ranks):
    """Returns a library to preload, in which sched_yield sleeps, the longer the more ranks poll."""
    source, library = folder / "patient_ranks.c", folder / "patient_ranks.so"
    source.write_text(f"#include <time.h>\nint sched_yield(void) {{ return nanosleep(&(struct timespec){{0, {3000 * ranks}}}, 0); }}\n")
    subprocess.run(["cc", "-O2", "-shared", "-fPIC", "-o", library, source], check=True)
    return library


class PeakMemory(threading.Thread):
    """Samples the largest resident set of each child of a process, the ranks that mpirun starts."""

    def __init__(self, parent):
        super().__init__(daemon=True)
        self.parent, self.peaks, self.ends = parent, {}, False

    def run(self):
        while not self.ends:
            for process in Path("/proc").iterdir():
                if process.name.isdigit():
                    try:
                        text = (process / "status").read_text()
                    except OSError:
                        continue
                    found = re.search(r"VmHWM:\s+(\d+)", text)
                    if found and f"\nPPid:\t{self.parent}\n" in text:
                        self.peaks[process.name] = int(found[1]) * 1024
            time.sleep(0.2)


def read_log(path):
    """Returns the events of PETSc's log in its Python format: stage → event → rank → figures."""
    values = {}
    exec(compile(path.read_text(), str(path), "exec"), values)  # written by PETSc in this run
    return values["Stages"]


def count(work):
    """Returns the figures per iteration of the solve, from the report."""
    iterations = work["iterations"] + SOLVES  # each solve applies the preconditioner before its first iteration, too
    return {
        "iterations": iterations,
        "coarse_cycles": work["coarse_iterations"] / COLUMNS / iterations + 1 if work["coarse_iterations"] else 0,
        "messages": work["messages"] / iterations,
        "kilobytes": work["bytes"] / iterations / 1e3,
        "reductions": work["reductions"] / iterations,
    }


def count_logged(log, ranks, vertices):
    """Returns the traffic of memory per iteration of the solve, from PETSc's log."""
    def event(stage, name, figure):
        return [log.get(stage, {}).get(name, {}).get(rank, {}).get(figure, 0) for rank in range(ranks)]

    def of_both(figure):
        """Of the iterations alone: KSPSolve of the fine grid leaves out what the coarse grid's stage counts."""
        return [sum(log[stage]["summary"][rank][figure] for stage in (FINE, COARSE) if stage in log)
                for rank in range(ranks)]

    def traffic(stage):
        """Of all ranks; every event that is counted here has no other within."""
        return sum(figures.get(rank, {}).get("flop", 0) * TRAFFIC[stage].get(name, VECTOR_TRAFFIC if name.startswith("Vec") else 0)
                   for name, figures in log.get(stage, {}).items() if name != "summary" for rank in range(ranks))

    iterations = max(1, event(FINE, "MatMult", "count")[0]) if COARSE not in log else event(COARSE, "KSPSolve", "count")[0] / COLUMNS
    return {
        "fine_products": event(FINE, "MatMult", "count")[0] / iterations,
        "flops_per_vertex": sum(of_both("flop")) / iterations / vertices,
        "coarse_flops_per_vertex": sum(log[COARSE]["summary"][rank]["flop"] for rank in range(ranks)) / iterations / vertices
        if COARSE in log else 0,
        "fine_traffic": traffic(FINE) / iterations / vertices,
        "coarse_traffic": traffic(COARSE) / iterations / vertices,
        "fine_seconds": max(log[FINE]["summary"][rank]["time"] for rank in range(ranks)),
        "coarse_seconds": max(log[COARSE]["summary"][rank]["time"] for rank in range(ranks)) if COARSE in log else 0,
        "set_up_flops_per_vertex": sum(log[SET_UP]["summary"][rank]["flop"] for rank in range(ranks)) / vertices,
    }


def processor_seconds():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure(arguments, mesh, edit, ranks):
    """Returns the record of a run."""
    report, output, log = mesh.with_suffix(".json"), mesh.with_suffix(".out.ply"), mesh.with_suffix(".log.py")
    environment = os.environ | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                                "OMPI_MCA_btl_vader_single_copy_mechanism": "none", "OMP_NUM_THREADS": "1",
                                "OMPI_MCA_mpi_yield_when_idle": "1"}
    if ranks > os.cpu_count():
        environment["LD_PRELOAD"] = str(patient_ranks(arguments.folder.resolve(), ranks))
    is_logged = ranks <= MOST_LOGGED
    before = processor_seconds()
    with subprocess.Popen(["mpirun", "-q", "-n", str(ranks), "--oversubscribe", arguments.program, "deform", str(edit), "-o",
                           str(output), "--report", str(report), "--petsc",
                           (f"-log_view :{log}:ascii_info_detail " if is_logged else "") + arguments.petsc,
                           "--preconditioner", arguments.preconditioner],
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment) as process:
        memory = PeakMemory(process.pid)
        memory.start()
        _, errors = process.communicate()
    memory.ends = True
    memory.join()
    if process.returncode != 0:
        sys.exit(errors)
    facts = json.loads(report.read_text())
    output.unlink()
    seconds, own = facts["seconds"], facts["distributed"]
    vertices, peak = facts["counts"]["vertices"], max(memory.peaks.values())
    return {
        "shape": arguments.shape, "vertices": vertices, "ranks": ranks, "preconditioner": arguments.preconditioner,
        "petsc": arguments.petsc, "settings": arguments.settings,
        "assemble": seconds["assemble"] - own["partition_seconds"], "divide": own["partition_seconds"],
        "set_up": seconds["factorise"], "solve": seconds["solve"], "total": seconds["total"],
        "processor_seconds": processor_seconds() - before, "memory_mb": peak / 1e6,
        "bytes_per_vertex": peak * ranks / vertices, "largest_part": own["largest_part"],
        "largest_halo": own["largest_halo"], "neighbours": own["most_neighbours"], "unknowns": own["unknowns"],
        "coarse_unknowns": own["coarse_unknowns"], "matrix_nonzeros": own["matrix_nonzeros"],
        **count(own["work"]),
        **(count_logged(read_log(log), ranks, vertices) if is_logged else {}),
    }


def text_of(value):
    if isinstance(value, float):
        return f"{value:,.0f}" if abs(value) >= 100 else f"{value:.1f}"
    return f"{value:,}" if isinstance(value, int) else str(value)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("side", type=int)
    parser.add_argument("ranks", type=int, nargs="+")
    parser.add_argument("--per-rank", action="store_true", help="SIDE × SIDE vertices of each rank, not of all")
    parser.add_argument("--shape", choices=SHAPES, default="sheet")
    parser.add_argument("--table", choices=TABLES, default="counts")
    parser.add_argument("--settings", default='{"method": "ft05", "refine_boundary": 0}')
    parser.add_argument("--petsc", default="")
    parser.add_argument("--preconditioner", default="blended")
    parser.add_argument("--records", type=Path, help="a file to append to, one JSON object per run")
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()))
    arguments = parser.parse_args()
    columns = TABLES[arguments.table]
    print("| " + " | ".join(columns).replace("_", " ") + " |\n|" + "---:|" * len(columns), flush=True)
    for ranks in arguments.ranks:
        side = round(arguments.side * math.sqrt(ranks)) if arguments.per_rank else arguments.side
        mesh = arguments.folder / f"{arguments.shape}_{side}.ply"
        edit = mesh.with_suffix(".edit.json")
        if not mesh.exists():
            SHAPES[arguments.shape][0](mesh, side)
        write_edit(edit, mesh, arguments.shape, json.loads(arguments.settings))
        record = measure(arguments, mesh, edit, ranks)
        if arguments.records:
            with open(arguments.records, "a", encoding="utf-8") as file:
                file.write(json.dumps(record) + "\n")
        print("| " + " | ".join(text_of(record[column]) for column in columns) + " |", flush=True)


if __name__ == "__main__":
    main()
