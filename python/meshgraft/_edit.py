"""Edits: inputs and steps that can be built, saved, loaded and run."""

from __future__ import annotations

import copy
import json
import os
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshgraft import _arrays, _core, _texts
from meshgraft._adapters import adapt
from meshgraft._calls import Progress, calling
from meshgraft._deform import deform_step, symmetry_spec
from meshgraft._docs_of import documented
from meshgraft._facts import Error
from meshgraft._merge import MergeKeywords, merge_step
from meshgraft._mesh import Mesh, write
from meshgraft._pose import pose_of
from meshgraft._records import CutKeywords, DeformKeywords, EditReport, MergePose, MergeShape, OverrideKeywords, RepairKeywords, SculptAction
from meshgraft._repair import cut_options
from meshgraft._texts import Direction

if sys.version_info >= (3, 11):
    from typing import Self, Unpack
else:
    from typing_extensions import Self, Unpack


@dataclass(frozen=True, kw_only=True, eq=False)
class EditResult:
    """What an edit made."""

    mesh: Mesh
    """the edit's output; without cuts and merges it has the topology and order of its input"""
    rest: NDArray[np.float64]
    """positions before the edit, or after the last cut or merge, (n, 3)"""
    report: EditReport
    kept: Mapping[str, Mesh]
    """the meshes that were asked for by `keep`, after the last step"""


@dataclass(frozen=True, kw_only=True, eq=False)
class MethodOutcome:
    """The result of an edit by one method, or the error with which it failed."""

    method: str
    result: EditResult | None
    failure: Error | None


