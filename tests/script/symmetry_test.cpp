// Tests the field `symmetry` of deform steps.
#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/run_edit.h>

#include "merge/pose_source.h"
#include "script/resolve_deform.h"
#include "script/symmetry.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// A mesh that is its own mirror image; vertex v is the mirror image of `partner[v]`.
struct SymmetricMesh {
  std::string name;
  Mesh mesh;
  std::vector<Index> partner;
  Plane plane;
};

/// Returns one half of a mesh, joined with its mirror image at x = 0.
SymmetricMesh doubled(const test::TestMesh& whole) {
  const double middle = 0.5 * (whole.positions.col(0).minCoeff() + whole.positions.col(0).maxCoeff());
  const Mesh half = cut_by_plane(make_mesh(whole.positions, whole.triangles), {{middle, 0, 0}, {1, 0, 0}},
                                 {.keep = CutKeep::above})
                        .mesh;
  const Triangles triangles = triangulate(half).triangles;
  const Index n = half.vertex_count();
  std::vector<Index> image(static_cast<std::size_t>(n));
  Points positions(2 * n, 3);
  Index count = n;
  for (Index v = 0; v < n; ++v) {
    positions.row(v) = half.positions.row(v) - Eigen::RowVector3d(middle, 0, 0);
    const bool on_plane = std::abs(positions(v, 0)) < 1e-9;
    if (on_plane) positions(v, 0) = 0;
    image[v] = on_plane ? v : count++;
    positions.row(image[v]) = positions.row(v).cwiseProduct(Eigen::RowVector3d(-1, 1, 1));
  }
  Triangles both(2 * triangles.rows(), 3);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    both.row(t) = triangles.row(t);
    both.row(triangles.rows() + t) << image[triangles(t, 0)], image[triangles(t, 2)], image[triangles(t, 1)];
  }
  SymmetricMesh symmetric{
      whole.name, make_mesh(positions.topRows(count), both), {}, {Eigen::Vector3d::Zero(), {1, 0, 0}}};
  symmetric.partner.resize(static_cast<std::size_t>(count));
  for (Index v = 0; v < n; ++v) {
    symmetric.partner[v] = image[v];
    symmetric.partner[image[v]] = v;
  }
  return symmetric;
}

/// Returns the mesh, turned and moved together with its plane.
SymmetricMesh turned(SymmetricMesh symmetric) {
  const Eigen::Affine3d map =
      Eigen::Translation3d(0.3, -2, 1) * Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized());
  for (auto point : symmetric.mesh.positions.rowwise()) point = (map * point.transpose()).transpose().eval();
  symmetric.plane = {map * symmetric.plane.point, 3 * (map.linear() * symmetric.plane.normal)};
  symmetric.name += ", turned";
  return symmetric;
}

std::vector<SymmetricMesh> symmetric_families() {
  std::vector<SymmetricMesh> families;
  for (const test::TestMesh& mesh : {test::bumpy_sphere(3), test::torus(24, 16), test::irregular_grid(16, 12),
                                     test::tube(16, 12), test::icosphere(2)}) {
    families.push_back(doubled(mesh));
    families.push_back(turned(families.back()));
  }
  return families;
}

/// Returns the vertex farthest along the plane's normal, and those near it.
std::vector<Index> tip(const SymmetricMesh& symmetric, double radius_rel) {
  const Points& positions = symmetric.mesh.positions;
  const Eigen::RowVector3d normal = symmetric.plane.normal.normalized().transpose();
  Eigen::Index farthest = 0;
  (positions * normal.transpose()).maxCoeff(&farthest);
  const double size = (positions.colwise().maxCoeff() - positions.colwise().minCoeff()).norm();
  std::vector<Index> near;
  for (Index v = 0; v < symmetric.mesh.vertex_count(); ++v)
    if ((positions.row(v) - positions.row(farthest)).norm() <= radius_rel * size) near.push_back(v);
  return near;
}

std::vector<Index> at_plane(const SymmetricMesh& symmetric, double width_rel) {
  const Points& positions = symmetric.mesh.positions;
  const double size = (positions.colwise().maxCoeff() - positions.colwise().minCoeff()).norm();
  std::vector<Index> near;
  for (Index v = 0; v < symmetric.mesh.vertex_count(); ++v)
    if (std::abs(positions(v, 0) - positions(symmetric.partner[v], 0)) +
            (positions.row(v) - positions.row(symmetric.partner[v])).norm() <=
        2 * width_rel * size)
      near.push_back(v);
  return near;
}

