"""Tests tools/message_kinds.py on the editor's protocol."""

import json
import re
import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import message_kinds  # noqa: E402

SCHEMA = ROOT / "src/editor/protocol.schema.json"


class MessageKinds(unittest.TestCase):
    def test_makes_an_enumerator_of_each_kind_of_the_schema(self):
        kinds = json.loads(SCHEMA.read_text())["$defs"]["message_kind"]["oneOf"]
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "editor/message_kind.h"
            message_kinds.main(SCHEMA, out)
            made = dict(re.findall(r"^  (\w+) = (\d+),", out.read_text(), re.MULTILINE))
        self.assertEqual(made, {kind["title"]: str(kind["const"]) for kind in kinds})
        self.assertEqual(len(set(made.values())), len(kinds))

    def test_every_kind_is_sent_and_taken(self):
        engine = "".join(path.read_text() for path in (ROOT / "src/editor").glob("*.cpp"))
        page = "".join(path.read_text() for path in (ROOT / "page/src").rglob("*.ts"))
        for kind in json.loads(SCHEMA.read_text())["$defs"]["message_kind"]["oneOf"]:
            self.assertIn(f"MessageKind::{kind['title']}", engine)
            self.assertIn(f"MessageKind.{kind['title']}", page)


if __name__ == "__main__":
    unittest.main()
