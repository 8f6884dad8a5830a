"""Grafting a mesh onto another."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshgraft import _arrays, _core, _texts
from meshgraft._adapters import adapt
from meshgraft._calls import Progress, calling
from meshgraft._deform import feature_spec
from meshgraft._docs_of import documented
from meshgraft._facts import Note
from meshgraft._records import (BaseReport, DeformKeywords, MergeIntersections, MergeOptions, MergePose, MergeReport,
                                MergeShape, SeamKeywords, StageSeconds)
from meshgraft._texts import Direction

if sys.version_info >= (3, 11):
    from typing import Unpack
else:
    from typing_extensions import Unpack

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.int32]
M = TypeVar("M")


class MergeKeywords(DeformKeywords, SeamKeywords, total=False):
    """Keywords of a merge: those of its solve and of its seam."""


@dataclass(frozen=True, kw_only=True, eq=False)
class MergeResult(Generic[M]):
    """A mesh grafted onto another."""

    mesh: M
    """the result, in the type of the target"""
    target_map: IndexArray
    """new index of each vertex of the target, or -1 where it was removed"""
    source_map: IndexArray
    """the same of the source"""
    new_faces: IndexArray
    """faces of the seams"""
    grafted: FloatArray
    """the source's positions after the solve, before the seam, (n, 3)"""
    posing: FloatArray
    """the source's pose before the merge, as the arguments define it, (4, 4)"""
    report: MergeReport
    options: MergeOptions
    """the options that were used"""
    intersections: MergeIntersections
    base: BaseReport | None
    """the plane that opened a closed source before it was dropped"""
    seconds: StageSeconds
    notes: tuple[Note, ...]


def _matches(value: Any, name: str) -> list[list[Any]]:
    """Reads pairs (target vertex, source vertex); edit files have them the other way round."""
    return [[_arrays.vertex(source, f"{name}[{i}][1]"), _arrays.vertex(target, f"{name}[{i}][0]")]
            for i, (target, source) in enumerate(_arrays.pairs(value, name, "(target vertex, source vertex)"))]


def merge_step(target: str, source: str, sizes: tuple[int | None, int | None], arguments: Mapping[str, Any]) -> dict[str, Any]:
    """Returns a merge step in the form of an edit file."""
    target_size, source_size = sizes
    a = {key: value for key, value in arguments.items() if value is not None}
    step: dict[str, Any] = {"kind": "merge", "target": target, "source": source}
    for key in ("pose", "shape", "normal_angle_deg", "smooth_boundary", "fix_winding", "retry", "size"):
        if key in a:
            step[key] = a[key]
    if "pairs" in a:
        step["pairs"] = [{"source_loop": _loop(source_loop, f"pairs[{i}][1]", source_size),
                          "target_loop": _loop(target_loop, f"pairs[{i}][0]", target_size)}
                         for i, (target_loop, source_loop)
                         in enumerate(_arrays.pairs(a["pairs"], "pairs", "(target loop, source loop)"))]
    for key in ("matches", "align"):
        if pairs := _matches(a.get(key, ()), key):
            step[key] = pairs
    if "mirror" in a:
        step["mirror"] = _arrays.plane(a["mirror"], "mirror")
    if "source_transform" in a:
        step["source_transform"] = _arrays.matrix(a["source_transform"], "source_transform", 4).tolist()
    if "fixed" in a:
        step["fixed"] = _texts.spec_of(a["fixed"], "fixed", source_size)
    if "reach_rings" in a or "reach_length" in a:
        step["reach"] = {key.removeprefix("reach_"): a[key] for key in ("reach_rings", "reach_length") if key in a}
    if "features" in a:
        step["features"] = [feature_spec(entry, f"features[{i}]", source_size) for i, entry in enumerate(a["features"])]
    if "at" in a:
        vertex = _arrays.vertex(a["at"], "at")
        step["at"] = {"vertex" if isinstance(vertex, int) else "point": vertex}
        if "spin_deg" in a:
            step["at"]["spin_deg"] = a["spin_deg"]
        if "source_loop" in a:
            step["at"]["source_loop"] = _loop(a["source_loop"], "source_loop", source_size)
        base = _texts.without_none(height=a.get("base_height"), tilt_deg=a.get("base_tilt_deg"))
        if "base_tilt_axis" in a:
            base["tilt_axis"] = _arrays.vector(a["base_tilt_axis"], "base_tilt_axis").tolist()
        if base:
            step["at"]["base"] = base
    if settings := _texts.without_none(**a.get("settings", {})):
        _texts.require_known(settings, MergeKeywords.__annotations__)
        step["settings"] = settings
    return step


def _loop(value: Any, name: str, vertices: int | None) -> Any:
    """Reads a boundary loop: its number, its vertices, or a selection."""
    if isinstance(value, (int, np.integer)) and not isinstance(value, bool):
        return {"loop": int(value)}
    return _texts.spec_of(value, name, vertices)


