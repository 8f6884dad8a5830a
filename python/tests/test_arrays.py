"""What happens at the border: shapes, types, indices, memory."""

import numpy as np
import pytest

import meshgraft as mg

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
F = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


@pytest.mark.parametrize("dtype", [np.int32, np.int64, np.uint8])
@pytest.mark.parametrize("order", ["C", "F"])
def test_types_and_orders_give_the_same_mesh(dtype, order):
    mesh = mg.Mesh(np.asarray(V.astype(np.float32), order=order), np.asarray(F.astype(dtype), order=order))
    assert np.array_equal(mesh.vertices, V) and np.array_equal(mesh.faces, F)
    assert mesh.vertices.dtype == np.float64 and mesh.faces.dtype == np.int32


def test_inputs_are_not_written_to_and_results_own_their_memory(bar, ends):
    vertices, faces = bar.vertices.copy(), bar.faces.copy()
    vertices.flags.writeable = faces.flags.writeable = False
    d = mg.Deformer((vertices, faces), handles=ends)
    result = d.evaluate(top=mg.Pose((1, 0, 0)))
    again = d.evaluate(top=mg.Pose((1, 0, 0)))
    result[:] = 7
    assert not np.array_equal(result, again) and result.flags.writeable
    kept = mg.Mesh(vertices, faces).vertices
    del d
    assert np.array_equal(kept, bar.vertices)


def test_views_cannot_be_written_to_and_outlive_the_mesh():
    mesh = mg.Mesh(V, F)
    vertices, faces = mesh.vertices, mesh.faces
    del mesh
    assert np.array_equal(vertices, V) and np.array_equal(faces, F)
    for view in (vertices, faces):
        with pytest.raises(ValueError):
            view[0, 0] = 1


def test_a_tuple_gives_what_went_in(bar):
    vertices, faces = bar.vertices.copy(), bar.faces.astype(np.int64)
    cut = mg.cut((vertices, faces), plane=((0, 0, 2.05), "z"), keep="above")
    assert isinstance(cut.mesh, tuple) and cut.mesh[1].dtype == np.int64 and len(cut.loops) == 1
    assert len(mg.repair((vertices, faces)).mesh) == 2


@pytest.mark.parametrize("call, text", [
    (lambda: mg.Mesh(V[:, :2], F), r"vertices: .*\(n, 3\), not \(4, 2\)"),
    (lambda: mg.Mesh(V, F[:, :2]), r"faces\[0\]: expected three or more corners"),
    (lambda: mg.Mesh(V, F + 1), r"faces\[1, 2\] is 4, and there are 4 vertices"),
    (lambda: mg.Mesh(V, F - 1), r"faces\[0, 0\] is -1"),
    (lambda: mg.Mesh(V, F.astype(float)), "faces: expected integers"),
    (lambda: mg.Mesh(V, [[0, 1, 2, 3], [0, 1, 9]]), r"faces\[1\]\[2\] is 9"),
    (lambda: mg.Mesh(np.where(V == 1, np.nan, V), F), r"vertices\[1, 0\] is nan"),
    (lambda: mg.Mesh(np.where(V == 1, np.inf, V), F), r"vertices\[1, 0\] is inf"),
    (lambda: mg.Mesh(np.full((4, 3), "a"), F), "vertices: expected numbers"),
    (lambda: mg.Mesh(V.astype(complex), F), "vertices: expected numbers"),
    (lambda: mg.Mesh([[0, 0, 0], [1, 0]], F), "vertices: expected numbers"),
    (lambda: mg.deform(5), "mesh: expected a meshgraft.Mesh"),
    (lambda: mg.deform((V, F), region=[1, 8]), r"region\[1\] is 8, and there are 4 vertices"),
    (lambda: mg.deform((V, F), handles={"a": np.ones(3, bool)}), r"handles\['a'\]: a mask of 3 flags for 4 vertices"),
    (lambda: mg.deform((V, F), handles={"a": [0.5]}), r"handles\['a'\]: expected integers"),
    (lambda: mg.deform((V, F), handles=[1]), "handles: expected a dict"),
    (lambda: mg.deform((V, F), targets={0: (1, np.nan, 0)}), r"targets\[0\]\[1\] is nan"),
    (lambda: mg.deform((V, F), transforms={0: np.eye(4)}), r"transforms\[0\]: expected a 3x3 matrix"),
    (lambda: mg.Pose((1, 2)), "translate: expected 3 numbers"),
    (lambda: mg.Pose(rotate=("w", 3)), r"rotate\[0\]: expected 'x', 'y', 'z'"),
    (lambda: mg.Pose(rotate=40), "rotate: expected an axis and an angle"),
    (lambda: mg.Pose(rotate=((0, 0, 0), 3)), r"rotate\[0\]: 0, 0, 0 is no direction"),
    (lambda: mg.Pose.matrix(np.eye(3)), "matrix: expected a 4x4 matrix"),
    (lambda: mg.Pose.matrix(np.ones((4, 4))), r"matrix\[3\]"),
    (lambda: mg.Pose.curve([[1, 2]]), "points"),
    (lambda: mg.cut((V, F)), "give one of plane, loop and values"),
    (lambda: mg.cut((V, F), values=[1, 2]), "values: expected a list of 4 numbers"),
    (lambda: mg.select.box((0, 0, 0), (1, 1)), "high: expected 3 numbers"),
    (lambda: mg.quality((V, F), V[:3]), r"edited: expected numbers of shape \(4, 3\)"),
    (lambda: mg.picture(), "expected at least one mesh"),
    (lambda: mg.picture((V, F), colours=[V[:2]]), r"colours\[0\]"),
    (lambda: mg.check((V, F), threads=-1), "threads"),
    (lambda: mg.Mesh(V, F).with_attribute("vertex", "a", [1, 2]), "values: expected shape"),
    (lambda: mg.Mesh(V, F).with_attribute("edge", "a", [1, 2]), "domain"),
])
def test_a_value_error_names_the_argument(call, text):
    with pytest.raises(ValueError, match=text):
        call()


