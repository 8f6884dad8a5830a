"""Deforming a mesh by handles."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Generic, Literal, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshgraft import _arrays, _core, _texts
from meshgraft._adapters import adapt
from meshgraft._calls import DEFAULT, CallArguments, Progress, calling
from meshgraft._docs_of import documented
from meshgraft._facts import Note, NoteWarning
from meshgraft._mesh import Mesh
from meshgraft._pose import handle_specs, pose_of, require_known
from meshgraft._records import (DeformerSummary, DeformKeywords, EvaluationReport, HandleBuffers, ProxySummary,
                                ReducedFramesKeywords)

if sys.version_info >= (3, 11):
    from typing import Unpack
else:
    from typing_extensions import Unpack

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.int32]
M = TypeVar("M")


def deform_step(mesh: str, vertices: int | None, *, region: Any = None, fixed: Any = None,
                handles: Mapping[str, Any] | None = None, poses: Mapping[str, Any] | None = None,
                targets: Mapping[int, ArrayLike] | None = None, transforms: Mapping[int, ArrayLike] | None = None,
                anchors: Any = None, features: Sequence[Any] | None = None, symmetry: Any = None,
                settings: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Returns a deform step in the form of an edit file."""
    step: dict[str, Any] = {"kind": "deform", "mesh": mesh, "handles": handle_specs(handles, vertices, poses)}
    if region is not None:
        step["region"] = _texts.spec_of(region, "region", vertices)
    if fixed is not None:
        step["fixed"] = _texts.spec_of(fixed, "fixed", vertices)
    if targets is not None and len(targets):
        step["targets"] = [{"vertex": vertex, "position": _arrays.vector(position, f"targets[{vertex}]").tolist()}
                           for vertex, position in _by_vertex(targets, "targets")]
    if transforms is not None and len(transforms):
        step["transforms"] = [{"vertex": vertex, "matrix": _arrays.matrix(matrix, f"transforms[{vertex}]", 3).tolist()}
                              for vertex, matrix in _by_vertex(transforms, "transforms")]
    if anchors is not None:
        step["anchors"] = [_anchor(entry, f"anchors[{i}]", vertices)
                           for i, entry in enumerate(anchors if isinstance(anchors, list) else [anchors])]
    if features is not None:
        step["features"] = [feature_spec(entry, f"features[{i}]", vertices)
                            for i, entry in enumerate(features if isinstance(features, list) else [features])]
    if symmetry is not None:
        step["symmetry"] = symmetry_spec(symmetry)
    settings = _texts.without_none(**(settings or {}))
    if settings:
        known = {*DeformKeywords.__annotations__, "proxy", "refine_boundary", "weld"}
        _texts.require_known(settings, known)
        step["settings"] = dict(settings)
    return step


def _by_vertex(values: Mapping[int, Any], name: str) -> list[tuple[int, Any]]:
    """Reads values by vertex."""
    if not isinstance(values, Mapping):
        raise TypeError(f"{name}: expected a dict of vertices and values, not {type(values).__name__}")
    for vertex in values:
        if not isinstance(vertex, (int, np.integer)):
            raise TypeError(f"{name}: expected whole numbers as vertices, not {vertex!r}")
    return [(int(vertex), value) for vertex, value in values.items()]


def _number(value: Any, name: str) -> float:
    if np.ndim(value) != 0 or np.asarray(value).dtype.kind not in "iuf":
        raise ValueError(f"{name}: expected a number, not {value!r}")
    return float(value)


def symmetry_spec(value: Any) -> dict[str, Any]:
    """Reads a plane, or a pair (plane, tolerance)."""
    if isinstance(value, tuple) and len(value) == 2 and np.ndim(value[1]) == 0 and value[1] not in _arrays.AXES:
        return {**_arrays.plane(value[0], "symmetry[0]"), "tolerance_rel": _number(value[1], "symmetry[1]")}
    return dict(_arrays.plane(value, "symmetry"))


def _anchor(entry: Any, name: str, vertices: int | None) -> dict[str, Any]:
    """Reads vertices, or a pair (vertices, weight)."""
    if isinstance(entry, tuple) and len(entry) == 2:
        return {"select": _texts.spec_of(entry[0], name, vertices), "weight": _number(entry[1], f"{name}[1]")}
    return {"select": _texts.spec_of(entry, name, vertices)}


