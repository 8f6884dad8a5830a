#!/usr/bin/env python3
"""Runs notebooks and keeps their outputs in them.

    PYTHONPATH=$PWD/build/release/python build/venv/bin/python tools/run_notebook.py [NOTEBOOK…]

Default: examples/tour.ipynb. Cells with the tag "live" show something of the running program; their outputs are left out.
"""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

TOUR = Path(__file__).resolve().parent.parent / "examples/tour.ipynb"


def run(path):
    """Returns the notebook as it is after all its cells have run. Raises CellExecutionError where one fails."""
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=600, record_timing=False).execute(cwd=str(path.parent))
    for cell in notebook.cells:
        if "live" in cell.metadata.get("tags", []):
            cell.outputs = []
        for output in cell.get("outputs", []):
            if "image/png" in output.get("data", {}):
                output["data"] = {"image/png": output["data"]["image/png"]}  # without the numbers of the picture
    notebook.metadata = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
                         "language_info": {"name": "python"}}
    return notebook


def main(paths):
    for path in paths or [TOUR]:
        notebook = run(Path(path))
        with open(path, "w", encoding="utf-8") as file:
            nbformat.write(notebook, file)
        print(f"{path}: {Path(path).stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main(sys.argv[1:])
