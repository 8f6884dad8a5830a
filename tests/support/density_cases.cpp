#include "support/density_cases.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace meshgraft::test {
namespace {

using Eigen::Vector3d;

constexpr double stretch_rel = 0.3;
constexpr double degree = std::numbers::pi / 180;

Eigen::Affine3d edit_map(const RowMesh& rows, RowEdit edit, const RowTurns& turns) {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  const Vector3d middle(0, 0, rows.length / 2);
  switch (edit) {
    case RowEdit::stretch: map.translate(stretch_rel * rows.length * Vector3d::UnitZ()); break;
    case RowEdit::bend:
      map = Eigen::Translation3d(middle) * Eigen::AngleAxisd(turns.bend_deg * degree, Vector3d::UnitX()) *
            Eigen::Translation3d(-middle);
      break;
    case RowEdit::twist: map.rotate(Eigen::AngleAxisd(turns.twist_deg * degree, Vector3d::UnitZ())); break;
  }
  return map;
}

double interpolate(const RowMesh& rows, const std::vector<double>& profile, double u) {
  std::size_t k = 1;
  while (k + 1 < rows.rows.size() && rows.rows[k].u < u) ++k;
  const double a = rows.rows[k - 1].u, b = rows.rows[k].u, t = (u - a) / (b - a);
  return (1 - t) * profile[k - 1] + t * profile[k];
}

}  // namespace

const char* to_string(RowEdit edit) {
  switch (edit) {
    case RowEdit::stretch: return "stretch";
    case RowEdit::bend: return "bend";
    case RowEdit::twist: return "twist";
  }
  return "";
}

std::vector<VertexConstraint> row_constraints(const RowMesh& rows, RowEdit edit, const RowTurns& turns) {
  const Eigen::Affine3d map = edit_map(rows, edit, turns);
  const double tenth = rows.length / 10, slack = 1e-9 * rows.length;
  std::vector<VertexConstraint> constraints;
  for (const Row& row : rows.rows) {
    const bool foot = row.u <= tenth + slack, head = row.u >= rows.length - tenth - slack;
    if (!foot && !head) continue;
    for (Index v = row.first; v < row.first + row.vertices; ++v) {
      const Vector3d p = rows.mesh.positions.row(v);
      if (foot)
        constraints.push_back({v, p, Eigen::Matrix3d::Identity()});
      else
        constraints.push_back({v, map * p, map.linear()});
    }
  }
  return constraints;
}

std::vector<double> row_profile(const RowMesh& rows, RowEdit edit, const Points& edited) {
  std::vector<double> profile;
  for (const Row& row : rows.rows) {
    const Points before = rows.mesh.positions.middleRows(row.first, row.vertices),
                 after = edited.middleRows(row.first, row.vertices);
    const Eigen::RowVector3d shift = (after - before).colwise().mean();
    if (edit == RowEdit::stretch) profile.push_back(shift.z() / rows.length);
    if (edit == RowEdit::bend) profile.push_back(shift.y() / rows.length);
    if (edit == RowEdit::twist) {
      const double sine =
          (before.col(0).cwiseProduct(after.col(1)) - before.col(1).cwiseProduct(after.col(0))).sum();
      const double cosine = (before.leftCols(2).cwiseProduct(after.leftCols(2))).sum();
      profile.push_back(std::atan2(sine, cosine));
    }
  }
  return profile;
}

namespace {

constexpr RowEdit edits[] = {RowEdit::stretch, RowEdit::bend, RowEdit::twist};

struct Profiled {
  RowMesh rows;
  std::vector<std::vector<double>> profiles;  // one per entry of `edits`
};

Profiled profile_of(RowMesh rows, const SolveRows& solve, const RowTurns& turns) {
  std::vector<std::vector<VertexConstraint>> constraints;
  for (const RowEdit edit : edits) constraints.push_back(row_constraints(rows, edit, turns));
  const std::vector<Points> edited = solve(rows.mesh, constraints);
  Profiled result{std::move(rows), {}};
  for (std::size_t e = 0; e < std::size(edits); ++e)
    result.profiles.push_back(row_profile(result.rows, edits[e], edited[e]));
  return result;
}

DensityDeviation compare(const Profiled& tested, const Profiled& even, std::size_t e) {
  const auto &profile = tested.profiles[e], &expected = even.profiles[e];
  const auto [least, most] = std::minmax_element(expected.begin(), expected.end());
  DensityDeviation result;
  for (std::size_t k = 0; k < profile.size(); ++k) {
    const double difference = profile[k] - interpolate(even.rows, expected, tested.rows.rows[k].u);
    result.deviation = std::max(result.deviation, std::abs(difference) / (*most - *least));
  }
  result.edit = edits[e];
  return result;
}

}  // namespace

std::vector<DensityDeviation> density_deviations(const SolveRows& solve, std::span<const RowShape> shapes,
                                                 const RowTurns& turns) {
  constexpr int coarse = 20;
  struct Case {
    int cells_along, ratio;
  };
  constexpr Case cases[] = {{coarse, 2}, {coarse, 4}, {coarse, 1}, {3 * coarse / 2, 1}, {3 * coarse, 1}};
  std::vector<DensityDeviation> result;
  for (const RowShape shape : shapes) {
    const Profiled even = profile_of(graded_rows(shape, 2 * coarse, 1), solve, turns);
    for (const auto& [cells_along, ratio] : cases) {
      const Profiled tested = profile_of(graded_rows(shape, cells_along, ratio), solve, turns);
      for (std::size_t e = 0; e < std::size(edits); ++e) {
        DensityDeviation entry = compare(tested, even, e);
        entry.shape = shape;
        entry.cells_along = cells_along;
        entry.ratio = ratio;
        result.push_back(entry);
      }
    }
  }
  return result;
}

}  // namespace meshgraft::test
