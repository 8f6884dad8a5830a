"""Laws of deformations and grafts, from Python."""

import ctypes
import os
import subprocess

import numpy as np
import pytest

import meshgraft as mg
from conftest import bend

ROTATION = mg.Pose((0.3, -0.2, 0.1), rotate=((1, 2, 3), 100), scale=1.7, pivot=(0.1, 0.2, 0.3))
SHEAR = np.array([[1.2, 0.4, 0, 1], [0.1, 0.8, 0.3, 2], [0, -0.2, 1.5, 3], [0, 0, 0, 1.0]])


def moved(points, matrix):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


@pytest.mark.parametrize("method", ["ft05", "rotation-aware", "corotational", "shell"])
def test_a_similarity_of_all_handles_moves_the_mesh(bar, ends, method):
    d = mg.Deformer(bar, handles=ends, method=method)
    found = d.positions({name: ROTATION for name in ends})
    wanted = moved(bar.vertices, ROTATION.as_matrix())
    assert np.abs(found - wanted).max() < 1e-9


def test_an_affine_map_of_all_handles_moves_the_mesh(bar, ends):
    found = mg.deform(bar, handles=ends, poses={"bottom": SHEAR, "top": SHEAR}, method="ft05")
    assert np.abs(found.vertices - moved(bar.vertices, SHEAR)).max() < 1e-9


def test_handles_are_exactly_at_their_poses_and_nothing_else_outside_moves(bar, ends):
    region = mg.select.half_space((0, 0, 1), "z")
    d = mg.Deformer(bar, region, {"top": ends["top"]})
    pose = np.array([[0, -1, 0, 0.5], [1, 0, 0, 0], [0, 0, 1, 0.25], [0, 0, 0, 1.0]])
    bent = d.evaluate(top=pose)
    assert np.array_equal(bent.vertices[ends["top"]], moved(bar.vertices[ends["top"]], pose))
    outside = np.setdiff1d(np.arange(len(bar)), region(bar))
    assert bent.vertices[outside].tobytes() == bar.vertices[outside].tobytes()
    assert np.abs(bent.vertices - bar.vertices).max() > 0.1
    assert set(d.free_vertices).isdisjoint(d.fixed) and set(d.fixed) <= set(d.region)


def test_deform_refines_around_a_single_vertex_and_a_deformer_does_not():
    sheet = mg.sample("bumpy_plane", 120)
    step = {"region": mg.select.sphere((0, 0, 0), 0.4), "handles": {"tip": mg.select.nearest((0, 0, 0))}}
    poses = {"tip": mg.Pose((0, 0, 0.15))}
    plain = mg.deform(sheet, **step, poses=poses, refine_boundary=0)
    refined = mg.deform(sheet, **step, poses=poses)
    assert mg.Deformer(sheet, **step).positions(poses).tobytes() == plain.vertices.tobytes()
    bends = [mg.quality(sheet, mesh).dihedral_max_deg for mesh in (refined, plain)]
    assert bends[0] < 0.9 * bends[1]


def test_the_result_does_not_depend_on_threads(bar, ends):
    poses = {"top": bend()}
    one = mg.Deformer(bar, handles=ends, threads=1).positions(poses)
    two = mg.Deformer(bar, handles=ends, threads=2).positions(poses)
    assert one.tobytes() == two.tobytes()


def test_all_ways_to_evaluate_agree(bar, ends):
    poses = {"bottom": mg.Pose(), "top": bend()}
    d = mg.Deformer(bar, handles=ends)
    wanted = mg.deform(bar, handles=ends, poses=poses).vertices
    out = np.empty_like(bar.vertices)
    assert d.positions(poses, out=out) is out
    positions, report = d.positions_and_report(top=bend())
    for found in (out, positions, d.evaluate(poses).vertices, d.positions(top=bend())):
        assert found.tobytes() == wanted.tobytes()
    assert report.iterations > 0 and report.residual < 1e-6


