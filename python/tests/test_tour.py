"""Runs examples/tour.ipynb in a kernel, and compares what it prints and shows with what the file has."""

import sys
from pathlib import Path

import pytest

pytest.importorskip("ipykernel")
nbformat = pytest.importorskip("nbformat")
ROOT = Path(__file__).resolve().parents[2]
TOUR = ROOT / "examples/tour.ipynb"
sys.path.insert(0, str(ROOT / "tools"))


def shown(notebook):
    """Returns, for each cell of code, the text that it prints and the kinds of pictures that it shows."""
    return [[output.get("text") or sorted(output.get("data", {})) for output in cell.outputs]
            for cell in notebook.cells if cell.cell_type == "code"]


def test_all_cells_run_and_show_what_the_file_has(program, monkeypatch, tmp_path):
    from run_notebook import run

    monkeypatch.setenv("MESHGRAFT_PROGRAM", str(Path(program).resolve()))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(tmp_path))
    kept = nbformat.read(TOUR, as_version=4)
    assert shown(run(TOUR)) == shown(kept)
    assert sum("image/png" in kinds for cell in shown(kept) for kinds in cell) >= 5


def test_the_file_is_small_and_has_nothing_of_the_machine():
    text = TOUR.read_text(encoding="utf-8")
    assert len(text) < 1_500_000 and "token=" not in text and str(ROOT) not in text