def test_other_mistakes_are_type_errors(bar, ends):
    with pytest.raises(TypeError, match="hole_edge"):
        mg.repair(bar, hole_edge=3)
    with pytest.raises(TypeError, match="there is no handle 'hand'"):
        mg.Deformer(bar, handles=ends).evaluate(hand=mg.Pose())
    with pytest.raises(ValueError, match="hole_fill: 'smooth' is none of 'plain', 'refined', 'faired'"):
        mg.repair(bar, hole_fill="smooth")
    with pytest.raises(TypeError, match="weld: expected True or False"):
        mg.repair(bar, weld=1.5)


@pytest.mark.parametrize("out", [np.zeros((3, 3)), np.zeros((3, 3), np.float32), [[0.0]]])
def test_an_output_must_fit(bar, ends, out):
    with pytest.raises(ValueError, match="out: expected an array of float64 of shape"):
        mg.Deformer(bar, handles=ends).positions(out=out)


def test_an_output_must_be_writable_and_contiguous(bar, ends):
    d = mg.Deformer(bar, handles=ends)
    frozen = np.zeros((len(bar), 3))
    frozen.flags.writeable = False
    for out in (frozen, np.zeros((len(bar), 3), order="F")):
        with pytest.raises(ValueError, match="out"):
            d.positions(out=out)


def test_polygons_attributes_and_defects():
    quads = mg.Mesh(V, [[0, 1, 2, 3]])
    assert not quads.is_triangular and len(quads.triangulated().faces) == 2
    with pytest.raises(ValueError, match="triangulated"):
        quads.faces
    assert [list(face) for face in mg.Mesh(V, [[0, 1, 2, 3], [0, 1, 2]]).polygons] == [[0, 1, 2, 3], [0, 1, 2]]
    mesh = mg.Mesh(V, F).with_attribute("vertex", "colour", np.arange(12, dtype=np.uint8).reshape(4, 3))
    mesh = mesh.with_attribute("face", "group", [0, 1, 1, 0], interpolation="nearest", labels=("a", "b"))
    assert mesh.vertex["colour"].dtype == np.uint8 and mesh.vertex["colour"][3, 2] == 11
    assert mesh.face["group"].shape == (4,) and mesh.face.labels("group") == ("a", "b")
    assert list(mesh.vertex) == ["colour"] and len(mesh.corner) == 0 and "none" in repr(mesh.corner)
    assert "colour" not in mesh.without_attribute("vertex", "colour").vertex
    with pytest.raises(KeyError):
        mesh.without_attribute("vertex", "colours")
    broken = (np.where(V == 1, np.nan, V), np.vstack([F, [[0, 1, 99]]]))
    found = mg.check(broken)
    assert {finding.kind for finding in found.findings} >= {"non-finite", "index-out-of-range"}
    assert found.findings[0].note.id == "mesh.non_finite" and found.findings[0].severity == "refused"


def test_what_is_meant_as_a_number_must_be_one(bar, ends):
    for keywords in ({"threads": 1.5}, {"threads": 10**12}, {"memory": -1}, {"memory": "1G"}, {"stiffness": float("nan")}):
        name = next(iter(keywords))
        with pytest.raises(ValueError, match=name):
            mg.deform(bar, handles=ends, **keywords)


