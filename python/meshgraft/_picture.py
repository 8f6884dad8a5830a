"""Pictures of meshes, which notebooks show."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike

from meshgraft import _arrays, _core
from meshgraft._adapters import adapt
from meshgraft._calls import Progress, calling


class Picture(np.ndarray[Any, np.dtype[np.uint8]]):
    """A picture: an array of (height, width, 3) bytes, sRGB, that a notebook shows."""

    def _repr_png_(self) -> bytes | None:
        if self.ndim != 3 or self.shape[2] != 3 or self.dtype != np.uint8:
            return None  # a part of a picture, or numbers computed from one
        return cast(bytes, _core.png_bytes(np.ascontiguousarray(self)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a PNG file."""
        png = self._repr_png_()
        if png is None:
            raise ValueError("no picture: expected bytes of shape (height, width, 3)")
        Path(path).write_bytes(png)


def picture(*meshes: Any, colours: Sequence[ArrayLike | None] | None = None, beside: bool = False,
            captions: Sequence[str] = (), width: int = 900, height: int = 675, look_from: ArrayLike | None = None,
            up: ArrayLike | str | None = None, bounds: ArrayLike | None = None, samples: int = 4, occlusion_rays: int = 16,
            smooth: bool = True, crease_angle_deg: float = 40.0, wireframe: bool = False, ground: bool = True,
            field_of_view_deg: float = 26.0, threads: int = 0, progress: Progress = None) -> Picture:
    """Draws meshes as clay under a light, in one picture or each in its own (`beside`), all with one camera.

    `colours`: per mesh an array (n, 3), linear 0 ... 1, or None for its attribute "colour". `look_from`: the direction
    towards the camera; by default (0.5, -1, 0.35) where z is up. `up`: by default the axis that is up in the first mesh:
    what its file says, else y or z by the file's format; z for samples and arrays. `bounds`: the box that is shown,
    (2, 3); by default all meshes. `samples`: per pixel, rounded down to a square. `occlusion_rays`: for the light on the
    surface in every second pixel in both directions; more of them make smoother shadows. `captions`: below pictures that
    stand beside each other.
    """
    if not meshes:
        raise ValueError("picture: expected at least one mesh")
    own = [adapt(mesh, f"meshes[{i}]").mesh for i, mesh in enumerate(meshes)]
    given = list(colours) if colours is not None else [None] * len(own)
    if len(given) != len(own):
        raise ValueError(f"colours: expected {len(own)} entries, not {len(given)}")
    shades = [None if c is None else _arrays.points(c, f"colours[{i}]", rows=len(own[i])) for i, c in enumerate(given)]
    if bounds is None and beside:
        boxes = np.array([mesh.bounds for mesh in own])
        bounds = np.array([np.nanmin(boxes[:, 0], axis=0), np.nanmax(boxes[:, 1], axis=0)])
    box = None if bounds is None else _arrays.points(bounds, "bounds", rows=2)
    upright = _core.up_axis(own[0]._core) if up is None else up
    options = dict(width=_arrays.whole(width, "width", 2**15), height=_arrays.whole(height, "height", 2**15), samples=samples, occlusion_rays=occlusion_rays, smooth=smooth,
                   crease_angle_deg=float(crease_angle_deg), wireframe=wireframe, ground=ground,
                   field_of_view_deg=float(field_of_view_deg),
                   look_from=None if look_from is None else _arrays.direction(look_from, "look_from"),
                   up=_arrays.direction(upright, "up"), low=None if box is None else box[0].copy(),
                   high=None if box is None else box[1].copy())
    groups = [[i] for i in range(len(own))] if beside else [list(range(len(own)))]
    with calling(threads, None, progress) as call:
        drawn = [_core.draw([own[i]._core for i in group], [shades[i] for i in group], options, call) for group in groups]
    if len(drawn) > 1 or captions:
        drawn = [_core.side_by_side(drawn, list(captions))]
    return cast(Picture, drawn[0].view(Picture))
