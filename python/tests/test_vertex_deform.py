"""Constraints per vertex, fields of maps, and evaluation into the caller's memory."""

import numpy as np
import pytest

import meshgraft as mg
from conftest import bend

SETTINGS = ({}, {"method": "ft05"}, {"method": "rotation-aware"}, {"method": "shell"})


@pytest.mark.parametrize("settings", SETTINGS, ids=["default", "ft05", "rotation-aware", "shell"])
def test_handles_are_constraints_per_vertex(bar, ends, settings):
    with_handles = mg.Deformer(bar, handles=ends, **settings)
    vertices, positions, transforms = with_handles.constraints(top=bend())
    assert sorted(vertices) == sorted([*ends["bottom"], *ends["top"]])
    by_vertex = mg.VertexDeformer(bar, targets=vertices, transforms=vertices, **settings)
    found, wanted = by_vertex.positions(positions, transforms), with_handles.positions(top=bend())
    assert np.abs(found - wanted).max() < 1e-9
    assert (by_vertex.free_vertices == with_handles.free_vertices).all()


def test_the_order_of_the_vertices_is_the_callers(bar, ends):
    top = ends["top"][::-1]
    held = mg.VertexDeformer(bar, targets=[*ends["bottom"], *top], transforms=top)
    goals = np.concatenate([bar.vertices[ends["bottom"]], bar.vertices[top] + np.arange(len(top))[:, None] * [0.001, 0, 0]])
    moved = held.evaluate(goals)
    assert moved.vertices[top].tobytes() == goals[len(ends["bottom"]):].tobytes()
    assert held.evaluate().vertices == pytest.approx(bar.vertices, abs=1e-12)
    assert held.summary.free_vertices == len(held.free_vertices)


def test_only_the_region_moves_and_what_is_fixed_stays(bar):
    z = bar.vertices[:, 2]
    region = np.flatnonzero((z > 1) & (z < 3))
    middle = np.flatnonzero(np.abs(z - 2) < 0.1)
    held = mg.VertexDeformer((bar.vertices, bar.faces), region, targets=middle)
    moved = held.evaluate(bar.vertices[middle] + [0.3, 0, 0])
    outside = np.setdiff1d(np.arange(len(bar)), held.free_vertices)
    outside = np.setdiff1d(outside, middle)
    assert moved[outside].tobytes() == bar.vertices[outside].tobytes() and len(held.free_vertices) > 0
    assert (moved[middle] - bar.vertices[middle]) == pytest.approx(np.tile([0.3, 0, 0], (len(middle), 1)))


def test_the_field_of_ft05_is_the_identity(bar, ends):
    linear = mg.Deformer(bar, handles=ends, method="ft05")
    field = np.tile(np.eye(3), (len(bar), 1, 1))
    wanted = linear.positions(top=bend())
    assert np.abs(linear.positions_with_field(field, top=bend()) - wanted).max() < 1e-12
    vertices, positions, transforms = linear.constraints(top=bend())
    by_vertex = mg.VertexDeformer(bar, targets=vertices, transforms=vertices, method="ft05")
    assert np.abs(by_vertex.positions_with_field(field, positions, transforms) - wanted).max() < 1e-9


def test_a_field_turns_what_is_between(bar, ends):
    rest = mg.Deformer(bar, handles=ends, method="ft05")
    angle = np.sin(np.pi * bar.vertices[:, 2] / 4)
    field = np.tile(np.eye(3), (len(bar), 1, 1))
    field[:, 0, 0], field[:, 0, 1] = np.cos(angle), -np.sin(angle)
    field[:, 1, 0], field[:, 1, 1] = np.sin(angle), np.cos(angle)
    moved = rest.positions_with_field(field)
    assert np.abs(moved - bar.vertices).max() > 0.1
    assert moved[ends["top"]].tobytes() == bar.vertices[ends["top"]].tobytes()


def test_it_writes_into_the_callers_array(bar, ends):
    d = mg.VertexDeformer(bar, targets=[*ends["bottom"], *ends["top"]])
    goals = np.concatenate([bar.vertices[ends["bottom"]], bar.vertices[ends["top"]] + [0, 0.2, 0]])
    out = np.full_like(bar.vertices, np.nan)
    assert d.positions(goals, out=out) is out
    assert out.tobytes() == d.positions(goals).tobytes()


def test_wrong_arrays_are_refused(bar, ends):
    d = mg.VertexDeformer(bar, targets=ends["bottom"], transforms=ends["top"])
    with pytest.raises(ValueError, match="targets"):
        d.positions(np.zeros((2, 3)))
    with pytest.raises(ValueError, match=r"transforms: expected numbers of shape \(\d+, 3, 3\)"):
        d.positions(None, np.eye(3))
    with pytest.raises(ValueError, match=r"field\[4, 1, 1\] is nan"):
        field = np.tile(np.eye(3), (len(bar), 1, 1))
        field[4, 1, 1] = np.nan
        d.positions_with_field(field)
    with pytest.raises(ValueError, match=r"targets\[2\]: vertex 7 is there twice"):
        mg.VertexDeformer(bar, targets=[7, 1, 7])
    with pytest.raises(mg.UnsolvableError):
        mg.VertexDeformer(bar, targets=[0])
