#!/usr/bin/env python3
"""Plans a run of meshgraft-mpi: memory, minutes and cost, from measured work and assumed machines.

    cluster_plan.py VERTICES MACHINES [--memory-bandwidth GB/S] [--latency MICROSECONDS] …

docs/scale.md tells the model in full and compares it with measurements. The work is that of a linear solve (method ft05,
tolerance 1e-8); bench/cluster_scale.py measures it.
"""

import argparse
import dataclasses
import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Work:
    """Work of an edit, as measured. Per vertex if not told otherwise; seconds are those of one core."""
    bytes: float = 4613  # of memory, at the peak
    assemble: float = 4.3e-6  # seconds
    divide: float = 2.2e-6  # seconds
    set_up: float = 1.75e-5  # seconds
    iterations: float = 40  # of the run, all solves together
    fine_traffic: float = 7693  # bytes of memory traffic per iteration, on the fine grid
    cycle_traffic: float = 2488  # bytes of memory traffic per cycle of GAMG on all three columns
    cycles: float = 16  # of GAMG per iteration and column; not more are done
    efficiency: float = 0.85  # of the triad's speed that the solve reaches
    messages: float = 4826  # per rank and iteration, at measured_ranks with measured_cycles
    message_bytes: float = 2.61e6  # likewise, with measured_part vertices per rank
    reductions: float = 52.2  # per iteration, with measured_cycles
    measured_ranks: int = 64
    measured_cycles: float = 8.6
    measured_part: int = 4096
    file_bytes: float = 50  # of a file of positions in double precision and triangles
    unknowns: float = 1.9  # x, y and z of an unknown are one
    entries: float = 82  # of the matrix
    wide: float = 1.13  # memory with indices of 64 bits, relative to 32


@dataclass(frozen=True)
class Machine:
    """A machine of the cluster, and its network. These are assumptions; put in your own."""
    ranks: int = 64
    memory: float = 256e9  # bytes
    memory_bandwidth: float = 300e9  # bytes per second, by the STREAM triad on all cores
    core_speed: float = 1.0  # relative to the core on which seconds were measured
    latency: float = 2e-6  # seconds for a message between machines
    network_bandwidth: float = 12.5e9  # bytes per second of one machine
    file_bandwidth: float = 2e9  # bytes per second of the file system, for all machines together
    price: float = 3.0  # per hour


MOST_INDEX = 2**31 - 1
COLUMNS = 3  # x, y and z, which PETSc numbers together
FACES = 2  # per vertex
NEIGHBOURS = 6  # of a vertex, which PT-Scotch numbers together


@dataclass(frozen=True)
class Plan:
    ranks: int
    part: float  # vertices per rank
    memory: float  # bytes per machine
    seconds: dict  # stage → seconds

    @property
    def total(self):
        return sum(self.seconds.values())


def most_narrow(work):
    """Returns the number of vertices that indices of 32 bits suffice for."""
    return math.floor(MOST_INDEX / max(COLUMNS * work.unknowns, NEIGHBOURS))


def plan(vertices, machines, machine=Machine(), work=Work()):
    """Returns the plan of a run on a number of machines."""
    ranks = machines * machine.ranks
    part, of_machine = vertices / ranks, vertices / machines
    traffic = work.fine_traffic + work.cycles * work.cycle_traffic
    # Messages grow with the number of levels of GAMG, which grows as the logarithm of the number of ranks. Halos grow as
    # the border of a part.
    levels = math.log2(ranks) / math.log2(work.measured_ranks) if ranks > 1 else 0
    halo = math.sqrt(part / work.measured_part) if ranks > 1 else 0
    sent = work.iterations * work.cycles / work.measured_cycles
    seconds = {
        "file": 2 * vertices * work.file_bytes / machine.file_bandwidth,
        "assemble": part * work.assemble / machine.core_speed,
        "divide": part * work.divide / machine.core_speed,
        "set-up": part * work.set_up / machine.core_speed,
        "solve: memory": work.iterations * of_machine * traffic / (work.efficiency * machine.memory_bandwidth),
        "solve: latency": sent * machine.latency
                          * (work.messages * levels + work.reductions * math.ceil(math.log2(ranks))),
        "solve: bytes sent": sent * work.message_bytes * halo * levels * machine.ranks / machine.network_bandwidth,
    }
    bytes_per_vertex = work.bytes * (work.wide if vertices > most_narrow(work) else 1)
    return Plan(ranks, part, of_machine * bytes_per_vertex, seconds)


