"""Checking, repairing and cutting meshes."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshgraft import _arrays, _core
from meshgraft._adapters import adapt, vertices_of
from meshgraft._calls import Progress, calling
from meshgraft._docs_of import documented
from meshgraft._records import CutKeywords, CutResult, Diagnostics, Quality, RepairKeywords, RepairResult
from meshgraft._texts import without_none
from meshgraft.select import Selection

if sys.version_info >= (3, 11):
    from typing import Unpack
else:
    from typing_extensions import Unpack

IndexArray = NDArray[np.int32]


@documented("check_mesh")
def check(mesh: Any, *, threads: int = 0, progress: Progress = None) -> Diagnostics:
    """Names the defects of a mesh that affect an edit."""
    own = adapt(mesh, allow_defects=True).mesh
    with calling(threads, None, progress) as call:
        return cast(Diagnostics, _core.check(own._core, call))


@documented("repair")
def repair(mesh: Any, *, threads: int = 0, progress: Progress = None, **options: Unpack[RepairKeywords]) -> RepairResult:
    """Repairs a mesh so that every function accepts it. `result.mesh` has the type of the mesh that was given."""
    adapted = adapt(mesh, allow_defects=True)
    with calling(threads, None, progress) as call:
        result = cast(RepairResult, _core.repair(adapted.mesh._core, dict(options), call))
    if not result.changes:
        return replace(result, mesh=mesh)
    return replace(result, mesh=adapted.like(result.mesh))


def cut_options(options: CutKeywords) -> dict[str, Any]:
    """Returns the options of a cut that are given. An option of the pins asks for pins."""
    given = without_none(**options)
    of_pins = [key for key in given if key.startswith("pin_")]
    if of_pins and given.setdefault("cap", "pins") != "pins":
        raise ValueError(f"cut: {of_pins[0]} asks for pins, so it goes with cap='pins', not {given['cap']!r}")
    return given


@documented("cut_by_plane")
def cut(mesh: Any, *, plane: Any = None, loop: Any = None, values: ArrayLike | None = None, threads: int = 0,
        progress: Progress = None, **options: Unpack[CutKeywords]) -> CutResult:
    """Cuts a mesh open by one of these; `result.mesh` has the type of the mesh that was given.

    `plane`: (point, normal), whose normal points above, or "z" for the plane z = 0. `loop`: vertices that a closed curve
    runs through on the surface; above is on its left. `values`: one number per vertex; the cut is where they are zero.
    """
    if (plane is not None) + (loop is not None) + (values is not None) != 1:
        raise ValueError("cut: give one of plane, loop and values")
    given = cut_options(options)
    adapted = adapt(mesh)
    own = adapted.mesh
    with calling(threads, None, progress) as call:
        if plane is not None:
            spec = _arrays.plane(plane, "plane")
            result = _core.cut_by_plane(own._core, np.array(spec["point"]), np.array(spec["normal"]), given, call)
        elif loop is not None:
            vertices = loop(own) if isinstance(loop, Selection) else _arrays.indices(loop, "loop", len(own))
            result = _core.cut_along_loop(own._core, vertices, given, call)
        else:
            numbers = _arrays.numbers(cast(ArrayLike, values), "values", count=len(own))
            result = _core.cut_at_zero(own._core, numbers, given, call)
    return replace(cast(CutResult, result), mesh=adapted.like(result.mesh))


@documented("measure_quality")
def quality(rest: Any, edited: Any, *, free: Any = None, self_intersections: bool = True, threads: int = 0,
            progress: Progress = None) -> Quality:
    """Compares a mesh with an edited state of it: a mesh of any kind, or positions (n, 3).

    `free`: the vertices that the edit could move; by default those that moved.
    """
    own = adapt(rest, "rest").mesh
    triangles = own if own.is_triangular else own.triangulated()
    positions = np.ascontiguousarray(vertices_of(edited, "edited", len(own)))
    if free is None:
        vertices = np.flatnonzero((positions != own.vertices).any(axis=1)).astype(np.int32)
    else:
        vertices = free(own) if callable(free) else _arrays.indices(free, "free", len(own))
    with calling(threads, None, progress) as call:
        return cast(Quality, _core.quality(own.vertices, positions, triangles.faces, vertices, self_intersections, call))


@documented("self_intersections")
def self_intersections(mesh: Any, *, free: Any = None, rest: Any = None, threads: int = 0,
                       progress: Progress = None) -> IndexArray:
    """Returns the pairs of triangles that intersect, (k, 2). `free`: only pairs that touch one of these vertices.
    `rest`: only pairs that do not intersect in this other state, a mesh of any kind or positions (n, 3)."""
    own = adapt(mesh).mesh
    triangles = own if own.is_triangular else own.triangulated()
    if free is None:
        vertices = np.arange(len(own), dtype=np.int32)
    else:
        vertices = free(own) if callable(free) else _arrays.indices(free, "free", len(own))
    with calling(threads, None, progress) as call:
        pairs = cast(IndexArray, _core.self_intersections(own.vertices, triangles.faces, vertices, call))
        if rest is None or not len(pairs):
            return pairs
        before = np.ascontiguousarray(vertices_of(rest, "rest", len(own)))
        old = _core.self_intersections(before, triangles.faces, vertices, call)
    found, known = (each[:, 0].astype(np.int64) * len(triangles.faces) + each[:, 1] for each in (pairs, old))
    return pairs[~np.isin(found, known)]
