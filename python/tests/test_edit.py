"""Edits, selections, errors, and what can be pickled."""

import copy
import errno
import json
import pickle

import numpy as np
import pytest

import meshgraft as mg
from conftest import bend


def edit_of(bar):
    edit = mg.Edit("a bent bar", about="for the tests").input("bar", bar)
    edit.selection("bottom", mg.select.half_space((0, 0, 0.3), (0, 0, -1)))
    return edit.deform("bar", handles={"top": mg.select.half_space((0, 0, 3.7), "z")}, poses={"top": bend()},
                       fixed="bottom", name="bend", stiffness=10)


def test_a_saved_edit_does_the_same(bar, tmp_path):
    edit = edit_of(bar)
    files = edit.save(tmp_path / "edit.json")
    assert [file.name for file in files] == ["edit.json", "bar.ply"]
    loaded = mg.Edit.load(tmp_path / "edit.json")
    assert '"kind": "deform"' in edit.to_json()
    assert loaded.steps[0]["settings"]["stiffness"] == 10 and "Edit of bar: deform" in repr(edit)
    result, again = edit.run(), loaded.run()
    assert result.mesh.vertices.tobytes() == again.mesh.vertices.tobytes()
    assert np.array_equal(result.rest, bar.vertices)
    (tmp_path / "elsewhere").mkdir()
    loaded.save(tmp_path / "elsewhere" / "moved.json")
    assert mg.Edit.load(tmp_path / "elsewhere" / "moved.json").run().mesh.vertices.tobytes() == again.mesh.vertices.tobytes()
    with pytest.raises(FileExistsError):
        edit.save(tmp_path / "edit.json", overwrite=False)


def test_the_paper_as_published(bar):
    edit = edit_of(bar)
    published = edit.run(preset="as-published")
    settings = published.report.steps[0].settings
    assert settings.preset == "as-published" and settings.deformer.method == "ft05"
    assert settings.deformer.operators.noise_lengths == "random" and settings.deformer.operators.laplacian_weight == 1
    top = mg.select.half_space((0, 0, 3.7), "z")
    bottom = mg.select.half_space((0, 0, 0.3), (0, 0, -1))
    once = mg.deform(bar, handles={"top": top}, poses={"top": bend()}, fixed=bottom, preset="as-published")
    assert once.vertices.tobytes() == published.mesh.vertices.tobytes() != edit.run().mesh.vertices.tobytes()
    kept = mg.Deformer(bar, handles={"top": top}, fixed=bottom, preset="as-published").evaluate(top=bend())
    assert np.allclose(kept.vertices, once.vertices, atol=1e-9)
    half = mg.cut(bar, plane=((0, 0, 2), "z"), keep="below").mesh, mg.cut(bar, plane=((0, 0, 2), "z"), keep="above").mesh
    merged = mg.merge(*half, matches=[((0.5, 0.5, 2), (0.5, 0.5, 2))], preset="as-published")
    assert merged.options.shape == "ft05" and merged.options.seam.fairing_method == "umbrella"


def test_an_edit_names_the_methods_that_made_it(bar, tmp_path):
    edit = edit_of(bar)
    edit.save(tmp_path / "edit.json")
    saved = json.loads((tmp_path / "edit.json").read_text(encoding="utf-8"))
    assert saved["made_with"] == {"version": mg.__version__, "methods": 9} and "made_with" not in edit.to_json()
    assert mg.Edit.load(tmp_path / "edit.json").run().report.notes == ()
    saved["made_with"]["methods"] = 1000
    (tmp_path / "edit.json").write_text(json.dumps(saved), encoding="utf-8")
    old = mg.Edit.load(tmp_path / "edit.json")
    assert [note.id for note in old.run().report.notes] == ["script.other_methods"]
    assert old.run(preset="as-published").report.notes == ()
    old.save(tmp_path / "edit.json")
    assert mg.Edit.load(tmp_path / "edit.json").run().report.notes == ()


def test_a_report_has_what_the_edit_did(bar):
    result = edit_of(bar).run(estimate_condition=True, keep=["bar"])
    step = result.report.steps[0]
    assert (step.name, step.method, step.handles) == ("bend", "corotational", ("top",))
    assert step.counts.vertices == len(bar) and step.evaluation.iterations > 0 and step.condition_estimate > 1
    assert result.report.quality.edge_rms > 0 and result.kept["bar"].vertices.tobytes() == result.mesh.vertices.tobytes()
    assert edit_of(bar).run(method="ft05").report.steps[0].method == "ft05"


