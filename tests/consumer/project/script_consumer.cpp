// Runs an edit of a built-in model by a method of the library and by a published one.
#include <cstdio>

#include <meshgraft/samples/samples.h>
#include <meshgraft/script/run_edit.h>

int main() {
  const meshgraft::EditFile edit = meshgraft::parse_edit(R"({"format": "meshgraft-edit", "version": 2,
    "inputs": {"bar": {"sample": "bar", "resolution": 6}},
    "steps": [{"kind": "deform", "mesh": "bar",
      "fixed": {"half_space": {"point": [0, 0, 0.3], "normal": [0, 0, -1]}},
      "handles": [{"name": "top", "select": {"half_space": {"point": [0, 0, 3.7], "normal": [0, 0, 1]}},
                   "pose": {"translate": [1, 0, 0]}}]}]})",
                                                         "edit.json", ".");
  bool moved = true;
  for (const char* name : {"corotational", "arap-2007"}) {
    meshgraft::RunOptions options;
    options.overrides.method = meshgraft::method_named(name);
    const meshgraft::EditResult result = meshgraft::run_edit(edit, options);
    const double farthest = (result.mesh.positions - result.rest).rowwise().norm().maxCoeff();
    std::printf("%s: farthest moved by %g\n", name, farthest);
    moved = moved && farthest > 0.9 && farthest < 1.5;
  }
  const meshgraft::Mesh bar = meshgraft::make_sample("bar", 6);
  return moved && bar.vertex_count() > 0 ? 0 : 1;
}
