"""Edits as text: the form in which the extension module reads them."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from meshgraft import _arrays
from meshgraft.select import Selection

Direction = str | ArrayLike
"""An axis, such as "z" or "-y", or a vector."""


def spec_of(value: Any, name: str, vertices: int | None) -> Any:
    """Returns a vertex set that an argument gives, in the form of an edit file. Arrays are kept as arrays."""
    if isinstance(value, Selection):
        return value._spec
    if isinstance(value, str):
        return value
    return {"indices": np.array(_arrays.indices(value, name, vertices))}  # the caller may change its own


class Writer:
    """Turns edits into text. Long lists of vertices are handed over as arrays, beside the text."""

    def __init__(self, *, aside: bool, of_step: bool = False) -> None:
        self.aside = aside
        self.of_step = of_step  # whether the edit is one step, whose fields are the arguments of a call
        self.arrays: dict[str, Any] = {}
        self.taken: Collection[str] = ()  # names of the edit's own selections

    def plain(self, value: Any, place: str = "") -> Any:
        """Returns a value without arrays and selections. An array that is kept aside is named by its place."""
        if isinstance(value, Selection):
            return self.plain(value._spec, place)
        if isinstance(value, Mapping):
            indices = value.get("indices")
            if isinstance(indices, np.ndarray) and self.aside and len(indices):
                name = next(name for k in itertools.count()
                            if (name := place + " " * k) not in self.taken and name not in self.arrays)
                self.arrays[name] = indices
                return name
            return {key: self.plain(entry, _within(place, key)) for key, entry in value.items()}
        if isinstance(value, np.ndarray):
            return value.tolist()
        if isinstance(value, np.generic):
            return value.item()
        if isinstance(value, (list, tuple)):
            return [self.plain(entry, f"{place}[{k}]") for k, entry in enumerate(value)]
        return value

    def text(self, edit: Mapping[str, Any]) -> str:
        """Returns the text of an edit."""
        self.taken = edit.get("selections", {})
        plain = self.plain(edit)
        if self.arrays:
            plain["selections"] = {**plain.get("selections", {}),
                                   **{name: {"indices": [0]} for name in self.arrays}}
        for place, number in _numbers(plain, ""):
            if not math.isfinite(number):
                place = place.removeprefix("steps[0].").removeprefix("settings.") if self.of_step else place
                raise ValueError(f"{place}: {number} is not finite")
        return json.dumps(plain, ensure_ascii=False, allow_nan=False)


def _within(place: str, key: str) -> str:
    return f"{place}.{key}" if place else str(key)


def _numbers(value: Any, place: str) -> Iterator[tuple[str, float]]:
    """Finds the floating-point numbers in plain data, with their places."""
    if isinstance(value, float):
        yield place, value
    elif isinstance(value, Mapping):
        for key, entry in value.items():
            yield from _numbers(entry, _within(place, key))
    elif isinstance(value, list) and value and not isinstance(value[0], int):
        for k, entry in enumerate(value):
            yield from _numbers(entry, f"{place}[{k}]")


def given(edit: Mapping[str, Any], meshes: Mapping[str, Any], *, name: str = "edit", folder: str = "",
          of_step: bool = False) -> tuple[Any, ...]:
    """Returns the arguments by which the extension module takes an edit and its meshes in memory."""
    writer = Writer(aside=True, of_step=of_step)
    text = writer.text(edit)
    return text, name, folder, writer.arrays, {key: mesh._core for key, mesh in meshes.items()}


def given_step(step: Mapping[str, Any], meshes: Mapping[str, Any], *, name: str,
               orientations: Mapping[str, Mapping[str, Any]] = {}) -> tuple[Any, ...]:
    """Returns the same for an edit of one step on meshes in memory."""
    inputs = {key: {"file": key, **orientations.get(key, {})} for key in meshes}
    edit = {"format": "meshgraft-edit", "version": 2, "inputs": inputs, "steps": [dict(step)]}
    return given(edit, meshes, name=name, of_step=True)


def orientation_spec(orientation: Any, name: str) -> dict[str, Any]:
    """Returns the fields of an input that tell how a model stands, of a pair (up, front) or None."""
    if orientation is None:
        return {}
    if isinstance(orientation, str) or not hasattr(orientation, "__len__") or len(orientation) != 2:
        raise ValueError(f"{name}: expected (up, front)")
    return {field: value if isinstance(value, str) else _arrays.vector(value, name).tolist()
            for field, value in zip(("up", "front"), orientation)}


def require_known(settings: Collection[str], known: Collection[str]) -> None:
    """Raises a TypeError for a keyword that is no setting."""
    for keyword in settings:
        if keyword not in known:
            raise TypeError(f"unexpected keyword argument {keyword!r}; the settings are {', '.join(sorted(known))}")


def without_none(**fields: Any) -> dict[str, Any]:
    """Returns the fields that are given."""
    return {name: value for name, value in fields.items() if value is not None}