def cost(found, machines, machine):
    return found.total / 3600 * machines * machine.price


def most_vertices(machine, work=Work(), share=0.5):
    """Returns the number of vertices that a share of a machine's memory holds."""
    return share * machine.memory / work.bytes


def limits(ranks, work=Work()):
    """Returns what breaks, each with the number of vertices of the whole mesh that still works, the smallest first."""
    return sorted([
        (most_narrow(work), "the unknowns need a PETSc and a PT-Scotch of 64-bit indices: the preset petsc64"),
        (math.floor(MOST_INDEX / work.entries * ranks), "the matrix of one rank has too many entries for PETSc's 32-bit "
                                                        "indices: more ranks are needed"),
        (MOST_INDEX // FACES, "a PLY file cannot have so many faces: the mesh has to be in chunks"),
        (MOST_INDEX, "an edit numbers its vertices by 32 bits: the mesh is refused"),
    ])


def broken(vertices, ranks, work=Work()):
    """Returns a sentence for everything that breaks at a number of vertices."""
    return [f"Beyond {most:,} vertices {what}." for most, what in limits(ranks, work) if vertices > most]


def rows_of(found, machines, machine):
    return [("ranks", f"{found.ranks:,}"), ("vertices per rank", f"{found.part:,.0f}"),
            ("memory per machine, GB", f"{found.memory / 1e9:,.0f}"),
            *((f"{stage}, s", f"{seconds:,.1f}") for stage, seconds in found.seconds.items()),
            ("minutes", f"{found.total / 60:,.1f}"), ("cost", f"{cost(found, machines, machine):,.2f}")]


def number(least, kind=float):
    """Returns a parser of finite numbers: above `least`, or from it on if they are whole."""
    def parse(text):
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value) or value < least or (kind is float and value == least):
            wanted = f"a whole number from {least} on" if kind is int else f"a number above {least}"
            raise argparse.ArgumentTypeError(f"'{text}' is not {wanted}")
        return value
    return parse


# Names of the options' units, and their sizes in those of the fields.
UNITS = {"memory": ("GB", 1e9), "memory_bandwidth": ("GB/s", 1e9), "network_bandwidth": ("GB/s", 1e9),
         "file_bandwidth": ("GB/s", 1e9), "latency": ("microseconds", 1e-6), "price": ("per hour", 1),
         "bytes": ("bytes", 1), "assemble": ("seconds", 1), "divide": ("seconds", 1), "set_up": ("seconds", 1),
         "fine_traffic": ("bytes", 1), "cycle_traffic": ("bytes", 1), "message_bytes": ("bytes", 1),
         "measured_part": ("vertices", 1), "file_bytes": ("bytes", 1)}


def unit_of(field):
    return UNITS.get(field.name, ("", 1))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("vertices", type=number(0))
    parser.add_argument("machines", type=number(1, int))
    for kind in (Machine, Work):
        for field in dataclasses.fields(kind):
            name, unit = unit_of(field)
            least = 2 if field.name == "measured_ranks" else 1
            parser.add_argument("--" + ("work-" if kind is Work else "") + field.name.replace("_", "-"),
                                type=number(least, int) if field.type is int else number(0),
                                default=field.default / unit if unit != 1 else field.default,
                                help=f"{name} ({field.default / unit:g})".strip())
    given = vars(parser.parse_args())
    machine = Machine(**{field.name: field.type(given[field.name] * unit_of(field)[1])
                         for field in dataclasses.fields(Machine)})
    work = Work(**{field.name: field.type(given["work_" + field.name]) for field in dataclasses.fields(Work)})
    found = plan(given["vertices"], given["machines"], machine, work)
    for name, value in rows_of(found, given["machines"], machine):
        print(f"| {name} | {value} |")
    if found.memory > machine.memory:
        most = most_vertices(machine, work, 1)
        print(f"It does not fit: a machine holds {most:,.0f} vertices, so that {math.ceil(given['vertices'] / most):,} "
              "machines would do.")
    for sentence in broken(given["vertices"], found.ranks, work):
        print(sentence)


if __name__ == "__main__":
    main()
