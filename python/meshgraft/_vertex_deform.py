"""Deforming by constraints per vertex."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshgraft import _arrays, _core
from meshgraft._calls import Progress, calling
from meshgraft._deform import FloatArray, IndexArray, M, _Solver
from meshgraft._mesh import Mesh
from meshgraft._records import DeformerSummary, DeformKeywords

if sys.version_info >= (3, 11):
    from typing import Generic, Unpack
else:
    from typing import Generic

    from typing_extensions import Unpack


class VertexDeformer(Generic[M]):
    """Deforms a region of a mesh by constraints per vertex. Making one takes the time; evaluations are quick.

        d = mg.VertexDeformer(mesh, targets=vertices)          # positions of these vertices will be given
        moved = d.evaluate(mesh.vertices[vertices] + noise)

    `targets`: vertices whose positions are given. `transforms`: vertices whose local maps are given, 3x3, from rest; a
    vertex may be in both. The other arguments are those of `deform`. Several threads may evaluate at once. The mesh is
    solved as it is: unlike in `deform`, edges around sparse targets are not halved.
    """

    def __init__(self, mesh: M, region: Any = None, *, targets: ArrayLike = (), transforms: ArrayLike = (),
                 fixed: Any = None, anchors: Any = None, features: Sequence[Any] | None = None, weld: bool | None = None,
                 threads: int = 0, progress: Progress = None, **settings: Unpack[DeformKeywords]) -> None:
        self._adapted: Any
        self.target_vertices: IndexArray
        """the vertices of `targets`, in the order of their positions"""
        self.transform_vertices: IndexArray
        """the vertices of `transforms`, in the order of their maps"""

        def held(own: Mesh) -> dict[str, Any]:
            # At rest, so that they are checked against the region and what is fixed, as those of `deform` are.
            self.target_vertices = _distinct(targets, "targets", len(own))
            self.transform_vertices = _distinct(transforms, "transforms", len(own))
            return {"targets": {v: own.vertices[v] for v in self.target_vertices},
                    "transforms": {v: np.eye(3) for v in self.transform_vertices}}

        given = _Solver._set_up(cast(Any, self), mesh, region, {}, fixed, anchors, features, None, weld, settings, held)
        self._default = (threads, 0, None)
        with calling(threads, None, progress) as call:
            self._core = _core.make_vertex_deformer(given, self.target_vertices, self.transform_vertices, call)

    def evaluate(self, targets: ArrayLike | None = None, transforms: ArrayLike | None = None, *, threads: int = 0) -> M:
        """Returns the mesh for positions, (k, 3), and local maps, (m, 3, 3), in the order of the vertices; None: at rest.

        The result has the type of the mesh that was given; for a tuple (vertices, faces) it is the vertices.
        """
        positions = self.positions(targets, transforms, threads=threads)
        if isinstance(self._adapted.given, Mesh):
            return cast(M, self._core.moved(positions))
        return cast(M, self._adapted.at(positions))

    def positions(self, targets: ArrayLike | None = None, transforms: ArrayLike | None = None, *,
                  out: FloatArray | None = None, threads: int = 0) -> FloatArray:
        """Returns the positions alone, (n, 3). With `out`, an array of float64, writes them there and returns it."""
        into = None if out is None else _arrays.output(out, "out", len(self._adapted.mesh))
        return cast(FloatArray, self._core.evaluate(*self._values(targets, transforms), into, self._call(threads)))

    def positions_with_field(self, field: ArrayLike, targets: ArrayLike | None = None,
                             transforms: ArrayLike | None = None, *, threads: int = 0) -> FloatArray:
        """Returns positions, (n, 3), whose local maps change from vertex to vertex as `field` does, one map for each
        vertex of the mesh, (n, 3, 3), in place of the method's own field. One linear solve."""
        maps = _arrays.maps(field, "field", len(self._adapted.mesh))
        return cast(FloatArray, self._core.evaluate_with_field(*self._values(targets, transforms), maps,
                                                               self._call(threads)))

    def _values(self, targets: ArrayLike | None, transforms: ArrayLike | None) -> tuple[Any, Any]:
        return (None if targets is None else _arrays.points(targets, "targets", rows=len(self.target_vertices)),
                None if transforms is None else _arrays.maps(transforms, "transforms", len(self.transform_vertices)))

    def _call(self, threads: int) -> tuple[int, int, None]:
        return (threads, 0, None) if threads else self._default

    @property
    def free_vertices(self) -> IndexArray:
        """The vertices whose position is solved for, ascending."""
        return cast(IndexArray, self._core.free_vertices())

    @property
    def summary(self) -> DeformerSummary:
        """Seconds per stage and figures of the set-up."""
        return cast(DeformerSummary, self._core.summary())


def _distinct(vertices: ArrayLike, name: str, count: int) -> NDArray[np.int32]:
    given = _arrays.indices(vertices, name, count) if np.size(vertices) else np.zeros(0, np.int32)
    distinct, first = np.unique(given, return_index=True)
    if len(distinct) < len(given):
        again = int(np.setdiff1d(np.arange(len(given)), first)[0])
        raise ValueError(f"{name}[{again}]: vertex {given[again]} is there twice")
    return given
