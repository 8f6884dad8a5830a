"""Descriptions of vertex sets, as edit files have them: by index, by geometry, by connectivity, and combined.

    head = mg.select.half_space((0, 0, 1.5), "z") & mg.select.sphere((0, 0, 2), 0.8)
    vertices = head(mesh)

Wherever a function takes vertices, it takes an array of indices, a mask with one flag per vertex, or a selection.
"""

from __future__ import annotations

import operator
from collections.abc import Iterable
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshgraft import _arrays, _core
from meshgraft._calls import DEFAULT

__all__ = ["Selection", "all", "box", "component", "half_space", "indices", "loop", "nearest", "path", "produced",
           "sphere"]


class Selection:
    """A description of a vertex set. `selection(mesh)` returns its vertices.

    `a & b`, `a | b` and `a - b` combine, `~a` has all other vertices.
    """

    __slots__ = ("_spec",)

    def __init__(self, spec: Any) -> None:
        self._spec = spec

    def __call__(self, mesh: Any) -> NDArray[np.int32]:
        """Returns the vertices on a mesh, ascending; those of indices, a loop or a path in their own order."""
        from meshgraft import _texts
        from meshgraft._adapters import adapt

        own = adapt(mesh).mesh
        edit = {"format": "meshgraft-edit", "version": 2, "inputs": {"mesh": {"file": "mesh"}},
                "selections": {"selection": self._spec}, "steps": [_NO_STEP]}
        return cast("NDArray[np.int32]",
                    _core.resolve_selection(own._core, _texts.given(edit, {}, name="select"), DEFAULT))

    def mask(self, mesh: Any) -> NDArray[np.bool_]:
        """Returns one flag per vertex of a mesh."""
        from meshgraft._adapters import adapt

        own = adapt(mesh).mesh
        flags = np.zeros(len(own), bool)
        flags[self(own)] = True
        return flags

    def __and__(self, other: Selection) -> Selection:
        return Selection({"intersect": [self._spec, _spec(other)]})

    def __or__(self, other: Selection) -> Selection:
        return Selection({"union": [self._spec, _spec(other)]})

    def __sub__(self, other: Selection) -> Selection:
        return Selection({"minus": [self._spec, _spec(other)]})

    def __invert__(self) -> Selection:
        return Selection({"minus": ["all", self._spec]})

    def grow(self, rings: int | None = None, *, length: float | None = None) -> Selection:
        """Adds so many rings of edges, or the vertices within a length along edges (model units)."""
        if (rings is None) == (length is None):
            raise ValueError("grow: give either rings or length")
        if length is not None:
            return Selection({"grow_length": {"of": self._spec, "length": float(length)}})
        return Selection({"grow": {"of": self._spec, "rings": rings}})

    def shrink(self, rings: int = 1) -> Selection:
        """Removes the vertices within so many edges of a vertex outside."""
        return Selection({"grow": {"of": self._spec, "rings": -rings}})

    def rim(self, rings: int = 1) -> Selection:
        """Returns its vertices within so many edges of a vertex outside."""
        return Selection({"rim": {"of": self._spec, "rings": rings}})

    def mirror(self, plane: Any, *, tolerance_rel: float = 1e-3) -> Selection:
        """Returns the vertices at the mirror images in a plane: (point, normal), or "x" for the plane x = 0.

        `tolerance_rel`: largest distance of a vertex from its image, x the diagonal of the bounding box.
        """
        return Selection({"mirror": {"of": self._spec, **_arrays.plane(plane, "plane"), "tolerance_rel": tolerance_rel}})

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Selection) and _plain(self._spec) == _plain(other._spec)

    def __hash__(self) -> int:
        return hash(repr(_plain(self._spec)))

    def __repr__(self) -> str:
        return f"<selection {_plain(self._spec)}>"


_NO_STEP = {"kind": "cut", "mesh": "mesh", "plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}


def _plain(spec: Any) -> Any:
    from meshgraft._texts import Writer

    return Writer(aside=False).plain(spec)


def _spec(value: object) -> Any:
    if not isinstance(value, Selection):
        raise TypeError(f"expected a selection, not {type(value).__name__}; meshgraft.select.indices makes one of an array")
    return value._spec


def all() -> Selection:  # noqa: A001
    """Every vertex."""
    return Selection("all")


def indices(vertices: ArrayLike) -> Selection:
    """These vertices, in their order, or those of a mask."""
    return Selection({"indices": _arrays.indices(vertices, "vertices", None)})


def sphere(centre: ArrayLike, radius: float) -> Selection:
    """Vertices within a radius of a point, model units."""
    return Selection({"sphere": {"centre": _arrays.vector(centre, "centre").tolist(), "radius": float(radius)}})


def box(low: ArrayLike, high: ArrayLike) -> Selection:
    """Vertices in an axis-parallel box."""
    return Selection({"box": {"min": _arrays.vector(low, "low").tolist(), "max": _arrays.vector(high, "high").tolist()}})


def half_space(point: ArrayLike, normal: ArrayLike | str) -> Selection:
    """Vertices on the side of a plane that its normal points to: "x", "y", "z" or three numbers."""
    return Selection({"half_space": {"point": _arrays.vector(point, "point").tolist(),
                                     "normal": _arrays.direction(normal, "normal").tolist()}})


def nearest(point: ArrayLike) -> Selection:
    """The vertex nearest to a point."""
    return Selection({"nearest": _arrays.vector(point, "point").tolist()})


def path(points: Iterable[ArrayLike], *, closed: bool = False) -> Selection:
    """Vertices of the shortest path along edges through those nearest to some points, in order."""
    return Selection({"path": {"points": [_arrays.vector(point, f"points[{i}]").tolist() for i, point in enumerate(points)],
                               "closed": closed}})


def loop(number: int = 0) -> Selection:
    """A boundary loop, in its order; mesh.boundary_loops() numbers them."""
    return Selection({"loop": operator.index(number)})


def component(number: int) -> Selection:
    """A connected component; mesh.components() numbers them."""
    return Selection({"component": operator.index(number)})


def produced(step: str, what: str) -> Selection:
    """In an edit: what a named step made, such as "loop" of a cut or "seam" of a merge."""
    return Selection({"produced": {"step": step, "what": what}})
