#include <meshgraft/samples/samples.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {
namespace {

struct Expected {
  Index loops;
  Index euler;
  double p1_angle_deg;  // the first percentile of the triangles' smallest angles is at least this
};

const std::map<std::string, Expected> expectations{
    {"octopus", {0, 2, 30}},   {"head", {1, 1, 30}},        {"bust", {1, 1, 30}},  {"dinosaur", {0, 2, 30}},
    {"cactus", {0, 2, 30}},    {"bumpy_plane", {1, 1, 30}}, {"bar", {0, 2, 40}},   {"cylinder", {2, 0, 55}},
    {"bracket", {4, -12, 30}}, {"posts", {4, 4, 30}},       {"torus", {0, 0, 40}}, {"knot", {0, 0, 30}},
};

Index components_of(const std::string& name) { return name == "posts" ? 4 : 1; }

struct Shape {
  double p1_angle_deg;
  double volume;
};

Shape measure(const Mesh& mesh) {
  std::vector<double> angles;
  double volume = 0.0;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    Eigen::Vector3d p[3];
    for (std::size_t k = 0; k < 3; ++k) p[k] = mesh.positions.row(face[k]).transpose();
    double smallest = 180.0;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d a = p[(k + 1) % 3] - p[k], b = p[(k + 2) % 3] - p[k];
      smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / M_PI);
    }
    angles.push_back(smallest);
    volume += p[0].dot(p[1].cross(p[2])) / 6.0;
  }
  std::sort(angles.begin(), angles.end());
  return {angles[angles.size() / 100], volume};
}

// Checks each model at a medium resolution and at the default one.
class SampleModel : public testing::TestWithParam<std::string> {};

TEST_P(SampleModel, IsACleanManifoldOfTheDocumentedKind) {
  const Expected& expected = expectations.at(GetParam());
  for (const int resolution : {60, 0}) {
    SCOPED_TRACE(resolution);
    const Mesh mesh = make_sample(GetParam(), resolution);
    const TopologySummary summary = summarise_topology(mesh);
    EXPECT_TRUE(summary.manifold);
    EXPECT_TRUE(summary.oriented);
    EXPECT_EQ(summary.components, components_of(GetParam()));
    EXPECT_EQ(summary.boundary_loops, expected.loops);
    EXPECT_EQ(summary.euler_characteristic, expected.euler);
    const Diagnostics report = check_mesh(mesh);
    EXPECT_TRUE(report.clean()) << report.findings.front().description();
    const Shape shape = measure(mesh);
    EXPECT_GE(shape.p1_angle_deg, expected.p1_angle_deg);
    if (expected.loops == 0) {
      EXPECT_GT(shape.volume, 0.0) << "the faces point inward";
    }
  }
}

TEST_P(SampleModel, HasAboutResolutionSquaredVertices) {
  const Mesh mesh = make_sample(GetParam(), 80);
  EXPECT_GT(mesh.vertex_count(), 0.7 * 80 * 80);
  EXPECT_LT(mesh.vertex_count(), 1.5 * 80 * 80);
}

TEST_P(SampleModel, IsTheSameForAnyNumberOfThreads) {
  Context context;
  context.threads = 1;
  const Mesh one = make_sample(GetParam(), 40, context);
  for (const int threads : {1, 2}) {
    context.threads = threads;
    const Mesh other = make_sample(GetParam(), 40, context);
    EXPECT_EQ(one.positions, other.positions);
    EXPECT_EQ(one.faces, other.faces);
    ASSERT_EQ(one.attributes.size(), other.attributes.size());
    for (std::size_t a = 0; a < one.attributes.size(); ++a)
      EXPECT_EQ(one.attributes[a].values, other.attributes[a].values);
  }
}

std::vector<std::string> names() {
  std::vector<std::string> list;
  for (const SampleInfo& info : sample_list()) list.emplace_back(info.name);
  return list;
}

INSTANTIATE_TEST_SUITE_P(Samples, SampleModel, testing::ValuesIn(names()),
                         [](const auto& sample) { return sample.param; });

TEST(Samples, TheSmallestResolutionIsStillClean) {
  for (const std::string& name : names()) {
    SCOPED_TRACE(name);
    const Mesh mesh = make_sample(name, 4);
    EXPECT_TRUE(check_mesh(mesh).clean());
    EXPECT_EQ(summarise_topology(mesh).components, components_of(name));
  }
}

// Head and bust are cut from the same neck: at one height, the loops are the same circle.
TEST(Samples, TheHeadFitsOnTheBust) {
  const Mesh head = make_sample("head", 80), bust = make_sample("bust", 80);
  const auto loop_radius = [](const Mesh& mesh) {
    const auto loops = boundary_loops(mesh);
    double sum = 0.0;
    for (const Index v : loops[0]) sum += std::hypot(mesh.positions(v, 0), mesh.positions(v, 1) - 0.11);
    return sum / static_cast<double>(loops[0].size());
  };
  EXPECT_NEAR(loop_radius(head), loop_radius(bust), 0.05);
}

TEST(Samples, TheLoopsOfHeadAndBustArePlane) {
  for (const auto& [name, height] : std::map<std::string, double>{{"head", -0.40}, {"bust", -0.28}}) {
    const Mesh mesh = make_sample(name, 60);
    const auto loops = boundary_loops(mesh);
    ASSERT_EQ(loops.size(), 1u);
    for (const Index v : loops[0]) EXPECT_EQ(mesh.positions(v, 2), height);
  }
}

TEST(Samples, AnUnknownNameIsRefusedWithTheList) {
  try {
    make_sample("octopuss");
    FAIL() << "no exception";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_EQ(error.id(), "samples.no_such_sample");
    EXPECT_EQ(error.fact().get<std::string>("name"), "octopuss");
    EXPECT_NE(std::string(error.what()).find("octopus, head"), std::string::npos);
  }
}

TEST(Samples, AResolutionOutOfRangeIsRefused) {
  for (const int resolution : {-1, 3, 4097}) {
    try {
      make_sample("bar", resolution);
      FAIL() << resolution;
    } catch (const Error& error) {
      EXPECT_EQ(error.id(), "core.out_of_range");
      EXPECT_EQ(error.fact().get<double>("value"), resolution);
      EXPECT_TRUE(error.problem().starts_with("must be from 4 to 4096")) << error.problem();
    }
  }
}

TEST(Samples, CanBeCancelledAndReportProgress) {
  std::stop_source stop;
  int reports = 0;
  const Context context{.progress =
                            [&](const Progress& progress) {
                              ++reports;
                              if (progress.fraction > 0.4) stop.request_stop();
                            },
                        .stop_token = stop.get_token()};
  try {
    make_sample("bust", 40, context);
    FAIL() << "no exception";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled);
  }
  EXPECT_GE(reports, 2);
}

}  // namespace
}  // namespace meshgraft
