// A cut that divides an object in two, each of which is an object.
#include <string>
#include <vector>

#include <meshgraft/mesh/topology.h>

#include "graft_editor.h"

namespace meshgraft::test {
namespace {

class Halves : public GraftEditor {
 protected:
  static Json plane_at(double z) { return {{"point", {0, 0, z}}, {"normal", {0, 0, 1}}}; }

  void SetUp() override { page_.ask({{"do", "open"}, {"sample", "bar"}, {"resolution", 12}}); }
  Json divide(Json more = {{"cap", "flat"}}) {
    more.update({{"do", "cut"}, {"plane", plane_at(2.1)}, {"halves", true}});
    return page_.ask(more);
  }
  Mesh exported(const std::string& mesh) {
    page_.ask({{"do", "export"}, {"path", "half.ply"}, {"mesh", mesh}, {"overwrite", true}});
    return read_mesh(folder_ / "half.ply");
  }
  static double lowest(const Mesh& mesh) { return mesh.positions.col(2).minCoeff(); }
  static double highest(const Mesh& mesh) { return mesh.positions.col(2).maxCoeff(); }
};

TEST_F(Halves, AreAModelAndAPart) {
  EXPECT_EQ(divide()["name"], "bar 2");
  const Json now = state();
  EXPECT_EQ(now["model"]["name"], "bar");
  ASSERT_EQ(now["parts"].size(), 1u);
  EXPECT_EQ(now["parts"][0]["name"], "bar 2");
  EXPECT_EQ(now["undo"], "cut");
  page_.ask({{"do", "undo"}});
  EXPECT_TRUE(state()["parts"].empty()) << "one change makes both";
}

TEST_F(Halves, AreExportedEachByItself) {
  divide();
  for (const char* name : {"bar", "bar 2"}) {
    const Mesh half = exported(name);
    EXPECT_TRUE(summarise_topology(half).closed) << name;
    EXPECT_NEAR(name == std::string("bar") ? lowest(half) : highest(half), 2.1, 1e-6);
  }
  EXPECT_EQ(page_.refusal({{"do", "export"}, {"path", "none.ply"}, {"mesh", "none"}})["id"],
            "editor.no_such_part");
}

TEST_F(Halves, AreMadeByTheSavedEditAndMayBeTheOutput) {
  divide({{"pins", {{"count", 1}, {"diameter", 0.2}}}});
  const Mesh above = exported("bar"), below = exported("bar 2");
  EXPECT_GT(highest(below), 2.3) << "the pin stands out";
  EXPECT_NEAR(lowest(above), 2.1, 1e-6) << "the hole goes into it";
  page_.ask({{"do", "save"}, {"edit", "halves.json"}});
  EXPECT_EQ(run_edit(read_edit_file(folder_ / "halves.json")).mesh.vertex_count(), above.vertex_count());
  page_.ask({{"do", "part"}, {"what", "edit"}, {"name", "bar 2"}});
  page_.ask({{"do", "save"}, {"edit", "lower.json"}});
  EXPECT_EQ(run_edit(read_edit_file(folder_ / "lower.json")).mesh.vertex_count(), below.vertex_count());
}

TEST_F(Halves, AreCutAlikeWhenTheCutIsChanged) {
  divide();
  page_.ask({{"do", "step"}, {"what", "change"}, {"index", 1}, {"fields", {{"plane", plane_at(1.1)}}}});
  EXPECT_NEAR(lowest(exported("bar")), 1.1, 1e-6);
  EXPECT_NEAR(highest(exported("bar 2")), 1.1, 1e-6);
  page_.ask({{"do", "step"}, {"what", "change"}, {"index", 0}, {"fields", {{"keep", "above"}}}});
  EXPECT_NEAR(highest(exported("bar")), 1.1, 1e-6);
  EXPECT_NEAR(lowest(exported("bar 2")), 1.1, 1e-6);
}

TEST_F(Halves, ShareTheFieldsOfTheCutAlone) {
  divide();
  page_.ask({{"do", "step"}, {"what", "change"}, {"index", 1}, {"fields", {{"about", "the red one"}}}});
  page_.ask({{"do", "save"}, {"edit", "halves.json"}});
  std::vector<std::string> remarks;
  for (const EditStep& step : read_edit_file(folder_ / "halves.json").steps)
    if (!step.about.empty()) remarks.push_back(step.about);
  EXPECT_EQ(remarks, std::vector<std::string>{"the red one"});
}

TEST_F(Halves, ArePartsThatCanBeRemovedAndDividedAgain) {
  divide();
  EXPECT_EQ(page_.ask({{"do", "cut"},
                       {"mesh", "bar 2"},
                       {"plane", plane_at(1)},
                       {"halves", true},
                       {"cap", "flat"}})["name"],
            "bar 2 2");
  EXPECT_EQ(page_.refusal({{"do", "part"}, {"what", "remove"}, {"name", "bar 2"}})["id"], "editor.part_in_use");
  page_.ask({{"do", "part"}, {"what", "remove"}, {"name", "bar 2 2"}});
  page_.ask({{"do", "part"}, {"what", "remove"}, {"name", "bar 2"}});
  const Json now = state();
  EXPECT_TRUE(now["parts"].empty());
  EXPECT_NEAR(lowest(exported("bar")), 2.1, 1e-6);
}

TEST_F(Halves, AreRefusedWhereOneSideIsAskedFor) {
  EXPECT_EQ(page_.refusal({{"do", "cut"}, {"plane", plane_at(2)}, {"halves", true}, {"keep", "above"}})["code"],
            "input");
}

}  // namespace
}  // namespace meshgraft::test
