#include <meshgraft/operators/affine_operator.h>

#include <cstring>

#include <gtest/gtest.h>
#include <Eigen/Geometry>
#include <Eigen/QR>

#include <meshgraft/core/error.h>

#include "linalg/sparse.h"
#include "linalg/sparse_products.h"
#include "operators/laplacian.h"
#include "operators/smoothness_pairs.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// Returns the families of about unit scale near the origin, for which the operator is made.
std::vector<test::TestMesh> families() {
  std::vector<test::TestMesh> meshes;
  for (test::TestMesh& mesh : test::mesh_families()) {
    const double diagonal = mesh.box_diagonal();
    if (mesh.positions.cwiseAbs().maxCoeff() < 1e3 * diagonal && diagonal > 1e-3)
      meshes.push_back(std::move(mesh));
  }
  return meshes;
}

std::vector<OperatorOptions> all_options() {
  std::vector<OperatorOptions> all;
  for (auto weights : {WeightScheme::uniform, WeightScheme::cotangent})
    for (auto density : {Density::ft05, Density::aware})
      for (auto degenerate : {DegenerateTreatment::ft05_noise, DegenerateTreatment::apex})
        for (int order : {1, 2, 3})
          all.push_back(
              {.weights = weights, .density = density, .degenerate = degenerate, .laplacian_order = order});
  return all;
}

std::string name_of(const OperatorOptions& options) {
  return std::string(to_string(options.weights)) + " " + std::string(to_string(options.density)) + " " +
         std::string(to_string(options.degenerate)) + " order " + std::to_string(options.laplacian_order);
}

TEST(Umbrella, RowsSumToZeroAndFollowTheRing) {
  for (const auto& mesh : families()) {
    const IndexLists rings = vertex_rings(mesh.size(), mesh.triangles);
    for (auto weights : {WeightScheme::uniform, WeightScheme::cotangent}) {
      const SparseRows D = umbrella_operator(mesh.positions, mesh.triangles, rings, weights);
      EXPECT_LT((D * Eigen::VectorXd::Ones(mesh.size())).cwiseAbs().maxCoeff(), 1e-14) << mesh.name;
      for (Index i = 0; i < mesh.size(); ++i) {
        for (SparseRows::InnerIterator it(D, i); it; ++it) {
          if (it.col() == i)
            EXPECT_EQ(it.value(), 1);
          else
            EXPECT_LE(it.value(), 0) << mesh.name << " vertex " << i;
        }
      }
    }
  }
}

TEST(Umbrella, CotangentWeightsOfARegularHexagonAreEven) {
  Points points(7, 3);
  Triangles triangles(6, 3);
  points.row(0).setZero();
  for (int k = 0; k < 6; ++k) {
    points.row(k + 1) << std::cos(k * M_PI / 3), std::sin(k * M_PI / 3), 0;
    triangles.row(k) << 0, k + 1, (k + 1) % 6 + 1;
  }
  const IndexLists rings = vertex_rings(7, triangles);
  const SparseRows D = umbrella_operator(points, triangles, rings, WeightScheme::cotangent);
  for (int k = 1; k <= 6; ++k) EXPECT_NEAR(D.coeff(0, k), -1.0 / 6, 1e-15);
}

TEST(LocalMaps, ReproduceAffineMapsWithoutConstants) {
  Eigen::Matrix3d B;
  B << 1.3, -0.4, 0.2, 0.7, -0.8, 0.1, 0.05, 0.6, 2.0;  // combines a shear, a reflection and scales
  const Eigen::RowVector3d t(3, -2, 5);
  for (const auto& mesh : families()) {
    for (const auto& options : all_options()) {
      if (options.laplacian_order > 1) continue;
      const AffineOperator op(mesh.positions, mesh.triangles, options);
      const Columns x = (op.nodes().positions * B.transpose()).rowwise() + t;
      const Columns m = multiply(op.H(), x);
      for (Index i = 0; i < mesh.size(); ++i) {
        if (op.rings()[i].empty()) continue;
        if (options.degenerate == DegenerateTreatment::ft05_noise && mesh.size() <= 12)
          continue;  // too few vertices to span space
        EXPECT_LT((m.middleRows<3>(3 * i) - B.transpose()).norm(), 1e-7)
            << mesh.name << " " << name_of(options) << " vertex " << i;
      }
    }
  }
}

