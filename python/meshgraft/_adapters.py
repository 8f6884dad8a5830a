"""Meshes of other libraries: what goes in comes out.

Libraries are recognised by the module of their classes, so that none of them need be installed.
"""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshgraft import _arrays
from meshgraft._mesh import Mesh

FloatArray = NDArray[np.float64]


class Adapted:
    """A mesh that was given, as the package's own, and the way back."""

    def __init__(self, mesh: Mesh, given: Any) -> None:
        self.mesh, self.given = mesh, given

    def at(self, vertices: FloatArray) -> Any:
        """Returns what was given, with its vertices elsewhere."""
        return self.mesh.with_vertices(vertices)

    def like(self, mesh: Mesh) -> Any:
        """Returns another mesh in the type of the one that was given."""
        return mesh


class _Arrays(Adapted):
    """A tuple (vertices, faces)."""

    def at(self, vertices: FloatArray) -> Any:
        return vertices

    def like(self, mesh: Mesh) -> Any:
        return mesh.vertices.copy(), _faces_like(mesh, np.asarray(self.given[1]).dtype)


class _Object(Adapted):
    """Anything with .vertices and .faces."""

    def at(self, vertices: FloatArray) -> Any:
        result = copy.copy(self.given)
        result.vertices = vertices
        return result

    def like(self, mesh: Mesh) -> Any:
        result = copy.copy(self.given)
        result.vertices = mesh.vertices.copy()
        result.faces = _faces_like(mesh, np.asarray(self.given.faces).dtype)
        return result


class _Trimesh(Adapted):
    def at(self, vertices: FloatArray) -> Any:
        result = self.given.copy()
        result.vertices = vertices
        return result

    def like(self, mesh: Mesh) -> Any:
        colours = mesh.vertex.get("colour")
        return type(self.given)(vertices=mesh.vertices.copy(), faces=_faces_like(mesh, np.dtype(np.int64)), process=False,
                                vertex_colors=colours, metadata=dict(self.given.metadata))


class _PolyData(Adapted):
    def at(self, vertices: FloatArray) -> Any:
        result = self.given.copy()
        result.points = vertices
        moved = self.mesh.with_vertices(vertices)
        if "normal" in moved.vertex and "Normals" in result.point_data:
            result.point_data["Normals"] = moved.vertex["normal"].astype(result.point_data["Normals"].dtype)
        return result

    def like(self, mesh: Mesh) -> Any:
        offsets, corners = mesh._core.polygons()
        padded = np.insert(corners.astype(np.int64), offsets[:-1], np.diff(offsets))
        result = type(self.given)(mesh.vertices.copy(), faces=padded)
        for name, values in mesh.vertex.items():
            result.point_data["Normals" if name == "normal" else name] = values
        for name, values in mesh.face.items():
            result.cell_data[name] = values
        return result


class _Open3d(Adapted):
    """The legacy open3d.geometry.TriangleMesh."""

    def at(self, vertices: FloatArray) -> Any:
        result = type(self.given)(self.given)
        result.vertices = _o3d().utility.Vector3dVector(vertices)
        return self._with_normals(result)

    def like(self, mesh: Mesh) -> Any:
        o3d = _o3d()
        result = type(self.given)(o3d.utility.Vector3dVector(mesh.vertices.copy()),  # it wants to be able to write
                                  o3d.utility.Vector3iVector(_faces_like(mesh, np.dtype(np.int32))))
        if "colour" in mesh.vertex:
            result.vertex_colors = o3d.utility.Vector3dVector(mesh.vertex["colour"].astype(float)[:, :3])
        return self._with_normals(result)

    def _with_normals(self, result: Any) -> Any:
        if self.given.has_vertex_normals():
            result.compute_vertex_normals()
        elif self.given.has_triangle_normals():
            result.compute_triangle_normals()
        return result


class _Open3dTensor(Adapted):
    """open3d.t.geometry.TriangleMesh."""

    def at(self, vertices: FloatArray) -> Any:
        result = self.given.clone()
        old = self.given.vertex.positions
        result.vertex.positions = _o3d().core.Tensor(vertices.astype(old.numpy().dtype))
        if "normals" in self.given.vertex:
            result.compute_vertex_normals()
        return result

    def like(self, mesh: Mesh) -> Any:
        tensor = _o3d().core.Tensor
        return type(self.given)(
            tensor(mesh.vertices.astype(self.given.vertex.positions.numpy().dtype)),
            tensor(_faces_like(mesh, self.given.triangle.indices.numpy().dtype)))


