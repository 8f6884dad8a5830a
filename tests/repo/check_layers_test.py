"""Tests that tools/check_layers.py finds the violations of small made-up trees, and no others."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.dont_write_bytecode = True
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))
import check_layers  # noqa: E402


class CheckLayers(unittest.TestCase):
    def violations(self, files):
        """Returns the violations of a tree given as {path: text}."""
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name, text in files.items():
                path = root / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            return check_layers.check(root)

    def assert_one(self, files, *parts):
        problems = self.violations(files)
        self.assertEqual(len(problems), 1, problems)
        for part in parts:
            self.assertIn(part, problems[0])

    def test_downward_and_sideways_within_a_layer_is_fine(self):
        self.assertEqual(
            self.violations({
                "include/meshgraft/core/error.h": "#include <string>\n",
                "include/meshgraft/mesh/mesh.h": "#include <meshgraft/core/error.h>\n",
                "src/mesh/table.h": "",
                "src/mesh/mesh.cpp": '#include <meshgraft/mesh/mesh.h>\n#include "table.h"\n#include "mesh/table.h"\n',
                "src/deform/deformer.cpp": "#include <meshgraft/mesh/mesh.h>\n",
                "cli/main.cpp": '#include <meshgraft/mesh/mesh.h>\n',
                "tests/mesh/mesh_test.cpp": "#include <meshgraft/deform/deformer.h>\n",
            }), [])

    def test_upward_include(self):
        self.assert_one({
            "include/meshgraft/deform/deformer.h": "",
            "src/mesh/mesh.cpp": "#include <string>\n\n#include <meshgraft/deform/deformer.h>\n",
        }, "src/mesh/mesh.cpp:3", "mesh must not use deform")

    def test_folders_of_a_layer_include_what_they_may(self):
        tree = {"src/deform/setup/patch.h": "", "src/deform/solve/solve.h": '#include "deform/setup/patch.h"\n',
                "src/deform/solve/a.cpp": '#include "solve.h"\n#include "deform/facts.h"\n'}
        self.assertEqual(self.violations(tree), [])
        self.assert_one({**tree, "src/deform/setup/b.cpp": '#include "deform/solve/solve.h"\n'},
                        "src/deform/setup/b.cpp:1", "deform/setup must not use deform/solve")
        self.assert_one({**tree, "src/deform/odd/b.cpp": '#include "deform/setup/patch.h"\n'}, "deform/odd is not in ROOMS")

    def test_the_core_of_a_layer_does_not_include_its_facade(self):
        facade = {"include/meshgraft/deform/deformer.h": ""}
        line = "#include <meshgraft/deform/deformer.h>\n"
        self.assertEqual(self.violations({**facade, "src/deform/proxy/a.cpp": line}), [])
        self.assert_one({**facade, "src/deform/solve/a.cpp": line}, "deform/solve lies below deformer.h")

    def test_the_drawing_leaves_out_what_follows(self):
        self.assertEqual(check_layers.reduced({"a": {"b", "c"}, "b": {"c"}, "c": set()}), {"a": ["b"], "b": ["c"], "c": []})

    def test_facts_are_of_the_layer_of_their_table(self):
        tree = {"src/io/gltf/facts.json": "{}", "src/io/file.cpp": '#include "gltf/facts.h"\n#include "core/facts.h"\n'}
        self.assertEqual(self.violations(tree), [])
        self.assert_one({**tree, "src/mesh/mesh.cpp": '#include "gltf/facts.h"\n'}, "mesh must not use io")

    def test_upward_include_of_a_header_that_does_not_exist_yet(self):
        self.assert_one({"src/core/error.cpp": "#include <meshgraft/mesh/mesh.h>\n"}, "core must not use mesh")

    def test_upward_include_by_a_private_path(self):
        for line in ('#include "../deform/rows.h"', '#include "deform/rows.h"', '  #  include "deform/rows.h"'):
            self.assert_one({"src/deform/rows.h": "", "src/operators/a.cpp": line + "\n"},
                            "src/operators/a.cpp:1", "operators must not use deform")

    def test_sideways_include(self):
        self.assert_one({"src/render/a.cpp": "#include <meshgraft/samples/samples.h>\n"}, "render must not use samples")
        self.assert_one({"src/linalg/a.cpp": "#include <meshgraft/io/mesh_io.h>\n"}, "linalg must not use io")

    def test_the_platform_uses_nothing_of_ours_and_all_use_it(self):
        header = {"src/core/platform/file.h": ""}
        for source in ("src/core/memory.cpp", "src/editor/journal.cpp", "cli/outputs.cpp"):
            self.assertEqual(self.violations(header | {source: '#include "core/platform/file.h"\n'}), [])
        self.assert_one({"src/core/platform/posix/file.cpp": "#include <meshgraft/core/error.h>\n"},
                        "platform must not use core")

    def test_public_header_with_a_private_one(self):
        self.assert_one({
            "src/mesh/table.h": "",
            "include/meshgraft/mesh/mesh.h": '#include "mesh/table.h"\n',
        }, "a public header includes the private src/mesh/table.h")

    def test_camd_in_one_source_only(self):
        one = {"src/linalg/symbolic_factorisation.cpp": "#include <camd.h>\n"}
        self.assertEqual(self.violations(one), [])
        self.assert_one(one | {"src/linalg/other.cpp": "#include <suitesparse/camd.h>\n"},
                        "camd.h is included by 2 files", "symbolic_factorisation.cpp:1", "other.cpp:1")
        self.assert_one({"include/meshgraft/linalg/linear_solver.h": "#include <camd.h>\n"},
                        "a public header includes camd.h")

    def test_cgal_in_one_source_only(self):
        one = {"src/deform/a.cpp": "#include <CGAL/intersections.h>\n#include <CGAL/enum.h>\n"}
        self.assertEqual(self.violations(one), [])
        self.assert_one(one | {"src/deform/b.cpp": "#include <CGAL/enum.h>\n"},
                        "CGAL is included by 2 files", "a.cpp:2", "b.cpp:1")

    def test_what_only_some_systems_have_stands_in_one_folder(self):
        for line, use in {
            "#include <unistd.h>": "<unistd.h>",
            " # include <sys/mman.h>": "<sys/mman.h>",
            "#include <windows.h>": "<windows.h>",
            'std::ifstream lines("/proc/self/cgroup");': "/proc/self/cgroup",
            'open("http://a", "/dev/null");  // quiet': "/dev/null",
            "if (setenv(name, value, 1) != 0) return;": "setenv",
        }.items():
            for source in ("src/io/file.cpp", "cli/edit.cpp", "include/meshgraft/core/context.h"):
                self.assert_one({source: "\n" + line + "\n"}, f"{source}:2", f"has {use};", "src/core/platform")
            self.assertEqual(self.violations({"src/core/platform/posix/file.cpp": line + "\n"}), [])

    def test_what_every_system_has_may_be_used_anywhere(self):
        for line in ("#include <csignal>", "#include <system_error>", '#include "signal.h"', "#include <netinet.h>",
                     "// behind /dev/stdout is no path", 'say("a");  // as in "/proc/self/exe"',
                     'say("see /usr/share/doc");', "platform::set_environment_variable(name, value);",
                     "signal(event);"):
            self.assertEqual(self.violations({"src/io/file.cpp": line + "\n"}), [], line)

    def test_a_layer_may_use_what_its_target_links(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for layer, text in {
                "core": "meshgraft_layer(core)\ntarget_link_libraries(meshgraft_layer_core PRIVATE fmt::fmt)\n",
                "mesh": "meshgraft_layer(mesh)\ntarget_link_libraries(meshgraft_layer_mesh\n"
                        "  PUBLIC meshgraft_layer_core  # not meshgraft_layer_io\n  PRIVATE $<LINK_ONLY:A::A>\n)\n"
                        "if(B)\n  target_link_libraries(meshgraft_layer_mesh PUBLIC meshgraft_layer_linalg)\nendif()\n",
            }.items():
                path = root / "src" / layer / "CMakeLists.txt"
                path.parent.mkdir(parents=True)
                path.write_text(text, encoding="utf-8")
            self.assertEqual(check_layers.read_uses(root), {"core": set(), "mesh": {"core", "linalg"}})

    def test_every_folder_of_sources_is_a_layer(self):
        folders = {path.name for path in (check_layers.ROOT / "src").iterdir() if path.is_dir()}
        self.assertEqual(set(check_layers.USES), folders | {"platform", "cli", "python"})
        self.assertEqual(set(check_layers.PURPOSE), set(check_layers.USES) - {"python"})

    def test_folder_that_is_no_layer(self):
        self.assert_one({"src/misc/a.cpp": ""}, "src/misc/a.cpp", "not in a known layer")

    def test_no_layer_uses_one_that_uses_it(self):
        def reach(layer):
            return set().union(*({used} | reach(used) for used in check_layers.USES[layer]))
        for layer in check_layers.USES:
            self.assertNotIn(layer, reach(layer))

    def test_an_empty_tree_is_a_failure(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(check_layers.main([folder]), 1)


if __name__ == "__main__":
    unittest.main()
