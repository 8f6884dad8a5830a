"""The editor on a mesh of this process: a program of its own, and what it hands back."""

from __future__ import annotations

import atexit
import html
import os
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import threading
import weakref
import webbrowser
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Generic, Literal, TypeAlias, TypeVar, cast

from meshgraft import _arrays, _core
from meshgraft._adapters import adapt
from meshgraft._edit import Edit, with_files
from meshgraft._facts import Error, InputError
from meshgraft._mesh import Mesh, read, sample
from meshgraft._notebook import notebook

M = TypeVar("M")
EditingState: TypeAlias = Literal["open", "done", "closed", "interrupted"]

_open: weakref.WeakSet[Editing[Any]] = weakref.WeakSet()
_shown: set[Editing[Any]] = set()  # open ones in a tab or a cell, which stay although no variable holds them


class Editing(Generic[M]):
    """An editor that is open on a mesh, or was; `meshgraft.edit` makes it.

    `mesh` and `edit` wait until the user is done. The result is the same however the editor ends: all that was done
    in it. Ctrl-C while one waits ends the editor.
    """

    note: str = ""
    """What is left out of the result, and why; empty otherwise."""

    def __init__(self, given: Any, edit: Edit | None, parts: Mapping[str, Any], options: Mapping[str, Any]) -> None:
        self._folder = Path(tempfile.mkdtemp(prefix="meshgraft-edit-")).resolve()
        self._process: subprocess.Popen[str] | None = None
        self._owner = os.getpid()
        self._clean_up = weakref.finalize(self, _remove, self._folder, self._owner)
        self._clean_up.atexit = False  # _close_all does it then
        self._lock = threading.RLock()  # several threads may wait
        try:
            self._begin(given, edit, parts, options)
        except BaseException:
            self._end()
            raise
        self._state: EditingState = "open"
        self._outcome: tuple[Any, Edit] | None = None
        _open.add(self)

    def _begin(self, given: Any, edit: Edit | None, parts: Mapping[str, Any], options: Mapping[str, Any]) -> None:
        is_file = isinstance(given, (str, os.PathLike))
        if is_file and not Path(given).is_file():
            raise FileNotFoundError(f"mesh: there is no file {os.fspath(given)!r}")
        name = cast(str, options["name"] or (Path(given).stem if is_file else "mesh"))
        if name in parts:
            raise ValueError(f"parts: '{name}' is the name of the mesh itself; choose another, or give name=")
        if edit is None:
            start = Edit().input(name, given)
        else:
            start = edit._copy()
            name = next(iter(start._json["inputs"]), name)
            if given is not None:
                start.input(name, given)
        for part, mesh in parts.items():
            start.input(part, mesh)
        self._start, self._name = start, name
        self._result_file.parent.mkdir()
        self._adapted = None if given is None or is_file else adapt(given)
        file, folders = self._files()
        command = [_program(), "edit", "--no-browser", "--port", str(options["port"]), "--result", str(self._result_file),
                   *(f"--folder={folder}" for folder in [*folders, *options["folders"]]),
                   *(f"--frame-origin={origin}" for origin in options["origins"]), str(file)]
        with open(self._folder / "messages", "w", encoding="utf-8") as messages:
            # In a session of its own, because Ctrl-C of the terminal is this process's.
            self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=messages,
                                             text=True, start_new_session=True)
        weakref.finalize(self, cast(Any, self._process.stdin).close)  # Python keeps processes that nobody asks for
        self.url = cast(Any, self._process.stdout).readline().strip()
        """address of the page, with its token"""
        if not self.url:
            raise RuntimeError("the editor did not start: " +
                               (self._folder / "messages").read_text(encoding="utf-8").strip())

    def _files(self) -> tuple[Path, list[str]]:
        """Writes the edit that the editor opens. Returns its file, and the folders of meshes in other files."""
        edit = self._start._copy()
        if not edit._json["steps"]:
            # An edit file needs a step. This one moves nothing.
            edit._json["steps"] = [{"kind": "deform", "mesh": self._name, "region": {"indices": []}}]
        folders: list[str] = []

        def note_folder(file: str) -> str:
            folders.append(str((Path(edit._folder) / file).resolve().parent))
            return file

        with_files(edit._json, edit._meshes, note_folder)
        return edit.save(self._folder / f"{self._name}.json")[0], folders

    @property
    def _result_file(self) -> Path:
        return self._folder / "result/edit.json"

    @property
    def state(self) -> EditingState:
        """"open"; then "done" (by the button), "closed" (the page was closed) or "interrupted" (Ctrl-C, or `close`)."""
        if os.getpid() == self._owner and self._state == "open" and cast(Any, self._process).poll() is not None:
            self._note_end()
        return self._state

    def wait(self, timeout: float | None = None) -> Editing[M]:
        """Waits until the editor has ended. Raises TimeoutError after `timeout` seconds. Ctrl-C ends the editor."""
        if self.state == "open":
            self._require_owner()
            try:
                cast(Any, self._process).wait(timeout)
            except subprocess.TimeoutExpired:
                raise TimeoutError(f"the editor is still open after {timeout} s") from None
            except KeyboardInterrupt:
                self.close()
            else:
                self._note_end()
        return self

    def close(self) -> None:
        """Ends the editor. What was done in it until now is the result."""
        with self._lock:
            if self.state != "open":
                return
            self._require_owner()
            process = cast(Any, self._process)
            process.stdin.close()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
            self._note_end()

    def _require_owner(self) -> None:
        if os.getpid() != self._owner:
            raise RuntimeError("the editor belongs to the process that this one was forked from")

    @property
    def mesh(self) -> M:
        """The edited mesh, in the type that was given. Waits until the editor has ended, and then runs the edit."""
        self.wait()
        return cast(M, self._finished()[0])

    @property
    def edit(self) -> Edit:
        """The edit; `edit.run()` makes the same mesh, to the byte. Waits until the editor has ended.

        Where the edit cannot run, as for want of memory or of a file, it is the edit as it is.
        """
        self.wait()
        try:
            return self._finished()[1]
        except Error:
            return self._last._copy()

    @property
    def edit_so_far(self) -> Edit:
        """The edit as it is now, accepted or not. Waits for nothing."""
        return self.edit if self.state != "open" else self._read()

    def _finished(self) -> tuple[Any, Edit]:
        with self._lock:
            if self._outcome is None:
                self._outcome = self._run(self._last._copy())
            return self._outcome

    def _run(self, edit: Edit) -> tuple[Any, Edit]:
        """Runs the edit, without a last step that is not complete: a graft, or a region without handles."""
        steps = edit._json["steps"]
        while steps:
            try:
                result = edit.run().mesh
            except InputError as error:
                last = steps[-1]
                if f"steps[{len(steps) - 1}]" not in error.location or last.get("handles") or last["kind"] in ("cut", "repair", "sculpt", "transform"):
                    raise
                if last["kind"] == "merge":
                    self.note = f"The last graft was not complete, and is left out: {error}"
                steps.pop()
                continue
            return self._in_given_type(edit, result), edit
        return self._given_mesh(), edit

    def _given_mesh(self) -> Any:
        if self._adapted is not None:
            return self._adapted.given
        edit = self._start
        entry = edit._json["inputs"][self._name]
        if "sample" in entry:
            return sample(entry["sample"], entry.get("resolution", 0))
        return edit._meshes.get(self._name) or read(Path(edit._folder) / entry["file"])

    def _in_given_type(self, edit: Edit, mesh: Mesh) -> Any:
        if self._adapted is None or isinstance(self._adapted.given, Mesh):
            return mesh
        own = self._adapted.mesh
        deforms_it = all(step["kind"] == "deform" and step["mesh"] == self._name for step in edit._json["steps"])
        return self._adapted.at(mesh.vertices.copy()) if deforms_it and len(own) == len(mesh) else self._adapted.like(mesh)

    def _read(self) -> Edit:
        """Reads what the editor has written; before the first change, what it began with."""
        if not self._result_file.exists():
            return self._start._copy()
        edit = Edit.load(self._result_file)
        edit._folder, folder = "", self._result_file.parent
        edit._json = with_files(edit._json, (), lambda path: str((folder / path).resolve()))
        for name, entry in edit._json["inputs"].items():
            if "file" not in entry:
                continue
            file = Path(entry["file"])
            known = self._start._meshes.get(name)
            if known is not None and file == self._folder / f"{name}.ply":
                edit.input(name, known)
            elif self._folder in file.parents:  # dropped on the page; the folder will be deleted
                edit.input(name, read(file))
        return edit

    def _note_end(self) -> None:
        with self._lock:
            if self._state != "open":
                return
            said = cast(Any, self._process).stdout.read().split()
            self._last = self._read()
            self._state = said[-1] if said and said[-1] in ("done", "closed") else "interrupted"
            self._end()
            _shown.discard(self)

    def _end(self) -> None:
        """Ends the program, if it runs, and deletes its folder."""
        if self._process is not None:
            for stream in (self._process.stdin, self._process.stdout):
                if stream is not None:
                    stream.close()
            if self._process.poll() is None:
                self._process.terminate()
                self._process.wait()
        self._clean_up()

    def __enter__(self) -> Editing[M]:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        where = f" at {self.url}" if self.state == "open" else ""
        return f"<meshgraft.Editing: {self.state}{where}>"


