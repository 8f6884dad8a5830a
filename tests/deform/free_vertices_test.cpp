#include "deform/setup/free_vertices.h"

#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

namespace meshgraft {
namespace {

TEST(FreeVertices, AreFlaggedInAnyOrderAndMoreThanOnce) {
  const std::vector<Index> free{4, 0, 4, 2};
  const Flags flags = flag_free(6, free);
  EXPECT_EQ(flags, (Flags{1, 0, 1, 0, 1, 0}));
  EXPECT_EQ(flag_free(3, {}), Flags(3, 0));
  EXPECT_TRUE(flag_free(0, {}).empty());
}

TEST(FreeVertices, ThatDoNotExistAreRefused) {
  for (const Index wrong : {-1, 5, 1000}) {
    const std::vector<Index> free{1, wrong};
    try {
      flag_free(5, free);
      ADD_FAILURE() << "nothing was thrown for " << wrong;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      EXPECT_EQ(error.id(), "deform.no_such_free_vertex");
    }
  }
}

TEST(FreeVertices, BelongToMeshesOfTheSameSize) {
  EXPECT_NO_THROW(require_same_vertices(Points(4, 3), Points(4, 3)));
  EXPECT_THROW(require_same_vertices(Points(4, 3), Points(5, 3)), Error);
}

}  // namespace
}  // namespace meshgraft
