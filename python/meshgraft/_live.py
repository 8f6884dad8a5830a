"""Deformations that are dragged."""

from __future__ import annotations

import atexit
import sys
import weakref
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar, cast

import numpy as np
from numpy.typing import NDArray

from meshgraft import _core
from meshgraft._calls import Progress, calling
from meshgraft._deform import Deformer, _Posed, _Solver
from meshgraft._docs_of import documented
from meshgraft._facts import Error
from meshgraft._records import DeformKeywords, FrameAccuracy, LiveStage

if sys.version_info >= (3, 11):
    from typing import Unpack
else:
    from typing_extensions import Unpack

M = TypeVar("M")


@dataclass(frozen=True, eq=False)
class LiveFrame:
    """One state of the surface while it is dragged."""

    pose: int
    """number of the pose, which `LiveDeformer.drag` returned"""
    vertices: NDArray[np.float64]
    """positions, (n, 3); nobody writes to them any more"""
    accuracy: FrameAccuracy
    seconds: float
    """computing time"""
    error_rel: float | None
    """largest distance from the exact positions, x the largest displacement: an earlier measurement"""


_open: weakref.WeakSet[LiveDeformer[Any]] = weakref.WeakSet()


@documented("LiveDeformer")
class LiveDeformer(_Posed[M]):
    """A deformation that answers every pose at once, and refines the answer while the handles rest.

        with mg.LiveDeformer(mesh, region=arm, handles={"hand": hand}, on_frame=show) as live:
            live.drag(hand=mg.Pose(rotate=("z", 40)))
            live.wait()

    `on_frame` gets each LiveFrame, on a thread of the library's; `on_failure` gets the number of a pose (0: the set-up)
    and its Error. Neither may call `wait`. Ctrl-C during `wait` closes the object.
    """

    def __init__(self, mesh: M, region: Any = None, handles: Mapping[str, Any] | None = None, *,
                 on_frame: Callable[[LiveFrame], object] | None = None,
                 on_failure: Callable[[int, Error], object] | None = None, fixed: Any = None, anchors: Any = None,
                 features: Sequence[Any] | None = None, symmetry: Any = None, weld: bool | None = None,
                 proxy_from: int = 10_000, proxy_vertices: int = 2000,
                 settle_seconds: float = 0.1, centres: int = 128, samples_per_centre: int = 6,
                 earlier: Deformer[M] | None = None, threads: int = 0, **settings: Unpack[DeformKeywords]) -> None:
        given = _Solver._set_up(cast(Any, self), mesh, region, handles or {}, fixed, anchors, features, symmetry, weld,
                                settings)
        self._default = (threads, 0, None)
        options = {"proxy_from": proxy_from, "proxy_vertices": proxy_vertices, "settle_seconds": settle_seconds,
                   "centres": centres, "samples_per_centre": samples_per_centre}
        deliver = None if on_frame is None else lambda frame: on_frame(LiveFrame(*frame))
        self._core = _core.make_live(given, deliver, on_failure, options, earlier and earlier._core, self._default)
        _open.add(self)

    def drag(self, poses: Mapping[str, Any] | None = None, /, **named: Any) -> int:
        """Asks for a pose of the handles, and returns its number at once: 0 after `close`.

        A newer pose replaces one that waits.
        """
        return cast(int, self._core.drag(self._poses(poses, named)))

    def wait(self, *, progress: Progress = None) -> None:
        """Waits until the newest pose has its exact frame. Raises the Error if that cannot happen."""
        with calling(0, None, progress) as call:
            self._core.wait(call)

    @property
    def frame(self) -> LiveFrame | None:
        """The newest frame; None before the first."""
        frame = self._core.newest()
        return None if frame is None else LiveFrame(*frame)

    @property
    def mesh(self) -> M:
        """The mesh of the newest frame, in the type that was given; at rest before the first."""
        frame = self._core.newest()
        return cast(M, self._adapted.given if frame is None else self._adapted.at(frame[1].copy()))

    @property
    def stage(self) -> LiveStage:
        """Stage of the set-up."""
        return cast(LiveStage, self._core.stage())

    @property
    def superseded(self) -> int:
        """Number of poses that were never computed, because a newer one came first."""
        return cast(int, self._core.superseded())

    def close(self) -> None:
        """Stops all work. Nothing is delivered any more."""
        self._core.close()

    def __enter__(self) -> LiveDeformer[M]:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@atexit.register
def _close_all() -> None:
    for live in list(_open):
        live._core.finish()
