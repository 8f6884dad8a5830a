#include "mesh/shown_orientation.h"

#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include <meshgraft/samples/samples.h>

#include "mesh/up_axis.h"

namespace meshgraft {
namespace {

using Vector = Eigen::Vector3d;

Mesh with_y_up(const char* sample, int resolution) {
  Mesh mesh = make_sample(sample, resolution);
  const Points z_up = mesh.positions;
  mesh.positions.col(1) = z_up.col(2);
  mesh.positions.col(2) = -z_up.col(1);
  return mesh;
}

Mesh from(Mesh mesh, std::optional<UpAxis> stated, UpAxis usual) {
  mesh.source = std::make_shared<const FilelessSource>(stated, usual);
  return mesh;
}

TEST(ShownOrientation, IsThatOfTheShapeWhereItIsClear) {
  for (const char* sample : {"octopus", "bust", "dinosaur"}) {
    const Mesh z_up = make_sample(sample, 24), y_up = with_y_up(sample, 24);
    for (const UpAxis usual : {UpAxis::y, UpAxis::z}) {
      EXPECT_EQ(shown_orientation(from(z_up, std::nullopt, usual)).up, Vector::UnitZ()) << sample;
      EXPECT_EQ(shown_orientation(from(y_up, std::nullopt, usual)).up, Vector::UnitY()) << sample;
    }
  }
}

TEST(ShownOrientation, IsThatWhichTheSourceStates) {
  const Mesh y_up = with_y_up("octopus", 24);
  EXPECT_EQ(shown_orientation(from(y_up, UpAxis::z, UpAxis::z)).up, Vector::UnitZ());
  EXPECT_EQ(shown_orientation(from(y_up, UpAxis::y, UpAxis::z)).up, Vector::UnitY());
}

TEST(ShownOrientation, FollowsTheConventionOfTheFormatWhereTheShapeDoesNotTell) {
  const Mesh bar = make_sample("bar", 8);
  EXPECT_EQ(shown_orientation(from(bar, std::nullopt, UpAxis::y)).up, Vector::UnitY());
  EXPECT_EQ(shown_orientation(from(bar, std::nullopt, UpAxis::z)).up, Vector::UnitZ());
  EXPECT_EQ(shown_orientation(Mesh{}).up, Vector::UnitZ()) << "and z without a source";
}

TEST(ShownOrientation, IsKeptWhereTheFileBehindAMeshIsForgotten) {
  Mesh mesh = from(with_y_up("octopus", 24), std::nullopt, UpAxis::z);
  forget_file(mesh);
  EXPECT_EQ(shown_orientation(mesh).up, Vector::UnitY());
}

}  // namespace
}  // namespace meshgraft