TEST(LocalMaps, AreTheLeastSquaresFitToRingsOfAnyHeight) {
  constexpr int ring = 6;
  Triangles triangles(ring, 3);
  for (int k = 0; k < ring; ++k) triangles.row(k) << 0, k + 1, (k + 1) % ring + 1;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  for (const double height : {1000.0, 170.0, 100.0, 10.0, 1.0, 0.1, 0.03, 0.01, 0.003, 1e-4, 1e-6}) {
    Points points(ring + 1, 3);
    points.row(0) << 0.1, 0, height;
    for (int k = 0; k < ring; ++k)
      points.row(k + 1) << std::cos(k * M_PI / 3), (1 + 0.1 * k) * std::sin(k * M_PI / 3),
          0.2 * height * (k % 3);
    points = (points * turn).eval();
    for (const auto degenerate : {DegenerateTreatment::ft05_noise, DegenerateTreatment::apex}) {
      const AffineOperator op(points, triangles, {.degenerate = degenerate, .flatness = 0});
      const Points& nodes = op.nodes().positions;
      std::vector<Index> stencil{0, 1, 2, 3, 4, 5, 6};
      if (op.nodes().apex[0] >= 0) stencil.push_back(op.nodes().apex[0]);
      const Columns x = Columns::Random(nodes.rows(), 3);
      const auto centred = [&](const auto& values) {
        Eigen::MatrixXd rows = values(stencil, Eigen::all);
        const Eigen::RowVectorXd centre = rows.middleRows(1, ring).colwise().mean();
        rows.rowwise() -= centre;
        return rows;
      };
      const Eigen::MatrixXd fit = centred(nodes).completeOrthogonalDecomposition().solve(centred(x));
      EXPECT_LT((multiply(op.H(), x).topRows<3>() - fit).norm(), 1e-8 * fit.norm()) << height;
    }
  }
}

TEST(Rows, VanishOnAffineImages) {
  Eigen::Matrix3d B;
  B << 0.6, 0.4, -0.2, 0.1, 1.8, 0.3, -0.5, 0.2, 0.9;
  for (const auto& mesh : families()) {
    for (const auto& options : all_options()) {
      if (options.degenerate == DegenerateTreatment::ft05_noise && mesh.size() <= 12) continue;
      const AffineOperator op(mesh.positions, mesh.triangles, options);
      const Columns x = (op.nodes().positions * B.transpose()).rowwise() + Eigen::RowVector3d(1, 2, 3);
      const SparseRows A = op.A();
      const Columns residual = multiply(A, x);
      for (Eigen::Index row = 0; row < A.rows(); ++row)
        ASSERT_LT(residual.row(row).norm(), 1e-8 * (1 + A.row(row).norm()))
            << mesh.name << " " << name_of(options) << " row " << row;
    }
  }
}

TEST(Rows, AreTheEnergysTerms) {
  for (const auto& mesh : test::small_families()) {
    OperatorOptions options;
    const AffineOperator op(mesh.positions, mesh.triangles, options);
    const Columns x = Columns::Random(op.nodes().positions.rows(), 3);
    const Columns m = multiply(op.H(), x);
    const Columns laplacian = multiply(op.L(), x) - multiply(op.delta(), m);
    const Columns smoothness = multiply(op.P(), m);
    const Columns all = multiply(op.A(), x);
    ASSERT_EQ(all.rows(), laplacian.rows() + smoothness.rows());
    const double scale = 1 + all.norm();
    EXPECT_LT((all.topRows(laplacian.rows()) - laplacian).norm(), 1e-10 * scale) << mesh.name;
    EXPECT_LT((all.bottomRows(smoothness.rows()) - smoothness).norm(), 1e-10 * scale) << mesh.name;
  }
}

TEST(Rows, AreTheSameBytesOnOneThreadAndTwo) {
  const auto mesh = test::irregular_grid(40, 40);
  for (const auto& options : all_options()) {
    const SparseRows one =
        AffineOperator(mesh.positions, mesh.triangles, options, {.threads = 1}).A({.threads = 1});
    const SparseRows two =
        AffineOperator(mesh.positions, mesh.triangles, options, {.threads = 2}).A({.threads = 2});
    ASSERT_EQ(one.nonZeros(), two.nonZeros());
    EXPECT_EQ(std::memcmp(one.valuePtr(), two.valuePtr(), sizeof(double) * one.nonZeros()), 0)
        << name_of(options);
  }
}

