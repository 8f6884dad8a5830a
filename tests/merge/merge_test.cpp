#include <meshgraft/merge/merge.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <random>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/mesh/winding.h>
#include <meshgraft/samples/samples.h>

#include "merge/cut_halves.h"

namespace meshgraft {
namespace {

/// Matches a note with this id.
auto HasId(std::string_view id) { return testing::Property(&Note::id, id); }

struct Graft {
  std::string name;
  Mesh target, source;
  std::vector<MergePair> pairs;
  bool closed = true;  // whether the joined mesh is closed
};

double diagonal(const Points& points) {
  return (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
}

double largest_distance(const Points& a, const Points& b) { return (a - b).rowwise().norm().maxCoeff(); }

Mesh posed(Mesh mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Eigen::Quaterniond turn(normal(random), normal(random), normal(random), normal(random));
  turn.normalize();
  const double scale = std::exp(normal(random));
  const Eigen::RowVector3d shift(normal(random), normal(random), normal(random));
  const auto map = [&](auto row) { return Eigen::RowVector3d(row * turn.toRotationMatrix().transpose()); };
  for (auto row : mesh.positions.rowwise()) row = scale * map(row) + 3 * shift;
  for (Attribute& attribute : mesh.attributes) {
    if (attribute.name != cut_normal_name) continue;
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      Eigen::Map<Eigen::RowVector3d> value(attribute.values.data() + std::ptrdiff_t{3} * v);
      value = map(Eigen::RowVector3d(value));
    }
  }
  return mesh;
}

std::vector<MergePair> without_matches(const std::vector<LoopPair>& loops) {
  std::vector<MergePair> pairs;
  for (const LoopPair& pair : loops) pairs.push_back({pair, {}});
  return pairs;
}

// Cuts a sample by a plane into a target below and a source above, to be grafted back.
Graft cut_sample(const std::string& sample, int resolution, const Eigen::Vector3d& point,
                 const Eigen::Vector3d& normal) {
  const Mesh whole = make_sample(sample, resolution);
  Graft graft{sample,
              cut_by_plane(whole, point, normal, {.keep = CutKeep::below}).mesh,
              cut_by_plane(whole, point, normal, {.keep = CutKeep::above}).mesh,
              {}};
  graft.pairs = without_matches(test::coinciding_loops(graft.target, graft.source));
  graft.closed = boundary_loops(whole).empty();
  return graft;
}

// Returns grafts with one or several loops, and of positive genus. No loop is so round that its start is open.
std::vector<Graft> grafts_back() {
  return {cut_sample("cactus", 28, {0, 0, 1.3}, {0.2, 0.1, 1}),
          cut_sample("dinosaur", 34, {-1, 0, 0}, {-1, 0.1, 0.2}),
          cut_sample("octopus", 40, {0, 0, 0.8}, {0, 0.1, 1}), cut_sample("head", 28, {0, 0, 0}, {0.1, 0.2, 1}),
          cut_sample("torus", 30, {0.1, 0, 0}, {1, 0.2, 0.3})};
}

Graft head_on_bust(int resolution = 40) {
  Graft graft{"head on bust", make_sample("bust", resolution), make_sample("head", resolution), {}};
  graft.pairs = {{{boundary_loops(graft.source).at(0), boundary_loops(graft.target).at(0)}, {}}};
  return graft;
}

void drop_cut_normals(Mesh& mesh) {
  std::erase_if(mesh.attributes, [](const Attribute& attribute) { return attribute.name == cut_normal_name; });
}

TEST(Merge, GraftsBackWhatWasCut) {
  for (const Graft& graft : grafts_back()) {
    ASSERT_FALSE(graft.pairs.empty()) << graft.name;
    for (const MergeShape shape : {MergeShape::ft05, MergeShape::similar}) {
      const MergeResult result =
          merge_meshes(graft.target, posed(graft.source, 3), graft.pairs, {.shape = shape});
      const double size = diagonal(graft.source.positions);
      EXPECT_LT(largest_distance(result.grafted, graft.source.positions), 1e-9 * size)
          << graft.name << " by " << to_string(shape);
      for (std::size_t p = 0; p < graft.pairs.size(); ++p) {
        const PairReport& pair = result.report.pairs[p];
        EXPECT_LT(pair.misfit_rel, 1e-9) << graft.name;
        EXPECT_EQ(pair.met.size(), graft.pairs[p].loops.source.size());
        for (std::size_t i = 0; i < pair.met.size(); ++i)
          EXPECT_LT(
              (pair.target_points.row(static_cast<Eigen::Index>(i)) - graft.source.positions.row(pair.met[i]))
                  .norm(),
              1e-9 * size)
              << graft.name;
      }
      EXPECT_TRUE(result.report.seam.manifold && result.report.seam.oriented) << graft.name;
      EXPECT_EQ(result.report.seam.closed, graft.closed) << graft.name;
      // Away from the seam the result is the uncut surface.
      std::vector<std::uint8_t> in_band(static_cast<std::size_t>(result.mesh.vertex_count()), 0);
      for (const Index v : result.band) in_band[v] = 1;
      for (Index v = 0; v < graft.source.vertex_count(); ++v) {
        const Index to = result.source.new_index[v];
        if (to < 0 || in_band[to]) continue;
        EXPECT_LT((result.mesh.positions.row(to) - graft.source.positions.row(v)).norm(), 1e-9 * size);
      }
    }
  }
}

TEST(Merge, GraftsBackNearlyWithEstimatedNormals) {
  for (Graft graft : grafts_back()) {
    drop_cut_normals(graft.target);
    drop_cut_normals(graft.source);
    for (const MergeShape shape : {MergeShape::ft05, MergeShape::similar}) {
      const MergeResult result =
          merge_meshes(graft.target, posed(graft.source, 4), graft.pairs, {.shape = shape});
      EXPECT_LT(largest_distance(result.grafted, graft.source.positions),
                0.05 * diagonal(graft.source.positions))
          << graft.name << " by " << to_string(shape);
    }
  }
}

TEST(Merge, DoesNotDependOnThePoseOfTheSource) {
  const Graft graft = head_on_bust();
  for (const MergeShape shape : {MergeShape::ft05, MergeShape::similar}) {
    for (const DeformMethod method :
         {DeformMethod::ft05, DeformMethod::rotation_aware, DeformMethod::corotational}) {
      MergeOptions options{.shape = shape};
      options.deformer.method = method;
      const MergeResult first = merge_meshes(graft.target, graft.source, graft.pairs, options);
      for (const unsigned seed : {1U, 2U}) {
        const MergeResult again = merge_meshes(graft.target, posed(graft.source, seed), graft.pairs, options);
        EXPECT_LT(largest_distance(first.grafted, again.grafted), 1e-9 * diagonal(first.grafted))
            << to_string(shape) << ", " << to_string(method);
        EXPECT_LT(largest_distance(first.mesh.positions, again.mesh.positions), 1e-9 * diagonal(first.grafted));
        EXPECT_EQ(first.mesh.faces, again.mesh.faces);
      }
    }
  }
}

TEST(Merge, LeavesTheTargetAloneOutsideTheBand) {
  const Graft graft = head_on_bust();
  for (const int rings : {0, 3}) {
    MergeOptions options;
    options.seam.target_rings = rings;
    const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs, options);
    const std::vector<Index> near = grow_rings(graft.pairs[0].loops.target, rings + 1,
                                               vertex_rings(graft.target.vertex_count(), graft.target.faces));
    for (Index v = 0; v < graft.target.vertex_count(); ++v) {
      const Index to = result.target.new_index[v];
      if (to < 0 || graft.target.positions.row(v) == result.mesh.positions.row(to)) continue;
      EXPECT_TRUE(rings > 0 && std::binary_search(near.begin(), near.end(), v)) << v;
    }
  }
}

TEST(Merge, TheFarPartKeepsItsShape) {
  const Graft graft = head_on_bust();
  const MergeResult similar = merge_meshes(graft.target, graft.source, graft.pairs);
  EXPECT_LT(similar.report.shape.distance_rel, 1e-9);
  EXPECT_EQ(similar.report.shape.inverted, 0);
  EXPECT_GT(similar.report.shape.smallest_singular_p5, 0.5);
  const MergeResult linear = merge_meshes(graft.target, graft.source, graft.pairs, {.shape = MergeShape::ft05});
  EXPECT_GT(linear.report.shape.distance_rel, 1e-4);  // the loops differ, so it shears the source
}

TEST(Merge, LocksTheScale) {
  const Graft graft = head_on_bust();
  for (const double size : {0.7, 1.3}) {
    const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs, {.size = size});
    EXPECT_NEAR(result.report.shape.similarity.scale, size, 1e-9);
  }
}

