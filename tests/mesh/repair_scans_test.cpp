// Repairs dirty scans like those of users, and then bends the whole result, without any other tool.

#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/samples/samples.h>

#include "support/defects.h"

namespace meshgraft {
namespace {

TEST(Repair, LeavesTheBuiltInModelsAsTheyAre) {
  for (const SampleInfo& sample : sample_list()) {
    for (const int resolution : {24, 60}) {
      SCOPED_TRACE(std::string(sample.name) + " " + std::to_string(resolution));
      const RepairResult result = repair(make_sample(sample.name, resolution));
      for (const RepairChange& change : result.changes)
        ADD_FAILURE() << name_of(change.kind) << ": " << change.description();
    }
  }
}

TEST(Repair, TakesAwayWhatWasAddedAndNothingElse) {
  Mesh cactus = make_sample("cactus", 40);
  cactus.attributes.clear();
  const std::vector<std::pair<std::string, Mesh>> damaged{
      {"fins", test::with_fins(cactus, 20, 1)},
      {"floating bits", test::with_floating_bits(cactus, 10, 2)},
      {"repeated faces", test::with_repeated_faces(cactus, 20, 3)},
      {"the whole twice", test::both(cactus, cactus)},
      {"bad indices", test::with_bad_indices(cactus, 9, 4)},
      {"isolated vertices", test::with_isolated(cactus, 9, 5)}};
  for (const auto& [name, mesh] : damaged) {
    SCOPED_TRACE(name);
    const RepairResult result = repair(mesh);
    EXPECT_TRUE(result.changed());
    EXPECT_TRUE(result.mesh.faces == cactus.faces);
    EXPECT_TRUE(result.mesh.positions.rows() == cactus.positions.rows() &&
                result.mesh.positions == cactus.positions);
  }
}

TEST(Repair, MakesTwentyDirtyScansDeformable) {
  int working = 0;
  for (const test::DirtyScan& scan : test::dirty_scans()) {
    SCOPED_TRACE(scan.name);
    const RepairResult result = repair(scan.mesh);
    EXPECT_FALSE(check_mesh(result.mesh).has_defects());
    EXPECT_FALSE(repair(result.mesh).changed());
    const test::Trial trial = test::try_deform(result.mesh);
    EXPECT_TRUE(trial.works) << trial.reason;
    working += trial.works;
  }
  EXPECT_GE(working, 18);
}

}  // namespace
}  // namespace meshgraft
