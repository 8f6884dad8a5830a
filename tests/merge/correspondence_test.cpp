#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "merge/ambiguous_start.h"
#include "merge/facts.h"

namespace meshgraft {
namespace {

TEST(AmbiguousStarts, AreReadBackFromTheirFact) {
  std::vector<AmbiguousStart> starts;
  for (int count = 1; count <= 4; ++count) {
    starts.push_back({static_cast<std::size_t>(3 * count), {10 + count, 70 - count}, 0.007 * count});
    const Fact fact = ambiguous_start_fact(starts);
    const std::vector<AmbiguousStart> read = ambiguous_starts(fact);
    ASSERT_EQ(read.size(), starts.size());
    for (std::size_t k = 0; k < starts.size(); ++k) {
      EXPECT_EQ(read[k].pair, starts[k].pair);
      EXPECT_EQ(read[k].least_turned.source, starts[k].least_turned.source);
      EXPECT_EQ(read[k].least_turned.target, starts[k].least_turned.target);
      EXPECT_EQ(read[k].confidence, starts[k].confidence);
    }
    // The sentence is about the first one.
    EXPECT_EQ(fact.get<std::int64_t>("source"), starts[0].least_turned.source);
    EXPECT_EQ(fact.get<std::int64_t>("target"), starts[0].least_turned.target);
    EXPECT_EQ(fact.get<double>("confidence"), starts[0].confidence);
  }
}

TEST(AmbiguousStarts, AreNotReadFromOtherFacts) {
  EXPECT_THROW(ambiguous_starts(facts::merge::FixedOnLoop{.vertex = 1}), std::out_of_range);
}

}  // namespace
}  // namespace meshgraft
