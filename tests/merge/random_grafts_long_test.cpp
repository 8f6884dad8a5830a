// Five hundred random grafts, like those of meshgraft_random_grafts.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "core/stopwatch.h"
#include "support/graft_faults.h"
#include "support/random_grafts.h"

namespace meshgraft::test {
namespace {

TEST(FiveHundredGrafts, AreValidOrRightlyRefused) {
  int refused = 0, thin = 0, bent = 0;
  const Stopwatch watch;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    RandomGraft graft = make_random_graft(seed);
    SCOPED_TRACE(std::to_string(seed) + ": " + graft.text);
    Attempt made = attempt(graft);
    // Each remedy settles one pair of loops.
    for (std::size_t k = 0; made.refusal && k < graft.pairs.size(); ++k) {
      ASSERT_EQ(made.refusal->id(), "merge.ambiguous_start") << made.refusal->what();
      EXPECT_TRUE(fit_of_loops(graft, ambiguous_starts(made.refusal->fact()).front().pair).is_ambiguous());
      ASSERT_TRUE(follow_remedy(graft, *made.refusal)) << made.refusal->what();
      refused += k == 0 ? 1 : 0;
      made = attempt(graft);
    }
    if (!made.result) {
      ADD_FAILURE() << made.refusal->what();
      continue;
    }
    EXPECT_EQ(faults_of(graft, *made.result), std::vector<std::string>());
    const SeamReport& seam = made.result->report.seam;
    thin += seam.angle_p1_deg < 10 ? 1 : 0;
    bent += seam.dihedral_p99_deg > std::max(seam.target_dihedral_p99_deg, seam.source_dihedral_p99_deg) + 5
                ? 1
                : 0;
  }
  RecordProperty("refused", refused);
  RecordProperty("thin", thin);
  RecordProperty("bent", bent);
  RecordProperty("seconds", std::to_string(watch.seconds()));
  // Loops of random shapes cannot all be joined well; one in fifty may be worse than what the kept scenarios
  // show.
  EXPECT_LE(thin, 10);
  EXPECT_LE(bent, 10);
  EXPECT_LE(refused, 50);  // a tenth: cuts that are nearly round
}

}  // namespace
}  // namespace meshgraft::test