def test_steps_follow_each_other():
    edit = mg.Edit().input("body", sample="octopus", resolution=40).input("part", sample="head", resolution=32)
    edit.cut("body", plane=((0, 0, 1.6), "z"), keep="below", name="open")
    edit.merge("body", "part", pairs=[(mg.select.produced("open", "loop"), 0)], name="graft", result="both")
    edit.output("both")
    report = edit.run().report
    assert report.steps[0].cut.topology.boundary_loops == 1 and report.steps[1].merge.report.seam.manifold


def test_compare_runs_each_method(bar):
    outcomes = mg.compare(edit_of(bar), ["ft05", "corotational"])
    assert [outcome.method for outcome in outcomes] == ["ft05", "corotational"]
    assert outcomes[1].result.mesh.vertices.tobytes() == edit_of(bar).run().mesh.vertices.tobytes()
    assert "arap-2007" in mg.methods() and outcomes[0].failure is None
    published, = mg.compare(edit_of(bar), ["as-published"])
    assert published.result.mesh.vertices.tobytes() == edit_of(bar).run(preset="as-published").mesh.vertices.tobytes()


def test_poses_edits_meshes_and_errors_can_be_pickled(bar):
    octopus = mg.sample("octopus", 24)
    for pose in (bend(), mg.Pose(), mg.Pose.matrix(np.eye(4)), mg.Pose.curve([[0, 0, 0], [1, 0, 0]])):
        assert pickle.loads(pickle.dumps(pose)) == pose and hash(copy.deepcopy(pose)) == hash(pose)
    edit = pickle.loads(pickle.dumps(edit_of(bar)))
    assert edit == edit_of(bar)
    assert edit.run().mesh.vertices.tobytes() == edit_of(bar).run().mesh.vertices.tobytes()
    mesh = pickle.loads(pickle.dumps(octopus))
    assert np.array_equal(mesh.faces, octopus.faces) and np.array_equal(mesh.vertex["colour"], octopus.vertex["colour"])
    with pytest.raises(mg.InputError) as caught:
        mg.sample("squid")
    error = pickle.loads(pickle.dumps(caught.value))
    assert (str(error), error.id, error.fields) == (str(caught.value), caught.value.id, caught.value.fields)


def test_errors_have_ids_and_places(bar, ends, tmp_path):
    with pytest.raises(mg.InputError, match="squid") as caught:
        mg.sample("squid")
    assert caught.value.id == "samples.no_such_sample" and caught.value.code == "input" and caught.value.problem
    with pytest.raises(mg.FileError) as caught:
        mg.read(tmp_path / "missing.ply")
    error = caught.value
    assert isinstance(error, FileNotFoundError) and error.errno == errno.ENOENT
    assert error.filename == error.location == str(tmp_path / "missing.ply") and str(error).startswith(error.location)
    copied = pickle.loads(pickle.dumps(error))
    assert (type(copied), str(copied), copied.errno, copied.filename) == (
        type(error), str(error), error.errno, error.filename)
    with pytest.raises(FileNotFoundError) as caught:
        mg.Edit().input("bar", tmp_path / "gone.ply").deform("bar", handles=ends).run()
    assert caught.value.filename == str(tmp_path / "gone.ply") and "inputs.bar" in caught.value.location
    with pytest.raises(ValueError, match="UTF-8"):
        mg.read("\udcff.ply")
    with pytest.raises(TypeError, match="'top' has two poses"):
        mg.Deformer(bar, handles=ends).positions({"top": bend()}, top=bend())
    with pytest.raises(ValueError, match="Unicode"):
        mg.deform(bar, handles=ends, method="\udcff")
    with pytest.raises(IsADirectoryError):
        mg.read(tmp_path)
    (tmp_path / "file").write_text("")
    with pytest.raises(NotADirectoryError):
        mg.read(tmp_path / "file" / "a.ply")
    with pytest.raises(mg.UnsolvableError) as caught:
        mg.deform(bar, handles={"top": mg.Handle(ends["top"][:1], shape="vertex", constrain="position")})
    assert caught.value.id.startswith("deform.component") and caught.value.remedy
    with pytest.raises(mg.InputError) as caught:
        mg.deform(bar, handles={"a": ends["top"], "b": ends["top"]})
    assert caught.value.location == "handles[1].select"
    with pytest.raises(mg.InputError) as caught:
        mg.deform(bar, handles=ends, stiffness=-1)
    assert caught.value.location == "stiffness"
    with pytest.raises(mg.InputError, match="an integer or 'auto'"):
        mg.deform(bar, handles=ends, refine_boundary="often")
    with pytest.raises(mg.InputError, match="meshgraft.cut"):
        mg.merge(bar, mg.sample("head", 24))
    with pytest.raises(FileExistsError):
        mg.write(bar, tmp_path / "a.ply", overwrite=mg.write(bar, tmp_path / "a.ply") is None)
    for kind in (mg.InputError, mg.UsageError):
        assert issubclass(kind, ValueError) and issubclass(kind, mg.Error)
    assert issubclass(mg.OutOfMemoryError, MemoryError) and issubclass(mg.Cancelled, mg.Error)


