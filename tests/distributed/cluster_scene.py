"""Meshes, edits and runs of the programs for the tests of meshgraft-mpi."""

import array
import json
import math
import os
import random
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

PROGRAM, MPI_PROGRAM, MPIRUN = sys.argv[1:4] if len(sys.argv) > 3 else ("", "", "")


class Mesh:
    """Vertices, triangles, and further properties of the vertices by their names."""

    def __init__(self):
        self.vertices, self.triangles, self.colours, self.normals = [], [], None, None

    def add_sheet(self, columns, rows, origin=(0.0, 0.0, 0.0), seed=1):
        """Adds a square sheet with bumps, irregular on purpose: jittered vertices, diagonals either way."""
        chance, first = random.Random(seed), len(self.vertices)
        for j in range(rows):
            for i in range(columns):
                x = (i + 0.3 * (chance.random() - 0.5)) / columns
                y = (j + 0.3 * (chance.random() - 0.5)) / columns
                z = 0.04 * math.sin(9 * x) * math.cos(7 * y)
                self.vertices.append((origin[0] + x, origin[1] + y, origin[2] + z))
        for j in range(rows - 1):
            for i in range(columns - 1):
                a = first + j * columns + i
                b, c, d = a + 1, a + columns, a + columns + 1
                self.triangles += [(a, b, d), (a, d, c)] if chance.random() < 0.5 else [(a, b, c), (b, d, c)]
        return range(first, len(self.vertices))

    def shuffle(self, seed=2):
        """Numbers vertices and triangles anew, so that neighbours are far apart in the file."""
        chance = random.Random(seed)
        order = list(range(len(self.vertices)))
        chance.shuffle(order)
        number = [0] * len(order)
        for new, old in enumerate(order):
            number[old] = new
        self.vertices = [self.vertices[old] for old in order]
        self.triangles = [tuple(number[v] for v in triangle) for triangle in self.triangles]
        chance.shuffle(self.triangles)
        return number

    def write(self, path, scalar="double"):
        """Writes a binary PLY file."""
        code = {"double": "d", "float": "f"}[scalar]
        names = ["x", "y", "z"] + (["nx", "ny", "nz"] if self.normals else [])
        lines = ["ply", "format binary_little_endian 1.0", "comment made for a test",
                 f"element vertex {len(self.vertices)}", *(f"property {scalar} {name}" for name in names)]
        if self.colours:
            lines += [f"property uchar {name}" for name in ("red", "green", "blue")]
        lines += [f"element face {len(self.triangles)}", "property list uchar int vertex_indices",
                  "property int label", "end_header"]
        body = bytearray(("\n".join(lines) + "\n").encode())
        for v, position in enumerate(self.vertices):
            body += struct.pack(f"<3{code}", *position)
            if self.normals:
                body += struct.pack(f"<3{code}", *self.normals[v])
            if self.colours:
                body += bytes(self.colours[v])
        for t, triangle in enumerate(self.triangles):
            body += struct.pack("<B3ii", 3, *triangle, t % 5)
        Path(path).write_bytes(body)


def assert_one_error(test, done, *words):
    """Checks that all ranks together print one error, which has these words."""
    messages = [line for line in done.stderr.splitlines() if "meshgraft-mpi: error:" in line]
    test.assertEqual(len(messages), 1, done.stderr)
    for word in words:
        test.assertIn(word, messages[0])


def convert(ranks, source, output, *arguments, **options):
    """Runs meshgraft-mpi convert."""
    return run(MPIRUN, "-q", "-n", ranks, "--oversubscribe", MPI_PROGRAM, "convert", source, "-o", output, *arguments, **options)


