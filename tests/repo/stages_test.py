"""Tests that the stages of progress are those of the editor's protocol, which is the list of them."""

import json
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DEFINITIONS = json.loads((ROOT / "src/editor/protocol.schema.json").read_text())["$defs"]
STAGES, TASKS = DEFINITIONS["progress_stage"]["enum"], DEFINITIONS["progress_task"]["enum"]
CALL = re.compile(r"\.step\(\s*([^,)]*)")
NAMED = re.compile(r'"([a-z]+(?:_[a-z]+)*)"')


def calls(folder):
    """Returns the first arguments of all calls of Context::step, with their files."""
    for path in sorted([*(ROOT / folder).rglob("*.cpp"), *(ROOT / folder).rglob("*.h")]):
        for argument in CALL.findall(path.read_text()):
            yield path, argument.strip()


def rows(title):
    """Returns the first column of the table below a heading of docs/architecture.md."""
    section = (ROOT / "docs/architecture.md").read_text().split(f"\n## {title}\n")[1].split("\n## ")[0]
    return re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE)


class Stages(unittest.TestCase):
    def test_the_list_is_sorted_and_has_no_stage_twice(self):
        self.assertEqual(STAGES, sorted(set(STAGES)))

    def test_every_stage_is_named_in_full(self):
        for path, argument in [*calls("src"), *calls("cli")]:
            self.assertRegex(argument, NAMED, path)

    def test_the_library_has_the_stages_of_the_list(self):
        self.assertEqual(sorted({argument.strip('"') for _, argument in calls("src")}), STAGES)

    def test_the_command_line_has_no_others(self):
        for path, argument in calls("cli"):
            self.assertIn(argument.strip('"'), STAGES, path)

    def test_the_documentation_describes_each(self):
        self.assertEqual(rows("Stages of progress"), STAGES)

    def test_the_command_line_words_those_of_several_words(self):
        table = (ROOT / "cli/progress_text.cpp").read_text()
        worded = re.findall(r'^    \{"(\w+)", "[^"]+"\},$', table, re.MULTILINE)
        self.assertLessEqual({stage for stage in STAGES if "_" in stage}, set(worded))
        self.assertLessEqual(set(worded), set(STAGES))

    def test_every_task_is_named_in_the_library(self):
        named = {task for source in sorted((ROOT / "src").rglob("*.cpp"))
                 for task in re.findall(r'\b(?:behind|context\.within)\("(\w+)"', source.read_text())}
        self.assertEqual(sorted(named), sorted(TASKS))


if __name__ == "__main__":
    unittest.main()