TEST(SmoothnessPairs, AreEdgesAndPairsOppositeAcrossThem) {
  const auto tetrahedron = test::tetrahedron();
  const std::vector<std::uint8_t> all(4, 1);
  const IndexLists faces_at = vertex_triangles(4, tetrahedron.triangles);
  const auto pairs =
      smoothness_pairs(tetrahedron.triangles, faces_at, vertex_rings(4, tetrahedron.triangles), all);
  EXPECT_EQ(pairs.size(), 6u);  // pairs opposite across an edge are edges here

  const auto quad = test::two_triangles();
  const std::vector<std::uint8_t> four(4, 1);
  const auto quad_pairs = smoothness_pairs(quad.triangles, vertex_triangles(4, quad.triangles),
                                           vertex_rings(4, quad.triangles), four);
  EXPECT_EQ(quad_pairs.size(), 6u);  // five edges and the pair across the diagonal
}

TEST(Degenerate, FlatRingsAreFoundAndNoiseMovesOnlyThem) {
  OperatorOptions options;
  options.degenerate = DegenerateTreatment::ft05_noise;
  const auto sheet = test::flat_sheet(12, 12);
  const AffineOperator flat(sheet.positions, sheet.triangles, options);
  EXPECT_EQ(static_cast<Index>(flat.nodes().moved.size()), sheet.size());
  double above = 0, below = 0;
  for (Index v : flat.nodes().moved) {
    const double height = flat.nodes().positions(v, 2) - sheet.positions(v, 2);
    EXPECT_NEAR(std::abs(height), options.noise_length_rel * flat.edge_lengths()[v], 1e-12);
    (height > 0 ? above : below) += 1;
  }
  EXPECT_GT(above, 0.3 * sheet.size());  // on both sides
  EXPECT_GT(below, 0.3 * sheet.size());

  const auto ball = test::icosphere(2);
  const AffineOperator round(ball.positions, ball.triangles, options);
  EXPECT_TRUE(round.nodes().moved.empty());
}

TEST(Options, OutOfRangeAreNamed) {
  const auto mesh = test::octahedron();
  for (auto [field, change] : std::initializer_list<std::pair<const char*, void (*)(OperatorOptions&)>>{
           {"apex_height_rel", [](OperatorOptions& o) { o.apex_height_rel = 0; }},
           {"noise_length_rel", [](OperatorOptions& o) { o.noise_length_rel = -1; }},
           {"flatness", [](OperatorOptions& o) { o.flatness = std::nan(""); }},
           {"laplacian_weight", [](OperatorOptions& o) { o.laplacian_weight = 0; }},
           {"laplacian_order", [](OperatorOptions& o) { o.laplacian_order = 9; }}}) {
    OperatorOptions options;
    change(options);
    try {
      AffineOperator(mesh.positions, mesh.triangles, options);
      FAIL() << field;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input);
      EXPECT_EQ(error.id(), "core.out_of_range");
      EXPECT_EQ(error.location().text(), field);
    }
  }
}

TEST(Coupling, IsTheProductOfTheSmoothnessRows) {
  for (const auto& mesh : families())
    for (const OperatorOptions& options : all_options()) {
      const AffineOperator op(mesh.positions, mesh.triangles, options);
      const SparseRows K = op.coupling(), expected = transpose(op.P()) * op.P();
      EXPECT_LE(SparseRows(K - expected).norm(), 1e-14 * expected.norm()) << mesh.name << name_of(options);
    }
}

TEST(Coupling, IsAppliedWithoutItsMatrix) {
  for (const auto& mesh : test::small_families())
    for (const OperatorOptions& options : all_options())
      for (const int columns : {1, 3, 8}) {
        const AffineOperator op(mesh.positions, mesh.triangles, options);
        const Columns m = Columns::Random(op.H().rows(), columns), expected = op.coupling() * m;
        Columns product;
        op.couple(m, product);
        EXPECT_LE((product - expected).norm(), 1e-13 * expected.norm()) << mesh.name << name_of(options);
      }
}

TEST(NormalMatrices, AreTheProductsOfAllRows) {
  for (const auto& mesh : families())
    for (const OperatorOptions& options : all_options()) {
      const AffineOperator op(mesh.positions, mesh.triangles, options);
      const SparseRows laplacian = op.L() - multiply(op.delta(), op.H()), A = op.A();
      const NormalMatrix lower = normal_equations({.A = laplacian,
                                                   .A_transposed = transpose(laplacian),
                                                   .G = op.H(),
                                                   .G_transposed = transpose(op.H()),
                                                   .K = op.coupling()});
      const Eigen::SparseMatrix<double> product = A.transpose() * A;
      const NormalMatrix expected = product.triangularView<Eigen::Lower>();
      // A row of E_L is a difference that may cancel, so that rounding is relative to its terms.
      EXPECT_LE(NormalMatrix(lower - expected).norm(), 1e-13 * (expected.norm() + op.L().squaredNorm()))
          << mesh.name << name_of(options);
    }
}

}  // namespace
}  // namespace meshgraft
