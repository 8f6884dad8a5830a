
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "io/selection_files.h"
#include "support/paths.h"

namespace meshgraft {
namespace {

using Indices = std::vector<Index>;

std::string problem_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    return error.location().text() + ": " + error.problem();
  }
  return "no error";
}

TEST(ParseSel, SortsVerticesByTheirNumber) {
  const SelRoles sel = parse_sel("# status\r\n0 1 2\n\n2 # handle\n1\n", 5, Location::file("bar.sel"));
  EXPECT_EQ(sel.fixed, Indices{0});
  EXPECT_EQ(sel.free, (Indices{1, 4}));
  EXPECT_EQ(sel.handle, (Indices{2, 3}));
}

TEST(ParseSel, NamesTheLine) {
  EXPECT_EQ(problem_of([] { parse_sel("0\n1\n3\n", 3, Location::file("bar.sel")); }),
            "bar.sel, line 3: '3' is not 0 (fixed), 1 (free) or 2 (handle)");
  EXPECT_EQ(problem_of([] { parse_sel("0\n# x\n1.5\n", 2, Location::file("bar.sel")); }),
            "bar.sel, line 3: '1.5' is not 0 (fixed), 1 (free) or 2 (handle)");
  EXPECT_EQ(problem_of([] { parse_sel("0\n1", 3, Location::file("bar.sel")); }),
            "bar.sel: has 2 numbers, but the mesh has 3 vertices");
  EXPECT_EQ(problem_of([] { parse_sel("0\n1\n2", 2, Location::file("bar.sel")); }),
            "bar.sel, line 3: has more numbers than the mesh has vertices (2)");
}

TEST(ParseIndices, KeepsTheOrderWithoutRepeats) {
  EXPECT_EQ(parse_indices("5\n3 # nose\n\n  5\t0\n", 6, Location::file("ear.txt")), (Indices{5, 3, 0}));
  EXPECT_EQ(parse_indices("", 6, Location::file("ear.txt")), Indices{});
}

TEST(ParseIndices, NamesTheLine) {
  EXPECT_EQ(problem_of([] { parse_indices("1\n\nx7\n", 9, Location::file("ear.txt")); }),
            "ear.txt, line 3: 'x7' is not a vertex index");
  EXPECT_EQ(problem_of([] { parse_indices("1\n9\n", 9, Location::file("ear.txt")); }),
            "ear.txt, line 2: vertex 9 does not exist; the mesh has 9");
  EXPECT_EQ(problem_of([] { parse_indices("-1\n", 9, Location::file("ear.txt")); }),
            "ear.txt, line 1: vertex -1 does not exist; the mesh has 9");
  EXPECT_EQ(problem_of([] { parse_indices("1,2\n", 9, Location::file("ear.txt")); }),
            "ear.txt, line 1: '1,2' is not a vertex index");
}

TEST(ParseDef, ReadsTheMatrixRowByRow) {
  const Eigen::Matrix4d matrix = parse_def(
      "# handle\n-0.5 0 +2e-1 5.25\n0 1 0 0\n1 0 -0.5 9\n0.000000 0 0 1.0\n", Location::file("bar.def"));
  Eigen::Matrix4d expected;
  expected << -0.5, 0, 0.2, 5.25, 0, 1, 0, 0, 1, 0, -0.5, 9, 0, 0, 0, 1;
  EXPECT_EQ(matrix, expected);
}

TEST(ParseDef, NamesTheLine) {
  EXPECT_EQ(problem_of([] { parse_def("1 0 0 0\n0 1 0 oops\n", Location::file("bar.def")); }),
            "bar.def, line 2: 'oops' is not a finite number");
  EXPECT_EQ(problem_of([] { parse_def("1 0 0 nan\n", Location::file("bar.def")); }),
            "bar.def, line 1: 'nan' is not a finite number");
  EXPECT_EQ(problem_of([] { parse_def("1 0 0 0\n0 1 0 0\n", Location::file("bar.def")); }),
            "bar.def: has 8 numbers; a matrix has 16");
  EXPECT_EQ(problem_of([] { parse_def("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0.5 1\n", Location::file("bar.def")); }),
            "bar.def, line 4: the last row is not 0 0 0 1");
  EXPECT_EQ(problem_of([] { parse_def("1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n2", Location::file("bar.def")); }),
            "bar.def, line 5: has more than 16 numbers");
}

TEST(ParseSelAndDef, ReadTheFilesOfTheStandardTests) {
  const std::filesystem::path data = test::data_folder();
  if (!std::filesystem::exists(data)) GTEST_SKIP() << "no test data in " << data << "; set MESHGRAFT_DATA";
  const auto text_of = [&](const std::string& file) {
    std::ifstream in(data / "botsch-sorkine" / file);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  // The rotation in each matrix, as the tests are known by.
  const std::vector<std::pair<std::string, double>> tests = {
      {"bar", 135}, {"cactus", 70}, {"cylinder", 120}, {"plane", 0}};
  for (const auto& [name, angle_deg] : tests) {
    SCOPED_TRACE(name);
    std::istringstream off(text_of(name + ".off").substr(4));
    Index vertices = 0;
    off >> vertices;
    const SelRoles sel = parse_sel(text_of(name + ".sel"), vertices, Location::file(name + ".sel"));
    EXPECT_EQ(static_cast<Index>(sel.fixed.size() + sel.free.size() + sel.handle.size()), vertices);
    EXPECT_FALSE(sel.fixed.empty() || sel.free.empty() || sel.handle.empty());
    const Eigen::Matrix4d matrix = parse_def(text_of(name + ".def"), Location::file(name + ".def"));
    const Eigen::Matrix3d turn = matrix.topLeftCorner<3, 3>();
    EXPECT_NEAR(std::acos((turn.trace() - 1) / 2) * 180 / std::numbers::pi, angle_deg, 1e-3);
  }
}

}  // namespace
}  // namespace meshgraft
