"""Handles and their poses."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshgraft import _arrays, _core
from meshgraft._records import HandleShape

FloatArray = NDArray[np.float64]
_KINDS = ("motion", "matrix", "curve")


class Pose:
    """The pose of a handle: x' = c + t + R S (x - c).

    `translate`: t, model units. `rotate`: an axis ("x", "y", "z" or three numbers) and an angle in degrees, of any number
    of turns. `scale`: a number, or one per axis. `pivot`: c; without one, the centre of the handle's boundary.
    """

    __slots__ = ("_kind", "_spec", "_core")
    _kind: str
    _spec: dict[str, Any]
    _core: Any

    def __init__(self, translate: ArrayLike = (0.0, 0.0, 0.0), *, rotate: tuple[ArrayLike | str, float] | None = None,
                 scale: ArrayLike = 1.0, pivot: ArrayLike | None = None) -> None:
        shift = _arrays.vector(translate, "translate")
        axis, angle = _arrays.AXES["z"], 0.0
        if rotate is not None:
            try:
                given, angle = rotate
            except (TypeError, ValueError):
                raise ValueError("rotate: expected an axis and an angle in degrees, such as ('z', 40)") from None
            axis = tuple(_arrays.direction(given, "rotate[0]"))
            angle = float(_arrays.numbers([angle], "rotate[1]")[0])
        factors = _arrays.vector(np.broadcast_to(scale, 3) if np.ndim(scale) == 0 else scale, "scale")
        centre = None if pivot is None else _arrays.vector(pivot, "pivot")
        spec: dict[str, Any] = {}
        if shift.any():
            spec["translate"] = shift.tolist()
        if rotate is not None:
            spec["rotate"] = {"axis": [float(number) for number in axis], "angle_deg": angle}
        if (factors != 1).any():
            spec["scale"] = factors.tolist()
        if centre is not None:
            spec["pivot"] = centre.tolist()
        self._kind, self._spec = "motion", spec
        self._core = _core.motion(shift, np.array(axis, np.float64), angle, factors, centre)

    @classmethod
    def matrix(cls, matrix: ArrayLike) -> Pose:
        """Makes the pose of an affine map: a 4x4 matrix that acts on columns."""
        array = _arrays.matrix(matrix, "matrix", 4)
        if tuple(array[3]) != (0.0, 0.0, 0.0, 1.0):
            raise ValueError(f"matrix[3]: expected 0, 0, 0, 1, not {array[3].tolist()}")
        return cls._make("matrix", {"matrix": array.tolist()})

    @classmethod
    def curve(cls, points: ArrayLike) -> Pose:
        """Makes the new course of a curve handle: a polyline, (k, 3). Vertices keep their relative arc lengths."""
        return cls._make("curve", {"curve": _arrays.points(points, "points").tolist()})

    @classmethod
    def _make(cls, kind: str, spec: dict[str, Any]) -> Pose:
        if kind == "motion":
            rotate = spec.get("rotate")
            return cls(spec.get("translate", (0.0, 0.0, 0.0)),
                       rotate=None if rotate is None else (rotate["axis"], rotate["angle_deg"]),
                       scale=spec.get("scale", 1.0), pivot=spec.get("pivot"))
        pose = cls.__new__(cls)
        pose._kind, pose._spec = kind, spec
        pose._core = (_core.matrix_pose(np.array(spec["matrix"], np.float64)) if kind == "matrix"
                      else _core.curve_pose(np.array(spec["curve"], np.float64).reshape(-1, 3)))
        return pose

    def as_matrix(self, pivot: ArrayLike = (0.0, 0.0, 0.0)) -> FloatArray:
        """Returns the affine map as a 4x4 matrix; `pivot` is used where the pose has none."""
        matrix = _core.pose_matrix(self._core, _arrays.vector(pivot, "pivot"))
        if matrix is None:
            raise ValueError("the new course of a curve is no affine map")
        return cast(FloatArray, matrix)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Pose) and (self._kind, self._spec) == (other._kind, other._spec)

    def __hash__(self) -> int:
        return hash(repr((self._kind, self._spec)))

    def __repr__(self) -> str:
        return f"Pose({self._kind}: {self._spec})" if self._kind != "motion" else f"Pose({self._spec or 'at rest'})"

    def __reduce__(self) -> tuple[object, ...]:
        return Pose._make, (self._kind, self._spec)


@dataclass(frozen=True)
class Handle:
    """A vertex set that moves as one.

    `vertices`: indices, a mask or a selection. `shape`: "region", "curve" (vertices in order) or "vertex" (exactly one).
    `constrain`: what the handle gives to its vertices. `closed`, of a curve: whether its last vertex is followed by its
    first; by default whether the two share an edge.
    """

    vertices: Any
    shape: HandleShape = "region"
    constrain: Literal["both", "position", "transform"] = "both"
    closed: bool | None = None


def pose_of(value: Any, name: str) -> Pose:
    """Returns the pose that an argument gives: a pose, or a 4x4 matrix."""
    if isinstance(value, Pose):
        return value
    if np.ndim(value) == 2:
        try:
            return Pose.matrix(value)
        except ValueError as error:
            raise ValueError(f"{name}: {error}") from None
    raise ValueError(f"{name}: expected a meshgraft.Pose or a 4x4 matrix, not {type(value).__name__}")


def handle_specs(handles: Mapping[str, Any] | None, vertices: int | None,
                 poses: Mapping[str, Any] | None = None) -> list[dict[str, Any]]:
    """Returns handles in the form of an edit file."""
    from meshgraft._texts import spec_of

    if handles is not None and not isinstance(handles, Mapping):
        raise ValueError(f"handles: expected a dict of names and vertices, not {type(handles).__name__}")
    require_known(poses or {}, list(handles or {}))
    specs = []
    for name, handle in (handles or {}).items():
        own = handle if isinstance(handle, Handle) else Handle(handle)
        spec: dict[str, Any] = {"name": name, "select": spec_of(own.vertices, f"handles[{name!r}]", vertices)}
        if own.shape != "region":
            spec["shape"] = own.shape
        if own.closed is not None:
            spec["closed"] = own.closed
        if own.constrain != "both":
            spec["constrain"] = own.constrain
        if poses and name in poses:
            spec["pose"] = pose_of(poses[name], name)._spec
        specs.append(spec)
    return specs


def require_known(poses: Iterable[str], handles: Sequence[str]) -> None:
    """Raises TypeError for the pose of a handle that does not exist."""
    if isinstance(poses, Pose):
        raise TypeError("poses: expected a dict of poses by the names of handles, not a Pose")
    for name in poses:
        if name not in handles:
            known = ", ".join(handles) or "none"
            raise TypeError(f"there is no handle {name!r}; the handles are {known}")
