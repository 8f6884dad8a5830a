#include <meshgraft/core/error.h>

#include <string>

#include <gtest/gtest.h>

namespace meshgraft {
namespace {

TEST(Error, JoinsThePartsThatAreGiven) {
  EXPECT_STREQ(Error(ErrorCode::input, "no faces").what(), "no faces");
  EXPECT_STREQ(Error(ErrorCode::input, "no faces", "arm.ply").what(), "arm.ply: no faces");
  EXPECT_STREQ(Error(ErrorCode::input, "no faces", "arm.ply", "Give a mesh").what(),
               "arm.ply: no faces. Give a mesh");
  EXPECT_STREQ(Error(ErrorCode::input, "no faces", "", "Give a mesh").what(), "no faces. Give a mesh");
}

TEST(Error, WithinPutsTheOuterPlaceFirst) {
  const Error inner(ErrorCode::unsolvable, "nothing is fixed", "component 2", "Fix a vertex");
  const Error outer = inner.within("edit.json").within("batch");
  EXPECT_EQ(outer.code(), ErrorCode::unsolvable);
  EXPECT_EQ(outer.location(), "batch: edit.json: component 2");
  EXPECT_EQ(outer.remedy(), inner.remedy());
  EXPECT_EQ(Error(ErrorCode::io, "cannot read").within("a.ply").location(), "a.ply");
}

TEST(Error, EveryCodeHasItsOwnNameAndAFailingStatus) {
  const ErrorCode codes[] = {ErrorCode::usage, ErrorCode::input,     ErrorCode::unsolvable,
                             ErrorCode::io,    ErrorCode::cancelled, ErrorCode::internal};
  for (const ErrorCode a : codes) {
    EXPECT_GT(exit_status(a), 0);
    EXPECT_LT(exit_status(a), 256);
    for (const ErrorCode b : codes) {
      EXPECT_EQ(to_string(a) == to_string(b), a == b);
      EXPECT_EQ(exit_status(a) == exit_status(b), a == b);
    }
  }
}

}  // namespace
}  // namespace meshgraft