def feature_spec(entry: Any, name: str, vertices: int | None) -> dict[str, Any]:
    """Reads vertices, or a pair (vertices, "similarity" or "affine")."""
    if isinstance(entry, tuple) and len(entry) == 2 and isinstance(entry[1], str):
        return {"select": _texts.spec_of(entry[0], name, vertices), "map": entry[1]}
    return {"select": _texts.spec_of(entry, name, vertices)}


def deform(mesh: M, *, handles: Mapping[str, Any] | None = None, poses: Mapping[str, Any] | None = None,
           region: Any = None, fixed: Any = None, targets: Mapping[int, ArrayLike] | None = None,
           transforms: Mapping[int, ArrayLike] | None = None, anchors: Any = None,
           features: Sequence[Any] | None = None, symmetry: Any = None,
           proxy: int | None = None, refine_boundary: int | Literal["auto"] | None = None, weld: bool | None = None,
           threads: int = 0, memory: int | None = None, progress: Progress = None, **settings: Unpack[DeformKeywords]) -> M:
    """Deforms a mesh once, as `meshgraft deform` does; the result has the type of `mesh`.

    `handles`: vertices by name (an array, a mask, a selection or a Handle). `poses`: a Pose or a 4x4 matrix by the name
    of the handle; others rest. `region`: the vertices that may move, by default all. `fixed`: vertices of the region that
    stay; by default two rings along its boundary. `targets`, `transforms`: positions (3 numbers) and local transforms
    (3x3) by vertex. `anchors`: vertices that are drawn to their rest positions, or pairs (vertices, weight); weight 1
    halves what they would move. `features`: sets of free vertices that keep their shape up to one similarity, or pairs
    (vertices, "affine"). `symmetry`: a plane, (point, normal) or "x" for x = 0; an edit on one side happens on the other,
    too. A pair (plane, tolerance) tells how far a vertex may be from its mirror image, x the diagonal of the bounding box.
    `refine_boundary`: how often the edges around handles and fixed vertices are halved for the solve, 0 to 4; "auto" or
    None: twice around handles and targets without an interior vertex, such as single vertices.
    `proxy`: solve a decimated proxy of about so many vertices. `memory`: bytes that the solve may take. All vertices
    outside the region keep their bits. Coincident vertices of triangle soups move as one. Other deviations from the
    request, such as a proxy that was solved for want of memory, are told as a NoteWarning.
    """
    adapted = adapt(mesh)
    own = adapted.mesh
    given = {**settings, "proxy": proxy, "refine_boundary": refine_boundary, "weld": weld}
    step = deform_step("mesh", len(own), region=region, fixed=fixed, handles=handles, poses=poses, targets=targets,
                       transforms=transforms, anchors=anchors, features=features, symmetry=symmetry, settings=given)
    options = {"estimate_condition": False, "strict": False, "keep": [], "memory": memory}
    edit = _texts.given_step(step, {"mesh": own}, name="deform")
    with calling(threads, memory, progress) as call:
        result, _, report, *_ = _core.run_one_step(edit, options, call)
    for note in (*report.notes, *report.steps[0].notes):
        if note.id != "script.welded":  # as is told of deform
            warnings.warn(str(note), NoteWarning, stacklevel=2)
    return cast(M, result if isinstance(mesh, Mesh) else adapted.at(result.vertices.copy()))


class _Posed(Generic[M]):
    """What is evaluated at poses of handles by name."""

    _core: Any
    _adapted: Any
    _handles: list[str]
    _default: CallArguments

    def _call(self, threads: int) -> CallArguments:
        return (threads, 0, None) if threads else self._default

    def _poses(self, poses: Mapping[str, Any] | None, named: Mapping[str, Any]) -> list[Any]:
        if poses is not None and not isinstance(poses, Mapping):
            raise TypeError(f"poses: expected a dict of poses by the names of handles, not {type(poses).__name__}")
        if poses and (twice := poses.keys() & named.keys()):
            raise TypeError(f"the handle {min(twice)!r} has two poses, in the dict and as a keyword")
        all_poses = {**poses, **named} if poses else named
        cores = [None if (pose := all_poses.get(name)) is None else pose_of(pose, name)._core for name in self._handles]
        if len(all_poses) > sum(core is not None for core in cores):
            require_known(all_poses, self._handles)
        return cores

    def _into(self, out: FloatArray) -> FloatArray:
        return _arrays.output(out, "out", len(self._adapted.mesh))

    @property
    def handles(self) -> tuple[str, ...]:
        """Names of the handles, in their order."""
        return tuple(self._handles)