def test_selections_combine(bar):
    z = bar.vertices[:, 2]
    top, ball = mg.select.half_space((0, 0, 3), "z"), mg.select.sphere((0, 0, 4), 1.2)
    assert set(top(bar)) == set(np.flatnonzero(z >= 3))
    assert set((top & ball)(bar)) == set(top(bar)) & set(ball(bar))
    assert set((top | ball)(bar)) == set(top(bar)) | set(ball(bar))
    assert set((top - ball)(bar)) == set(top(bar)) - set(ball(bar))
    assert set((~top)(bar)) == set(np.flatnonzero(z < 3))
    assert set(top.grow(2)(bar)) > set(top(bar)) > set(top.shrink(1)(bar))
    assert set(top.grow(length=0.5)(bar)) > set(top(bar)) and set(top.rim(1)(bar)) < set(top(bar))
    assert top.mask(bar).sum() == len(top(bar))
    assert list(mg.select.indices([5, 3])(bar)) == [5, 3] and len(mg.select.all()(bar)) == len(bar)
    assert set(mg.select.box((-1, -1, 3), (1, 1, 5))(bar)) == set(top(bar))
    assert len(mg.select.component(0)(bar)) == len(bar) and mg.select.half_space((0, 0, 3), "z") == top
    head = mg.sample("head", 24)
    assert list(mg.select.loop(0)(head)) == list(head.boundary_loops()[0])
    assert "half_space" in repr(top) and len({top, mg.select.half_space((0, 0, 3), "z")}) == 1
    with pytest.raises(mg.InputError) as caught:
        mg.select.loop(3)(bar)
    assert caught.value.id == "select.no_loops"
    with pytest.raises(TypeError):
        top & [1]
    with pytest.raises(ValueError):
        top.grow()


def test_files_keep_what_they_have(tmp_path):
    octopus = mg.sample("octopus", 24)
    assert mg.write(octopus, tmp_path / "a.ply").files == (tmp_path / "a.ply",)
    mesh = mg.read(tmp_path / "a.ply")
    assert mesh.vertex["colour"].dtype == np.uint8 and mesh.notes == () and mesh.unit == ""
    mg.write(mesh, tmp_path / "b.ply")
    assert (tmp_path / "a.ply").read_bytes() == (tmp_path / "b.ply").read_bytes()
    moved = mesh.with_vertices(mesh.vertices + 1)
    assert np.allclose(moved.bounds, mesh.bounds + 1)
    mg.write(moved, tmp_path / "m.glb", morph_target="up", rest=mesh.vertices)
    assert np.allclose(mg.read(tmp_path / "m.glb").vertices, mesh.vertices, atol=1e-6)
    with pytest.raises(ValueError):
        mg.write(moved, tmp_path / "m.glb", morph_target="up")


