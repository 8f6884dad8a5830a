#!/usr/bin/env python3
"""Turn meshgraft_bench's JSON into markdown tables of medians and ratios, and plots.

    meshgraft_bench --benchmark_repetitions=5 --benchmark_out=times.json
    bench/report.py times.json                            # to the terminal
    bench/report.py times.json --into docs/performance.md # between the page's two markers; plots beside it
"""

import argparse
import json
import math
import statistics
import sys
from collections import defaultdict
from pathlib import Path

from plot import log_log_plot, stacked_bars

BEGIN = "<!-- tables: begin (made by bench/report.py) -->"
END = "<!-- tables: end -->"
STAGES = ["assemble", "analyse", "factorise"]
REGION_PARTS = ["prepare", "normal", "analyse", "factorise"]
MERGE_STAGES = ["match", "assemble", "factorise", "solve", "seam"]


SHEET = "sheet"


def mesh_of(entry):
    """Return the mesh of a benchmark: the fifth part of its name, or the sheet."""
    parts = entry["name"].split("/")
    return parts[4] if len(parts) > 4 and ":" not in parts[4] and parts[4] != "manual_time" else SHEET


def read_medians(benchmarks, mesh=SHEET):
    """Return {(system, variant, backend): {size: {counter: median}}} of a mesh, and the number of repetitions."""
    runs = defaultdict(list)
    for entry in benchmarks:
        if entry.get("run_type", "iteration") != "iteration":
            continue
        if mesh_of(entry) != mesh:
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
    return medians, max(map(len, runs.values()), default=0)


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---:|" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines)


def milliseconds(seconds):
    value = 1000 * seconds
    return f"{value:.0f}" if value >= 100 else f"{value:.1f}"


def ratio(ours, theirs):
    value = ours / theirs
    return f"{value:.2f}×" if value < 10 else f"{value:.1f}×"


def set_up(numbers):
    return sum(numbers[stage] for stage in STAGES)


def stage_table(by_size, dgemm):
    rows = []
    for size, numbers in sorted(by_size.items()):
        rate = numbers["factor_flops"] / numbers["factorise"]
        rows.append(
            [f"{numbers['vertices']:,.0f}", f"{numbers['unknowns']:,.0f}", f"{numbers['factor_nonzeros'] / 1e6:.2f} M"]
            + [milliseconds(numbers[stage]) for stage in STAGES]
            + [milliseconds(set_up(numbers)), milliseconds(numbers["evaluate"])]
            + [(f"{rate / 1e9:.0f}" + (f" ({100 * rate / dgemm:.0f} %)" if dgemm else "")) if rate else "–"]
            + [f"{numbers['peak_bytes'] / 1e6:,.0f}"]
        )
    header = ["vertices", "unknowns", "factor non-zeros"] + STAGES + ["set-up", "evaluate", "GFlop/s", "MB"]
    return table(header, rows)


def frame_table(runs):
    rows = []
    for (_, kind, variant), by_size in runs.items():
        for numbers in by_size.values():
            rows.append([
                kind.replace("-1", ", one handle").replace("-8", ", 8 handles"),
                variant,
                f"{numbers['vertices']:,.0f}",
                milliseconds(numbers["set_up"]),
                milliseconds(numbers["basis"]) if "basis" in numbers else "–",
                milliseconds(numbers["frame"]),
                f"{numbers['error']:.1e}" if numbers["error"] else "–",
                f"{numbers['peak_bytes'] / 1e6:,.0f}",
            ])
    return table(["frames", "variant", "vertices", "set-up", "basis", "frame", "error", "MB"], rows)


def live_table(runs):
    rows = []
    for (_, method, _), by_size in runs.items():
        for numbers in by_size.values():
            exact = numbers["first"] + numbers["exact"]
            rows.append([method, f"{numbers['vertices']:,.0f}"] + [milliseconds(seconds) for seconds in (
                numbers["first"], exact, exact + numbers["made"], numbers["quick"])])
    return table(["method", "vertices", "first frame", "exact", "all made", "a frame then"], rows)