def _o3d() -> Any:
    import open3d  # the caller's mesh is one of its

    return open3d


def _faces_like(mesh: Mesh, dtype: np.dtype[Any]) -> NDArray[Any]:
    faces = mesh.faces if mesh.is_triangular else mesh.triangulated().faces
    return faces.astype(dtype if dtype.kind in "iu" else np.int64)


def _from_polydata(given: Any, allow_defects: bool) -> Mesh:
    cells = given.GetNumberOfVerts() + given.GetNumberOfLines() + given.GetNumberOfStrips()
    if cells:
        raise ValueError("mesh: a PolyData with vertices, lines or strips beside its faces; take only its faces")
    polygons = given.GetPolys()
    import pyvista

    offsets = pyvista.convert_array(polygons.GetOffsetsArray()).astype(np.int64)
    corners = pyvista.convert_array(polygons.GetConnectivityArray())
    sizes = np.diff(offsets)
    faces: Any = corners.reshape(-1, 3) if (sizes == 3).all() else np.split(corners, offsets[1:-1])
    mesh = Mesh(given.points, faces, allow_defects=allow_defects)
    for data, domain in ((given.point_data, "vertex"), (given.cell_data, "face")):
        for name, values in data.items():
            values = np.asarray(values)
            if values.dtype.kind not in "iufb" or values.ndim > 2:
                continue
            normal = name == "Normals" and values.shape[-1] == 3
            rule = "direction" if normal else "linear" if values.dtype.kind == "f" else "nearest"
            mesh = mesh.with_attribute(domain, "normal" if normal else name, values, interpolation=rule)  # type: ignore[arg-type]
    return mesh


def _from_trimesh(given: Any, allow_defects: bool) -> Mesh:
    mesh = Mesh(given.vertices, given.faces, allow_defects=allow_defects)
    if getattr(given.visual, "kind", None) == "vertex":
        mesh = mesh.with_attribute("vertex", "colour", np.asarray(given.visual.vertex_colors, np.uint8))
    return mesh


def _from_open3d(given: Any, allow_defects: bool) -> Mesh:
    mesh = Mesh(np.asarray(given.vertices), np.asarray(given.triangles), allow_defects=allow_defects)
    if given.has_vertex_colors():
        mesh = mesh.with_attribute("vertex", "colour", np.asarray(given.vertex_colors))
    return mesh


def adapt(given: Any, name: str = "mesh", *, allow_defects: bool = False) -> Adapted:
    """Returns a mesh of any known kind as the package's own. Raises ValueError for anything else."""
    if isinstance(given, Mesh):
        return Adapted(given, given)
    library = type(given).__module__.split(".")[0]
    try:
        if isinstance(given, tuple) and len(given) == 2:
            return _Arrays(Mesh(given[0], given[1], allow_defects=allow_defects), given)
        if library == "trimesh" and hasattr(given, "visual"):
            return _Trimesh(_from_trimesh(given, allow_defects), given)
        if library in ("pyvista", "vtkmodules") and hasattr(given, "point_data") and hasattr(given, "GetPolys"):
            return _PolyData(_from_polydata(given, allow_defects), given)
        if library == "open3d" and hasattr(given, "triangle"):
            return _Open3dTensor(Mesh(given.vertex.positions.numpy(), given.triangle.indices.numpy(),
                                      allow_defects=allow_defects), given)
        if library == "open3d" and hasattr(given, "triangles"):
            return _Open3d(_from_open3d(given, allow_defects), given)
        if hasattr(given, "vertices") and hasattr(given, "faces"):
            return _Object(Mesh(given.vertices, given.faces, allow_defects=allow_defects), given)
    except ValueError as error:
        text = str(error)
        raise ValueError(text if text.startswith(name) else f"{name}: {text}") from None
    raise ValueError(f"{name}: expected a meshgraft.Mesh, a tuple (vertices, faces), a trimesh.Trimesh, a pyvista.PolyData, "
                     f"an open3d TriangleMesh or an object with .vertices and .faces, not {type(given).__name__}")


def vertices_of(given: Any, name: str, rows: int) -> FloatArray:
    """Returns positions, (rows, 3), of an array or of any known kind of mesh."""
    if isinstance(given, (np.ndarray, list)):
        return _arrays.points(given, name, rows=rows)
    positions = adapt(given, name).mesh.vertices
    if len(positions) != rows:
        raise ValueError(f"{name}: expected {rows} vertices, not {len(positions)}")
    return positions