def test_with_region_agrees_with_a_new_deformer(bar, ends):
    middle = mg.select.sphere((0.5, 0, 2), 0.3)(bar)
    first = mg.Deformer(bar, handles=ends)
    second = first.with_region(None, {**ends, "middle": middle})
    assert second.summary.reused and second.handles == ("bottom", "top", "middle")
    fresh = mg.Deformer(bar, handles={**ends, "middle": middle})
    assert np.abs(second.positions(top=bend()) - fresh.positions(top=bend())).max() < 1e-8


def test_quick_frames_are_near_the_exact_ones(bar, ends):
    linear = mg.Deformer(bar, handles=ends, method="ft05")
    basis = linear.handle_basis()
    exact = linear.positions(top=bend())
    assert np.abs(basis.frame(top=bend()) - exact).max() < 1e-9
    positions, normals = basis.frame_with_normals(top=bend())
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5) and basis.has_normals
    assert np.array_equal(positions, basis.frame(top=bend()))
    buffers = basis.buffers()
    assert buffers.blocks.shape == (len(buffers.vertices), 32) and basis.memory_bytes > 0
    assert basis.pose_matrices(top=bend()).shape == (2, 4, 3)
    d = mg.Deformer(bar, handles=ends)
    frames = d.reduced_frames(centres=32)
    far = np.abs(d.positions(top=bend()) - bar.vertices).max()
    assert np.abs(frames.frame(top=bend()) - d.positions(top=bend())).max() < 0.15 * far
    assert frames.centres <= 32 and frames.memory_bytes > 0


def test_a_proxy_is_near_the_exact_solve():
    bar = mg.sample("bar", 40)
    z = bar.vertices[:, 2]
    ends = {"bottom": z < 0.3, "top": z > 3.7}
    proxy = mg.ProxyDeformer(bar, handles=ends, vertices=400)
    exact = mg.Deformer(bar, handles=ends).positions(top=bend())
    far = np.abs(exact - bar.vertices).max()
    assert np.abs(proxy.positions(top=bend()) - exact).max() < 0.1 * far
    vertices, triangles = proxy.proxy
    assert triangles.max() == len(vertices) - 1 and proxy.summary.vertices == len(vertices)


def test_a_curve_follows_its_new_course():
    plane = mg.sample("bumpy_plane", 16)
    curve = mg.select.path([(-0.2, 0, 0), (0.2, 0, 0)])
    handle = mg.Handle(curve, shape="curve", constrain="both", closed=False)
    course = [(-0.2, 0, 0.2), (0.2, 0, 0.2)]
    bent = mg.deform(plane, region=curve.grow(6), handles={"ridge": handle}, poses={"ridge": mg.Pose.curve(course)})
    assert np.allclose(bent.vertices[curve(plane)][:, 2], 0.2)


def test_symmetry_mirrors_a_pose(bar):
    z = bar.vertices[:, 2]
    left = mg.select.sphere((-0.5, 0, 2), 0.3)
    ends = {"bottom": z < 0.3, "top": z > 3.7, "left": left}
    bent = mg.deform(bar, handles=ends, poses={"left": mg.Pose((-0.3, 0, 0))}, symmetry="x")
    mirrored = left.mirror("x")(bar)
    assert np.allclose(bent.vertices[mirrored][:, 0], bar.vertices[mirrored][:, 0] + 0.3)
    d = mg.Deformer(bar, handles=ends, symmetry="x")
    assert d.positions(left=mg.Pose((-0.3, 0, 0))).tobytes() == bent.vertices.tobytes()


def test_targets_transforms_and_anchors(bar, ends):
    vertex = int(mg.select.nearest((0.5, 0, 2))(bar)[0])
    bent = mg.deform(bar, handles=ends, targets={vertex: (0.8, 0, 2)}, transforms={vertex: np.eye(3)},
                     anchors=[(mg.select.sphere((0, 0.5, 1), 0.2), 5.0)])
    assert np.array_equal(bent.vertices[vertex], (0.8, 0, 2))


