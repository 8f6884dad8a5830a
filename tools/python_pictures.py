#!/usr/bin/env python3
"""Makes the pictures of docs/python.md again: runs its examples, and keeps what each calls `picture`.

    PYTHONPATH=build/release/python build/venv/bin/python tools/python_pictures.py [NAME…]
"""

import os
import re
import sys
import tempfile
from pathlib import Path

DOCS = Path(__file__).resolve().parent.parent / "docs"


def main(names):
    page = (DOCS / "python.md").read_text(encoding="utf-8")
    folder = DOCS / "images/python"
    folder.mkdir(parents=True, exist_ok=True)
    for name, code in re.findall(r"<!-- example: (\S+) -->\n```python\n(.*?)```", page, re.DOTALL):
        if names and name not in names:
            continue
        with tempfile.TemporaryDirectory() as scratch:
            os.chdir(scratch)
            space = {}
            exec(compile(code, name, "exec"), space)
            os.chdir(DOCS)
        space["picture"].save(folder / f"{name}.png")
        print(f"docs/images/python/{name}.png", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
