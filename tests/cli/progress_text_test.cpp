#include "cli/progress_text.h"

#include <gtest/gtest.h>

namespace meshgraft::cli {
namespace {

TEST(ProgressText, WordsTheStageAndTheTaskThatItBelongsTo) {
  EXPECT_EQ(progress_text({.stage = "factorise"}), "factorise");
  EXPECT_EQ(progress_text({.stage = "find_surface", .fraction = 0.5}), "finding the surface");
  EXPECT_EQ(progress_text({.stage = "solve", .within = "proxy"}), "proxy: solve");
  EXPECT_EQ(progress_text({.stage = "render", .within = "ft05", .number = 1, .count = 2}),
            "ft05 (1 of 2): rendering");
}

}  // namespace
}  // namespace meshgraft::cli
