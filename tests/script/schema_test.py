#!/usr/bin/env python3
"""Checks docs/edit-file.schema.json against the files that the parser accepts and refuses, the examples and the
scenarios.

    schema_test.py ROOT

Exits with 77 (skipped) where python3-jsonschema is missing.
"""

import json
import sys
from pathlib import Path

try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is missing")
    sys.exit(77)

root = Path(sys.argv[1])
schema = json.loads((root / "docs/edit-file.schema.json").read_text())
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)

corpus = root / "tests/script"
accepted = sorted(path for folder in (corpus / "accepted", root / "examples", root / "tests/scenarios")
                  for path in folder.glob("*.json"))
refused = sorted(corpus.glob("refused/*.json"))
wrong = [f"{path}: {error.json_path}: {error.message}"
         for path in accepted for error in validator.iter_errors(json.loads(path.read_text()))]
wrong += [f"{path}: is not refused" for path in refused if validator.is_valid(json.loads(path.read_text()))]
for line in wrong:
    print(line)
print(f"{len(accepted)} accepted, {len(refused)} refused, {len(wrong)} wrong")
sys.exit(1 if wrong or not accepted or not refused else 0)
