#!/usr/bin/env python3
"""Makes a C++ enumeration of the kinds of binary messages that the editor's protocol describes.

    tools/message_kinds.py SCHEMA OUT.h
"""

import json
import sys
from pathlib import Path


def header(schema):
    kinds = schema["$defs"]["message_kind"]["oneOf"]
    lines = ["// Made from src/editor/protocol.schema.json by tools/message_kinds.py.", "#pragma once", "",
             "#include <cstdint>", "", "namespace meshgraft::editor {", "",
             "/// The kinds of binary messages, each with its arrays.", "enum class MessageKind : std::uint32_t {"]
    lines += [f"  {kind['title']} = {kind['const']},  ///< {kind['description']}" for kind in kinds]
    return "\n".join(lines + ["};", "", "}  // namespace meshgraft::editor", ""])


def main(schema, out):
    made = header(json.loads(Path(schema).read_text()))
    path = Path(out)
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != made:
        path.write_text(made)


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
