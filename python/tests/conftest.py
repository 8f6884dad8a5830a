"""Meshes that the tests share, and the program to compare with."""

import os
import shutil

import numpy as np
import pytest

import meshgraft as mg


@pytest.fixture(scope="session")
def bar():
    """A closed bar, [-0.5, 0.5]² x [0, 4]."""
    return mg.sample("bar", 16)


@pytest.fixture(scope="session")
def ends(bar):
    """Vertices of its two ends."""
    z = bar.vertices[:, 2]
    return {"bottom": np.flatnonzero(z < 0.3), "top": np.flatnonzero(z > 3.7)}


@pytest.fixture(scope="session")
def program():
    """The command line program of the same build."""
    path = os.environ.get("MESHGRAFT_PROGRAM") or shutil.which("meshgraft")
    if not path or not os.path.exists(path):
        pytest.skip("no program: MESHGRAFT_PROGRAM names it")
    return path


def bend(angle=40.0):
    return mg.Pose((0.1, 0, 0.05), rotate=("y", angle))
