// Dirty scans as people bring them, repaired and then bent as a whole without any other tool.

#include <gtest/gtest.h>

#include <meshgraft/mesh/repair.h>
#include <meshgraft/mesh/triage.h>

#include "support/defects.h"

namespace meshgraft {
namespace {

TEST(Repair, MakesTwentyDirtyScansDeformable) {
  int working = 0;
  for (const test::DirtyScan& scan : test::dirty_scans()) {
    SCOPED_TRACE(scan.name);
    const RepairResult result = repair(scan.mesh);
    EXPECT_FALSE(triage(result.mesh).has_defects());
    EXPECT_FALSE(repair(result.mesh).changed());
    const test::Trial trial = test::try_deform(result.mesh);
    EXPECT_TRUE(trial.works) << trial.reason;
    working += trial.works;
  }
  EXPECT_GE(working, 18);
}

}  // namespace
}  // namespace meshgraft