TEST(Merge, PairsMayComeInAnyOrder) {
  Graft graft = cut_sample("torus", 30, {0.1, 0, 0}, {1, 0.2, 0.3});
  ASSERT_EQ(graft.pairs.size(), 2U);
  const MergeResult first = merge_meshes(graft.target, graft.source, graft.pairs);
  std::swap(graft.pairs[0], graft.pairs[1]);
  const MergeResult second = merge_meshes(graft.target, graft.source, graft.pairs);
  EXPECT_LT(largest_distance(first.grafted, second.grafted), 1e-12 * diagonal(first.grafted));
  EXPECT_EQ(first.report.seam.euler_characteristic, 0);
  EXPECT_EQ(second.report.seam.euler_characteristic, 0);
}

TEST(Merge, KeepsThePoseBitForBitBeyondReach) {
  const Graft graft = head_on_bust();
  MergeOptions options{.pose = MergePose::keep, .reach = {.rings = 4, .length = {}}};
  Mesh source = graft.source;
  source.positions.col(2).array() += 0.05;
  const MergeResult result = merge_meshes(graft.target, source, graft.pairs, options);
  const std::vector<Index> near =
      grow_rings(graft.pairs[0].loops.source, 4, vertex_rings(source.vertex_count(), source.faces));
  Index moved = 0;
  for (Index v = 0; v < source.vertex_count(); ++v) {
    if (std::binary_search(near.begin(), near.end(), v)) {
      moved += source.positions.row(v) != result.grafted.row(v);
    } else {
      EXPECT_EQ(source.positions.row(v), result.grafted.row(v)) << v;
    }
  }
  EXPECT_GT(moved, 0);
}