def write_chunks(folder, mesh, files=3, index_type="int64", label_type="uint64"):
    """Writes a mesh in chunks whose triangles have indices and labels of 64 bits. Returns the index."""
    codes = {"int64": "q", "uint64": "Q", "uint": "I", "int": "i"}

    def table(name, records, fields):
        parts = []
        for k in range(files):
            part = records[k * len(records) // files:(k + 1) * len(records) // files]
            (folder / f"{name}{k}").write_bytes(b"".join(part))
            parts.append({"file": f"{name}{k}", "count": len(part)})
        return {"count": len(records), "properties": [{"name": n, "type": t} for n, t in fields], "files": parts}

    folder.mkdir()
    pattern = f"<{codes[label_type]}3{codes[index_type]}"
    index = {"format": "meshgraft-chunks", "version": 1,
             "vertex": table("v", [struct.pack("<H3d", v % 999, *p) for v, p in enumerate(mesh.vertices)],
                             [("id", "ushort"), ("x", "double"), ("y", "double"), ("z", "double")]),
             "triangle": table("t", [struct.pack(pattern, t % 5, *corners) for t, corners in enumerate(mesh.triangles)],
                               [("label", label_type), ("vertex_indices", index_type)])}
    (folder / "mesh.json").write_text(json.dumps(index))
    return index


def read_chunks(folder):
    """Returns the bytes of the vertices' records and of the triangles' records, through all files."""
    index = json.loads((folder / "mesh.json").read_text())
    return [b"".join((folder / part["file"]).read_bytes() for part in index[table]["files"]) for table in ("vertex", "triangle")]


def read_ply(path):
    """Returns the bytes before the vertices, the vertices' records as bytes, the rest, and positions."""
    data = Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    size, count, code, of_vertex = 0, 0, "d", False
    for line in data[:end].decode().splitlines():
        words = line.split()
        if words[0] == "element":
            of_vertex = words[1] == "vertex"
            count = int(words[2]) if of_vertex else count
        elif words[0] == "property" and of_vertex:
            size += {"double": 8, "float": 4, "ushort": 2, "uchar": 1}[words[1]]
            if words[2] == "x":
                code = words[1][0]
    records = [data[end + k * size:end + (k + 1) * size] for k in range(count)]
    positions = [struct.unpack_from(f"<3{code}", record) for record in records]
    return data[:end], records, data[end + count * size:], positions


def largest_difference(a, b):
    """The largest difference of a coordinate, relative to the diagonal of the box of `a`."""
    low = [min(p[k] for p in a) for k in range(3)]
    high = [max(p[k] for p in a) for k in range(3)]
    return max(abs(p[k] - q[k]) for p, q in zip(a, b, strict=True) for k in range(3)) / math.dist(low, high)


def write_edit(path, mesh, **step):
    """Writes an edit file of one deform step, by the linear method if no other is given."""
    step.setdefault("settings", {"method": "ft05"})
    path.write_text(json.dumps({"format": "meshgraft-edit", "version": 2, "inputs": {"mesh": {"file": Path(mesh).name}},
                                "steps": [{"kind": "deform", "mesh": "mesh", **step}]}))
    return path


def run(*command, timeout=300, **options):
    environment = os.environ | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                                "OMPI_MCA_btl_vader_single_copy_mechanism": "none", "OMP_NUM_THREADS": "1"}
    return subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=timeout,
                          env=environment, **options)


def run_ranks(ranks, *arguments, mpi=(), **options):
    return run(MPIRUN, "-q", "-n", ranks, "--oversubscribe", *mpi, MPI_PROGRAM, "deform", *arguments, **options)


def kill_a_rank(edit, output):
    """Starts three ranks, kills one of them, and returns the exit status, which comes within 30 seconds."""
    environment = os.environ | {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    with subprocess.Popen([MPIRUN, "-q", "-n", "3", "--oversubscribe", MPI_PROGRAM, "deform", str(edit), "-o", str(output)],
                          stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=environment) as process:
        children, deadline = [], time.monotonic() + 30
        while len(children) < 3 and time.monotonic() < deadline:
            listed = subprocess.run(["ps", "-o", "pid=,comm=", "--ppid", str(process.pid)], capture_output=True, text=True)
            children = [line.split()[0] for line in listed.stdout.splitlines() if "meshgraft" in line]
            time.sleep(0.05)
        if len(children) < 3:
            process.kill()
            raise AssertionError("the ranks do not start")
        os.kill(int(children[1]), signal.SIGKILL)
        try:
            process.communicate(timeout=30)
        except subprocess.TimeoutExpired:
            process.kill()
            raise
        return process.returncode
