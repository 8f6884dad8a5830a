"""python -m meshgraft: the program."""

import os
import sys
from pathlib import Path

program = Path(__file__).parent / "bin" / "meshgraft"
if not program.exists():
    sys.exit("This build of the package has no program. Build it with MESHGRAFT_BUILD_CLI.")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # the program would restart itself to set it
os.execv(program, ["meshgraft", *sys.argv[1:]])
