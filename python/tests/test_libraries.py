"""Meshes of other libraries, for real where they are installed: what goes in comes out."""

from types import SimpleNamespace

import numpy as np
import pytest

import meshgraft as mg
from conftest import bend


def check_deform(make, vertices_of, bar, ends):
    """The result has the type of the input, which stays as it was."""
    given = make(bar.vertices, bar.faces)
    wanted = mg.deform(bar, handles=ends, poses={"top": bend()}).vertices
    before = np.array(vertices_of(given))
    result = mg.deform(given, handles=ends, poses={"top": bend()})
    assert type(result) is type(given) and result is not given
    assert np.allclose(vertices_of(result), wanted, atol=1e-5)
    assert np.array_equal(vertices_of(given), before)
    assert np.allclose(vertices_of(mg.Deformer(given, handles=ends).evaluate(top=bend())), wanted, atol=1e-5)
    return result


def check_cut(make, count_of, bar):
    cut = mg.cut(make(bar.vertices, bar.faces), plane=((0, 0, 2.05), "z"), keep="above").mesh
    assert type(cut) is type(make(bar.vertices, bar.faces))
    assert count_of(cut) == len(mg.cut(bar, plane=((0, 0, 2.05), "z"), keep="above").mesh)


def test_trimesh(bar, ends):
    trimesh = pytest.importorskip("trimesh")

    def make(vertices, faces):
        return trimesh.Trimesh(vertices, faces, process=False, metadata={"name": "bar"})

    result = check_deform(make, lambda mesh: mesh.vertices, bar, ends)
    assert result.metadata["name"] == "bar" and result.is_watertight
    check_cut(make, lambda mesh: len(mesh.vertices), bar)
    coloured = make(bar.vertices, bar.faces)
    coloured.visual.vertex_colors = np.tile([200, 10, 20, 255], (len(bar), 1))
    bent = mg.deform(coloured, handles=ends, poses={"top": bend()})
    assert (bent.visual.vertex_colors == [200, 10, 20, 255]).all()
    cut = mg.cut(coloured, plane=((0, 0, 2.05), "z"), keep="below").mesh
    assert (cut.visual.vertex_colors == [200, 10, 20, 255]).all()


def test_pyvista(bar, ends):
    pyvista = pytest.importorskip("pyvista")

    def make(vertices, faces):
        mesh = pyvista.PolyData.from_regular_faces(vertices.copy(), faces)
        mesh.point_data["height"] = vertices[:, 2].copy()
        mesh.cell_data["number"] = np.arange(len(faces))
        return mesh

    result = check_deform(make, lambda mesh: mesh.points, bar, ends)
    assert np.array_equal(result.point_data["height"], bar.vertices[:, 2])
    check_cut(make, lambda mesh: mesh.n_points, bar)
    cut = mg.cut(make(bar.vertices, bar.faces), plane=((0, 0, 2.05), "z"), keep="above").mesh
    assert np.allclose(cut.point_data["height"], cut.points[:, 2]) and "number" in cut.cell_data
    with_normals = make(bar.vertices, bar.faces).compute_normals(split_vertices=False, consistent_normals=False)
    turned = mg.deform(with_normals, handles=ends, poses={"top": bend()})
    fresh = turned.copy().compute_normals(split_vertices=False, consistent_normals=False)
    cosines = (turned.point_data["Normals"] * fresh.point_data["Normals"]).sum(axis=1)
    assert np.median(cosines) > 0.99
    quads = pyvista.PolyData(bar.vertices[:4].copy(), faces=[4, 0, 1, 2, 3])
    assert len(mg.check(quads).findings)
    with pytest.raises(ValueError, match="lines"):
        mg.check(pyvista.Line())


def test_the_accessor_of_pyvista(bar, ends):
    pyvista = pytest.importorskip("pyvista")
    if not hasattr(pyvista, "register_dataset_accessor"):
        pytest.skip("this PyVista has no accessors")
    import meshgraft._pyvista  # noqa: F401  what the entry point of an installed package imports

    mesh = pyvista.PolyData.from_regular_faces(bar.vertices.copy(), bar.faces)
    wanted = mg.deform(bar, handles=ends, poses={"top": bend()}).vertices
    assert np.allclose(mesh.meshgraft.deform(handles=ends, poses={"top": bend()}).points, wanted)
    assert np.allclose(mesh.meshgraft.deformer(handles=ends).evaluate(top=bend()).points, wanted)
    opened = mesh.meshgraft.cut(plane=((0, 0, 2.05), "z"), keep="below")
    assert opened.n_points and mesh.meshgraft.check().findings == () and mesh.meshgraft.repair().n_points == len(bar)
    assert len(mesh.meshgraft.select(mg.select.half_space((0, 0, 3), "z")))
    octopus, head = mg.sample("octopus", 40), mg.sample("head", 24)
    body = pyvista.PolyData.from_regular_faces(octopus.vertices.copy(), octopus.faces)
    assert body.meshgraft.drop(head, (0, -0.33, 1.63), size=0.3).n_points > len(octopus)
    top = pyvista.PolyData.from_regular_faces(mg.sample("bust", 32).vertices.copy(), mg.sample("bust", 32).faces)
    grafted = top.meshgraft.merge(mg.sample("head", 32), matches=[((0, -0.3, -0.28), (0, -0.3, -0.4))])
    assert isinstance(grafted, pyvista.PolyData)


def test_open3d(bar, ends):
    o3d = pytest.importorskip("open3d", exc_type=ImportError)  # it needs libraries of the system

    def make(vertices, faces):
        mesh = o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(vertices.copy()),
                                         o3d.utility.Vector3iVector(faces.copy()))
        mesh.compute_vertex_normals()
        return mesh

    result = check_deform(make, lambda mesh: np.asarray(mesh.vertices), bar, ends)
    assert result.has_vertex_normals()
    check_cut(make, lambda mesh: len(mesh.vertices), bar)

    def make_tensor(vertices, faces):
        return o3d.t.geometry.TriangleMesh(o3d.core.Tensor(vertices.copy()), o3d.core.Tensor(faces.copy()))

    check_deform(make_tensor, lambda mesh: mesh.vertex.positions.numpy(), bar, ends)
    check_cut(make_tensor, lambda mesh: len(mesh.vertex.positions), bar)


def test_anything_with_vertices_and_faces(bar, ends):
    def make(vertices, faces):
        return SimpleNamespace(vertices=vertices.copy(), faces=faces.copy(), name="bar")

    assert check_deform(make, lambda mesh: mesh.vertices, bar, ends).name == "bar"
    check_cut(make, lambda mesh: len(mesh.vertices), bar)
    assert mg.repair(make(bar.vertices, bar.faces[1:])).mesh.name == "bar"
