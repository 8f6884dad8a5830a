#include "deform/solve/anderson_mixing.h"

#include <random>

#include <gtest/gtest.h>
#include <Eigen/Core>

namespace meshgraft {
namespace {

double dot(const Columns& a, const Columns& b) { return a.cwiseProduct(b).sum(); }

/// Returns the residuals' norms of `steps` iterates of x ← x + f(x), from x = 0, with three columns.
template <class Residual>
std::vector<double> mixed_residuals(Eigen::Index rows, int steps, const Residual& residual) {
  AndersonMixing mixing(dot);
  Columns x = Columns::Zero(rows, 3);
  std::vector<double> norms;
  for (int k = 0; k < steps; ++k) {
    const Columns step = residual(x);
    norms.push_back(step.norm());
    x = mixing.next(x, step);
  }
  norms.push_back(residual(x).norm());
  return norms;
}

Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index columns, std::mt19937& random) {
  return Eigen::MatrixXd::NullaryExpr(rows, columns,
                                      [&] { return static_cast<double>(random()) / 2147483648.0 - 1.0; });
}

TEST(AndersonMixing, BeginsWithAPlainStep) {
  std::mt19937 random(1);
  const Columns x = random_matrix(6, 3, random), step = random_matrix(6, 3, random);
  AndersonMixing mixing(dot);
  EXPECT_EQ(mixing.next(x, step), x + step);
}

TEST(AndersonMixing, SolvesALinearProblemInOneStepPerEigenvalue) {
  // On linear problems the iterates are those of GMRES (Walker and Ni 2011, theorem 2.2), so that k different
  // eigenvalues take k + 1 steps, also where the plain iteration diverges. Smaller ones meet the bound of the
  // extrapolation.
  std::mt19937 random(2);
  for (const std::vector<double>& values :
       {std::vector{0.6}, {1.9}, {4.0}, {0.3, 1.5}, {0.2, 0.9, 3.0}, {0.5, 0.8, 1.2, 1.9}}) {
    Eigen::VectorXd diagonal(12);
    for (Eigen::Index k = 0; k < 12; ++k) diagonal[k] = values[static_cast<std::size_t>(k) % values.size()];
    const Columns b = random_matrix(12, 3, random);
    const auto norms = mixed_residuals(12, static_cast<int>(values.size()) + 1, [&](const Columns& x) {
      return Columns(b - diagonal.asDiagonal() * x);
    });
    EXPECT_LT(norms.back(), 1e-5 * norms.front())
        << values.size() << " eigenvalues, the last " << values.back();
  }
}

TEST(AndersonMixing, ConvergesWhereThePlainStepsSwingAndGrow) {
  const auto residual = [](const Columns& x) {
    return Columns((1.0 - 2.6 * x.array() - 0.3 * x.array().sin()).matrix());
  };
  Columns plain = Columns::Zero(2, 3);
  for (int k = 0; k < 12; ++k) plain += residual(plain);
  EXPECT_GT(residual(plain).norm(), residual(Columns::Zero(2, 3)).norm());
  EXPECT_LT(mixed_residuals(2, 12, residual).back(), 1e-8);
}

TEST(AndersonMixing, NeedsFewerStepsWhereThePlainOnesCreep) {
  std::mt19937 random(3);
  Eigen::VectorXd pace(40);
  for (Eigen::Index k = 0; k < 40; ++k) pace[k] = 0.05 + 0.9 * static_cast<double>(k) / 39;
  const Columns b = random_matrix(40, 3, random);
  const auto residual = [&](const Columns& x) {
    const Columns bent = x.array() + 0.1 * x.array().cube() / (1 + x.array().square());
    return Columns(b - pace.asDiagonal() * bent);
  };
  Columns plain = Columns::Zero(40, 3);
  for (int k = 0; k < 20; ++k) plain += residual(plain);
  EXPECT_LT(mixed_residuals(40, 20, residual).back(), 0.02 * residual(plain).norm());
}

TEST(AndersonMixing, StaysAtAFixedPoint) {
  AndersonMixing mixing(dot);
  const Columns x = Columns::Constant(4, 3, 2.0), none = Columns::Zero(4, 3);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(mixing.next(x, none), x);
}

}  // namespace
}  // namespace meshgraft