def test_repair_cut_and_quality(bar, ends):
    assert mg.check(bar).findings == ()
    opened = mg.Mesh(bar.vertices, bar.faces[1:])
    result = mg.repair(opened)
    assert result.changes[0].kind == "filled-hole" and result.mesh.topology().closed
    assert mg.repair(bar).mesh is bar
    cut = mg.cut(bar, plane=((0, 0, 2.05), "z"), keep="both")
    assert len(cut.loops) == 2 and set(cut.face_side) == {-1, 1} and len(cut.origin.t) == len(cut.mesh)
    assert len(mg.cut(bar, values=bar.vertices[:, 2] - 1.23, snap=0.0).loops) == 2
    pinned = mg.cut(bar, plane=((0, 0, 2.05), "z"), keep="below", cap="pins", pin_count=1, pin_diameter=0.2)
    assert pinned.mesh.topology().closed and len(pinned.pins) == 1 and pinned.pins[0].diameter == 0.2
    step = mg.Edit().input("bar", bar).cut("bar", plane=((0, 0, 2.05), "z"), keep="below", cap="pins", pin_count=1,
                                           pin_diameter=0.2).run()
    assert np.array_equal(step.mesh.faces, pinned.mesh.faces) and len(step.report.steps[0].cut.pins) == 1
    implied = mg.cut(bar, plane=((0, 0, 2.05), "z"), keep="below", pin_count=1, pin_diameter=0.2)
    assert np.array_equal(implied.mesh.faces, pinned.mesh.faces)
    assert len(mg.cut(bar, plane=((0, 0, 2.05), "z"), keep="both", pin_side="above").pins) == 2
    step = mg.Edit().input("bar", bar).cut("bar", plane=((0, 0, 2.05), "z"), keep="below", pin_count=1, pin_side=None)
    assert len(step.run().report.steps[0].cut.pins) == 1
    for cap in ("flat", "open"):
        for refuses, mesh in ((mg.cut, bar), (mg.Edit().input("bar", bar).cut, "bar")):
            with pytest.raises(ValueError, match="pin_count asks for pins, so it goes with cap='pins'"):
                refuses(mesh, plane=((0, 0, 2.05), "z"), cap=cap, pin_count=1)
    flat = mg.Edit().input("bar", bar).cut("bar", plane=((0, 0, 2.05), "z"), cap="flat").run()
    assert flat.mesh.topology().closed
    around = mg.select.indices([int(mg.select.nearest(p)(bar)[0]) for p in
                                ((0.5, 0, 2), (0, 0.5, 2), (-0.5, 0, 2), (0, -0.5, 2))])
    assert len(mg.cut(bar, loop=around).loops) == 2
    repaired = mg.Edit().input("opened", opened).repair("opened", hole_edges=5, weld=False, name="mend").run()
    assert np.array_equal(repaired.mesh.faces, mg.repair(opened, hole_edges=5, weld=False).mesh.faces)
    outcome = repaired.report.steps[0].repair
    assert outcome.changes[0].kind == "filled-hole" and len(outcome.map) == len(bar) and not outcome.options.weld
    round_ = mg.Edit().input("bar", bar).sculpt("bar", "inflate", ends["top"], height=0.2).run()
    assert round_.report.steps[0].sculpt.action == "inflate" and round_.report.max_displacement > 0.1
    wide = mg.Edit().input("bar", bar).sculpt("bar", "inflate", ends["top"], height=0.2, reach=0.8).run()
    moved = [(result.mesh.vertices != bar.vertices).any(axis=1).sum() for result in (round_, wide)]
    assert moved[1] > moved[0] > 0
    for reach in (-0.1, float("nan"), "far"):
        with pytest.raises((mg.InputError, ValueError, TypeError), match="reach"):
            mg.Edit().input("bar", bar).sculpt("bar", "flatten", ends["top"], reach=reach).run()
    both = mg.Edit().input("bar", bar).sculpt("bar", "inflate", ends["top"], height=0.2,
                                              symmetry=((0, 0, np.ptp(bar.vertices[:, 2]) / 2), "z")).run()
    assert both.report.steps[0].sculpt.region == 2 * round_.report.steps[0].sculpt.region
    pose = mg.Pose((1, 0, 0), rotate=("x", 90), scale=2)
    moved = mg.Edit().input("bar", bar).transform("bar", pose).run()
    corners = np.c_[bar.vertices, np.ones(len(bar))] @ pose.as_matrix().T
    assert np.allclose(moved.mesh.vertices, corners[:, :3]) and np.allclose(moved.report.steps[0].transform, pose.as_matrix())
    bent = mg.deform(bar, handles=ends, poses={"top": bend(80)})
    quality = mg.quality(bar, bent)
    assert quality.edge_rms > 0 and quality.new_self_intersections == 0
    assert mg.quality(bar, bar).edge_rms == 0 and len(mg.self_intersections(bar)) == 0
    folded = bar.with_vertices(np.where(bar.vertices[:, 2:] > 3, bar.vertices - [0, 0, 2.03], bar.vertices))
    assert mg.self_intersections(folded).shape[1] == 2 and len(mg.self_intersections(folded)) > 0
    assert mg.estimated_memory(10_000) > 1_000_000
    assert bar.vertex_normals().shape == bar.vertices.shape and len(bar.rings()) == len(bar)
    assert set(bar.components()) == {0} and {info.name for info in mg.samples()} >= {"bar", "octopus"}