EditSelection indices(std::vector<Index> vertices) { return {Selection::Indices{std::move(vertices)}}; }

std::vector<Index> images_of(const SymmetricMesh& symmetric, const std::vector<Index>& set) {
  std::vector<Index> images;
  for (const Index v : set) images.push_back(symmetric.partner[v]);
  std::sort(images.begin(), images.end());
  return images;
}

DeformStep step_of(const SymmetricMesh& symmetric, const HandleMotion& motion, DeformMethod method) {
  DeformStep step;
  step.mesh = "m";
  step.fixed = indices(at_plane(symmetric, 0.04));
  step.handles.push_back({.name = "tip", .select = indices(tip(symmetric, 0.12)), .pose = {motion}});
  step.symmetry = SymmetrySpec{symmetric.plane};
  step.settings.deformer.method = method;
  return step;
}

ResolvedDeform resolved(const SymmetricMesh& symmetric, const DeformStep& step) {
  const SelectionMesh context(symmetric.mesh);
  return resolve_deform({}, step, context, "edit.json: steps[0]");
}

Points edited(const SymmetricMesh& symmetric, const DeformStep& step) {
  const ResolvedDeform deform = resolved(symmetric, step);
  const Deformer deformer(symmetric.mesh.positions, triangulate(symmetric.mesh).triangles, deform.region,
                          step.settings.deformer);
  return deformer.evaluate(deform.poses);
}

/// Returns the largest distance between the result and its mirror image, × the largest displacement.
double asymmetry(const SymmetricMesh& symmetric, const Points& positions) {
  const Eigen::Affine3d s = reflection(symmetric.plane, "plane");
  double largest = 0;
  for (Index v = 0; v < symmetric.mesh.vertex_count(); ++v)
    largest = std::max(
        largest, (s * positions.row(v).transpose() - positions.row(symmetric.partner[v]).transpose()).norm());
  return largest / (positions - symmetric.mesh.positions).rowwise().norm().maxCoeff();
}

Error symmetry_refusal(const SymmetricMesh& symmetric, const DeformStep& step) {
  try {
    resolved(symmetric, step);
  } catch (const Error& error) {
    EXPECT_FALSE(error.remedy().empty()) << error.what();
    return error;
  }
  throw std::logic_error("the step was accepted");
}

std::vector<Note> notes_on_poses(const SymmetricMesh& symmetric, const DeformStep& step) {
  const ResolvedDeform deform = resolved(symmetric, step);
  return pose_notes(*deform.symmetry, deform.region.handles, deform.poses, symmetric.mesh.positions);
}

constexpr double rounding = 1e-8;

TEST(Symmetry, TheResultIsItsOwnMirrorImage) {
  const HandleMotion motion{
      .translate = {0.2, 0.1, 0.3}, .axis = {1, 2, 0.5}, .angle_deg = 50, .scale = {1.2, 0.8, 1}};
  for (const SymmetricMesh& symmetric : symmetric_families())
    for (const DeformMethod method :
         {DeformMethod::ft05, DeformMethod::rotation_aware, DeformMethod::corotational}) {
      const DeformStep step = step_of(symmetric, motion, method);
      const ResolvedDeform deform = resolved(symmetric, step);
      ASSERT_EQ(deform.region.handles.size(), 2U) << symmetric.name;
      EXPECT_TRUE(deform.region.symmetric);
      EXPECT_EQ(deform.region.handles[1].name, "tip, mirrored");
      EXPECT_EQ(deform.region.handles[1].vertices, images_of(symmetric, deform.region.handles[0].vertices));
      EXPECT_TRUE(deform.notes.empty()) << deform.notes.front().text();
      EXPECT_LT(asymmetry(symmetric, edited(symmetric, step)), rounding)
          << symmetric.name << ", " << to_string(method);
    }
}

TEST(Symmetry, ItDoesNotMatterOnWhichSideTheHandleIs) {
  const HandleMotion motion{.translate = {0.2, 0.1, 0.3}, .axis = {1, 2, 0.5}, .angle_deg = 50};
  const HandleMotion behind{.translate = {-0.2, 0.1, 0.3}, .axis = {-1, 2, 0.5}, .angle_deg = -50};
  for (const SymmetricMesh& symmetric : symmetric_families()) {
    if (symmetric.plane.point.norm() > 0) continue;  // the motions are in unturned axes
    DeformStep step = step_of(symmetric, motion, DeformMethod::corotational);
    const Points here = edited(symmetric, step);
    step.handles[0].select = indices(images_of(symmetric, tip(symmetric, 0.12)));
    step.handles[0].pose = {behind};
    const double moved = (here - symmetric.mesh.positions).rowwise().norm().maxCoeff();
    EXPECT_LT((edited(symmetric, step) - here).rowwise().norm().maxCoeff(), rounding * moved) << symmetric.name;
  }
}