def edit(mesh: M | None = None, edit: Edit | None = None, *, parts: Mapping[str, Any] | None = None, name: str | None = None,
         show: Literal["cell", "tab", "none"] | None = None, wait: bool | None = None,
         folders: Sequence[str | os.PathLike[str]] = (), origin: str | Sequence[str] | None = None,
         proxy: bool | None = None, port: int = 0) -> Editing[M]:
    """Opens the editor on a mesh, and returns what was done in it.

    In a terminal or a script, it opens a tab of the browser and waits until the button Done, the closing of the tab or
    Ctrl-C. In a notebook, the editor is in the cell and the call returns at once; `mesh` and `edit` of what it returns
    wait. The editor is the program `meshgraft edit`, for this machine's user alone.

    `mesh`: a mesh of any kind, or the path of a file. `edit`: an Edit to go on with; `mesh` replaces its first input.
    `parts`: further meshes by name, to graft. `name`: that of the mesh in the edit, by default "mesh" or the stem of
    the file. `show`: in a "cell", a "tab", or "none" to open `url` by other means. `folders`: folders of this machine in which the editor may read and write.

    For notebooks: `origin` is the address of the notebook's server as the browser sees it (http://HOST:PORT; found by
    itself where the server runs on this machine), and the only one whose pages may frame the editor. `proxy`: reach the
    editor through jupyter-server-proxy, by default if it is installed. `port`: 0 for one that is free.
    """
    if mesh is None and edit is None:
        raise TypeError("edit: give a mesh, an Edit, or both")
    here = notebook(origin, proxy) if show in (None, "cell") else None
    if show not in (None, "cell", "tab", "none"):
        raise ValueError(f"show: '{show}' is none of 'cell', 'tab', 'none'")
    if show == "cell" and here is None:
        raise ValueError("show: this is no notebook")
    if isinstance(folders, (str, os.PathLike)):
        folders = [folders]
    options = {"name": name, "folders": [_arrays.path(folder, "folders") for folder in folders], "port": port,
               "origins": here.origins if here else [] if origin is None else [origin] if isinstance(origin, str) else origin}
    editing: Editing[M] = Editing(mesh, edit, parts or {}, options)
    try:
        if here is not None or show != "none":
            _shown.add(editing)
        if here is not None:
            here.show(editing.url)
        elif show != "none":
            _open_tab(editing)
        if wait if wait is not None else here is None and show != "none":
            editing.wait()
    except KeyboardInterrupt:
        editing.close()
    return editing


