#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/script/run_edit.h>

#include "io/file.h"
#include "io/temporary_folder.h"
#include "page_client.h"

namespace meshgraft::test {

inline const Json loop_0 = {{"loop", 0}};

/// An editor whose model is a bust that a head can be grafted onto.
class GraftEditor : public testing::Test {
 protected:
  TemporaryFolder folder_;
  RunningEditor editor_{{folder_.path()}};
  Page page_{editor_.url()};

  void open_bust() { page_.ask({{"do", "open"}, {"sample", "bust"}, {"resolution", 20}}); }
  std::string add_head() {
    return page_.ask({{"do", "part"}, {"what", "add"}, {"sample", "head"}, {"resolution", 18}})["name"];
  }
  void open_bust_and_head() {
    open_bust();
    add_head();
  }
  Json state() { return page_.ask({{"do", "state"}}); }

  /// Waits for the event of this graft or of a newer one.
  Json told(const Json& number) {
    return page_.event("graft", [&](const Json& event) { return event["graft"] >= number; });
  }
  Json graft(Json fields) {
    fields["do"] = "graft";
    return told(page_.ask(fields)["graft"]);
  }
  Frame shown(const Json& event) {
    return page_.frame(6, [&](const Frame& frame) { return frame.header["graft"] == event["graft"]; });
  }
  std::string saved(const std::string& name) {
    page_.ask({{"do", "save"}, {"edit", name}, {"overwrite", true}});
    return read_file(folder_.path() / name);
  }
  /// Saves the edit and the mesh. Expects that running the edit gives the saved mesh and the shown positions.
  Mesh expect_replayed(const std::vector<float>& positions, const std::vector<double>& offset) {
    page_.ask({{"do", "save"}, {"edit", "replayed.json"}, {"mesh", "saved.ply"}, {"overwrite", true}});
    Mesh mesh = run_edit(read_edit_file(folder_ / "replayed.json")).mesh;
    write_mesh(mesh, folder_ / "replayed.ply");
    EXPECT_EQ(read_file(folder_ / "saved.ply"), read_file(folder_ / "replayed.ply"));
    std::vector<float> expected;
    for (Eigen::Index v = 0; v < mesh.positions.rows(); ++v)
      for (int k = 0; k < 3; ++k)
        expected.push_back(static_cast<float>(mesh.positions(v, k) - offset[static_cast<std::size_t>(k)]));
    EXPECT_EQ(positions, expected);
    return mesh;
  }
  Mesh expect_replayed(const Frame& frame) {
    return expect_replayed(frame.numbers.at("positions"), frame.header["offset"].get<std::vector<double>>());
  }
};

}  // namespace meshgraft::test