TEST(Symmetry, TurnsGoRoundAsFarOnBothSides) {
  for (const double angle_deg : {270.0, 720.0})
    for (const SymmetricMesh& symmetric :
         {doubled(test::bumpy_sphere(3)), turned(doubled(test::tube(16, 12)))}) {
      const HandleMotion motion{.axis = symmetric.plane.normal, .angle_deg = angle_deg};
      const DeformStep step = step_of(symmetric, motion, DeformMethod::rotation_aware);
      const std::vector<HandlePose> poses = resolved(symmetric, step).poses;
      ASSERT_TRUE(poses[1].rotation);
      EXPECT_NEAR(std::abs(poses[1].rotation->angle()), angle_deg * M_PI / 180, 1e-12);
      EXPECT_LT((poses[1].rotation->toRotationMatrix() - poses[1].transform.linear()).norm(), 1e-12);
      const Points result = edited(symmetric, step);
      EXPECT_LT(asymmetry(symmetric, result), rounding) << symmetric.name << ", " << angle_deg;
      DeformStep short_way = step;  // given by a matrix, which cannot tell 270° from -90°
      short_way.handles[0].pose = {poses[0].transform.matrix()};
      if (angle_deg == 270) {
        EXPECT_GT((edited(symmetric, short_way) - result).norm(), 0.01);
      }
    }
}

TEST(Symmetry, AnchorsTargetsAndTheRegionHaveImages) {
  const SymmetricMesh symmetric = doubled(test::bumpy_sphere(3));
  DeformStep step = step_of(symmetric, {}, DeformMethod::ft05);
  step.handles.clear();
  const std::vector<Index> part = tip(symmetric, 0.3);
  const Index target = tip(symmetric, 0.01).front();
  step.region = indices(part);
  step.fixed.reset();
  step.anchors.push_back({indices(tip(symmetric, 0.05)), 3});
  step.targets.push_back({target, symmetric.mesh.positions.row(target).transpose() * 1.3});
  Eigen::Matrix3d shear = Eigen::Matrix3d::Identity();
  shear(0, 1) = 0.5;
  step.transforms.push_back({target, shear});
  const ResolvedDeform deform = resolved(symmetric, step);
  std::vector<Index> both = images_of(symmetric, part);
  both.insert(both.end(), part.begin(), part.end());
  std::sort(both.begin(), both.end());
  both.erase(std::unique(both.begin(), both.end()), both.end());
  EXPECT_EQ(deform.region.vertices, both);
  EXPECT_EQ(deform.region.fixed, images_of(symmetric, deform.region.fixed));
  std::vector<Index> anchored;
  for (const Anchor& anchor : deform.region.anchors) anchored.push_back(anchor.vertex);
  EXPECT_EQ(anchored, images_of(symmetric, anchored));
  EXPECT_GT(anchored.size(), 2U);
  ASSERT_EQ(deform.constraints.size(), 2U);
  const bool first = deform.constraints[0].vertex == target;
  const VertexConstraint& image = deform.constraints[first ? 1 : 0];
  EXPECT_EQ(image.vertex, symmetric.partner[target]);
  EXPECT_EQ((*image.transform)(0, 1), -0.5);
  EXPECT_EQ(*image.position, Eigen::Vector3d(symmetric.mesh.positions.row(image.vertex).transpose() * 1.3));
}

TEST(Symmetry, ARedrawnCurveIsRedrawnBehindTheMirror) {
  const SymmetricMesh symmetric = doubled(test::irregular_grid(16, 12));
  const Points& p = symmetric.mesh.positions;
  const Eigen::RowVector3d high = p.colwise().maxCoeff(), low = p.colwise().minCoeff();
  DeformStep step = step_of(symmetric, {}, DeformMethod::corotational);
  HandleSpec& curve = step.handles[0];
  curve.shape = HandleShape::curve;
  const double x = 0.8 * high.x();
  curve.select = {
      Selection::Path{{{x, 0.9 * low.y() + 0.1 * high.y(), 0}, {x, 0.1 * low.y() + 0.9 * high.y(), 0}}}};
  Points course(3, 3);
  course << x, low.y(), 0, 1.2 * x, 0.5 * (low.y() + high.y()), 0.3 * high.y(), x, high.y(), 0;
  curve.pose = {PoseSpec::Redrawn{course}};
  EXPECT_LT(asymmetry(symmetric, edited(symmetric, step)), 1e-7);
}