def _open_tab(editing: Editing[Any]) -> None:
    # A file that leads there and that only this user may read, because everybody may read arguments of programs.
    page = editing._folder / "open.html"
    url = html.escape(editing.url)
    page.write_text(f'<!doctype html><meta charset="utf-8"><meta http-equiv="refresh" content="0; url={url}">'
                    f'<a href="{url}">Open the editor</a>\n', encoding="utf-8")
    print(f"The editor is at {editing.url}\nCtrl-C ends it.", file=sys.stderr)
    webbrowser.open(page.as_uri())


def _program() -> str:
    """Returns the path of the program: $MESHGRAFT_PROGRAM, the package's own, that of this environment, or on PATH."""
    named = os.environ.get("MESHGRAFT_PROGRAM")
    beside = [Path(_core.__file__).parent / "bin/meshgraft", Path(sysconfig.get_path("scripts")) / "meshgraft"]
    found = named or next((str(path) for path in beside if path.exists()), None) or shutil.which("meshgraft")
    if not found:
        raise FileNotFoundError("the program meshgraft was not found; $MESHGRAFT_PROGRAM may name it")
    return found


def _remove(folder: Path, owner: int) -> None:
    if os.getpid() == owner:  # not in a fork
        shutil.rmtree(folder, ignore_errors=True)


@atexit.register
def _close_all() -> None:
    for editing in list(_open):
        if editing._owner == os.getpid():  # not in a fork
            editing.close()