class Edit:
    """Inputs and steps, in order; the same as an edit file (docs/edit-file.md).

        edit = mg.Edit()
        edit.input("octopus", mg.sample("octopus"))
        edit.deform("octopus", handles={"arm": mg.select.sphere((1.8, 0, 0.3), 0.4)}, ...)
        edit.save("edit.json")
        result = edit.run()

    Methods that add something return the edit. Everything is checked when the edit is run or saved.
    """

    def __init__(self, name: str = "", about: str = "") -> None:
        self._json: dict[str, Any] = {"format": "meshgraft-edit", "version": 2}
        if name:
            self._json["name"] = name
        if about:
            self._json["about"] = about
        self._json.update(inputs={}, steps=[])
        self._meshes: dict[str, Mesh] = {}
        self._folder = os.getcwd()  # paths are relative to it
        self._loaded: set[Path] = set()  # input files of the edit file that was loaded

    # Building.

    def input(self, name: str, mesh: Any = None, *, sample: str | None = None, resolution: int = 0,
              sha256: str | None = None, up: Direction | None = None, front: Direction | None = None) -> Self:
        """Adds a mesh by name: a mesh of any kind, the path of a file, or a built-in model (`sample`).

        It replaces an earlier one of the same name.

        `up`, `front`: how the model stands, as axes such as "z" and "-y" or as vectors; without them merge steps guess.
        """
        if (mesh is None) == (sample is None):
            raise ValueError("input: give a mesh, a path, or sample")
        if not isinstance(name, str):
            raise TypeError(f"name: expected a str, not {type(name).__name__}")
        if resolution and sample is None:
            raise ValueError("resolution: only a sample has one")
        if sha256 is not None and not isinstance(mesh, (str, os.PathLike)):
            raise ValueError("sha256: only a file has one")
        if not name or name.startswith(".") or "/" in name or "\\" in name:
            raise ValueError(f"name: '{name}' cannot name a file beside the edit")
        self._meshes.pop(name, None)
        if sample is not None:
            self._json["inputs"][name] = {"sample": sample, **({"resolution": resolution} if resolution else {})}
        elif isinstance(mesh, (str, os.PathLike)):
            self._json["inputs"][name] = {"file": self._in_folder(os.fspath(mesh)), **({"sha256": sha256} if sha256 else {})}
        else:
            self._meshes[name] = adapt(mesh, name).mesh
            self._json["inputs"][name] = {"file": f"{name}.ply"}
        if (up is None) != (front is None):
            raise ValueError("input: up and front go together")
        self._json["inputs"][name].update(_texts.orientation_spec(None if up is None else (up, front), "input"))
        return self

    def _in_folder(self, path: str) -> str:
        """Returns a path that is relative to the working directory, as the edit keeps it."""
        return path if os.path.isabs(path) or os.getcwd() == self._folder else os.path.relpath(path, self._folder)

    def selection(self, name: str, vertices: Any) -> Self:
        """Adds a vertex set that steps can name."""
        self._json.setdefault("selections", {})[name] = _texts.spec_of(vertices, name, None)
        return self

    def deform(self, mesh: str, *, handles: Mapping[str, Any] | None = None, poses: Mapping[str, Any] | None = None,
               region: Any = None, fixed: Any = None, targets: Mapping[int, ArrayLike] | None = None,
               transforms: Mapping[int, ArrayLike] | None = None, anchors: Any = None,
               features: Sequence[Any] | None = None, symmetry: Any = None,
               result: str | None = None, name: str | None = None, about: str | None = None, proxy: int | None = None,
               refine_boundary: int | Literal["auto"] | None = None, weld: bool | None = None,
               **settings: Unpack[DeformKeywords]) -> Self:
        """Adds a deform step on a mesh by name. The arguments are those of `meshgraft.deform`."""
        given = {**settings, "proxy": proxy, "refine_boundary": refine_boundary, "weld": weld}
        step = deform_step(mesh, None, region=region, fixed=fixed, handles=handles, poses=poses, targets=targets,
                           transforms=transforms, anchors=anchors, features=features, symmetry=symmetry, settings=given)
        return self._add(step, result, name, about)

    def merge(self, target: str, source: str, *, pairs: Sequence[tuple[Any, Any]] | None = None,
              matches: Sequence[tuple[Any, Any]] | None = None, at: Any = None, spin_deg: float | None = None,
              source_loop: Any = None, base_height: float | None = None, base_tilt_deg: float | None = None,
              base_tilt_axis: Any = None, pose: MergePose | None = None, shape: MergeShape | None = None,
              align: Sequence[tuple[Any, Any]] | None = None, mirror: Any = None,
              source_transform: ArrayLike | None = None, size: float | None = None, normal_angle_deg: float | None = None,
              fixed: Any = None, reach_rings: int | None = None, reach_length: float | None = None,
              features: Sequence[Any] | None = None, smooth_boundary: bool | None = None, fix_winding: bool | None = None,
              retry: bool | None = None, result: str | None = None, name: str | None = None, about: str | None = None,
              **settings: Unpack[MergeKeywords]) -> Self:
        """Adds a merge step; with `at`, a drop. The arguments are those of `meshgraft.merge` and `meshgraft.drop`."""
        step = merge_step(target, source, (None, None), dict(
            pairs=pairs, matches=matches, at=at, spin_deg=spin_deg, source_loop=source_loop, base_height=base_height,
            base_tilt_deg=base_tilt_deg, base_tilt_axis=base_tilt_axis, pose=pose, shape=shape,
            align=align, mirror=mirror, source_transform=source_transform, size=size, normal_angle_deg=normal_angle_deg,
            fixed=fixed, reach_rings=reach_rings, reach_length=reach_length, features=features,
            smooth_boundary=smooth_boundary, fix_winding=fix_winding, retry=retry, settings=settings))
        return self._add(step, result, name, about)

    def cut(self, mesh: str, *, plane: Any = None, loop: ArrayLike | None = None, result: str | None = None,
            name: str | None = None, about: str | None = None, **options: Unpack[CutKeywords]) -> Self:
        """Adds a cut step on a mesh by name. The arguments are those of `meshgraft.cut`."""
        if (plane is None) == (loop is None):
            raise ValueError("cut: give either plane or loop")
        step: dict[str, Any] = {"kind": "cut", "mesh": mesh, **_cut_fields(options)}
        if plane is not None:
            step["plane"] = _arrays.plane(plane, "plane")
        else:
            step["loop"] = _arrays.indices(cast(ArrayLike, loop), "loop", None).tolist()
        return self._add(step, result, name, about)

    def repair(self, mesh: str, *, result: str | None = None, name: str | None = None, about: str | None = None,
               **options: Unpack[RepairKeywords]) -> Self:
        """Adds a repair step on a mesh by name. The options are those of `meshgraft.repair`."""
        return self._add({"kind": "repair", "mesh": mesh, **_texts.without_none(**options)}, result, name, about)

    def sculpt(self, mesh: str, action: SculptAction, region: Any, *, strength: float | None = None,
               height: float | None = None, reach: float | None = None, symmetry: Any = None, result: str | None = None,
               name: str | None = None, about: str | None = None) -> Self:
        """Adds a step that smooths, inflates or flattens a region. `strength`, from 0 to 1, is for "smooth" and "flatten",
        `height`, of the middle in model units, for "inflate". With `reach`, for "inflate" and "flatten", the surface
        around the region follows within this length along edges (model units; 0: a hard edge); without it the movement
        fades inside the region. With `symmetry`, as of `deform`, the mirror image of the region is shaped, too."""
        step = {"kind": "sculpt", "mesh": mesh, "action": action, "region": _texts.spec_of(region, "region", None),
                **_texts.without_none(strength=strength, height=height, reach=reach,
                                      symmetry=None if symmetry is None else symmetry_spec(symmetry))}
        return self._add(step, result, name, about)

    def transform(self, mesh: str, pose: Any, *, result: str | None = None, name: str | None = None,
                  about: str | None = None) -> Self:
        """Adds a step that moves, turns and scales a whole mesh. `pose`: a Pose or a 4x4 matrix; its pivot is the origin
        unless it has one."""
        step = {"kind": "transform", "mesh": mesh, "pose": pose_of(pose, "pose")._spec}
        return self._add(step, result, name, about)

    def output(self, name: str) -> Self:
        """Names the mesh that is the result; by default that of the last step."""
        self._json["output"] = name
        return self

    def _add(self, step: dict[str, Any], result: str | None, name: str | None, about: str | None) -> Self:
        self._json["steps"].append({**step, **_texts.without_none(result=result, name=name, about=about)})
        return self

    # Text and files.

    @property
    def steps(self) -> tuple[Mapping[str, Any], ...]:
        """The steps, in the form of the edit file."""
        return tuple(_texts.Writer(aside=False).plain(self._json["steps"]))

    def to_json(self) -> str:
        """Returns the text of the edit file, checked. Meshes in memory appear as files beside it."""
        return self._text(saved=False)

    def _text(self, saved: bool) -> str:
        text = _texts.Writer(aside=False).text(self._json)
        return cast(str, _core.normalised_edit((text, "edit", self._folder, {}, {}), saved))

    def save(self, path: str | os.PathLike[str], *, overwrite: bool | None = None) -> list[Path]:
        """Writes the edit file, and meshes in memory beside it as NAME.ply. Returns the files that were written.

        By default, an edit file that was saved is replaced, with the meshes that were saved beside it; any other file is
        not. True replaces files of any kind, False none. Input files of the edit are never replaced.
        """
        if overwrite is not None and not isinstance(overwrite, bool):
            raise TypeError(f"overwrite: expected True, False or None, not {overwrite!r}")
        file = Path(_arrays.path(path, "path"))
        if file.is_dir():
            raise IsADirectoryError(f"{file} is a folder; give the path of the edit file")
        text = self._text(saved=True)
        beside = {name: file.parent / self._json["inputs"][name]["file"] for name in self._meshes}
        written = [file, *beside.values()]
        inputs = {self._resolved(entry["file"]) for name, entry in self._json["inputs"].items()
                  if "file" in entry and name not in self._meshes}
        for where in written:
            if where.resolve() in inputs or (where is not file and where.resolve() == file.resolve()):
                raise ValueError(f"path: {where} is the file of a mesh of the edit")
        own = _saved_with(file) - self._loaded if overwrite is None else set()
        for where in written:
            if where.exists() and not overwrite and where.resolve() not in own:
                raise FileExistsError(f"{where} exists" + (", and was not saved with this edit" if overwrite is None else "")
                                      + ". Give overwrite=True to replace it, or another name.")
        for name, where in beside.items():
            write(self._meshes[name], where)
        folder = file.parent.resolve()
        moved = with_files(json.loads(text), self._meshes, lambda path: os.path.relpath(self._resolved(path), folder))
        file.write_text(json.dumps(moved, ensure_ascii=False, indent=2) + "\n", encoding="utf-8")
        return written

    def _resolved(self, path: str) -> Path:
        """Returns the place of a file that the edit names, without links to folders."""
        place = Path(self._folder) / path
        return place.parent.resolve() / place.name

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Edit:
        """Reads an edit file of version 1 or 2."""
        edit = cls()
        edit._json = json.loads(_core.read_edit(_arrays.path(path, "path")))
        edit._folder = os.path.dirname(os.path.abspath(path))
        edit._loaded = {edit._resolved(entry["file"]) for entry in edit._json["inputs"].values() if "file" in entry}
        return edit

    def _copy(self) -> Edit:
        """Returns an edit that changes by itself."""
        edit = Edit()
        edit._json, edit._meshes, edit._folder = copy.deepcopy(self._json), dict(self._meshes), self._folder
        edit._loaded = set(self._loaded)
        return edit

    __copy__ = _copy

    # Running.

    def _given(self) -> tuple[Any, ...]:
        return _texts.given(self._json, self._meshes, folder=self._folder)

    @documented("run_edit")
    def run(self, *, keep: Sequence[str] = (), strict: bool = False, estimate_condition: bool = False,
            memory: int | None = None, threads: int = 0, progress: Progress = None,
            **overrides: Unpack[OverrideKeywords]) -> EditResult:
        """Runs the edit; writes nothing. Overrides replace the settings of every step."""
        options = {"estimate_condition": estimate_condition, "strict": strict, "keep": list(keep), "memory": memory}
        with calling(threads, None, progress) as call:
            return _result(_core.run_edit(self._given(), dict(overrides), options, call))

    def compare(self, methods: Sequence[str] = (), *, threads: int = 0,
                progress: Progress = None) -> tuple[MethodOutcome, ...]:
        """Runs the edit once by each method: those named, or all (`meshgraft.methods()`, and "as-published")."""
        if isinstance(methods, str):
            methods = [methods]
        with calling(threads, None, progress) as call:
            outcomes = _core.compare(self._given(), list(methods), call)
        return tuple(MethodOutcome(method=method, result=None if result is None else _result(result), failure=failure)
                     for method, result, failure in outcomes)

    def __eq__(self, other: object) -> bool:
        return (isinstance(other, Edit) and self._meshes.keys() == other._meshes.keys()
                and self._comparable() == other._comparable()
                and all(_is_same(mesh, other._meshes[name]) for name, mesh in self._meshes.items()))

    def _comparable(self) -> dict[str, Any]:
        edit = json.loads(self.to_json()) if self._json["steps"] else _texts.Writer(aside=False).plain(self._json)
        return {**with_files(edit, self._meshes, lambda path: str(self._resolved(path))), "made_with": None}

    __hash__ = None  # type: ignore[assignment]  # edits change

    def __repr__(self) -> str:
        kinds = ", ".join(step["kind"] for step in self._json["steps"])
        return f"<meshgraft.Edit of {', '.join(self._json['inputs']) or 'nothing'}: {kinds or 'no steps'}>"

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_json": _texts.Writer(aside=False).plain(self._json)}


