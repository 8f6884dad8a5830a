#include <meshgraft/mesh/orientation.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/samples/samples.h>

namespace meshgraft {
namespace {

using Vector = Eigen::Vector3d;

/// Adds the quads of a box.
void add_box(Mesh& mesh, const Vector& low, const Vector& high) {
  const Index first = mesh.vertex_count();
  mesh.positions.conservativeResize(first + 8, 3);
  for (int k = 0; k < 8; ++k)
    for (int axis = 0; axis < 3; ++axis)
      mesh.positions(first + k, axis) = (k >> axis & 1) == 0 ? low[axis] : high[axis];
  for (const auto& quad : {std::array<Index, 4>{0, 2, 3, 1},
                           {4, 5, 7, 6},
                           {0, 1, 5, 4},
                           {2, 6, 7, 3},
                           {0, 4, 6, 2},
                           {1, 3, 7, 5}}) {
    std::array<Index, 4> face = quad;
    for (Index& v : face) v += first;
    mesh.faces.push_back(face);
  }
}

/// A body of boxes: a trunk on four legs that stand apart, and a head at +x, so that y is the side.
Mesh four_legged() {
  Mesh mesh;
  const auto add = [&](const Vector& low, const Vector& high) { add_box(mesh, low, high); };
  add({-2, -0.3, 1}, {2, 0.3, 2});
  for (const double x : {-1.8, 1.4})
    for (const double y : {-0.9, 0.6}) add({x, y, 0}, {x + 0.4, y + 0.3, 1});
  add({1.6, -0.2, 2}, {2.8, 0.2, 3.5});
  return mesh;
}

double sum_of(const std::vector<OrientationGuess>& guesses) {
  double sum = 0;
  for (const OrientationGuess& guess : guesses) sum += guess.probability;
  return sum;
}

TEST(Orientation, OfAnAnimalHasItsBackUpAndItsSideAcross) {
  const Mesh animal = four_legged();
  // The axes of the coordinates in which a file may have it, and what is up and aside then.
  for (const auto& [x, y, z] : {std::tuple(Vector(1, 0, 0), Vector(0, 1, 0), Vector(0, 0, 1)),
                                std::tuple(Vector(1, 0, 0), Vector(0, 0, -1), Vector(0, 1, 0)),
                                std::tuple(Vector(0, 0, 1), Vector(1, 0, 0), Vector(0, 1, 0)),
                                std::tuple(Vector(0, 1, 0), Vector(-1, 0, 0), Vector(0, 0, 1))}) {
    Eigen::Matrix3d turn;
    turn << x, y, z;
    Mesh turned = animal;
    turned.positions = animal.positions * turn.transpose();
    const std::vector<OrientationGuess> guesses = guess_orientations(turned);
    ASSERT_EQ(guesses.size(), 24U);
    EXPECT_NEAR(sum_of(guesses), 1, 1e-12);
    const auto& [up, front] = guesses.front().orientation;
    EXPECT_EQ(up, z);
    EXPECT_NEAR(std::abs(up.cross(front).dot(y)), 1, 1e-12);
    for (std::size_t k = 1; k < guesses.size(); ++k)
      EXPECT_LE(guesses[k].probability, guesses[k - 1].probability);
  }
}

/// Returns the most probable front with z up of a sample that is turned by a number of quarter turns about z,
/// as it would be without that turn.
Vector front_of_turned(const char* sample, int quarters) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(quarters * std::numbers::pi / 2, Vector::UnitZ())
                                   .toRotationMatrix()
                                   .array()
                                   .round()
                                   .matrix();
  Mesh mesh = make_sample(sample, 40);
  mesh.positions = (mesh.positions * turn.transpose()).eval();
  for (const OrientationGuess& guess : guess_orientations(mesh))
    if (guess.orientation.up == Vector::UnitZ()) return turn.transpose() * guess.orientation.front;
  return Vector::Zero();
}

TEST(Orientation, OfAnAnimalHasItsHeadInFrontHoweverItIsTurned) {
  for (int quarters = 0; quarters < 4; ++quarters)
    EXPECT_EQ(front_of_turned("dinosaur", quarters), -Vector::UnitX()) << quarters;
}

TEST(Orientation, LiesInTheMirrorPlaneHoweverTheModelIsTurned) {
  for (const char* sample : {"bust", "head"})
    for (int quarters = 0; quarters < 4; ++quarters)
      EXPECT_EQ(std::abs(front_of_turned(sample, quarters).y()), 1) << sample << quarters;
}

TEST(Orientation, OfWhatHasNoFrontFollowsTheConvention) {
  for (const char* sample : {"cylinder", "bar", "torus", "bracket"})
    for (int quarters = 0; quarters < 4; ++quarters) {
      const Vector usual =
          Eigen::AngleAxisd(-quarters * std::numbers::pi / 2, Vector::UnitZ()) * -Vector::UnitY();
      EXPECT_TRUE(front_of_turned(sample, quarters).isApprox(usual)) << sample << quarters;
    }
}

TEST(Orientation, DoesNotDependOnScalePlaceAndTriangles) {
  const Mesh animal = four_legged();
  Mesh moved = animal;
  moved.positions = (1000 * animal.positions).rowwise() + Eigen::RowVector3d(5e4, -2e4, 7e4);
  const std::vector<OrientationGuess> guesses = guess_orientations(animal), others = guess_orientations(moved);
  for (std::size_t k = 0; k < guesses.size(); ++k)
    EXPECT_NEAR(guesses[k].probability, others[k].probability, 1e-6);
}

TEST(Orientation, OfNothingFollowsConventionsAlone) {
  Mesh point;
  add_box(point, Vector::Zero(), Vector::Zero());
  for (const Mesh& mesh : {Mesh(), point}) {
    const std::vector<OrientationGuess> guesses = guess_orientations(mesh);
    ASSERT_EQ(guesses.size(), 24U);
    EXPECT_NEAR(sum_of(guesses), 1, 1e-12);
    EXPECT_EQ(guesses[0].probability, guesses[1].probability);  // y up and z front, or z up and −y front
    EXPECT_LT(guesses[2].probability, guesses[1].probability);
  }
}

TEST(Orientation, IsMadeOfDirectionsOfAnyLength) {
  const Orientation made = make_orientation({0, 0, 1e-200}, {3e200, 0, 1e200});
  EXPECT_TRUE(made.up.isApprox(Vector::UnitZ()));
  const Orientation level = make_orientation({0, 2, 0}, {1, 1, 0});
  EXPECT_TRUE(level.front.isApprox(Vector::UnitX()));
  for (const auto& [up, front] :
       {std::pair(Vector(0, 0, 0), Vector(1, 0, 0)), std::pair(Vector(1, 0, 0), Vector(0, 0, 0)),
        std::pair(Vector(1, 2, 3), Vector(-2, -4, -6))}) {
    try {
      make_orientation(up, front);
      ADD_FAILURE();
    } catch (const Error& error) {
      EXPECT_EQ(error.id(), "mesh.orientation_undefined");
    }
  }
}

TEST(Orientation, AxesHaveNames) {
  EXPECT_EQ(axis_named("y"), Vector::UnitY());
  EXPECT_EQ(axis_named("-z"), -Vector::UnitZ());
  for (const std::string name : {"", "-", "w", "xy", "+x", "--x", "X"}) EXPECT_FALSE(axis_named(name)) << name;
}

}  // namespace
}  // namespace meshgraft