class _Solver(_Posed[M]):
    """What the exact deformer and the proxy have in common."""

    def _set_up(self, mesh: M, region: Any, handles: Mapping[str, Any], fixed: Any, anchors: Any,
                features: Sequence[Any] | None, symmetry: Any, weld: bool | None, settings: Mapping[str, Any],
                held: Callable[[Mesh], Mapping[str, Any]] | None = None) -> tuple[Any, ...]:
        for name in ("proxy", "refine_boundary"):
            if name in settings:
                raise TypeError(f"{name!r} is a keyword of deform and of an edit's steps, not of {type(self).__name__}")
        self._adapted = adapt(mesh)
        self._handles = list(handles or {})
        own = self._adapted.mesh
        step = deform_step("mesh", len(own), region=region, fixed=fixed, handles=handles, anchors=anchors,
                           features=features, symmetry=symmetry, settings={**settings, **_texts.without_none(weld=weld)},
                           **(held(own) if held else {}))
        return _texts.given_step(step, {"mesh": own}, name="deformer")

    def evaluate(self, poses: Mapping[str, Any] | None = None, /, *, threads: int = 0, **named: Any) -> M:
        """Returns the mesh with its handles at poses: `d.evaluate(hand=Pose(...))`, or of a dict by name.

        Handles without a pose rest. Vertices outside the region keep their coordinates bit for bit. The result has the
        type of the mesh that was given; for a tuple (vertices, faces) it is the vertices.
        """
        positions = self._core.evaluate(self._poses(poses, named), None, self._call(threads))
        if isinstance(self._adapted.given, Mesh):
            return cast(M, self._core.moved(positions))
        return cast(M, self._adapted.at(positions))

    def positions(self, poses: Mapping[str, Any] | None = None, /, *, out: FloatArray | None = None, threads: int = 0,
                  **named: Any) -> FloatArray:
        """Returns the positions alone, (n, 3). With `out`, an array of float64, writes them there and returns it."""
        target = None if out is None else self._into(out)
        return cast(FloatArray, self._core.evaluate(self._poses(poses, named), target, self._call(threads)))

    def positions_and_report(self, poses: Mapping[str, Any] | None = None, /, *, threads: int = 0,
                             **named: Any) -> tuple[FloatArray, EvaluationReport]:
        """Returns the positions, (n, 3), and figures of the evaluation."""
        return cast("tuple[FloatArray, EvaluationReport]",
                    self._core.evaluate_with_report(self._poses(poses, named), self._call(threads)))

    @property
    def free_vertices(self) -> IndexArray:
        """The vertices whose position is solved for, ascending."""
        return cast(IndexArray, self._core.free_vertices())

    @property
    def region(self) -> IndexArray:
        """The vertices that may move."""
        return cast(IndexArray, self._core.region())

    @property
    def fixed(self) -> IndexArray:
        """The vertices of the region that stay."""
        return cast(IndexArray, self._core.fixed())

    def handle_vertices(self, name: str) -> IndexArray:
        """Returns the vertices of a handle."""
        require_known([name], self._handles)
        return cast(IndexArray, self._core.handle(self._handles.index(name)))

    def pivot(self, name: str) -> FloatArray:
        """Returns the point about which a handle turns unless its pose names another: the centre of its boundary."""
        require_known([name], self._handles)
        return cast(FloatArray, self._core.pivot(self._handles.index(name)))

    @property
    def notes(self) -> tuple[Note, ...]:
        """Notes about the set-up."""
        return cast("tuple[Note, ...]", self._core.notes())

    def condition_estimate(self, *, progress: Progress = None) -> float:
        """Returns a lower bound of the condition number of the system, at the cost of a few solves."""
        with calling(progress=progress) as call:
            return cast(float, self._core.condition_estimate(call))