def _run(name: str, target: M, source: Any, arguments: Mapping[str, Any], *, strict: bool, threads: int,
         progress: Progress) -> MergeResult[M]:
    adapted = adapt(target, "target")
    own, part = adapted.mesh, adapt(source, "source").mesh
    step = merge_step("target", "source", (len(own), len(part)), arguments)
    orientations = {side: _texts.orientation_spec(arguments.get(f"{side}_orientation"), f"{side}_orientation")
                    for side in ("target", "source")}
    edit = _texts.given_step(step, {"target": own, "source": part}, name=name, orientations=orientations)
    options = {"estimate_condition": False, "strict": strict, "keep": [], "memory": None}
    with calling(threads, None, progress) as call:
        mesh, _, report, _ = _core.run_one_step(edit, options, call)
    done = report.steps[0]
    return MergeResult(
        mesh=adapted.like(mesh), target_map=done.merge.target_map, source_map=done.merge.source_map,
        new_faces=done.merge.new_faces, grafted=done.merge.grafted, posing=done.merge.posing, report=done.merge.report,
        options=done.merge.options, intersections=done.merge.intersections, base=done.merge.base,
        seconds=done.seconds, notes=done.notes)


@documented("merge_meshes")
def merge(target: M, source: Any, *, pairs: Sequence[tuple[Any, Any]] | None = None,
          matches: Sequence[tuple[Any, Any]] | None = None, pose: MergePose | None = None, shape: MergeShape | None = None,
          align: Sequence[tuple[Any, Any]] | None = None, mirror: Any = None, source_transform: ArrayLike | None = None,
          size: float | None = None, normal_angle_deg: float | None = None, fixed: Any = None,
          reach_rings: int | None = None, reach_length: float | None = None, features: Sequence[Any] | None = None,
          smooth_boundary: bool | None = None, fix_winding: bool | None = None, retry: bool | None = None,
          target_orientation: tuple[Direction, Direction] | None = None,
          source_orientation: tuple[Direction, Direction] | None = None, strict: bool = False, threads: int = 0,
          progress: Progress = None, **settings: Unpack[MergeKeywords]) -> MergeResult[M]:
    """Grafts `source` onto `target` across boundary loops, as `meshgraft merge` does.

    Without `pairs` and `matches`, the only loop of each mesh meets. `pairs`: (target loop, source loop), each a number, its
    vertices or a selection. `matches`: (target vertex, source vertex), each an index or a point. `mirror`: a plane that
    the source is mirrored in first; `source_transform`: a 4x4 matrix, or `align`: three or more matches, poses it.
    `features`: vertex sets of the source that keep their shape, or pairs (vertices, "affine"). `reach_rings`,
    `reach_length`: how far from its loops the source may deform. `strict`: raise an error where the result intersects itself.
    `retry=False`: keep the first graft, also with faults at its seam. `blend_colours`: a length from the seam within which
    vertex colours mix. `target_orientation`, `source_orientation`: (up, front) of a model, such as ("z", "-y"), for a
    start that is found; guessed without it. `result.report.pairs[0].starts` are the most probable starts.
    """
    arguments = dict(pairs=pairs, matches=matches, pose=pose, shape=shape, align=align, mirror=mirror,
                     source_transform=source_transform, size=size, normal_angle_deg=normal_angle_deg, fixed=fixed,
                     reach_rings=reach_rings, reach_length=reach_length, features=features, smooth_boundary=smooth_boundary,
                     fix_winding=fix_winding, retry=retry, target_orientation=target_orientation,
                     source_orientation=source_orientation, settings=settings)
    return _run("merge", target, source, arguments, strict=strict, threads=threads, progress=progress)


@documented("drop_source")
def drop(target: M, source: Any, at: Any, *, spin_deg: float | None = None, source_loop: Any = None,
         base_height: float | None = None, base_tilt_deg: float | None = None, base_tilt_axis: Any = None,
         shape: MergeShape | None = None, align: Sequence[tuple[Any, Any]] | None = None, mirror: Any = None,
         source_transform: ArrayLike | None = None, size: float | None = None, normal_angle_deg: float | None = None,
         reach_rings: int | None = None, reach_length: float | None = None, features: Sequence[Any] | None = None,
         smooth_boundary: bool | None = None, fix_winding: bool | None = None, retry: bool | None = None,
         strict: bool = False, threads: int = 0, progress: Progress = None, **settings: Unpack[MergeKeywords]) -> MergeResult[M]:
    """Grafts `source` onto a surface without a hole: `at` a vertex, or at the point of the surface nearest to a point.

    `spin_deg`: rotation about the surface's normal. `source_loop`: the loop of the source, if it has several. A
    closed source is opened at its base, by a plane that `base_height`, `base_tilt_deg` and `base_tilt_axis` move; the
    result's `base` names it. Other arguments as for `merge`.
    """
    arguments = dict(at=at, spin_deg=spin_deg, source_loop=source_loop, base_height=base_height,
                     base_tilt_deg=base_tilt_deg, base_tilt_axis=base_tilt_axis, shape=shape, align=align, mirror=mirror,
                     source_transform=source_transform, size=size, normal_angle_deg=normal_angle_deg,
                     reach_rings=reach_rings, reach_length=reach_length, features=features, smooth_boundary=smooth_boundary,
                     fix_winding=fix_winding, retry=retry, settings=settings)
    return _run("drop", target, source, arguments, strict=strict, threads=threads, progress=progress)
