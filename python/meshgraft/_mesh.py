"""Meshes: positions, polygons and attributes."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshgraft import _arrays, _core
from meshgraft._calls import DEFAULT, Progress, calling
from meshgraft._docs_of import documented
from meshgraft._facts import Note
from meshgraft._records import Domain, SampleInfo, TopologySummary, WriteResult

FloatArray = NDArray[np.float64]
IndexArray = NDArray[np.int32]


class Attributes(Mapping[str, NDArray[Any]]):
    """The attributes of a mesh's vertices, faces or corners, by name.

    An attribute of one component has the shape (n,), others (n, components). It has the type that it has in its file;
    with missing values it is an array of float64 that has NaN there.
    """

    def __init__(self, mesh: Mesh, domain: Domain) -> None:
        self._mesh, self._domain = mesh, domain

    def _described(self) -> dict[str, tuple[str, int]]:
        return {name: (kind, components) for domain, name, kind, components, *_ in self._mesh._core.attributes()
                if domain == self._domain}

    def __getitem__(self, name: str) -> NDArray[Any]:
        kind, components = self._described()[name]
        values: FloatArray = self._mesh._core.attribute_values(self._domain, name)
        if kind != "float64" and (kind == "float32" or not np.isnan(values).any()):
            typed = values.astype(kind)
            typed.flags.writeable = False
        else:
            typed = values
        return typed[:, 0] if components == 1 else typed

    def __iter__(self) -> Iterator[str]:
        return iter(self._described())

    def __len__(self) -> int:
        return len(self._described())

    def labels(self, name: str) -> tuple[str, ...]:
        """Returns the names of the values of a group or material: that of value k at k. Others have none."""
        for domain, other, _, _, _, labels, _ in self._mesh._core.attributes():
            if (domain, other) == (self._domain, name):
                return cast("tuple[str, ...]", labels)
        raise KeyError(name)

    def __repr__(self) -> str:
        return f"<attributes of {self._domain}: {', '.join(self) or 'none'}>"


class Mesh:
    """A mesh of triangles or polygons with attributes. Nothing changes it; functions return new ones.

    `vertices`: (n, 3) numbers, model units. `faces`: (m, 3) vertex indices, counter-clockwise seen from outside, or a
    list of polygons. The mesh copies both once. Raises ValueError for a coordinate that is not finite and for an index
    out of range, unless `allow_defects`: `check` and `repair` are for those.
    """

    __slots__ = ("_core", "__weakref__")
    _core: Any

    def __init__(self, vertices: ArrayLike, faces: Any, *, allow_defects: bool = False) -> None:
        positions = _arrays.points(vertices, "vertices", finite=not allow_defects)
        limit = None if allow_defects else len(positions)
        if _is_ragged(faces):
            offsets = np.zeros(len(faces) + 1, np.int32)
            np.cumsum([len(face) for face in faces], out=offsets[1:])
            corners = (np.concatenate([np.asarray(face) for face in faces]) if len(faces) else np.zeros(0, np.int32))
            self._core = _core.mesh_of_polygons(positions, offsets, _corners(corners, offsets, limit))
        elif np.ndim(faces) == 2 and np.shape(faces)[1] != 3 and np.size(faces):
            array = np.asarray(faces)
            count = array.shape[0]
            flat = _corners(array.reshape(-1), np.arange(0, array.size + 1, array.shape[1]), limit)
            self._core = _core.mesh_of_polygons(
                positions, (np.arange(count + 1) * array.shape[1]).astype(np.int32), flat)
        else:
            self._core = _core.mesh_of_triangles(positions, _arrays.triangles(faces, "faces", limit))

    @classmethod
    def _wrap(cls, core: Any) -> Mesh:
        mesh = cls.__new__(cls)
        mesh._core = core
        return mesh

    @property
    def vertices(self) -> FloatArray:
        """Positions, (n, 3), model units: a view that cannot be written to."""
        return cast(FloatArray, self._core.vertices())

    @property
    def faces(self) -> IndexArray:
        """Triangles, (m, 3): a view that cannot be written to. Raises ValueError for a mesh with other polygons."""
        triangles = self._core.triangles()
        if triangles is None:
            raise ValueError("not all faces are triangles: take mesh.polygons, or mesh.triangulated().faces")
        return cast(IndexArray, triangles)

    @property
    def polygons(self) -> list[IndexArray]:
        """Faces of any number of corners, each an array of vertex indices."""
        offsets, corners = self._core.polygons()
        return np.split(corners, offsets[1:-1]) if len(offsets) > 1 else []

    @property
    def is_triangular(self) -> bool:
        """Whether all faces are triangles."""
        return bool(self._core.triangles() is not None)

    @property
    def vertex(self) -> Attributes:
        """Attributes of vertices: mesh.vertex["colour"]."""
        return Attributes(self, "vertex")

    @property
    def face(self) -> Attributes:
        """Attributes of faces: mesh.face["group"]."""
        return Attributes(self, "face")

    @property
    def corner(self) -> Attributes:
        """Attributes of corners, face after face: mesh.corner["uv"]."""
        return Attributes(self, "corner")

    @property
    def bounds(self) -> FloatArray:
        """Smallest and largest coordinates, (2, 3); NaN without a finite vertex."""
        return cast(FloatArray, self._core.bounds())

    @property
    def unit(self) -> str:
        """Unit of length of the file behind the mesh, such as "millimeter"; empty where it has none."""
        return cast(str, self._core.unit())

    @property
    def notes(self) -> tuple[Note, ...]:
        """Notes on the files behind the mesh."""
        return cast("tuple[Note, ...]", self._core.notes())

    def with_vertices(self, vertices: ArrayLike) -> Mesh:
        """Returns the mesh at other positions, (n, 3). Normals and tangents turn with the surface."""
        positions = _arrays.points(vertices, "vertices", rows=len(self))
        return Mesh._wrap(self._core.with_vertices(positions))

    def with_attribute(self, domain: Domain, name: str, values: ArrayLike, *, interpolation: str = "linear",
                       labels: tuple[str, ...] = ()) -> Mesh:
        """Returns the mesh with an attribute, of shape (n,) or (n, components), added or replaced.

        Functions that make new elements give them values by `interpolation`: "linear", "direction" (normalised) or
        "nearest". The mesh no longer belongs to a file.
        """
        array = np.asarray(values)
        if array.dtype.kind not in "iufb":
            raise ValueError(f"values: expected numbers, not an array of {array.dtype}")
        offsets, corners = self._core.polygons()
        count = {"vertex": len(self), "face": len(offsets) - 1, "corner": len(corners)}.get(domain)
        if count is None:
            raise ValueError(f"domain: '{domain}' is none of 'vertex', 'face', 'corner'")
        if array.ndim not in (1, 2) or len(array) != count or array.shape[-1] == 0 < count:
            raise ValueError(f"values: expected shape ({count},) or ({count}, k), not {array.shape}")
        kind = array.dtype.name if array.dtype.name in _SCALARS else "float64" if array.dtype.kind == "f" else "int32"
        if kind == "int32" and array.size and not -2**31 <= array.min() <= array.max() < 2**31:
            if max(abs(int(array.min())), abs(int(array.max()))) > 2**53:
                raise ValueError("values: integers beyond 2^53 cannot be kept exactly")
            kind = "float64"
        flat = np.ascontiguousarray(array.reshape(count, -1), dtype=np.float64)
        return Mesh._wrap(self._core.with_attribute(domain, name, flat, kind, interpolation, list(labels), []))

    def without_attribute(self, domain: Domain, name: str) -> Mesh:
        """Returns the mesh without an attribute. The mesh no longer belongs to a file."""
        if name not in Attributes(self, domain):
            raise KeyError(name)
        return Mesh._wrap(self._core.without_attribute(domain, name))

    @documented("triangulate")
    def triangulated(self) -> Mesh:
        """Returns a mesh of the triangles alone, without attributes."""
        triangles, _ = self._core.triangulated(DEFAULT)
        return Mesh._wrap(_core.mesh_of_triangles(self.vertices, triangles))

    def topology(self) -> TopologySummary:
        """Returns counts of elements, components and loops, and whether the surface is closed and manifold."""
        return cast(TopologySummary, self._core.topology(DEFAULT))

    @documented("boundary_loops")
    def boundary_loops(self) -> tuple[IndexArray, ...]:
        """Returns the boundary loops, each an array of vertex indices."""
        return cast("tuple[IndexArray, ...]", self._core.boundary_loops(DEFAULT))

    @documented("connected_components")
    def components(self) -> IndexArray:
        """Returns the connected component of each vertex, (n,)."""
        return cast(IndexArray, self._core.components(DEFAULT))

    @documented("vertex_normals")
    def vertex_normals(self) -> FloatArray:
        """Returns unit normals of the vertices, (n, 3)."""
        return cast(FloatArray, self._core.vertex_normals(DEFAULT))

    def rings(self) -> list[IndexArray]:
        """Returns for each vertex those that share an edge with it, ascending."""
        offsets, values = self._core.rings(DEFAULT)
        return np.split(values, offsets[1:-1]) if len(self) else []

    def __len__(self) -> int:
        return cast(int, self._core.vertex_count)

    def __repr__(self) -> str:
        return f"<meshgraft.Mesh: {len(self):,} vertices, {self._core.face_count:,} faces>"

    def _repr_png_(self) -> bytes | None:
        from meshgraft._facts import UsageError
        from meshgraft._picture import picture

        try:
            return picture(self, width=480, height=360, occlusion_rays=4)._repr_png_()
        except UsageError:  # a build without pictures
            return None

    def __reduce__(self) -> tuple[object, ...]:
        offsets, corners = self._core.polygons()
        attributes = [(*description, self._core.attribute_values(*description[:2]).copy())
                      for description in self._core.attributes()]
        return _remake, (self.vertices.copy(), offsets.copy(), corners.copy(), attributes)

    def __copy__(self) -> Mesh:
        return self

    def __deepcopy__(self, _: object) -> Mesh:
        return self


_SCALARS = ("int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64")


def _is_ragged(faces: Any) -> bool:
    if isinstance(faces, np.ndarray):
        return bool(faces.dtype == object)
    if not isinstance(faces, (list, tuple)) or not faces:
        return False
    first = np.size(faces[0])
    return any(np.size(face) != first for face in faces)


def _corners(flat: NDArray[Any], offsets: NDArray[Any], limit: int | None) -> IndexArray:
    """Returns corners of polygons as int32; an error names the face."""
    small = np.flatnonzero(np.diff(offsets) < 3)
    if len(small) and limit is not None:
        raise ValueError(f"faces[{small[0]}]: expected three or more corners")
    try:
        return _arrays.indices(flat, "faces", limit) if flat.dtype.kind != "b" else _arrays.triangles(flat, "faces", 0)
    except ValueError:
        top = np.iinfo(np.int32).max if limit is None else limit - 1
        bad = np.flatnonzero((flat < 0) | (flat > top))
        if not len(bad):
            raise
        face = int(np.searchsorted(offsets, bad[0], side="right")) - 1
        many = "" if limit is None else f", and there are {limit} vertices"
        raise ValueError(f"faces[{face}][{int(bad[0] - offsets[face])}] is {flat[bad[0]]}{many}") from None


def _remake(vertices: FloatArray, offsets: IndexArray, corners: IndexArray, attributes: list[Any]) -> Mesh:
    core = _core.mesh_of_polygons(vertices, offsets, corners)
    for domain, name, kind, _, interpolation, labels, source_names, values in attributes:
        core = core.with_attribute(domain, name, values, kind, interpolation, list(labels), list(source_names))
    return Mesh._wrap(core)


@documented("read_mesh")
def read(path: str | os.PathLike[str], *, threads: int = 0, memory: int | None = None,
         progress: Progress = None) -> Mesh:
    """Reads a mesh from a PLY, OBJ, OFF, STL, glTF or 3MF file. `memory`: the most bytes that it may take."""
    with calling(threads, memory, progress) as call:
        return Mesh._wrap(_core.read(_arrays.path(path, "path"), call))


@documented("write_mesh")
def write(mesh: Any, path: str | os.PathLike[str], *, overwrite: bool = True, morph_target: str | None = None,
          rest: ArrayLike | None = None, progress: Progress = None) -> WriteResult:
    """Writes a mesh in the format of the path's extension.

    `morph_target`: for glTF, the name of a morph target that has the mesh's positions, while the file's own are `rest`,
    (n, 3).
    """
    from meshgraft._adapters import adapt

    own = adapt(mesh, "mesh", allow_defects=True).mesh
    positions = None if rest is None else _arrays.points(rest, "rest", rows=len(own))
    if (morph_target is None) != (positions is None):
        raise ValueError("morph_target and rest go together")
    with calling(progress=progress) as call:
        return cast(WriteResult, _core.write(own._core, _arrays.path(path, "path"), overwrite, morph_target, positions, call))


@documented("make_sample")
def sample(name: str, resolution: int = 0) -> Mesh:
    """Returns a built-in model of about resolution² vertices; 0: its default."""
    if not isinstance(name, str):
        raise TypeError(f"name: expected the name of a built-in model, not {type(name).__name__}")
    return cast(Mesh, _core.sample(name, _arrays.whole(resolution, "resolution", 2**31 - 1), DEFAULT))


def samples() -> tuple[SampleInfo, ...]:
    """Returns the built-in models."""
    return cast("tuple[SampleInfo, ...]", _core.samples())