TEST(Merge, FeaturesFollowOneMap) {
  const Graft graft = head_on_bust();
  for (const MergeShape shape : {MergeShape::ft05, MergeShape::similar}) {
    for (const bool similarity : {true, false}) {
      MergeFeature feature{{}, similarity};
      for (Index v = 0; v < graft.source.vertex_count(); ++v)
        if (graft.source.positions(v, 2) > 0 && graft.source.positions(v, 1) < -0.2)
          feature.vertices.push_back(v);
      ASSERT_GT(feature.vertices.size(), 20U);
      MergeOptions options{.shape = shape};
      options.features = {feature};
      const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs, options);
      const auto count = static_cast<Eigen::Index>(feature.vertices.size());
      Eigen::MatrixXd before(count, 4), after(count, 3);
      for (Eigen::Index k = 0; k < count; ++k) {
        const Index v = feature.vertices[static_cast<std::size_t>(k)];
        before.row(k) << graft.source.positions.row(v), 1;
        after.row(k) = result.grafted.row(v);
      }
      const Eigen::MatrixXd map = before.colPivHouseholderQr().solve(after);
      EXPECT_LT((before * map - after).norm(), 1e-9 * after.norm());
      const Eigen::Matrix3d linear = map.topRows<3>().transpose();
      const double scale = std::cbrt(linear.determinant());
      const double shear = (linear.transpose() * linear / (scale * scale) - Eigen::Matrix3d::Identity()).norm();
      if (similarity) {
        EXPECT_LT(shear, 1e-9);
      } else if (shape == MergeShape::ft05) {
        EXPECT_GT(shear, 1e-6);
      }
    }
  }
}