def test_the_operator_is_a_matrix_of_scipys(bar, ends):
    pytest.importorskip("scipy")
    operator = mg.operators.AffineOperator(bar, opposite_pairs=False)
    count, nodes = len(bar), operator.nodes.positions.shape[0]
    assert operator.H.shape == (3 * count, nodes) and operator.A().shape[1] == nodes
    assert abs(operator.coupling() - operator.P.T @ operator.P).max() < 1e-12
    # Local maps of an affine image are its linear part.
    matrix = np.array([[1.2, 0.4, 0], [0.1, 0.8, 0.3], [0, -0.2, 1.5]])
    maps = operator.H @ (operator.nodes.positions @ matrix.T)
    assert np.allclose(maps.reshape(count, 3, 3), matrix.T, atol=1e-9)
    assert abs(operator.A() @ (operator.nodes.positions @ matrix.T)).max() < 1e-8
    assert operator.L.shape[0] == operator.delta.shape[0] and len(operator.pairs) and operator.mean_edge_length > 0
    assert len(operator.edge_lengths) == count
    d = mg.Deformer(bar, handles=ends)
    lower = d.normal_matrix()
    assert lower.shape[0] == lower.shape[1] and (lower.diagonal() > 0).all() and d.condition_estimate() > 1
    assert d.affine_operator().H.shape[0] == 3 * len(d.patch_vertices)
    assert d.summary.free_vertices == len(d.free_vertices) and d.notes == ()
    assert np.array_equal(d.handle_vertices("top"), ends["top"]) and d.pivot("top").shape == (3,)


def test_a_picture_is_an_array_that_notebooks_show(bar, tmp_path):
    picture = mg.picture(bar, width=64, height=48, samples=1, occlusion_rays=1)
    assert picture.shape == (48, 64, 3) and picture.dtype == np.uint8
    assert picture._repr_png_().startswith(b"\x89PNG")
    two = mg.picture(bar, (bar.vertices, bar.faces), beside=True, captions=["a", "b"], width=64, height=48, samples=1,
                     colours=[None, np.full((len(bar), 3), 0.5)])
    assert two.shape[1] >= 128
    picture.save(tmp_path / "a.png")
    assert (tmp_path / "a.png").stat().st_size > 100 and bar._repr_png_()
    assert (picture * 2.0)._repr_png_() is None


def test_pictures_stand_as_the_models_do(bar, tmp_path):
    small = dict(width=48, height=48, samples=1, occlusion_rays=1)
    turned = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0.0]])  # z up to y up
    upright = mg.picture(bar, **small)
    assert np.array_equal(mg.picture(bar, up="z", look_from=(0.5, -1, 0.35), **small), upright)
    assert not np.array_equal(mg.picture(bar, up="y", **small), upright)
    for name, mesh in {"sample.ply": bar, "sample.obj": bar, "sample.off": bar, "sample.stl": bar,
                       "y.glb": bar.with_vertices(bar.vertices @ turned.T),
                       "y.obj": mg.Mesh(bar.vertices @ turned.T, bar.faces)}.items():
        mg.write(mesh, tmp_path / name)
        again = mg.read(tmp_path / name)
        shown = mg.picture(again, **small).astype(int)
        assert np.abs(shown - upright).mean() < 2, name
        named = again.with_attribute("vertex", "number", np.arange(len(again), dtype=float))
        assert np.array_equal(mg.picture(named, **small), shown), name


def test_names_of_selections_are_the_users(bar, ends, tmp_path):
    handles = {"top": "file", "bottom": "steps[0].anchors[0].select"}
    edit = mg.Edit().input("bar", bar)
    edit.selection("head", ends["top"]).selection("file", "head").selection(handles["bottom"], ends["bottom"])
    edit.deform("bar", handles=handles, poses={"top": mg.Pose((0.5, 0, 0))}, anchors=np.arange(40, 60))
    (tmp_path / "sub").mkdir()
    edit.save(tmp_path / "sub/edit.json")
    found = edit.run().mesh
    assert np.allclose(found.vertices[ends["top"]] - bar.vertices[ends["top"]], (0.5, 0, 0))
    assert mg.Edit.load(tmp_path / "sub/edit.json").run().mesh.vertices.tobytes() == found.vertices.tobytes()