def test_features_keep_their_shape(bar, ends):
    disc = mg.select.sphere((0, 0.5, 2), 0.4)

    def strain(positions):
        before, after = bar.vertices[disc(bar)], positions[disc(bar)]
        p, q = before - before.mean(0), after - after.mean(0)
        u, s, v = np.linalg.svd(q.T @ p)
        turn = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
        scale = (s * [1, 1, np.linalg.det(u @ v)]).sum() / (p**2).sum()
        return np.abs(scale * p @ turn.T - q).max()

    pose = mg.Pose((0.5, 0, 1), rotate=("x", 60))
    assert strain(mg.deform(bar, handles=ends, poses={"top": pose}).vertices) > 1e-3
    kept = mg.deform(bar, handles=ends, poses={"top": pose}, features=[disc])
    assert strain(kept.vertices) < 1e-9
    d = mg.Deformer(bar, handles=ends, features=[(disc, "similarity")])
    assert d.positions(top=pose).tobytes() == kept.vertices.tobytes()
    with pytest.raises(mg.Error, match="already|held|constrain"):
        mg.deform(bar, handles=ends, features=[bar.vertices[:, 2] > 3.7])


def test_a_welded_soup_stays_closed(bar, ends):
    soup = mg.Mesh(bar.vertices[bar.faces.ravel()], np.arange(3 * len(bar.faces)).reshape(-1, 3))
    z = soup.vertices[:, 2]
    handles = {"bottom": z < 0.3, "top": z > 3.7}
    d = mg.Deformer(soup, handles=handles)
    found = d.positions(top=bend()).reshape(-1, 3, 3)
    wanted = mg.deform(soup, handles=handles, poses={"top": bend()}).vertices.reshape(-1, 3, 3)
    assert found.tobytes() == wanted.tobytes() == d.evaluate(top=bend()).vertices.tobytes()
    assert len(np.unique(found.reshape(-1, 3), axis=0)) == len(bar)


def with_kernels_of_this_process():
    """Returns an environment in which the program has the BLAS kernels of this process, where that is OpenBLAS."""
    try:
        name = ctypes.CDLL("libopenblas.so.0").openblas_get_corename
    except (OSError, AttributeError):
        return None
    name.restype = ctypes.c_char_p
    return {**os.environ, "OPENBLAS_CORETYPE": name().decode()}


def same_bytes(tmp_path, program, edit, result, name="edit.json"):
    """Runs a saved edit by the program and compares the files."""
    edit.save(tmp_path / name)
    mg.write(result, tmp_path / "python.ply")
    subprocess.run([program, "run", tmp_path / name, "-o", tmp_path / "program.ply"], check=True, capture_output=True,
                   env=with_kernels_of_this_process())
    assert (tmp_path / "python.ply").read_bytes() == (tmp_path / "program.ply").read_bytes()


def test_a_deformation_has_the_bytes_of_the_command_line(tmp_path, program):
    octopus = mg.sample("octopus", 48)
    arm = mg.select.sphere((1.7, 0.7, 0.3), 0.5)
    edit = mg.Edit().input("octopus", octopus)
    edit.deform("octopus", region=arm.grow(8), handles={"arm": arm}, poses={"arm": bend()})
    result = edit.run().mesh
    assert not np.array_equal(result.vertices, octopus.vertices)
    same_bytes(tmp_path, program, edit, result)


def test_a_graft_has_the_bytes_of_the_command_line(tmp_path, program):
    edit = mg.Edit().input("bust", sample="bust", resolution=40).input("head", sample="head", resolution=40)
    edit.merge("bust", "head", matches=[((0, -0.3, -0.28), (0, -0.3, -0.4))])
    result = edit.run()
    same_bytes(tmp_path, program, edit, result.mesh)
    direct = mg.merge(mg.sample("bust", 40), mg.sample("head", 40), matches=[((0, -0.3, -0.28), (0, -0.3, -0.4))])
    assert direct.mesh.vertices.tobytes() == result.mesh.vertices.tobytes()
    assert direct.mesh.topology().manifold and direct.report.seam.closed == direct.mesh.topology().closed


