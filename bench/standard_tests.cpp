#include "standard_tests.h"

#include <functional>
#include <numbers>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/samples/samples.h>
#include <meshgraft/select/selection.h>

#include "io/file.h"
#include "io/selection_files.h"

namespace meshgraft::bench {

namespace {

using Eigen::Vector3d;

Eigen::Affine3d turn_about(const Vector3d& centre, double degrees, const Vector3d& axis) {
  return Eigen::Translation3d(centre) * Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis) *
         Eigen::Translation3d(-centre);
}

StandardTest make_test(const std::string& name, const std::string& sample,
                       const std::function<bool(const Vector3d&)>& fixed,
                       const std::function<bool(const Vector3d&)>& handle, const Eigen::Affine3d& pose) {
  const Mesh mesh = make_sample(sample);
  StandardTest test{name, {mesh.positions, triangulate(mesh).triangles, {}, {}, pose}};
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Vector3d p = mesh.positions.row(v);
    if (fixed(p)) test.edit.fixed.push_back(v);
    if (handle(p)) test.edit.handle.push_back(v);
  }
  return test;
}

}  // namespace

std::vector<StandardTest> sample_tests() {
  const auto below = [](double z) { return [z](const Vector3d& p) { return p.z() <= z; }; };
  const auto above = [](double z) { return [z](const Vector3d& p) { return p.z() >= z; }; };
  const auto beyond = [](const Vector3d& p) { return p.head<2>().cwiseAbs().maxCoeff() > 0.45; };
  const auto disc = [](const Vector3d& p) { return p.head<2>().norm() < 0.12; };
  const Eigen::Affine3d lift(Eigen::Translation3d(0, 0, 0.2));
  const Vector3d low(0, 0, 1), middle(0, 0, 2);
  const Eigen::Affine3d bent = turn_about(middle, 120, Vector3d::UnitX());
  return {make_test("plane", "bumpy_plane", beyond, disc, lift),
          make_test("cylinder", "cylinder", below(0.4), above(3.6), bent),
          make_test("bar", "bar", below(0.4), above(3.6), turn_about(middle, 135, Vector3d::UnitZ())),
          make_test("cactus", "cactus", below(0.25), above(2.45), turn_about(low, -70, Vector3d::UnitX()))};
}

std::vector<StandardTest> read_tests(const std::filesystem::path& folder) {
  std::vector<StandardTest> tests;
  for (const std::string name : {"plane", "cylinder", "bar", "cactus"}) {
    StandardTest test{name, {}};
    const Mesh mesh = read_mesh(folder / (name + ".off"));
    test.edit.positions = mesh.positions;
    test.edit.triangles = triangulate(mesh).triangles;
    const auto count = static_cast<Index>(test.edit.positions.rows());
    const SelRoles parts = parse_sel(read_file(folder / (name + ".sel")), count, Location::file(name + ".sel"));
    test.edit.fixed = parts.fixed;
    test.edit.handle = parts.handle;
    test.edit.pose.matrix() = parse_def(read_file(folder / (name + ".def")), Location::file(name + ".def"));
    tests.push_back(std::move(test));
  }
  return tests;
}

}  // namespace meshgraft::bench