TEST(Merge, TurnsTheTargetsNormals) {
  const Graft graft = head_on_bust();
  MergeOptions options{.shape = MergeShape::ft05};
  const Points straight = merge_meshes(graft.target, graft.source, graft.pairs, options).grafted;
  options.normal_angle_deg = 20;
  const Points wider = merge_meshes(graft.target, graft.source, graft.pairs, options).grafted;
  options.normal_angle_deg = -20;
  const Points narrower = merge_meshes(graft.target, graft.source, graft.pairs, options).grafted;
  // A positive angle must change the neck's width one way, a negative angle the other way.
  const auto width = [](const Points& points) {
    return (points.col(0).maxCoeff() - points.col(0).minCoeff()) +
           (points.col(1).maxCoeff() - points.col(1).minCoeff());
  };
  EXPECT_GT(std::abs(width(wider) - width(straight)), 0.02 * width(straight));
  EXPECT_LT((width(wider) - width(straight)) * (width(narrower) - width(straight)), 0);
}

// Returns a tube of radius 1 with `rows` rows of `around` vertices, closed above. Its loop lies at z = 0.
Mesh peg(Index rows, Index around) {
  Mesh mesh;
  mesh.positions.resize(rows * around + 1, 3);
  const auto angle = [&](Index k) { return 2 * std::numbers::pi * k / around; };
  for (Index r = 0; r < rows; ++r)
    for (Index k = 0; k < around; ++k)
      mesh.positions.row(r * around + k) << std::cos(angle(k)), std::sin(angle(k)), 2.0 * r / (rows - 1);
  const Index top = rows * around;
  mesh.positions.row(top) << 0, 0, 2;
  for (Index k = 0; k < around; ++k) {
    const Index next = (k + 1) % around;
    for (Index r = 0; r + 1 < rows; ++r)
      mesh.faces.push_back(
          std::vector<Index>{r * around + k, r * around + next, (r + 1) * around + next, (r + 1) * around + k});
    mesh.faces.push_back(std::vector<Index>{(rows - 1) * around + k, (rows - 1) * around + next, top});
  }
  return mesh;
}

// Returns a plate with a hole around z, or a tube that is cut off at an angle. The hole has 32 vertices.
Mesh holed(double radius, double tilt_deg, bool plate) {
  constexpr Index around = 32, rows = 10;
  const double slope = std::tan(tilt_deg * std::numbers::pi / 180);
  Mesh mesh;
  mesh.positions.resize(rows * around, 3);
  for (Index r = 0; r < rows; ++r)
    for (Index k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around, way = plate ? radius * (1 + 0.3 * r) : radius;
      const double x = way * std::cos(angle), y = way * std::sin(angle);
      mesh.positions.row(r * around + k) << x, y,
          plate ? x * slope : x * slope * (rows - 1 - r) / (rows - 1) - 0.25 * radius * r;
    }
  for (Index r = 0; r + 1 < rows; ++r)
    for (Index k = 0; k < around; ++k) {
      const Index next = (k + 1) % around;
      mesh.faces.push_back(
          std::vector<Index>{r * around + k, (r + 1) * around + k, (r + 1) * around + next, r * around + next});
    }
  return mesh;
}

// Returns the loop whose first vertex is 0.
std::vector<Index> first_loop(const Mesh& mesh) {
  for (std::vector<Index>& loop : boundary_loops(mesh))
    if (loop.front() == 0) return loop;
  return {};
}

