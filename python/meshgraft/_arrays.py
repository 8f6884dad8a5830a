"""Checks of arrays at the border: a ValueError names the argument, and the first bad index."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.int32]


def path(value: object, name: str) -> str:
    """Returns the path of a file as text."""
    if not isinstance(value, (str, os.PathLike)) or not isinstance(text := os.fspath(value), str):
        raise TypeError(f"{name}: expected a path, a str or an os.PathLike, not {type(value).__name__}")
    try:
        text.encode()
    except UnicodeEncodeError:
        raise ValueError(f"{name}: names of files are taken in UTF-8 alone, not {text!r}; rename the file") from None
    return text


def whole(value: object, name: str, largest: int) -> int:
    """Returns a whole number from 0 on."""
    if not isinstance(value, (int, np.integer)) or not 0 <= value <= largest:
        raise ValueError(f"{name}: expected a whole number from 0 to {largest}, not {value!r}")
    return int(value)


def _array(value: ArrayLike, name: str, what: str) -> NDArray[Any]:
    try:
        return np.asarray(value)
    except (ValueError, TypeError) as error:
        raise ValueError(f"{name}: expected {what}; {error}") from None


def _numeric(value: ArrayLike, name: str, what: str) -> NDArray[Any]:
    array = _array(value, name, what)
    if array.dtype.kind not in "iuf":
        raise ValueError(f"{name}: expected {what}, not an array of {array.dtype}")
    return array


def points(value: ArrayLike, name: str, *, rows: int | None = None, finite: bool = True) -> FloatArray:
    """Returns n points as a C-contiguous (n, 3) array of float64. One that is that already is not copied."""
    what = "numbers of shape (n, 3)" if rows is None else f"numbers of shape ({rows}, 3)"
    array = _numeric(value, name, what)
    if array.ndim != 2 or array.shape[1] != 3 or (rows is not None and array.shape[0] != rows):
        raise ValueError(f"{name}: expected {what}, not {array.shape}")
    result = np.ascontiguousarray(array, dtype=np.float64)
    if finite:
        _require_finite(result, name)
    return result


def _require_finite(array: FloatArray, name: str) -> None:
    with np.errstate(all="ignore"):
        if np.isfinite(array.sum()):  # no NaN, and no infinity, in one pass
            return
    bad = np.argwhere(~np.isfinite(array))
    if len(bad):  # otherwise only the sum is too large
        index = tuple(int(i) for i in bad[0])
        raise ValueError(f"{name}[{', '.join(map(str, index))}] is {array[index]}")


def vector(value: ArrayLike, name: str) -> FloatArray:
    """Returns three finite numbers."""
    array = _numeric(value, name, "3 numbers")
    if array.shape != (3,):
        raise ValueError(f"{name}: expected 3 numbers, not an array of shape {array.shape}")
    result = np.ascontiguousarray(array, dtype=np.float64)
    _require_finite(result, name)
    return result


def matrix(value: ArrayLike, name: str, size: int) -> FloatArray:
    """Returns a finite size x size matrix."""
    array = _numeric(value, name, f"a {size}x{size} matrix")
    if array.shape != (size, size):
        raise ValueError(f"{name}: expected a {size}x{size} matrix, not an array of shape {array.shape}")
    result = np.ascontiguousarray(array, dtype=np.float64)
    _require_finite(result, name)
    return result


def maps(value: ArrayLike, name: str, count: int) -> FloatArray:
    """Returns finite 3x3 matrices, (count, 3, 3)."""
    array = _numeric(value, name, f"numbers of shape ({count}, 3, 3)")
    if array.shape != (count, 3, 3):
        raise ValueError(f"{name}: expected numbers of shape ({count}, 3, 3), not {array.shape}")
    result = np.ascontiguousarray(array, dtype=np.float64)
    _require_finite(result, name)
    return result


def numbers(value: ArrayLike, name: str, *, count: int | None = None) -> FloatArray:
    """Returns a list of finite numbers."""
    array = _numeric(value, name, "a list of numbers")
    if array.ndim != 1 or (count is not None and len(array) != count):
        length = "" if count is None else f" {count}"
        raise ValueError(f"{name}: expected a list of{length} numbers, not an array of shape {array.shape}")
    result = np.ascontiguousarray(array, dtype=np.float64)
    _require_finite(result, name)
    return result


def vertex(value: ArrayLike, name: str) -> int | list[float]:
    """Returns a vertex: its index, or a point that stands for the nearest one."""
    array = _numeric(value, name, "a vertex or 3 numbers")
    return int(_as_int32(array[None], name, None)[0]) if array.ndim == 0 else vector(array, name).tolist()


def pairs(value: Any, name: str, what: str) -> list[tuple[Any, Any]]:
    """Returns a list of pairs. `what` says of what, such as "(target vertex, source vertex)"."""
    if isinstance(value, str) or not hasattr(value, "__len__"):
        raise ValueError(f"{name}: expected pairs {what}, not {type(value).__name__}")
    result = []
    for i, pair in enumerate(value):
        try:
            first, second = pair
        except (TypeError, ValueError):
            raise ValueError(f"{name}[{i}]: expected a pair {what}") from None
        result.append((first, second))
    return result


def _as_int32(array: NDArray[Any], name: str, limit: int | None) -> IndexArray:
    """Returns indices below the limit (if there is one) as int32."""
    if array.dtype.kind not in "iu":
        raise ValueError(f"{name}: expected integers, not an array of {array.dtype}")
    if array.size:
        top = np.iinfo(np.int32).max if limit is None else limit - 1
        if array.min() < 0 or array.max() > top:
            bad = np.argwhere((array < 0) | (array > top))[0]
            index = tuple(int(i) for i in bad)
            many = "" if limit is None else f", and there are {limit} vertices"
            raise ValueError(f"{name}[{', '.join(map(str, index))}] is {array[index]}{many}")
    return np.ascontiguousarray(array, dtype=np.int32)


def triangles(value: ArrayLike, name: str, vertices: int | None) -> IndexArray:
    """Returns m triangles as a C-contiguous (m, 3) array of int32. One that is that already is not copied."""
    array = _array(value, name, "integers of shape (m, 3)")
    if array.size == 0:
        array = np.zeros((0, 3), np.int32)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name}: expected integers of shape (m, 3), not {array.shape}")
    return _as_int32(array, name, vertices)


def indices(value: ArrayLike, name: str, vertices: int | None) -> IndexArray:
    """Returns a list of vertices, of their indices or of a mask with one flag per vertex."""
    array = _array(value, name, "a list of vertices or a mask")
    if array.ndim == 0:
        array = array[None]
    if array.size == 0 and array.dtype.kind == "f":
        array = array.astype(np.int32)
    if array.ndim != 1:
        raise ValueError(f"{name}: expected a list of vertices or a mask, not an array of shape {array.shape}")
    if array.dtype.kind == "b":
        if vertices is not None and len(array) != vertices:
            raise ValueError(f"{name}: a mask of {len(array)} flags for {vertices} vertices")
        return np.flatnonzero(array).astype(np.int32)
    if array.dtype.itemsize == 1 and vertices is not None and len(array) == vertices > 2 and array.max() <= 1:
        raise ValueError(f"{name}: an array of {array.dtype} with one 0 or 1 per vertex; is it a mask? .astype(bool)")
    return _as_int32(array, name, vertices)


def output(value: object, name: str, rows: int) -> FloatArray:
    """Requires an array that results can be written to."""
    if not isinstance(value, np.ndarray) or value.dtype != np.float64 or value.shape != (rows, 3):
        raise ValueError(f"{name}: expected an array of float64 of shape ({rows}, 3)")
    if not value.flags.c_contiguous or not value.flags.writeable:
        raise ValueError(f"{name}: expected a C-contiguous array that can be written to")
    return value


AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def direction(value: ArrayLike | str, name: str) -> FloatArray:
    """Returns a direction: "x", "y", "z", or three numbers that are not all zero."""
    if isinstance(value, str):
        if value not in AXES:
            raise ValueError(f"{name}: expected 'x', 'y', 'z' or 3 numbers, not {value!r}")
        return np.array(AXES[value])
    result = vector(value, name)
    if not result.any():
        raise ValueError(f"{name}: 0, 0, 0 is no direction")
    return result


def plane(value: object, name: str) -> dict[str, list[float]]:
    """Returns a plane (point, normal) in the form of an edit file. "x" is the plane x = 0."""
    if isinstance(value, str):
        return {"point": [0.0, 0.0, 0.0], "normal": direction(value, name).tolist()}
    if not isinstance(value, (tuple, list, np.ndarray)) or len(value) != 2:
        raise ValueError(f"{name}: expected a plane (point, normal), or 'x', 'y', 'z'")
    return {"point": vector(value[0], f"{name}[0]").tolist(), "normal": direction(value[1], f"{name}[1]").tolist()}
