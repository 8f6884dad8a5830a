"""The package as a whole: its types, its docs, and that every public name is used."""

import ast
import dataclasses
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest

import meshgraft as mg

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]


def public_names():
    for name in mg.__all__:
        value = getattr(mg, name)
        if inspect.ismodule(value):
            yield from value.__all__
        elif inspect.isclass(value):
            yield name
            if not hasattr(value, "__dataclass_fields__") and not issubclass(value, Exception):
                yield from (own for own in vars(value) if not own.startswith("_"))
        elif not name.startswith("__"):
            yield name


def used_names():
    """Names and attributes in the tests and in the examples of the docs."""
    sources = [path.read_text() for path in HERE.glob("*.py") if path.name != "test_package.py"]
    sources += re.findall(r"```python\n(.*?)```", (ROOT / "docs/python.md").read_text(), re.DOTALL)
    for source in sources:
        for node in ast.walk(ast.parse(source)):
            if isinstance(node, ast.Attribute):
                yield node.attr


# Classes that functions return, which nobody calls by name.
RETURNED = {"Attributes", "CutResult", "DeformerSummary", "Diagnostics", "EdgePoints", "EditReport", "EditResult",
            "EvaluationReport", "Finding", "HandleBasis", "LiveFrame", "MergeReport", "MergeResult", "MethodOutcome", "Note",
            "Picture", "ProxySummary", "Quality", "ReducedFrames", "RepairChange", "RepairResult", "SampleInfo",
            "Selection", "StepReport", "TopologySummary", "WriteResult"}


def test_every_public_name_is_used():
    assert sorted(set(public_names()) - set(used_names()) - RETURNED) == []


def test_every_public_name_has_a_docstring():
    for name in mg.__all__:
        value = getattr(mg, name)
        if name != "__version__":
            assert inspect.getdoc(value), name
        if inspect.isclass(value) and value.__module__.startswith("meshgraft"):
            for own, member in vars(value).items():
                if not own.startswith("_") and (callable(member) or isinstance(member, property)):
                    assert inspect.getdoc(member), f"{name}.{own}"


def test_docstrings_have_what_the_headers_say():
    assert "NaN" in mg.check.__doc__ or "non_finite" in mg.check.__doc__
    assert "Raises" in mg.read.__doc__ and "Error(" not in mg.read.__doc__
    assert "n×3" in mg.Deformer.__doc__ or "back-substitutions" in mg.Deformer.__doc__
    assert mg.__version__ == (ROOT / "VERSION").read_text().strip()


def test_mypy_finds_nothing_in_strict_mode(tmp_path):
    pytest.importorskip("mypy")
    program = tmp_path / "program.py"
    program.write_text(USES)
    package = Path(mg.__file__).parent
    for target in (["-p", "meshgraft"], [str(program)]):
        result = subprocess.run([sys.executable, "-m", "mypy", "--config-file", str(ROOT / "pyproject.toml"),
                                 "--cache-dir", str(package.parent / ".mypy_cache"), *target],
                                capture_output=True, text=True, cwd=package.parent)
        assert result.returncode == 0, result.stdout + result.stderr


USES = '''
import numpy as np
import meshgraft as mg

mesh = mg.sample("bar")
deformer = mg.Deformer(mesh, handles={"top": mg.select.half_space((0, 0, 3), "z")}, method="ft05", stiffness=3.0)
bent: mg.Mesh = deformer.evaluate(top=mg.Pose(rotate=("z", 40)))
count: int = mg.repair(bent, hole_fill="faired").changes[0].count
result = mg.merge(mesh, bent, matches=[(0, 1)], strip="greedy", band=2)
grafted: mg.Mesh = result.mesh
mg.Deformer(mesh, method="ft06")  # type: ignore[arg-type]
mg.repair(mesh, hole_file="faired")  # type: ignore[call-arg]
'''


def test_help_tells_of_each_attribute_of_what_functions_return():
    for record in (mg.CutResult, mg.RepairResult, mg.Quality, mg.MergeReport):
        for field in dataclasses.fields(record):
            assert f"\n    {field.name}: " in inspect.getdoc(record), f"{record.__name__}.{field.name}"