def test_a_graft_does_not_depend_on_the_sources_pose():
    bust, head = mg.sample("bust", 40), mg.sample("head", 40)
    matches = [(int(mg.select.nearest((0, -0.3, -0.28))(bust)[0]), int(mg.select.nearest((0, -0.3, -0.4))(head)[0]))]
    first = mg.merge(bust, head, matches=matches)
    turned = head.with_vertices(moved(head.vertices, ROTATION.as_matrix()))
    second = mg.merge(bust, turned, matches=matches)
    assert np.abs(first.mesh.vertices - second.mesh.vertices).max() < 1e-8
    kept = first.target_map >= 0
    assert kept.sum() and (first.source_map >= 0).any() and len(first.new_faces) == first.report.seam.new_faces
    assert first.grafted.shape == head.vertices.shape and first.posing.shape == (4, 4)


def test_a_dropped_part_is_grafted_whole():
    octopus, head = mg.sample("octopus", 48), mg.sample("head", 32)
    dropped = mg.drop(octopus, head, (0, -0.33, 1.63), size=0.3, spin_deg=30)
    assert dropped.mesh.topology().closed and dropped.intersections.result >= 0
    assert dropped.options.size == 0.3


def test_a_closed_part_is_opened_where_its_base_is():
    octopus, cactus = mg.sample("octopus", 48), mg.sample("cactus", 32)
    dropped = mg.drop(octopus, cactus, (0, -0.33, 1.63), size=0.2)
    assert dropped.mesh.topology().closed and dropped.base.loops == 1
    assert np.allclose(dropped.base.normal, (0, 0, 1), atol=0.01)
    higher = mg.drop(octopus, cactus, (0, -0.33, 1.63), size=0.2, base_height=0.3, base_tilt_deg=10, base_tilt_axis=(0, 1, 0))
    assert higher.base.height == 0.3 and higher.base.cut_away > dropped.base.cut_away
    assert np.isclose(np.degrees(np.arccos(higher.base.normal @ dropped.base.normal)), 10, atol=0.01)


@pytest.mark.parametrize("keyword", [{"proxy": 100}, {"refine_boundary": 1}])
def test_a_deformer_refuses_keywords_of_steps(bar, ends, keyword):
    for kind in (mg.Deformer, mg.ProxyDeformer, mg.LiveDeformer):
        with pytest.raises(TypeError, match=next(iter(keyword))):
            kind(bar, handles=ends, **keyword)


def test_another_region_keeps_what_is_said_of_welding():
    knot = mg.sample("knot", 24)
    soup = knot.vertices[knot.faces].reshape(-1, 3), np.arange(3 * len(knot.faces)).reshape(-1, 3)
    apart = mg.Deformer(soup, handles={"all": np.arange(len(soup[0]))}, weld=False)
    other = apart.with_region(None, {"all": np.arange(len(soup[0]))})
    assert len(other.handle_vertices("all")) == len(apart.handle_vertices("all")) == len(soup[0])


def test_intersections_that_were_there_at_rest_do_not_count():
    bar = mg.sample("bar", 16)
    twice = mg.Mesh(np.concatenate([bar.vertices, bar.vertices + [0.3, 0.2, 0.1]]),
                    np.concatenate([bar.faces, bar.faces + len(bar)]))
    moved = twice.vertices.copy()
    moved[len(bar):][bar.vertices[:, 2] > 2] += [0.4, 0, 0.8]
    pairs = {tuple(pair) for pair in mg.self_intersections(twice.with_vertices(moved))}
    before = {tuple(pair) for pair in mg.self_intersections(twice)}
    new = mg.self_intersections(twice.with_vertices(moved), rest=twice)
    assert before & pairs and [tuple(pair) for pair in new] == sorted(pairs - before)
    assert len(new) == mg.quality(twice, moved, free=np.arange(len(twice))).new_self_intersections
