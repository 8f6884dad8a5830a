#!/usr/bin/env python3
"""Turn meshgraft_bench's JSON into markdown tables of medians and ratios.

    meshgraft_bench --benchmark_repetitions=5 --benchmark_out=times.json
    bench/report.py times.json                            # to the terminal
    bench/report.py times.json --into docs/performance.md # between the page's two markers
"""

import argparse
import json
import statistics
import sys
from collections import defaultdict

BEGIN = "<!-- tables: begin (made by bench/report.py) -->"
END = "<!-- tables: end -->"
STAGES = ["assemble", "analyse", "factorise"]
MERGE_STAGES = ["match", "assemble", "factorise", "solve", "seam"]


def read_medians(benchmarks):
    """{(system, variant, backend): {size: {counter: median over repetitions}}}"""
    runs = defaultdict(list)
    for entry in benchmarks:
        if entry.get("run_type", "iteration") != "iteration":
            continue
        if entry.get("error_occurred"):
            raise SystemExit(f"{entry['name']} failed: {entry.get('error_message', '')}")
        system, variant, backend, size = entry["name"].split("/")[:4]
        runs[system, variant, backend, int(size)].append(entry)
    medians = defaultdict(dict)
    for (system, variant, backend, size), entries in runs.items():
        numbers = {
            key: statistics.median(entry[key] for entry in entries)
            for key, value in entries[0].items()
            if isinstance(value, (int, float))
        }
        medians[system, variant, backend][size] = numbers
    return medians, max(map(len, runs.values()))


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---:|" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines)


def milliseconds(seconds):
    value = 1000 * seconds
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}"


def ratio(ours, theirs):
    value = ours / theirs
    return f"{value:.1f}×" if value >= 1 else f"{value:.2f}×"


def set_up(numbers):
    return sum(numbers[stage] for stage in STAGES)


def stage_table(by_size):
    rows = []
    for size, numbers in sorted(by_size.items()):
        rows.append(
            [f"{numbers['vertices']:,.0f}", f"{numbers['unknowns']:,.0f}", f"{numbers['factor_nonzeros'] / 1e6:.2f} M"]
            + [milliseconds(numbers[stage]) for stage in STAGES]
            + [milliseconds(set_up(numbers)), milliseconds(numbers["evaluate"])]
        )
    header = ["vertices", "unknowns", "factor non-zeros"] + STAGES + ["set-up", "evaluate"]
    return table(header, rows)


def comparison_table(ours, theirs):
    rows = []
    for size in sorted(ours.keys() & theirs.keys()):
        our, their = ours[size], theirs[size]
        their_set_up = their["construct"] + their["preprocess"]
        rows.append([
            f"{our['vertices']:,.0f}",
            milliseconds(set_up(our)),
            milliseconds(their_set_up),
            ratio(set_up(our), their_set_up),
            milliseconds(our["evaluate"]),
            milliseconds(their["deform"]),
            ratio(our["evaluate"], their["deform"]),
        ])
    header = ["vertices", "meshgraft set-up", "CGAL set-up", "ratio", "meshgraft evaluate", "CGAL deform", "ratio"]
    return table(header, rows)


def merge_table(runs):
    rows = []
    for (_, shape, pose), by_size in runs.items():
        for numbers in by_size.values():
            rows.append(
                [shape, pose, f"{numbers['target_vertices']:,.0f}", f"{numbers['source_vertices']:,.0f}"]
                + [milliseconds(numbers[stage]) for stage in MERGE_STAGES]
                + [milliseconds(sum(numbers[stage] for stage in MERGE_STAGES))]
            )
    return table(["shape", "pose", "target vertices", "source vertices"] + MERGE_STAGES + ["total"], rows)


def machine(context, repetitions):
    caches = ", ".join(f"L{c['level']} {c['type'].lower()} {c['size'] // 1024} KiB" for c in context["caches"])
    load, cores = context["load_avg"][0], context["num_cpus"]
    runs = f"medians of {repetitions} runs" if repetitions > 1 else "a single run"
    text = (f"Measured {context['date'][:10]} on {cores} cores at {context['mhz_per_cpu']} MHz ({caches}); "
            f"load average at the start {load:.1f}. Milliseconds, {runs}.")
    if load > cores / 2:
        text += " Other work was running: times are longer than on a quiet machine, and ratios rough."
    return text


def make_report(data):
    medians, repetitions = read_medians(data["benchmarks"])
    parts = [machine(data["context"], repetitions)]
    ours = {key: sizes for key, sizes in medians.items() if key[0] == "meshgraft"}
    for (_, treatment, backend), sizes in ours.items():
        parts += [f"### meshgraft, {treatment}, {backend}", stage_table(sizes)]
    for (_, method, _), sizes in ((key, sizes) for key, sizes in medians.items() if key[0] == "cgal"):
        for (_, treatment, backend), our_sizes in ours.items():
            if backend == "cholmod":
                parts += [f"### {treatment}, {backend} beside CGAL's {method}", comparison_table(our_sizes, sizes)]
    merges = {key: sizes for key, sizes in medians.items() if key[0] == "merge"}
    if merges:
        parts += ["### merging", merge_table(merges)]
    return "\n\n".join(parts)


def replace_between_markers(path, report):
    with open(path, encoding="utf-8") as page:
        text = page.read()
    if BEGIN not in text or END not in text:
        raise SystemExit(f"{path} lacks the markers '{BEGIN}' and '{END}'")
    head, tail = text.split(BEGIN)[0], text.split(END)[1]
    with open(path, "w", encoding="utf-8") as page:
        page.write(f"{head}{BEGIN}\n\n{report}\n\n{END}{tail}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("json", help="output of meshgraft_bench --benchmark_out=…")
    parser.add_argument("--into", metavar="PAGE", help="replace what stands between the page's markers")
    arguments = parser.parse_args()
    with open(arguments.json, encoding="utf-8") as file:
        report = make_report(json.load(file))
    if arguments.into:
        replace_between_markers(arguments.into, report)
    else:
        sys.stdout.write(report + "\n")


if __name__ == "__main__":
    main()