@documented("Deformer")
class Deformer(_Solver[M]):
    """Deforms a region of a mesh by handles. Making one takes the time; evaluations are quick.

        d = mg.Deformer(mesh, region=arm, handles={"hand": hand})
        bent = d.evaluate(hand=mg.Pose(rotate=("z", 40), pivot=wrist))

    The arguments are those of `deform`. Several threads may evaluate at once. The mesh is solved as it is: unlike in
    `deform`, edges around sparse handles are not halved.
    """

    def __init__(self, mesh: M, region: Any = None, handles: Mapping[str, Any] | None = None, *, fixed: Any = None,
                 anchors: Any = None, features: Sequence[Any] | None = None, symmetry: Any = None, weld: bool | None = None,
                 threads: int = 0, progress: Progress = None, **settings: Unpack[DeformKeywords]) -> None:
        given = self._set_up(mesh, region, handles or {}, fixed, anchors, features, symmetry, weld, settings)
        self._given_settings, self._weld = dict(settings), weld
        self._default = (threads, 0, None)
        with calling(threads, None, progress) as call:
            self._core = _core.make_deformer(given, call)

    @documented("Deformer.with_region")
    def with_region(self, region: Any, handles: Mapping[str, Any], *, fixed: Any = None, anchors: Any = None,
                    features: Sequence[Any] | None = None, symmetry: Any = None,
                    progress: Progress = None) -> Deformer[M]:
        """Returns a Deformer for another region of the same mesh, by the same settings.

        Handles, fixed vertices, anchors, features and symmetry are those given here alone.
        """
        other: Deformer[M] = Deformer.__new__(Deformer)
        given = other._set_up(self._adapted.given, region, handles, fixed, anchors, features, symmetry, self._weld,
                              self._given_settings)
        other._given_settings, other._weld, other._default = self._given_settings, self._weld, self._default
        with calling(self._default[0], None, progress) as call:
            other._core = self._core.with_region(given, call)
        return other

    @documented("Deformer.constraints")
    def constraints(self, poses: Mapping[str, Any] | None = None, /,
                    **named: Any) -> tuple[IndexArray, FloatArray, FloatArray]:
        """Returns vertices, (k,), positions, (k, 3), and local maps, (k, 3, 3); NaN where one is not given."""
        return cast("tuple[IndexArray, FloatArray, FloatArray]", _core.constraints(self._core, self._poses(poses, named)))

    def positions_with_field(self, field: ArrayLike, poses: Mapping[str, Any] | None = None, /, *, threads: int = 0,
                             **named: Any) -> FloatArray:
        """Returns positions, (n, 3), whose local maps change from vertex to vertex as `field` does, one map for each
        vertex of the mesh, (n, 3, 3), in place of the method's own field. One linear solve."""
        maps = _arrays.maps(field, "field", len(self._adapted.mesh))
        return cast(FloatArray, _core.evaluate_with_field(self._core, self._poses(poses, named), maps,
                                                          self._call(threads)))

    @property
    def summary(self) -> DeformerSummary:
        """Seconds per stage and figures of the set-up."""
        return cast(DeformerSummary, self._core.summary())

    def handle_basis(self, *, normals: bool = True, progress: Progress = None) -> HandleBasis[M]:
        """Makes the basis of the linear frames of method "ft05"."""
        with calling(self._default[0], None, progress) as call:
            return HandleBasis(_core.handle_basis(self._core, normals, call), self)

    def reduced_frames(self, *, progress: Progress = None, **options: Unpack[ReducedFramesKeywords]) -> ReducedFrames[M]:
        """Makes approximate frames of the methods "corotational" and "rotation-aware"."""
        with calling(self._default[0], None, progress) as call:
            return ReducedFrames(_core.reduced_frames(self._core, dict(options), call), self)

    def normal_matrix(self) -> Any:
        """Returns the lower triangle of the matrix that is factorised, a scipy.sparse.csc_array. For study."""
        from meshgraft.operators import csc

        return csc(self._core.normal_matrix(DEFAULT))

    def affine_operator(self) -> Any:
        """Returns the rows of the energy on the patch that is solved (scaled to unit size). For study."""
        from meshgraft.operators import AffineOperator

        return AffineOperator._wrap(self._core.operator())

    @property
    def patch_vertices(self) -> IndexArray:
        """The vertices of the patch of `affine_operator`."""
        return cast(IndexArray, self._core.patch_vertices())


