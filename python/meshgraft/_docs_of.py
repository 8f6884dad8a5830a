"""Docstrings from the public headers' comments."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from meshgraft._docs import DOCS

T = TypeVar("T", bound=Callable[..., object])


def documented(name: str) -> Callable[[T], T]:
    """Appends what the header says about a function or class to a docstring."""
    text = DOCS[name]

    def add(function: T) -> T:
        function.__doc__ = f"{(function.__doc__ or '').rstrip()}\n\n{text}\n".lstrip("\n")
        return function

    return add
