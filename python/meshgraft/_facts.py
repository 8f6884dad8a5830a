"""Notes and errors: facts with an id and fields. docs/facts.md lists all ids."""

from __future__ import annotations

import errno
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
        """stable name of the fact, e.g. "merge.no_such_vertex" """
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
                         self.notes, getattr(self, "filename", None))


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
    """Reading or writing a file failed.

    `errno` is the system's number where there is one, and `filename` the file. What Python has a class for is of a
    subclass that also is of that class, such as FileNotFoundError.
    """

    code = "io"


class MissingFileError(FileError, FileNotFoundError):
    """There is no such file or folder."""


class PermissionFileError(FileError, PermissionError):
    """The file or its folder may not be read or written."""


class ExistingFileError(FileError, FileExistsError):
    """The file exists already."""


class FolderError(FileError, IsADirectoryError):
    """A folder stands where a file is expected."""


class NoFolderError(FileError, NotADirectoryError):
    """A file stands where a folder is expected."""


class OutOfMemoryError(Error, MemoryError):
    """The machine has too little memory for the call."""

    code = "memory"


class Cancelled(Error):
    """The caller asked to stop."""

    code = "cancelled"


_CLASSES: dict[str, type[Error]] = {
    kind.code: kind for kind in (InputError, UsageError, UnsolvableError, FileError, OutOfMemoryError, Cancelled)}


_FILE_ERRORS: dict[str, tuple[int, type[FileError]]] = {
    "io.file_not_found": (errno.ENOENT, MissingFileError),
    "io.no_permission": (errno.EACCES, PermissionFileError),
    "io.file_exists": (errno.EEXIST, ExistingFileError),
    "io.is_folder": (errno.EISDIR, FolderError),
    "io.name_with_nul": (errno.EINVAL, FileError),
    "io.not_a_file": (errno.EINVAL, FileError),
    "io.not_a_folder": (errno.ENOTDIR, NoFolderError),
    "io.disk_full": (errno.ENOSPC, FileError),
    "io.file_too_large": (errno.EFBIG, FileError),
    "io.link_loop": (errno.ELOOP, FileError),
    "io.name_too_long": (errno.ENAMETOOLONG, FileError),
    "io.read_only": (errno.EROFS, FileError),
    "io.nobody_reads": (errno.EPIPE, FileError),
}
"""number of the system and class of an id"""


def _remake(kind: type[Error], message: str, id: str, fields: Mapping[str, FactValue], location: str, problem: str,
            remedy: str, notes: tuple[Note, ...], file: str | None) -> Error:
    error = kind(message, id=id, fields=fields, location=location, problem=problem, remedy=remedy, notes=notes)
    if isinstance(error, FileError) and id in _FILE_ERRORS:
        error.errno, error.filename, error.strerror = _FILE_ERRORS[id][0], file, problem
    return error


def make_error(code: str, id: str, fields: Mapping[str, FactValue], location: str, problem: str, remedy: str,
               notes: tuple[Note, ...], message: str, file: str | None) -> Error:
    """Returns the exception of an error of the extension module. `file` is the innermost file of the location."""
    kind = _FILE_ERRORS[id][1] if id in _FILE_ERRORS else _CLASSES.get(code, Error)
    return _remake(kind, message, id, fields, location, problem, remedy, notes, file)