def test_what_is_unknown_is_a_type_error(bar, ends):
    d = mg.Deformer(bar, handles=ends)
    for call in (lambda: d.pivot("x"), lambda: d.handle_vertices("x"), lambda: mg.deform(bar, handles=ends, metod="ft05"),
                 lambda: mg.deform(bar, handles=ends, poses=mg.Pose())):
        with pytest.raises(TypeError):
            call()


def test_arrays_that_change_afterwards_do_not_change_an_edit(bar):
    vertices = np.arange(10)
    edit = mg.Edit().input("bar", bar).deform("bar", handles={"a": vertices})
    before = edit.to_json()
    vertices[:] = 3
    assert edit.to_json() == before


def test_notes_are_warnings(bar, ends):
    with pytest.warns(mg.NoteWarning, match="proxy"):
        mg.deform(bar, handles=ends, poses={"top": mg.Pose((0.1, 0, 0))}, memory=1)


@pytest.mark.parametrize(("call", "error", "says"), [
    (lambda mesh: mg.sample("octopus", 40.5), ValueError, "resolution: expected a whole number"),
    (lambda mesh: mg.sample(None), TypeError, "name: expected the name of a built-in model"),
    (lambda mesh: mg.read(b"a.ply"), TypeError, "path: expected a path"),
    (lambda mesh: mg.write(mesh, 3), TypeError, "path: expected a path"),
    (lambda mesh: mg.cut(mesh, loop="abc"), ValueError, "loop: expected"),
    (lambda mesh: mg.picture(mesh, width=90.5), ValueError, "width: expected a whole number"),
    (lambda mesh: mg.merge(mesh, mesh, no_setting=1), TypeError, "unexpected keyword argument 'no_setting'"),
    (lambda mesh: mg.deform(mesh, handles={"h": [5]}, fixed=np.zeros(len(mesh), np.uint8)), ValueError, "mask"),
    (lambda mesh: mg.merge(mesh, mesh, matches=np.array([[1, 2.5]])), ValueError, r"matches\[0\]\[1\]"),
    (lambda mesh: mg.merge(mesh, mesh, matches=[(1,)]), ValueError, r"matches\[0\]: expected a pair"),
    (lambda mesh: mg.merge(mesh, mesh, matches=3), ValueError, "matches: expected pairs"),
    (lambda mesh: mg.merge(mesh, mesh, matches=[((0, (0, 1)), 0)]), ValueError, r"matches\[0\]\[0\]: expected a vertex"),
    (lambda mesh: mg.merge(mesh, mesh, pairs=[0]), ValueError, r"pairs\[0\]: expected a pair"),
    (lambda mesh: mg.Deformer(mesh, [[0], [1, 2]], handles={"h": [5]}), ValueError, "region: expected a list"),
    (lambda mesh: mg.Deformer(mesh, handles={"h": [5]}).evaluate(mg.Pose()), TypeError, "poses: expected a dict .* not Pose"),
    (lambda mesh: mg.deform(mesh, targets=[(5, (0, 0, 1))]), TypeError, "targets: expected a dict"),
    (lambda mesh: mg.deform(mesh, targets={5.5: (0, 0, 1)}), TypeError, "targets: expected whole numbers"),
    (lambda mesh: mg.deform(mesh, handles={"h": [5]}, anchors=[([1], "x")]), ValueError, r"anchors\[0\]\[1\]"),
    (lambda mesh: mg.deform(mesh, handles={"h": [5]}, symmetry=("x", "a")), ValueError, r"symmetry\[1\]"),
    (lambda mesh: mg.Edit().input(5, mesh), TypeError, "name: expected a str"),
    (lambda mesh: mg.Edit().input("a", mesh, sha256="0"), ValueError, "sha256: only a file"),
    (lambda mesh: mg.Edit().input("a", mesh, resolution=5), ValueError, "resolution: only a sample"),
    (lambda mesh: mg.Edit.load(3), TypeError, "path: expected a path"),
    (lambda mesh: mg.edit(mesh, folders=[3], show="none"), TypeError, "folders: expected a path"),
])
def test_a_strange_argument_is_named(call, error, says):
    with pytest.raises(error, match=says):
        call(mg.sample("bumpy_plane", 12))


def test_none_is_no_setting(bar, ends):
    one, other = (mg.deform(bar, handles=ends, **none) for none in ({}, {"method": None, "stiffness": None}))
    assert one.vertices.tobytes() == other.vertices.tobytes()


def test_a_tolerance_of_symmetry_may_be_whole():
    mesh = mg.sample("bumpy_plane", 12)
    with pytest.raises(mg.Error):  # a bumpy plane has no partners within less
        mg.deform(mesh, handles={"h": [5]}, symmetry=("x", 0))
    mg.deform(mesh, handles={"h": [5]}, symmetry=("x", 1))
