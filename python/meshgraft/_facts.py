"""Notes and errors: facts with an id and fields. docs/facts.md lists all ids."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

FactValue: TypeAlias = "int | float | str | tuple[str, ...] | object"


@dataclass(frozen=True, kw_only=True, eq=False)
class Note:
    """A fact about a result that is no error."""

    id: str
    """stable name, e.g. "merge.boundary_ragged" """
    fields: Mapping[str, FactValue]
    text: str
    remedy: str
    """what can be done; may be empty"""

    def __str__(self) -> str:
        return f"{self.text}. {self.remedy}" if self.remedy else self.text


class NoteWarning(UserWarning):
    """Tells of a note on a result that has no place for notes."""


class Error(Exception):
    """An error of the library. `str` is "location: problem. remedy"."""

    code = "internal"
    """kind of error: usage, input, unsolvable, io, memory, cancelled or internal"""

    def __init__(self, message: str, *, id: str = "core.internal", fields: Mapping[str, FactValue] | None = None,
                 location: str = "", problem: str = "", remedy: str = "", notes: tuple[Note, ...] = ()) -> None:
        super().__init__(message)
        self.message = message
        self.id = id
        """stable name of the fact, e.g. "merge.ambiguous_start" """
        self.fields: dict[str, FactValue] = dict(fields or {})
        self.location = location
        """where it is, e.g. "handles[0].select"; may be empty"""
        self.problem = problem
        self.remedy = remedy
        """what can be done; may be empty"""
        self.notes = notes

    def __str__(self) -> str:
        return self.message

    def __reduce__(self) -> tuple[object, ...]:
        return _remake, (type(self), self.message, self.id, self.fields, self.location, self.problem, self.remedy,
                         self.notes)


class InputError(Error, ValueError):
    """A file, a mesh or an option's value is not acceptable."""

    code = "input"


class UsageError(Error, ValueError):
    """The call is malformed."""

    code = "usage"


class UnsolvableError(Error):
    """The input is well formed, but the edit it asks for has no unique or no finite solution."""

    code = "unsolvable"


class FileError(Error, OSError):
    """Reading or writing a file failed."""

    code = "io"


class OutOfMemoryError(Error, MemoryError):
    """The machine has too little memory for the call."""

    code = "memory"


class Cancelled(Error):
    """The caller asked to stop."""

    code = "cancelled"


_CLASSES: dict[str, type[Error]] = {
    kind.code: kind for kind in (InputError, UsageError, UnsolvableError, FileError, OutOfMemoryError, Cancelled)}


def _remake(kind: type[Error], message: str, id: str, fields: Mapping[str, FactValue], location: str, problem: str,
            remedy: str, notes: tuple[Note, ...]) -> Error:
    return kind(message, id=id, fields=fields, location=location, problem=problem, remedy=remedy, notes=notes)


def make_error(code: str, id: str, fields: Mapping[str, FactValue], location: str, problem: str, remedy: str,
               notes: tuple[Note, ...], message: str) -> Error:
    """Returns the exception of an error of the extension module."""
    return _remake(_CLASSES.get(code, Error), message, id, fields, location, problem, remedy, notes)