def _cut_fields(options: CutKeywords) -> dict[str, Any]:
    """The fields of a cut step, from the keywords of `meshgraft.cut`."""
    given = cut_options(options)
    pins = {key.removeprefix("pin_"): given.pop(key) for key in list(given) if key.startswith("pin_")}
    if given.get("cap") == "pins":
        given.pop("cap")
        return {**given, "pins": pins}
    return given


def with_files(edit: dict[str, Any], but: Collection[str], change: Callable[[str], str]) -> dict[str, Any]:
    """Returns an edit with other paths of files, except those of the inputs `but`."""

    def changed(value: Any) -> Any:
        if isinstance(value, list):
            return [changed(entry) for entry in value]
        if isinstance(value, dict):
            return {key: change(entry) if key in ("file", "sel", "def") and isinstance(entry, str) else changed(entry)
                    for key, entry in value.items()}
        return value

    # Inputs and selections have names of the user's, which may be those of fields.
    inputs = {name: entry if name in but else changed(entry) for name, entry in edit["inputs"].items()}
    selections = {name: changed(entry) for name, entry in edit.get("selections", {}).items()}
    return {**edit, "inputs": inputs, **({"selections": selections} if "selections" in edit else {}),
            "steps": changed(edit["steps"])}


def _saved_with(file: Path) -> set[Path]:
    """Returns an edit file that was saved, and the meshes beside it that it names; nothing for any other file."""
    try:
        edit = json.loads(file.read_text(encoding="utf-8"))
        if edit["format"] != "meshgraft-edit" or "made_with" not in edit:
            return set()
        meshes = {name: entry.get("file") for name, entry in edit["inputs"].items()}
    except (OSError, ValueError, LookupError, TypeError, AttributeError):
        return set()
    folder = file.parent.resolve()
    return {file.resolve(), *(folder / path for name, path in meshes.items() if path == f"{name}.ply")}


def _is_same(mesh: Mesh, other: Mesh | None) -> bool:
    return other is mesh or (
        other is not None and np.array_equal(mesh.vertices, other.vertices)
        and all(map(np.array_equal, mesh._core.polygons(), other._core.polygons())))


def _result(parts: Any) -> EditResult:
    mesh, rest, report, kept = parts
    return EditResult(mesh=mesh, rest=rest, report=report, kept=kept)


def compare(edit: Edit | str | os.PathLike[str], methods: Sequence[str] = (), *, threads: int = 0,
            progress: Progress = None) -> tuple[MethodOutcome, ...]:
    """Runs an edit, or an edit file, once by each method, to compare them."""
    own = edit if isinstance(edit, Edit) else Edit.load(edit)
    return own.compare(methods, threads=threads, progress=progress)


def methods() -> tuple[str, ...]:
    """Returns the names of this library's methods, then of the published ones."""
    return tuple(_core.methods())
