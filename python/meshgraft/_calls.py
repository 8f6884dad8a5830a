"""What every long function takes: threads, memory and progress."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeAlias

from meshgraft import _arrays, _core

Progress: TypeAlias = "bool | Callable[[str, float | None], object] | None"
"""True shows a bar of tqdm's. A function gets the stage, and the fraction of it that is done or None."""

CallArguments: TypeAlias = "tuple[int, int, Any]"


@contextmanager
def calling(threads: int = 0, memory: int | None = None, progress: Progress = None) -> Iterator[CallArguments]:
    """Gives the arguments of a call of the extension module, and closes a bar after it."""
    threads = _arrays.whole(threads, "threads", 2**16)
    memory = None if memory is None else _arrays.whole(memory, "memory", 2**63 - 1)
    if progress is None or progress is False:
        yield threads, memory or 0, None
    elif progress is True:
        with _Bar() as bar:
            yield threads, memory or 0, bar
    else:
        yield threads, memory or 0, progress


class _Bar:
    """A bar of tqdm's: one line in a terminal, a widget in a notebook."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            raise ImportError("progress=True needs tqdm: pip install tqdm") from None
        self.bar = tqdm(total=1.0, bar_format="{desc}: {percentage:3.0f}%|{bar}| {elapsed}", leave=False)

    def __enter__(self) -> _Bar:
        return self

    def __exit__(self, *_: object) -> None:
        self.bar.close()

    def __call__(self, stage: str, fraction: float | None) -> None:
        self.bar.set_description_str(stage.replace("_", " "), refresh=False)
        self.bar.n = fraction or 0.0
        self.bar.refresh()


DEFAULT: CallArguments = (0, 0, None)

os.register_at_fork(after_in_child=_core.note_fork)