@documented("ProxyDeformer")
class ProxyDeformer(_Solver[M]):
    """Deforms a region by way of a decimated proxy of about `vertices` vertices. Other arguments as for Deformer."""

    def __init__(self, mesh: M, region: Any = None, handles: Mapping[str, Any] | None = None, *, vertices: int = 4000,
                 fixed: Any = None, anchors: Any = None, features: Sequence[Any] | None = None, symmetry: Any = None,
                 weld: bool | None = None, threads: int = 0, progress: Progress = None, **settings: Unpack[DeformKeywords]) -> None:
        given = self._set_up(mesh, region, handles or {}, fixed, anchors, features, symmetry, weld, settings)
        self._default = (threads, 0, None)
        with calling(threads, None, progress) as call:
            self._core = _core.make_proxy(given, vertices, call)

    @property
    def summary(self) -> ProxySummary:
        """Seconds per stage and figures of the set-up."""
        return cast(ProxySummary, self._core.summary())

    @property
    def proxy(self) -> tuple[IndexArray, IndexArray]:
        """The proxy: its vertices as indices into the mesh, and its triangles, (k, 3), as indices into these."""
        return self._core.proxy_vertices(), self._core.proxy_triangles()


class _Frames(_Posed[M]):
    def __init__(self, core: Any, deformer: Deformer[M]) -> None:
        self._core, self._adapted, self._handles = core, deformer._adapted, deformer._handles
        self._default = deformer._default

    def frame(self, poses: Mapping[str, Any] | None = None, /, *, out: FloatArray | None = None, threads: int = 0,
              **named: Any) -> FloatArray:
        """Returns positions, (n, 3), or writes them to `out`."""
        target = None if out is None else self._into(out)
        return cast(FloatArray, self._core.frame(self._poses(poses, named), target, self._call(threads)))

    @property
    def memory_bytes(self) -> int:
        """Memory that it takes."""
        return cast(int, self._core.memory_bytes())


@documented("HandleBasis")
class HandleBasis(_Frames[M]):
    """Linear frames in real time; `Deformer.handle_basis` makes one."""

    def frame_with_normals(self, poses: Mapping[str, Any] | None = None, /, *, threads: int = 0,
                           **named: Any) -> tuple[FloatArray, NDArray[np.float32]]:
        """Returns positions and unit normals, both (n, 3)."""
        return cast("tuple[FloatArray, NDArray[np.float32]]",
                    self._core.frame_with_normals(self._poses(poses, named), None, self._call(threads)))

    @property
    def has_normals(self) -> bool:
        """Whether frames can have normals."""
        return cast(bool, self._core.has_normals())

    @documented("HandleBasis.buffers")
    def buffers(self) -> HandleBuffers:
        """Returns the data of a vertex shader."""
        return cast(HandleBuffers, self._core.buffers())

    def pose_matrices(self, poses: Mapping[str, Any] | None = None, /, **named: Any) -> NDArray[np.float32]:
        """Returns the handles' matrices of one frame for a vertex shader, (handles, 4, 3)."""
        return cast("NDArray[np.float32]", self._core.pose_matrices(self._poses(poses, named)))


@documented("ReducedFrames")
class ReducedFrames(_Frames[M]):
    """Approximate frames in real time; `Deformer.reduced_frames` makes them."""

    @property
    def centres(self) -> int:
        """Number of points with a function of which the field of maps is a sum."""
        return cast(int, self._core.centres())


@documented("estimated_memory")
def estimated_memory(free_vertices: int) -> int:
    """Returns an estimate of the bytes that the solver needs for so many free vertices."""
    return cast(int, _core.estimated_memory(free_vertices))