def region_table(runs):
    rows = []
    for (_, method, _), by_size in runs.items():
        for numbers in by_size.values():
            for way, prefix in (("from nothing", "fresh_"), ("shared", "")):
                parts = [numbers[prefix + part] for part in REGION_PARTS]
                rows.append([method, f"{numbers['vertices']:,.0f}", way]
                            + [milliseconds(part) for part in parts] + [milliseconds(sum(parts))])
    return table(["method", "vertices", "set-up", "prepare", "AᵀA", "analyse", "factorise", "total"], rows)


def ordering_table(runs):
    rows = []
    for (_, treatment, _), by_size in runs.items():
        for numbers in by_size.values():
            rows.append([
                treatment,
                f"{numbers['vertices']:,.0f}",
                milliseconds(numbers["metis_analyse"]),
                f"{numbers['metis_factor_nonzeros'] / 1e6:.1f} M",
                f"{numbers['metis_flops'] / 1e9:.1f}",
                milliseconds(numbers["analyse"]),
                f"{numbers['factor_nonzeros'] / 1e6:.1f} M",
                f"{numbers['factor_flops'] / 1e9:.1f}",
                ratio(numbers["analyse"], numbers["metis_analyse"]),
                ratio(numbers["factor_flops"], numbers["metis_flops"]),
            ])
    return table(["treatment", "vertices", "METIS", "non-zeros", "GFlop", "dissection", "non-zeros", "GFlop", "time",
                  "flops"], rows)


def growth(by_size):
    """Return a sentence on the exponent of the set-up's growth from 50,000 vertices to the largest size."""
    sizes = sorted(size for size in by_size if size >= 50_000)
    if len(sizes) < 2:
        return ""
    low, high = by_size[sizes[0]], by_size[sizes[-1]]
    exponent = math.log(set_up(high) / set_up(low)) / math.log(high["vertices"] / low["vertices"])
    return f"Set-up grows with the {exponent:.2f}th power of the size between {sizes[0]:,} and {sizes[-1]:,}."


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


def mesh_table(benchmarks):
    """Return the set-ups and evaluations on all meshes but the sheet, beside CGAL's."""
    rows = []
    for mesh in dict.fromkeys(map(mesh_of, benchmarks)):
        if mesh == SHEET:
            continue
        medians, _ = read_medians(benchmarks, mesh)
        theirs = medians.get(("cgal", "SRE_ARAP", "default"), {})
        for (system, variant, _), by_size in medians.items():
            if system != "meshgraft":
                continue
            for size, our in sorted(by_size.items()):
                their = theirs.get(size)
                their_set_up = their["construct"] + their["preprocess"] if their else None
                rows.append([
                    mesh, f"{our['vertices']:,.0f}", variant, milliseconds(set_up(our)),
                    milliseconds(their_set_up) if their else "–",
                    ratio(set_up(our), their_set_up) if their else "–",
                    milliseconds(our["evaluate"]),
                    milliseconds(their["deform"]) if their else "–",
                    ratio(our["evaluate"], their["deform"]) if their else "–",
                    f"{our.get('steps', 0):.0f}",
                ])
    if not rows:
        return ""
    return table(["mesh", "vertices", "method", "set-up", "CGAL set-up", "ratio", "evaluate", "CGAL deform", "ratio",
                  "steps"], rows)


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
    parts = [machine(data["context"], repetitions or 1)]
    rates = {key[1]: next(iter(sizes.values())) for key, sizes in medians.items() if key[0] == "machine"}
    dgemm = rates["dgemm"]["all_cores"] if "dgemm" in rates else None
    if rates:
        parts.append(" ".join(
            f"{name}: {numbers['one_core'] / 1e9:.0f} {unit} on one core, {numbers['all_cores'] / 1e9:.0f} on all."
            for name, unit in (("dgemm", "GFlop/s"), ("triad", "GB/s")) if (numbers := rates.get(name))))
    ours = {key: sizes for key, sizes in medians.items() if key[0] == "meshgraft"}
    for (_, treatment, backend), sizes in ours.items():
        parts += [f"### meshgraft, {treatment}, {backend}", stage_table(sizes, dgemm), growth(sizes)]
    frames = {key: sizes for key, sizes in medians.items() if key[0] == "frames"}
    if frames:
        parts += ["### frames", frame_table(frames)]
    live = {key: sizes for key, sizes in medians.items() if key[0] == "live"}
    if live:
        parts += ["### dragging at once", live_table(live)]
    regions = {key: sizes for key, sizes in medians.items() if key[0] == "region"}
    if regions:
        parts += ["### adding a handle", region_table(regions)]
    orderings = {key: sizes for key, sizes in medians.items() if key[0] == "ordering"}
    if orderings:
        parts += ["### orderings, measured", ordering_table(orderings)]
    for (_, method, _), sizes in ((key, sizes) for key, sizes in medians.items() if key[0] == "cgal"):
        for (_, treatment, backend), our_sizes in ours.items():
            if backend == "multifrontal":
                parts += [f"### {treatment}, {backend} beside CGAL's {method}", comparison_table(our_sizes, sizes)]
    others = mesh_table(data["benchmarks"])
    if others:
        parts += ["### other meshes", others]
    merges = {key: sizes for key, sizes in medians.items() if key[0] == "merge"}
    if merges:
        parts += ["### merging", merge_table(merges)]
    return "\n\n".join(part for part in parts if part)


