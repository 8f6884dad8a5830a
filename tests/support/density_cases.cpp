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

const char* to_string(Diagonals diagonals) {
  switch (diagonals) {
    case Diagonals::alternate: return "alternate";
    case Diagonals::rising: return "rising";
    case Diagonals::falling: return "falling";
    case Diagonals::shifted: return "shifted";
  }
  return "";
}

namespace {

constexpr double long_rows_length = 3, long_rows_width = 2.4;

/// Rows of points without faces: rings around a tube, or lines across a sheet.
struct OpenRows {
  RowMesh rows;
  std::vector<Vector3d> points;
  std::vector<std::array<Index, 3>> faces;

  OpenRows() { rows.length = long_rows_length; }
  void add_row(double u, std::span<const Vector3d> row_points) {
    const auto count = static_cast<Index>(row_points.size());
    rows.rows.push_back({u, count, static_cast<Index>(points.size()), count});
    points.insert(points.end(), row_points.begin(), row_points.end());
  }
  Index at(int row, int i) const { return rows.rows[row].first + i % rows.rows[row].vertices; }
  void add_quad(Index a, Index b, Index c, Index d, bool rising) {
    if (rising)
      faces.insert(faces.end(), {{a, b, c}, {a, c, d}});
    else
      faces.insert(faces.end(), {{a, b, d}, {b, c, d}});
  }
  RowMesh finish() {
    rows.mesh.positions.resize(static_cast<Eigen::Index>(points.size()), 3);
    for (std::size_t v = 0; v < points.size(); ++v)
      rows.mesh.positions.row(static_cast<Eigen::Index>(v)) = points[v].transpose();
    rows.mesh.triangles.resize(static_cast<Eigen::Index>(faces.size()), 3);
    for (std::size_t t = 0; t < faces.size(); ++t)
      rows.mesh.triangles.row(static_cast<Eigen::Index>(t)) << faces[t][0], faces[t][1], faces[t][2];
    return std::move(rows);
  }
};

}  // namespace

RowMesh tube_of_long_cells(int around, const std::array<int, 2>& halves, Diagonals diagonals) {
  OpenRows tube;
  const double radius = long_rows_width / (2 * std::numbers::pi), half = long_rows_length / 2;
  const int cell_rows = halves[0] + halves[1];
  for (int k = 0; k <= cell_rows; ++k) {
    const double u = half * (k <= halves[0] ? double(k) / halves[0] : 1 + double(k - halves[0]) / halves[1]);
    std::vector<Vector3d> ring;
    for (int i = 0; i < around; ++i) {
      const double angle =
          2 * std::numbers::pi * (i + (diagonals == Diagonals::shifted && k % 2 == 1 ? 0.5 : 0)) / around;
      ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle), u);
    }
    tube.add_row(u, ring);
  }
  for (int k = 0; k < cell_rows; ++k)
    for (int i = 0; i < around; ++i)
      tube.add_quad(tube.at(k, i), tube.at(k, i + 1), tube.at(k + 1, i + 1), tube.at(k + 1, i),
                    diagonals == Diagonals::rising || (diagonals == Diagonals::alternate && (k + i) % 2 == 1) ||
                        (diagonals == Diagonals::shifted && k % 2 == 1));
  return tube.finish();
}

RowMesh sheet_of_odd_cells(OddCells odd) {
  constexpr int cells = 24, cell_rows = 30, fan = 8;
  OpenRows sheet;
  const auto is_coarse = [&](int k) {
    return odd == OddCells::fans && k > cell_rows / 2 && k < cell_rows && k % 2 == 1;
  };
  const double size = long_rows_length / cell_rows;
  for (int k = 0; k <= cell_rows; ++k) {
    const int count = is_coarse(k) ? cells / fan : cells;
    std::vector<Vector3d> line;
    for (int i = 0; i <= count; ++i) {
      const bool shifted = odd == OddCells::slivers && k > cell_rows / 2 && k < cell_rows && i > 0 && i < count;
      line.emplace_back((double(i) / count - 0.5) * long_rows_width, 0,
                        size * (k + (shifted ? ((i + k) % 2 == 0 ? 0.45 : -0.45) : 0)));
    }
    sheet.add_row(size * k, line);
  }
  for (int k = 0; k < cell_rows; ++k) {
    const bool low = is_coarse(k), high = is_coarse(k + 1);
    if (!low && !high) {
      for (int i = 0; i < cells; ++i)
        sheet.add_quad(sheet.at(k, i), sheet.at(k, i + 1), sheet.at(k + 1, i + 1), sheet.at(k + 1, i),
                       (k + i) % 2 == 1);
      continue;
    }
    // Each fine edge gets a triangle to the coarse vertex nearest to it, each coarse edge one to the fine
    // vertex in the middle.
    const int coarse = low ? k : k + 1, fine = low ? k + 1 : k;
    const auto add = [&](Index a, Index b, Index c) {
      sheet.faces.push_back(low ? std::array{a, b, c} : std::array{b, a, c});
    };
    for (int i = 0; i < cells; ++i)
      add(sheet.at(fine, i + 1), sheet.at(fine, i), sheet.at(coarse, (i + fan / 2) / fan));
    for (int j = 0; j < cells / fan; ++j)
      add(sheet.at(coarse, j), sheet.at(coarse, j + 1), sheet.at(fine, j * fan + fan / 2));
  }
  return sheet.finish();
}

double fraction_at_half(const RowMesh& rows, const std::vector<double>& profile) {
  return (interpolate(rows, profile, rows.length / 2) - profile.front()) / (profile.back() - profile.front());
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

std::vector<DensityDeviation> odd_cell_deviations(const SolveRows& solve, OddCells odd, const RowTurns& turns) {
  const Profiled even = profile_of(sheet_of_odd_cells(OddCells::none), solve, turns),
                 tested = profile_of(sheet_of_odd_cells(odd), solve, turns);
  std::vector<DensityDeviation> result;
  for (std::size_t e = 0; e < std::size(edits); ++e) result.push_back(compare(tested, even, e));
  return result;
}

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