TEST(Symmetry, AHandleAcrossThePlaneHasItsPoseAsGiven) {
  const SymmetricMesh symmetric = doubled(test::tube(16, 12));
  DeformStep step = step_of(symmetric, {.translate = {0, 0.1, 0.3}}, DeformMethod::corotational);
  step.fixed = indices(tip(symmetric, 0.1));
  step.handles[0].select = indices(at_plane(symmetric, 0.02));
  const ResolvedDeform deform = resolved(symmetric, step);
  EXPECT_EQ(deform.region.handles.size(), 1U);
  EXPECT_EQ(deform.symmetry->own, std::vector<std::size_t>{0});
  EXPECT_TRUE(notes_on_poses(symmetric, step).empty());
  EXPECT_LT(asymmetry(symmetric, edited(symmetric, step)), rounding);

  for (const HandleMotion& aside :
       {HandleMotion{.translate = {0.2, 0, 0}}, HandleMotion{.axis = {0, 0, 1}, .angle_deg = 360},
        HandleMotion{.axis = {0, 1, 0}, .angle_deg = 30}}) {
    step.handles[0].pose = {aside};
    EXPECT_EQ(notes_on_poses(symmetric, step).size(), 1U);
  }
  step.handles[0].pose = {HandleMotion{.axis = {1, 0, 0}, .angle_deg = 360, .scale = {2, 1, 1}}};
  EXPECT_TRUE(notes_on_poses(symmetric, step).empty()) << "a turn about the normal";
}

TEST(Symmetry, RefusesWhatCannotBeMirrored) {
  const SymmetricMesh symmetric = doubled(test::bumpy_sphere(3));
  const DeformStep good = step_of(symmetric, {}, DeformMethod::corotational);
  DeformStep across = good;
  across.fixed = indices(tip(symmetric, 0.05));
  std::vector<Index> half = at_plane(symmetric, 0.04);
  std::erase_if(half, [&](Index v) { return symmetric.mesh.positions(v, 0) < -1e-3; });
  across.handles[0].select = indices(half);
  const Error overlap = symmetry_refusal(symmetric, across);
  EXPECT_EQ(overlap.id(), "script.overlaps_mirror_image");
  EXPECT_EQ(overlap.fact().get<std::string>("handle"), across.handles[0].name);
  EXPECT_EQ(overlap.fact().get<std::int64_t>("all"), static_cast<std::int64_t>(half.size()));
  EXPECT_LT(overlap.fact().get<std::int64_t>("shared"), static_cast<std::int64_t>(half.size()));

  DeformStep twice = good;
  twice.handles.push_back(twice.handles[0]);
  twice.handles[1].name = "other tip";
  twice.handles[1].select = indices(images_of(symmetric, tip(symmetric, 0.12)));
  const Error held = symmetry_refusal(symmetric, twice);
  EXPECT_EQ(held.id(), "script.mirror_image_held");
  EXPECT_EQ(held.fact().get<std::string>("other"), "other tip");
  EXPECT_NE(held.problem().find("already part of the handle 'other tip'"), std::string::npos) << held.what();

  DeformStep onto_fixed = good;
  onto_fixed.fixed = indices(images_of(symmetric, tip(symmetric, 0.05)));
  onto_fixed.handles[0].select = indices(tip(symmetric, 0.12));
  EXPECT_EQ(symmetry_refusal(symmetric, onto_fixed).id(), "deform.vertex_also_fixed");

  DeformStep named = good;
  named.handles.push_back({.name = "tip, mirrored", .select = {Selection::NearestVertex{{0, 0.7, 0.7}}}});
  named.fixed = indices({});
  EXPECT_EQ(symmetry_refusal(symmetric, named).id(), "script.name_of_twin");

  DeformStep aside = good;
  aside.symmetry->plane.point.x() = 0.3;
  const Error far = symmetry_refusal(symmetric, aside);
  EXPECT_EQ(far.id(), "script.not_mirrored");
  EXPECT_GT(far.fact().get<double>("distance_rel"), 0.05);
  EXPECT_NE(far.problem().find("no vertex at the mirror image, the first is"), std::string::npos);
  EXPECT_NE(far.remedy().find("Choose a plane that mirrors the mesh"), std::string::npos) << far.what();
  aside.symmetry->plane.point.x() = 0.02;
  const Error near = symmetry_refusal(symmetric, aside);
  EXPECT_EQ(near.id(), "script.no_mirror_image");
  EXPECT_EQ(near.fact().get<std::string>("handle"), aside.handles[0].name);
  EXPECT_GT(near.fact().get<std::int64_t>("lost"), 0);
  EXPECT_LE(near.fact().get<std::int64_t>("lost"), near.fact().get<std::int64_t>("all"));
  EXPECT_NE(near.remedy().find("A 'symmetry.tolerance_rel' of"), std::string::npos) << near.what();
  aside.handles.clear();
  aside.targets.push_back({tip(symmetric, 0.01).front(), {0, 0, 0}});
  EXPECT_EQ(symmetry_refusal(symmetric, aside).id(), "script.vertex_without_mirror_image");
}