def draw_plots(data, folder):
    """Plot time and memory over size beside CGAL's, and the stages of the set-ups."""
    medians, _ = read_medians(data["benchmarks"])
    chosen = {
        "apex": ("meshgraft", "apex", "multifrontal"),
        "ft05-noise": ("meshgraft", "ft05-noise", "multifrontal"),
        "default (corotational)": ("meshgraft", "corotational", "default"),
        "CGAL SRE_ARAP": ("cgal", "SRE_ARAP", "default"),
    }
    runs = {name: medians[key] for name, key in chosen.items() if key in medians}

    def curve(value):
        return {name: [(n["vertices"], value(n)) for _, n in sorted(sizes.items())] for name, sizes in runs.items()}

    def all_of_set_up(n):
        return n["construct"] + n["preprocess"] if "construct" in n else set_up(n)

    frames = {
        "frame of the default": ("frames", "reduced", "corotational"),
        "linear frame": ("frames", "linear-1", "apex"),
    }
    frame_curves = {name: [(n["vertices"], n["frame"]) for _, n in sorted(medians[key].items())]
                    for name, key in frames.items() if key in medians}

    folder.mkdir(parents=True, exist_ok=True)
    plots = {
        "set_up": log_log_plot("Set-up", "vertices", "seconds", curve(all_of_set_up)),
        "evaluate": log_log_plot("One new pose (CGAL: 10 iterations)", "vertices", "seconds",
                                 curve(lambda n: n.get("evaluate", n.get("deform"))) | frame_curves),
        "memory": log_log_plot("Memory beside the mesh", "vertices", "bytes", curve(lambda n: n["peak_bytes"])),
    }
    bars = []
    for name, sizes in runs.items():
        if name.startswith("CGAL"):
            continue
        size, numbers = max(sizes.items())
        bars.append((f"{name}, {size:,}", [(stage, numbers[stage]) for stage in STAGES]))
    plots["stages"] = stacked_bars("Where a set-up's time goes", "seconds", bars)
    for name, svg in plots.items():
        (folder / f"{name}.svg").write_text(svg, encoding="utf-8")


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
        data = json.load(file)
    report = make_report(data)
    if arguments.into:
        replace_between_markers(arguments.into, report)
        draw_plots(data, Path(arguments.into).parent / "performance")
    else:
        sys.stdout.write(report + "\n")


if __name__ == "__main__":
    main()