def test_errors_name_arguments_and_no_hidden_edit(bar, ends):
    sphere = mg.select.sphere((0, 0, 0), -1)
    both = {"handles": ends, "poses": {"top": mg.Pose()}}
    for make, location in (
            (lambda: sphere(bar), "selection.sphere.radius"),
            (lambda: (mg.select.all() & sphere)(bar), "selection.intersect[1].sphere.radius"),
            (lambda: mg.select.indices([3, 999])(bar), "selection.indices[1]"),
            (lambda: mg.select.loop(5)(bar), "selection.loop"),
            (lambda: mg.Deformer(bar, handles={"top": sphere}), "handles[0].select.sphere.radius"),
            (lambda: mg.Deformer(bar, handles={"top": mg.select.indices([999])}), "handles[0].select.indices[0]"),
            (lambda: mg.Deformer(bar, handles=ends, fixed=sphere), "fixed.sphere.radius"),
            (lambda: mg.Deformer(bar, handles=ends, stiffness=-1), "stiffness"),
            (lambda: mg.ProxyDeformer(bar, vertices=50, handles=ends, stiffness=-1), "stiffness"),
            (lambda: mg.deform(bar, **both, region=sphere), "region.sphere.radius"),
            (lambda: mg.deform(bar, **both, fixed=mg.select.indices([0, 999])), "fixed.indices[1]")):
        with pytest.raises(mg.InputError) as caught:
            make()
        assert caught.value.location == location and str(caught.value).startswith(location)
    with pytest.raises(ValueError, match="^stiffness: nan"):
        mg.Deformer(bar, handles=ends, stiffness=float("nan"))


def test_an_empty_list_fixes_nothing(bar, ends):
    handles, poses = {"top": ends["top"]}, {"top": mg.Pose((0, 0, 1))}
    moved = mg.deform(bar, handles=handles, poses=poses, fixed=[])
    assert np.allclose(moved.vertices, bar.vertices + (0, 0, 1))
    with pytest.raises(mg.InputError, match="selects no vertex"):
        mg.deform(bar, handles=handles, poses=poses, fixed=mg.select.sphere((99, 0, 0), 1))


def test_what_no_step_has_made_is_an_error(bar):
    with pytest.raises(mg.InputError, match="no step named 'a'"):
        mg.select.produced("a", "b")(bar)


def test_starts_that_are_found_can_be_given():
    bust, head = mg.sample("bust", 24), mg.sample("head", 24)
    found = mg.merge(bust, head)
    starts = found.report.pairs[0].starts
    assert 1 < len(starts) <= 5
    assert [start.probability for start in starts] == sorted((start.probability for start in starts), reverse=True)
    given = mg.merge(bust, head, matches=[(starts[0].start.target, starts[0].start.source)])
    assert np.array_equal(given.mesh.vertices, found.mesh.vertices)
    assert len(given.report.pairs[0].starts) == 0


def test_what_is_known_of_up_and_front_turns_a_part():
    bust, head = mg.sample("bust", 24), mg.sample("head", 24)
    for front, seen in ((("z", "-y"), 1), (((0, 0, 2), (0, 3, 0)), -1)):
        result = mg.merge(bust, head, target_orientation=("z", "-y"), source_orientation=front)
        assert np.sign(result.report.shape.similarity.rotation[0, 0]) == seen
    edit = mg.Edit().input("bust", bust, up="z", front="-y").input("head", head, up="z", front=(0, 1, 0))
    report = edit.merge("bust", "head").run().report
    assert report.steps[0].merge.report.shape.similarity.rotation[0, 0] < 0
    with pytest.raises(ValueError, match="go together"):
        mg.Edit().input("bust", bust, up="z")
    with pytest.raises(ValueError, match="expected \\(up, front\\)"):
        mg.merge(bust, head, source_orientation=("z",))
    with pytest.raises(mg.InputError, match="no orientation"):
        mg.merge(bust, head, source_orientation=("z", "-z"))


def test_large_integers_are_kept_or_refused(bar):
    for value in (2**40, -5, 3_000_000_000):
        assert (bar.with_attribute("vertex", "id", np.full(len(bar), value)).vertex["id"] == value).all()
    with pytest.raises(ValueError, match="2\\^53"):
        bar.with_attribute("vertex", "id", np.full(len(bar), 2**60))