/// The vertices on the two sides of a scan are no mirror images of each other.
TEST(Symmetry, AScanThatIsNearlySymmetricIsMatchedWithinATolerance) {
  const test::TestMesh grid = test::irregular_grid(40, 30);
  SymmetricMesh scan{"scan", make_mesh(grid.positions, grid.triangles), {}, {}};
  const Eigen::RowVector3d middle =
      0.5 * (grid.positions.colwise().maxCoeff() + grid.positions.colwise().minCoeff());
  scan.mesh.positions.col(2).setZero();
  scan.plane = {middle.transpose(), {1, 0, 0}};
  const std::vector<Index> held = tip(scan, 0.15);
  DeformStep step;
  step.mesh = "m";
  step.symmetry = SymmetrySpec{scan.plane};
  step.handles.push_back(
      {.name = "tip", .select = indices(held), .pose = {HandleMotion{.translate = {0, 0, 1}}}});
  step.region = indices(tip(scan, 0.3));
  step.symmetry->tolerance_rel = symmetry_refusal(scan, step).fact().get<double>("tolerance_rel");
  const ResolvedDeform deform = resolved(scan, step);
  const std::vector<Index>& twin = deform.region.handles[1].vertices;
  EXPECT_GE(twin.size(), held.size() * 8 / 10);
  // The image has no holes: a vertex is held if all its neighbours are held.
  const SelectionMesh context(scan.mesh);
  for (Index v = 0; v < scan.mesh.vertex_count(); ++v) {
    const auto ring = context.rings[v];
    const auto is_held = [&](Index w) { return std::binary_search(twin.begin(), twin.end(), w); };
    EXPECT_TRUE(is_held(v) || !std::all_of(ring.begin(), ring.end(), is_held)) << v;
  }
  ASSERT_EQ(deform.symmetry->without_partner > 0, deform.notes.size() == 1);
  for (const Note& note : deform.notes) {
    EXPECT_EQ(note.id(), "script.region_without_mirror_image");
    EXPECT_EQ(note.get<std::int64_t>("lost"), deform.symmetry->without_partner);
  }
}

TEST(Symmetry, TheFileSaysItAndTheReportTellsIt) {
  const std::string text = R"({"format": "meshgraft-edit", "version": 2, "inputs": {"bar": {"sample": "bar"}},
    "steps": [{"kind": "deform", "mesh": "bar",
      "symmetry": {"point": [0, 0, 2], "normal": [0, 0, 2]},
      "fixed": {"box": {"min": [-9, -9, 1.8], "max": [9, 9, 2.2]}},
      "handles": [{"name": "end", "select": {"half_space": {"point": [0, 0, 3.7], "normal": [0, 0, 1]}},
                   "pose": {"rotate": {"axis": [1, 0, 0], "angle_deg": 30}}}]}]})";
  const EditFile edit = parse_edit(text, "edit.json");
  EXPECT_EQ(write_edit(parse_edit(write_edit(edit), "edit.json")), write_edit(edit));
  EXPECT_EQ(nlohmann::json::parse(write_edit(edit))["steps"][0]["symmetry"]["tolerance_rel"], 1e-3);
  const EditResult result = run_edit(edit);
  const nlohmann::json report = nlohmann::json::parse(write_report(result.report));
  EXPECT_EQ(report["steps"][0]["symmetry"],
            (nlohmann::json{
                {"twins", {"end, mirrored"}}, {"own_image", nlohmann::json::array()}, {"without_partner", 0}}));
  EXPECT_EQ(report["counts"]["handle"].get<int>() % 2, 0);
  EXPECT_EQ(report["steps"][0]["notes"].size(), 0U);
}

}  // namespace
}  // namespace meshgraft
