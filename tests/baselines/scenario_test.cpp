// The four standard tests of Botsch and Sorkine (On linear variational surface deformation methods, 2008).
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/baselines/baselines.h>
#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/deform/selection.h>

namespace meshgraft::test {
namespace {

std::filesystem::path data_folder() {
  const char* variable = std::getenv("MESHGRAFT_DATA");
  const std::filesystem::path data =
      variable != nullptr ? std::filesystem::path(variable)
                          : std::filesystem::path(MESHGRAFT_SOURCE_DIR) / ".." / "shared" / "data";
  return data / "botsch-sorkine";
}

std::string read_text(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

/// A mesh in the OFF format with the `.sel` and `.def` of the same name.
struct StandardTest {
  Points rest;
  Triangles triangles;
  SelFile selection;
  std::vector<VertexConstraint> constraints;

  explicit StandardTest(const std::string& name) {
    std::ifstream off(data_folder() / (name + ".off"));
    std::string word;
    Index vertices = 0, faces = 0, edges = 0, corners = 0;
    off >> word >> vertices >> faces >> edges;
    rest.resize(vertices, 3);
    triangles.resize(faces, 3);
    for (double& value : rest.reshaped<Eigen::RowMajor>()) off >> value;
    for (Index t = 0; t < faces; ++t) off >> corners >> triangles(t, 0) >> triangles(t, 1) >> triangles(t, 2);
    if (!off) throw Error(ErrorCode::input, "the OFF file cannot be read", name);
    selection = parse_sel(read_text(data_folder() / (name + ".sel")), vertices, name);
    const Eigen::Affine3d move(parse_def(read_text(data_folder() / (name + ".def")), name));
    for (Index v : selection.fixed)
      constraints.push_back({v, Eigen::Vector3d(rest.row(v)), Eigen::Matrix3d::Identity()});
    for (Index v : selection.handle)
      constraints.push_back({v, move * Eigen::Vector3d(rest.row(v)), move.linear()});
  }
};

/// Figures measured once; where they were published as pictures, the pictures were looked at beside.
struct Expected {
  const char* test;
  Baseline method;
  double edge_rms, dihedral_p99_deg;
};

class StandardTests : public testing::TestWithParam<Expected> {};

TEST_P(StandardTests, GiveTheKnownQuality) {
  const Expected& expected = GetParam();
  if (!std::filesystem::exists(data_folder() / (std::string(expected.test) + ".off")))
    GTEST_SKIP() << "no test data in " << data_folder() << "; set MESHGRAFT_DATA";
  const StandardTest test(expected.test);
  const Points edited = deform_by(expected.method, test.rest, test.triangles, {}, test.constraints);
  const Quality quality = measure_quality(test.rest, edited, test.triangles, test.selection.free);
  EXPECT_NEAR(quality.edge_rms, expected.edge_rms, 0.2 * expected.edge_rms);
  EXPECT_NEAR(quality.dihedral_p99_deg, expected.dihedral_p99_deg, 0.2 * expected.dihedral_p99_deg);
}

}  // namespace
}  // namespace meshgraft::test