def test_vertices_by_number_are_whole_and_within_the_region(bar, ends):
    with pytest.raises(TypeError):
        mg.deform(bar, handles=ends, targets={7.9: (0, 0, 0)})
    region = bar.vertices[:, 2] > 2
    with pytest.raises(mg.InputError, match="outside the region"):
        mg.VertexDeformer(bar, region, targets=[int(np.argmin(bar.vertices[:, 2]))])


def test_an_edit_keeps_its_files_wherever_the_process_goes(bar, tmp_path, monkeypatch):
    (tmp_path / "meshes").mkdir()
    (tmp_path / "elsewhere").mkdir()
    mg.write(bar, tmp_path / "meshes" / "bar.ply")
    monkeypatch.chdir(tmp_path / "meshes")
    edit = mg.Edit().input("bar", "bar.ply").cut("bar", plane=((0, 0, 2), "z"))
    edit.save("edit.json")
    loaded = mg.Edit.load("edit.json")
    monkeypatch.chdir(tmp_path / "elsewhere")
    for one in (edit, loaded):
        one.run()
        one.input("second", "../meshes/bar.ply").run()
    edit.save("edit.json")
    mg.Edit.load("edit.json").run()


def test_a_save_replaces_no_mesh_of_others(bar, tmp_path):
    mg.write(mg.sample("torus", 8), tmp_path / "bar.ply")
    edit = edit_of(bar)
    with pytest.raises(FileExistsError, match="bar.ply exists.*overwrite=True"):
        edit.save(tmp_path / "edit.json")
    assert not (tmp_path / "edit.json").exists() and len(mg.read(tmp_path / "bar.ply")) != len(bar)
    edit.save(tmp_path / "edit.json", overwrite=True)
    edit.save(tmp_path / "edit.json")  # its own
    assert len(mg.read(tmp_path / "bar.ply")) == len(bar)


def test_a_save_replaces_edit_files_alone(bar, tmp_path):
    notes = tmp_path / "notes.txt"
    notes.write_text("mine")
    with pytest.raises(FileExistsError):
        edit_of(bar).save(notes)
    assert notes.read_text() == "mine" and not (tmp_path / "bar.ply").exists()
    with pytest.raises(IsADirectoryError):
        edit_of(bar).save(tmp_path)
    with pytest.raises(TypeError, match="overwrite"):
        edit_of(bar).save(tmp_path / "edit.json", overwrite="no")


def test_a_save_replaces_no_input(bar, tmp_path):
    torus = mg.sample("torus", 8)
    mg.write(torus, tmp_path / "scan.ply")
    mg.Edit().input("scan", tmp_path / "scan.ply").cut("scan", plane="z").save(tmp_path / "edit.json")
    loaded = mg.Edit.load(tmp_path / "edit.json").input("scan", bar)
    with pytest.raises(FileExistsError):
        loaded.save(tmp_path / "edit.json")
    both = mg.Edit().input("a", tmp_path / "scan.ply").input("scan", bar).cut("a", plane="z")
    for overwrite in (None, True, False):
        with pytest.raises(ValueError, match="is the file of a mesh of the edit"):
            both.save(tmp_path / "both.json", overwrite=overwrite)
    assert len(mg.read(tmp_path / "scan.ply")) == len(torus)


def test_an_edit_is_saved_through_links(bar, tmp_path):
    (tmp_path / "real" / "deep").mkdir(parents=True)
    (tmp_path / "link").symlink_to(tmp_path / "real" / "deep")
    mg.write(bar, tmp_path / "bar.ply")
    mg.Edit().input("bar", tmp_path / "bar.ply").cut("bar", plane=((0, 0, 2), "z")).save(tmp_path / "link" / "edit.json")
    mg.Edit.load(tmp_path / "link" / "edit.json").run()


def test_edits_with_other_meshes_are_not_equal(bar):
    assert mg.Edit() == mg.Edit() != mg.Edit("another name")
    first = edit_of(bar)
    second = copy.copy(first).input("second", bar)
    assert first != second != first and "second" not in first.to_json()
    assert edit_of(bar) == edit_of(bar) == edit_of(bar.with_vertices(bar.vertices))
    assert edit_of(bar) != edit_of(bar.with_vertices(2 * bar.vertices))
