"""Runs the examples of docs/python.md, each as a reader would: alone, in an empty folder."""

import re
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[2] / "docs/python.md"
EXAMPLES = re.findall(r"<!-- example: (\S+) -->\n```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def test_there_are_twelve_of_a_few_lines():
    assert len(EXAMPLES) >= 12 and len({name for name, _ in EXAMPLES}) == len(EXAMPLES)
    for name, code in EXAMPLES:
        assert 5 <= len(code.strip().splitlines()) <= 25, name


@pytest.mark.parametrize("name, code", EXAMPLES, ids=[name for name, _ in EXAMPLES])
def test_example(name, code, tmp_path, monkeypatch):
    for library in re.findall(r"^import (trimesh|pyvista|open3d|scipy)", code, re.MULTILINE):
        pytest.importorskip(library)
    monkeypatch.chdir(tmp_path)
    exec(compile(code, f"{PAGE.name}: {name}", "exec"), {"__name__": "__main__"})


@pytest.mark.parametrize("name", [name for name, _ in EXAMPLES])
def test_each_has_its_picture(name):
    picture = PAGE.parent / "images/python" / f"{name}.png"
    assert picture.exists() and f"(images/python/{name}.png)" in PAGE.read_text(encoding="utf-8")
