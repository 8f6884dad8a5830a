#!/usr/bin/env python3
"""Checks a recorded conversation against src/editor/protocol.schema.json.

    protocol_schema_test.py ROOT CONVERSATION

Each line of the conversation is {"from": "page" | "engine" | "header", "message"}. Exits with 77 where
python3-jsonschema is missing.
"""

import json
import sys
from pathlib import Path

try:
    import jsonschema
except ImportError:
    print("python3-jsonschema is missing")
    sys.exit(77)

schema = json.loads((Path(sys.argv[1]) / "src/editor/protocol.schema.json").read_text())
jsonschema.Draft202012Validator.check_schema(schema)


def validator_of(part):
    return jsonschema.Draft202012Validator({"$ref": f"#/$defs/{part}", "$defs": schema["$defs"]})


validators = {part: validator_of(part) for part in ("request", "reply", "event", "message_header")}


def part_of(sender, message):
    if sender == "engine":
        return "event" if "event" in message else "reply"
    return {"page": "request", "header": "message_header"}[sender]


spoken, wrong = {}, []
for line in Path(sys.argv[2]).read_text().splitlines():
    entry = json.loads(line)
    part = part_of(entry["from"], entry["message"])
    spoken[part] = spoken.get(part, 0) + 1
    for error in validators[part].iter_errors(entry["message"]):
        best = jsonschema.exceptions.best_match([error])
        wrong.append(f"{part} {json.dumps(entry['message'])[:200]}: {best.json_path}: {best.message[:300]}")

# Every request of the schema must occur in the conversation, so that each of them is checked.
known = set()
for one in schema["$defs"]["request"]["oneOf"]:
    word = one["properties"]["do"]
    known.update(word.get("enum", [word.get("const")]))
asked = {json.loads(line)["message"].get("do") for line in Path(sys.argv[2]).read_text().splitlines()}
wrong += [f"'{word}' was never asked" for word in sorted(known - asked)]

for line in wrong:
    print(line)
print(f"{spoken}, {len(wrong)} wrong")
sys.exit(1 if wrong or set(spoken) != set(validators) else 0)
