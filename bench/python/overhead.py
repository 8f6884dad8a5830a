#!/usr/bin/env python3
"""Measures what an evaluation into the caller's array costs over C++.

    overhead.py PROGRAM [RESOLUTION…]

PROGRAM: meshgraft_evaluate of the preset `bench`. Prints a Markdown table of medians in microseconds, on the sample "bar"
with both ends as handles and method ft05, on one thread. Each figure is the smallest median of five rounds, in which both sides take
turns.
"""

import statistics
import subprocess
import sys
import time

import numpy as np

import meshgraft as mg

ROUNDS = 5


def median_microseconds(count, call):
    times = []
    for _ in range(count):
        start = time.perf_counter_ns()
        call()
        times.append(time.perf_counter_ns() - start)
    return statistics.median(times) / 1000


def main(program, resolutions):
    print("| vertices | call | C++, µs | Python, µs | more, µs |\n|---|---|---|---|---|")
    for resolution in resolutions:
        count = max(21, 20_000 // resolution)
        bar = mg.sample("bar", resolution)
        z = bar.vertices[:, 2]
        deformer = mg.Deformer(bar, handles={"bottom": z < 0.3, "top": z > 3.7}, method="ft05")
        basis = deformer.handle_basis(normals=False)
        pose, out = mg.Pose(rotate=("y", 20), pivot=(0, 0, 3.7)), np.empty_like(bar.vertices)
        rounds = []
        for _ in range(ROUNDS):
            answer = subprocess.run([program, str(resolution), str(count)], capture_output=True, text=True, check=True)
            here = [median_microseconds(count, call) for call in (lambda: deformer.positions(top=pose, out=out, threads=1),
                                                                  lambda: basis.frame(top=pose, out=out, threads=1))]
            rounds.append([*map(float, answer.stdout.split()), *here])
        solve, frame, own_solve, own_frame = (min(column) for column in zip(*rounds))
        for name, there, own in (("Deformer.positions", solve, own_solve), ("HandleBasis.frame", frame, own_frame)):
            print(f"| {len(bar):,} | `{name}` | {there:.1f} | {own:.1f} | {own - there:.1f} |", flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    main(sys.argv[1], [int(word) for word in sys.argv[2:]] or [8, 40, 100])