TEST(Merge, BendsPartsOfFewRows) {
  for (const bool plate : {true, false})
    for (const Index rows : {2, 3, 5})
      for (const Index around : {8, 16, 40})
        for (const double tilt_deg : {0.0, plate ? 45.0 : 60.0}) {
          const Mesh target = holed(rows == 2 ? 0.5 : 2, tilt_deg, plate), source = peg(rows, around);
          const MergePair pair{{first_loop(source), first_loop(target)}, {{0, 0}}};
          const MergeResult result = merge_meshes(target, source, {{pair}});
          const std::string what =
              fmt::format("{} rows of {} on a {} at {}°", rows, around, plate ? "plate" : "tube", tilt_deg);
          EXPECT_EQ(result.report.shape.inverted, 0) << what;
          EXPECT_GE(result.report.shape.smallest_singular_p5, 0.5) << what;
          EXPECT_TRUE(result.report.seam.manifold && result.report.seam.oriented) << what;
          EXPECT_LT(result.report.seam.dihedral_p99_deg, 80) << what;
          EXPECT_EQ(result.grafted.rows(), source.vertex_count());
          EXPECT_EQ(result.source.new_index.size(), static_cast<std::size_t>(source.vertex_count()));
          // The source stands upright on the hole.
          const Eigen::Vector3d up = result.report.shape.similarity.rotation.col(2);
          const double slope = tilt_deg * std::numbers::pi / 180;
          EXPECT_GT(up.dot(Eigen::Vector3d(-std::sin(slope), 0, std::cos(slope))), std::cos(0.6)) << what;
        }
}

TEST(Merge, KeepsAPartThatIsFixedAsAWhole) {
  const Mesh target = holed(1, 0, true), source = peg(6, 16);
  const MergePair pair{{first_loop(source), first_loop(target)}, {{0, 0}}};
  MergeOptions options{.pose = MergePose::keep};
  for (Index v = 0; v < source.vertex_count(); ++v) options.fixed.push_back(v);
  const MergeResult result = merge_meshes(target, source, {{pair}}, options);
  const std::vector<Index> loop = first_loop(source);
  for (Index v = 0; v < source.vertex_count(); ++v)
    if (std::find(loop.begin(), loop.end(), v) == loop.end()) {
      EXPECT_EQ(result.grafted.row(v), source.positions.row(v)) << v;
    }
}

TEST(Merge, RefusesSizesAMillionTimesOff) {
  const Mesh target = holed(1, 0, true), source = peg(6, 16);
  const MergePair pair{{first_loop(source), first_loop(target)}, {{0, 0}}};
  for (const double size : {1e-300, 1e-20, 1e9, 1e99, 1e300}) {
    try {
      merge_meshes(target, source, {{pair}}, {.size = size});
      ADD_FAILURE() << size << " was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.location(), "size");
      EXPECT_EQ(error.id(), size < 1 ? "merge.size_makes_source_tiny" : "merge.size_makes_source_huge");
      EXPECT_EQ(error.fact().get<double>("size"), size);
    }
  }
}

TEST(Merge, TellsWhenTheResultIsNoManifold) {
  const Mesh target = holed(1, 0, true);
  Mesh source = peg(6, 16);
  const MergePair pair{{first_loop(source), first_loop(target)}, {{0, 0}}};
  const auto merged = [&] { return merge_meshes(target, source, {{pair}}).report; };
  EXPECT_TRUE(merged().seam.manifold);
  EXPECT_THAT(merged().notes, testing::Not(testing::Contains(HasId("merge.result_not_manifold"))));
  source.faces.push_back(std::vector<Index>{5 * 16, 5 * 16 + 8, 6 * 16});  // a wall within the cap
  EXPECT_FALSE(merged().seam.manifold);
  EXPECT_THAT(merged().notes, testing::Contains(HasId("merge.result_not_manifold")));
}

TEST(Merge, TellsWhenAKeptPoseDrawsOutANeck) {
  const Mesh target = holed(1, 0, true);
  Mesh source = peg(6, 16);
  const MergePair pair{{first_loop(source), first_loop(target)}, {{0, 0}}};
  const auto notes = [&] {
    return merge_meshes(target, source, {{pair}}, {.pose = MergePose::keep}).report.notes;
  };
  EXPECT_THAT(notes(), testing::Not(testing::Contains(HasId("merge.source_drawn_out"))));
  source.positions.col(2).array() += 5;
  const std::vector<Note> told = notes();
  const auto drawn_out = std::find_if(told.begin(), told.end(),
                                      [](const Note& note) { return note.id() == "merge.source_drawn_out"; });
  ASSERT_NE(drawn_out, told.end());
  EXPECT_THAT(drawn_out->text(), testing::HasSubstr("is 5 times the radius of the target's away"));
}

