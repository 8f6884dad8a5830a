#include "deform/reduced/response_columns.h"

#include <numeric>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "linalg/sparse.h"
#include "mesh/shapes.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

/// A response with rows at some vertices, the same numbers as a dense matrix, and coefficients.
struct ResponseCase {
  std::vector<Index> vertices;
  Columns dense, coefficients;
  Points base;

  ResponseCase(Index vertex_count, Index step, Eigen::Index columns) {
    std::mt19937 random(static_cast<unsigned>(17 + vertex_count));
    const auto number = [&] { return static_cast<double>(random()) / 2147483648.0 - 1.0; };
    for (Index v = step > 1 ? 1 : 0; v < vertex_count; v += step) vertices.push_back(v);
    dense = Columns::NullaryExpr(static_cast<Eigen::Index>(vertices.size()), columns, number);
    coefficients = Columns::NullaryExpr(columns, 3, number);
    base = Points::NullaryExpr(vertex_count, 3, number);
  }
  ResponseColumns columns(const Context& context = {}) const {
    ResponseColumns response(vertices, static_cast<std::size_t>(dense.cols()));
    std::vector<std::size_t> all(static_cast<std::size_t>(dense.cols()));
    std::iota(all.begin(), all.end(), std::size_t{0});
    response.set(all, dense, context);
    return response;
  }
};

std::vector<ResponseCase> response_cases() {
  std::vector<ResponseCase> cases;
  for (const Index count : {1, 7, 8, 9, 65, 5000})
    for (const Index step : {1, 3})
      for (const Eigen::Index columns : {1, 4, 31, 33, 100})
        if (count < 100 || columns < 32) cases.emplace_back(count, step, columns);
  return cases;
}

TEST(ResponseColumns, PlaceIsTheProductOfMatrixAndCoefficients) {
  constexpr double scale = 2.5;
  for (const ResponseCase& test : response_cases()) {
    Points positions;
    positions.resize(test.base.rows(), 3);
    test.columns().place(test.coefficients, scale, test.base, positions, {});
    Points expected = test.base;
    const Columns moves = test.dense * test.coefficients;
    for (std::size_t k = 0; k < test.vertices.size(); ++k)
      expected.row(test.vertices[k]) += scale * moves.row(static_cast<Eigen::Index>(k));
    const double bound = 1e-6 * static_cast<double>(test.dense.cols()) * scale;  // single precision
    EXPECT_LT((positions - expected).cwiseAbs().maxCoeff(), bound);
  }
}

TEST(ResponseColumns, VerticesWithoutARowKeepTheirBits) {
  for (const ResponseCase& test : response_cases()) {
    Points positions = Points::Constant(test.base.rows(), 3, 77);
    test.columns().place(test.coefficients, 1, test.base, positions, {});
    Flags moves(static_cast<std::size_t>(test.base.rows()), 0);
    for (const Index v : test.vertices) moves[v] = 1;
    for (Index v = 0; v < static_cast<Index>(test.base.rows()); ++v)
      if (!moves[v]) {
        EXPECT_EQ(positions.row(v), test.base.row(v));
      }
    test.columns().place(Columns::Zero(test.coefficients.rows(), 3), 1, test.base, positions, {});
    EXPECT_TRUE(test::same_bytes(positions, test.base));
  }
}

TEST(ResponseColumns, MayBeSetInAnyOrder) {
  for (const ResponseCase& test : response_cases()) {
    const auto count = static_cast<std::size_t>(test.dense.cols());
    ResponseColumns strided(test.vertices, count);
    const std::size_t stride = 3;
    for (std::size_t first = 0; first < std::min(stride, count); ++first) {
      std::vector<std::size_t> chosen;
      for (std::size_t c = first; c < count; c += stride) chosen.push_back(c);
      strided.set(chosen, test.dense(Eigen::all, chosen), {});
    }
    Points one = test.base, other = test.base;
    strided.place(test.coefficients, 1, test.base, one, {});
    test.columns().place(test.coefficients, 1, test.base, other, {});
    EXPECT_TRUE(test::same_bytes(one, other));
  }
}

TEST(ResponseColumns, TheNumberOfThreadsDoesNotMatter) {
  for (const ResponseCase& test : response_cases()) {
    Points one(test.base.rows(), 3);
    test.columns(shapes::with_threads(1))
        .place(test.coefficients, 0.3, test.base, one, shapes::with_threads(1));
    for (const int threads : {2, 3}) {
      Points other(test.base.rows(), 3);
      const Context context = shapes::with_threads(threads);
      test.columns(context).place(test.coefficients, 0.3, test.base, other, context);
      EXPECT_TRUE(test::same_bytes(one, other));
    }
  }
}

TEST(ResponseColumns, WithoutRowsCopyTheBase) {
  const Points base = Points::Constant(5, 3, 1.5);
  Points positions(5, 3);
  ResponseColumns({}, 2).place(Columns::Ones(2, 3), 1, base, positions, {});
  EXPECT_TRUE(test::same_bytes(positions, base));
}

}  // namespace
}  // namespace meshgraft