TEST(Merge, RefinesTheCoarserSide) {
  for (const auto& [target_resolution, source_resolution] : {std::pair(60, 24), std::pair(24, 60)}) {
    Graft graft{"", make_sample("bust", target_resolution), make_sample("head", source_resolution), {}};
    graft.pairs = {{{boundary_loops(graft.source).at(0), boundary_loops(graft.target).at(0)}, {}}};
    const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs);
    EXPECT_GT(result.report.source_vertices_added + result.report.seam.new_faces, 0);
    EXPECT_EQ(result.report.source_vertices_added > 0, source_resolution < target_resolution);
    EXPECT_LT(result.report.seam.edge_ratio, 2.2);
    EXPECT_GT(result.report.seam.edge_ratio, 1 / 2.2);
    EXPECT_TRUE(result.report.seam.closed && result.report.seam.manifold);
    EXPECT_EQ(result.grafted.rows(), graft.source.vertex_count());
  }
}

std::optional<Error> refusal_of(const Graft& graft, const MergeOptions& options = {}) {
  try {
    merge_meshes(graft.target, graft.source, graft.pairs, options);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

// Returns the id of a refusal, followed by its role if it has one. Returns "" if nothing was refused.
std::string cause_of(const Graft& graft, const MergeOptions& options = {}) {
  const std::optional<Error> refusal = refusal_of(graft, options);
  if (!refusal) return "";
  std::string cause(refusal->id());
  for (const FieldType& field : refusal->fact().type().fields)
    if (field.name == "role") cause += " " + refusal->fact().get<std::string>("role");
  return cause;
}

TEST(MergeErrors, NameWhatIsWrong) {
  const Graft good = head_on_bust(24);
  Graft bad = good;
  bad.pairs.clear();
  EXPECT_EQ(cause_of(bad), "merge.no_pairs");

  bad = good;
  bad.source = make_sample("cactus", 24);
  EXPECT_EQ(cause_of(bad), "merge.no_boundary_loop source");

  bad = good;
  bad.target = make_sample("cactus", 24);
  EXPECT_EQ(cause_of(bad), "merge.no_boundary_loop target");

  bad = good;
  bad.pairs[0].loops.source.pop_back();
  EXPECT_EQ(cause_of(bad), "merge.loop_not_listed_whole source");
  EXPECT_EQ(refusal_of(bad)->fact().get<std::int64_t>("listed") + 1,
            refusal_of(bad)->fact().get<std::int64_t>("count"));

  bad = good;
  std::swap(bad.pairs[0].loops.source[3], bad.pairs[0].loops.source[7]);
  EXPECT_EQ(cause_of(bad), "merge.loop_not_listed_in_order source");

  bad = good;
  const std::vector<std::uint8_t> on_loop = [&] {
    std::vector<std::uint8_t> flags(static_cast<std::size_t>(good.source.vertex_count()), 0);
    for (const Index v : good.pairs[0].loops.source) flags[v] = 1;
    return flags;
  }();
  const auto inner = static_cast<Index>(std::find(on_loop.begin(), on_loop.end(), 0) - on_loop.begin());
  bad.pairs[0].loops.source[0] = inner;
  EXPECT_EQ(cause_of(bad), "merge.vertex_not_on_boundary source");
  EXPECT_EQ(refusal_of(bad)->fact().get<std::int64_t>("vertex"), inner);
  bad.pairs[0].loops.source[0] = 1 << 20;
  EXPECT_EQ(cause_of(bad), "merge.no_such_vertex source");

  bad = good;
  bad.pairs.push_back(bad.pairs[0]);
  EXPECT_EQ(cause_of(bad), "merge.loop_named_twice source");

  // Matched vertices must follow each other in opposite directions on the two loops, so these matches cross.
  bad = good;
  const auto& s = good.pairs[0].loops.source;
  const auto& t = good.pairs[0].loops.target;
  bad.pairs[0].matches = {{s[0], t[0]}, {s[5], t[5]}, {s[10], t[10]}};
  EXPECT_EQ(cause_of(bad), "merge.matches_cross");
  bad.pairs[0].matches = {{s[0], t[0]}, {s[5], t[0]}};
  EXPECT_EQ(cause_of(bad), "merge.target_matched_twice");
  bad.pairs[0].matches = {{s[0], t[0]}, {s[0], t[5]}};
  EXPECT_EQ(cause_of(bad), "merge.source_matched_twice");
  bad.pairs[0].matches = {{inner, t[0]}};
  EXPECT_EQ(cause_of(bad), "merge.match_not_on_loop source");

  bad = good;  // a second component of the source without a pair
  const Mesh lone = make_sample("cylinder", 8);
  const Index offset = bad.source.vertex_count();
  Points positions(offset + lone.vertex_count(), 3);
  positions << bad.source.positions, lone.positions;
  bad.source.positions = positions;
  bad.source.attributes.clear();
  for (Index f = 0; f < lone.face_count(); ++f) {
    std::vector<Index> face(lone.faces[f].begin(), lone.faces[f].end());
    for (Index& v : face) v += offset;
    bad.source.faces.push_back(face);
  }
  EXPECT_EQ(cause_of(bad), "merge.component_without_pair");
  EXPECT_EQ(refusal_of(bad)->fact().get<std::int64_t>("component"), 1);

  bad = good;
  for (const Index v : good.pairs[0].loops.source) bad.source.positions.row(v).setConstant(0.25);
  EXPECT_EQ(cause_of(bad), "merge.loop_without_length source");

  EXPECT_EQ(cause_of(good, {.size = -1}), "core.not_positive");
  EXPECT_EQ(cause_of(good, {.reach = {.rings = 0, .length = {}}}), "merge.reach_less_than_one_ring");
  EXPECT_EQ(cause_of(good, {.fixed = {0}}), "merge.fixed_while_pose_found");
}

TEST(MergeErrors, RoundLoopsNeedAStart) {
  Graft graft{"tubes", make_sample("cylinder", 24), make_sample("cylinder", 24), {}};
  graft.pairs = {{{boundary_loops(graft.source).at(0), boundary_loops(graft.target).at(1)}, {}}};
  ASSERT_EQ(cause_of(graft), "merge.open_start");
  const std::vector<OpenStart> starts = open_starts(refusal_of(graft)->fact());
  ASSERT_EQ(starts.size(), 1U);
  EXPECT_EQ(starts[0].pair, 0U);
  graft.pairs[0].matches = {starts[0].least_turned};
  EXPECT_EQ(cause_of(graft), "");
}

TEST(MergeErrors, ListTheOpenStartsOfAllComponents) {
  const Mesh tube = make_sample("cylinder", 24);
  const auto two = [&] {
    Mesh mesh = tube;
    const Index offset = tube.vertex_count();
    mesh.attributes.clear();
    mesh.positions.resize(2 * offset, 3);
    mesh.positions << tube.positions, tube.positions.rowwise() + Eigen::RowVector3d(10, 0, 0);
    for (Index f = 0; f < tube.face_count(); ++f) {
      std::vector<Index> face(tube.faces[f].begin(), tube.faces[f].end());
      for (Index& v : face) v += offset;
      mesh.faces.push_back(face);
    }
    return mesh;
  }();
  const auto loops = boundary_loops(tube);
  const auto second = [&](std::vector<Index> loop) {
    for (Index& v : loop) v += tube.vertex_count();
    return loop;
  };
  const Graft graft{
      "tubes", two, two, {{{second(loops.at(0)), second(loops.at(1))}, {}}, {{loops.at(0), loops.at(1)}, {}}}};
  ASSERT_EQ(cause_of(graft), "merge.open_start");
  const Error refusal = *refusal_of(graft);
  EXPECT_EQ(refusal.location(), "pair 0");
  const std::vector<OpenStart> starts = open_starts(refusal.fact());
  ASSERT_EQ(starts.size(), 2U);
  for (std::size_t p = 0; p < 2; ++p) {
    EXPECT_EQ(starts[p].pair, p);
    EXPECT_EQ(starts[p].least_turned.source, graft.pairs[p].loops.source.front());
  }
  EXPECT_EQ(refusal.fact().get<std::int64_t>("source"), starts[0].least_turned.source);
}

TEST(MergeErrors, InwardFacesAreNamedOrTurned) {
  Graft graft = head_on_bust(24);
  const MergeResult expected = merge_meshes(graft.target, graft.source, graft.pairs);
  graft.source = turned_over(graft.source);
  ASSERT_EQ(cause_of(graft), "merge.orientations_disagree");
  EXPECT_EQ(refusal_of(graft)->fact().get<std::string>("inward"), "source");
  const MergeResult turned = merge_meshes(graft.target, graft.source, graft.pairs, {.fix_winding = true});
  EXPECT_LT(largest_distance(turned.grafted, expected.grafted), 1e-9 * diagonal(expected.grafted));
}

TEST(MergeErrors, NoSideIsReadIntoSheetsAndDents) {
  Mesh ball = make_sample("torus", 24);
  const Mesh dent = turned_over(test::side_of_plane(ball, {0, 0, 1}, 0.3, true));
  EXPECT_EQ(enclosed_volume(dent), 0) << "as much opening as surface";
  EXPECT_EQ(enclosed_volume(make_sample("bumpy_plane", 24)), 0);
  EXPECT_GT(enclosed_volume(make_sample("cylinder", 24)), 0.1);
}

TEST(Merge, AFeatureThatReachesIntoTheKeptPartStays) {
  Graft graft = head_on_bust(24);
  MergeOptions options{.pose = MergePose::keep};
  const IndexLists rings = vertex_rings(graft.source.vertex_count(), graft.source.faces);
  const std::vector<Index> near = grow_rings(graft.pairs[0].loops.source, 3, rings);
  for (Index v = 0; v < graft.source.vertex_count(); ++v)
    if (!std::binary_search(near.begin(), near.end(), v)) options.fixed.push_back(v);
  const std::vector<Index> wide = grow_rings(graft.pairs[0].loops.source, 5, rings),
                           loop = grow_rings(graft.pairs[0].loops.source, 1, rings);
  MergeFeature feature;
  std::set_difference(wide.begin(), wide.end(), loop.begin(), loop.end(), std::back_inserter(feature.vertices));
  options.features = {feature};
  const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs, options);
  for (const Index v : feature.vertices)
    ASSERT_LT((result.grafted.row(v) - graft.source.positions.row(v)).norm(), 1e-12);
}

TEST(MergeErrors, LoopsThatTouchThemselvesAreNamed) {
  // Two holes in a grid share a corner.
  const Mesh sheet = make_sample("bumpy_plane", 12);
  std::vector<Index> taken;
  const IndexLists rings = vertex_rings(sheet.vertex_count(), sheet.faces);
  const Index pivot = 5 * 12 + 5;
  Index kept = 0;
  const Mesh holed = test::faces_where(sheet, [&](Index f) {
    const bool at_pivot =
        std::find(sheet.faces[f].begin(), sheet.faces[f].end(), pivot) != sheet.faces[f].end();
    return !at_pivot || (kept++ % 3 == 0);
  });
  const auto loops = boundary_loops(holed);
  ASSERT_GT(loops.size(), 1U);
  Graft graft{"", make_sample("bust", 24), holed, {}};
  graft.pairs = {{{loops[1], boundary_loops(graft.target).at(0)}, {}}};
  EXPECT_EQ(cause_of(graft), "merge.boundary_touches_itself source");
}

TEST(Merge, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  const Graft graft = head_on_bust(24);
  EXPECT_THROW(merge_meshes(graft.target, graft.source, graft.pairs, {}, context), Error);
}

}  // namespace
}  // namespace meshgraft
