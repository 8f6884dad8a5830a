#include "fill_attributes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include "core/parallel.h"
#include "mesh/area_vector.h"
#include "mesh/interpolate_attribute.h"

namespace meshgraft {

namespace {

using Sparse = Eigen::SparseMatrix<double>;

// The new faces, with separate numbers for the vertices inside and around them.
struct Fills {
  std::vector<Index> corners;  // first corner of each new triangle
  std::vector<Index> inner, around;
  std::vector<Index> row;         // per vertex of the mesh: index in `inner`, or -1
  std::vector<Index> around_row;  // per vertex of the mesh: index in `around`, or -1

  Fills(const Mesh& mesh, std::span<const std::uint8_t> is_new)
      : row(mesh.vertex_count(), -1), around_row(row) {
    Flags has_old_face(row.size(), 0);
    for (Index f = 0; f < mesh.face_count(); ++f)
      if (!is_new[f])
        for (const Index v : mesh.faces[f]) has_old_face[v] = 1;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      if (!is_new[f] || mesh.faces[f].size() != 3) continue;
      corners.push_back(mesh.faces.first_corner(f));
      for (const Index v : mesh.faces[f]) {
        const bool outer = has_old_face[v];
        Index& number = (outer ? around_row : row)[v];
        if (number >= 0) continue;
        number = static_cast<Index>((outer ? around : inner).size());
        (outer ? around : inner).push_back(v);
      }
    }
  }
};

// Solves the Laplace equation in the fills for many columns.
class HarmonicFills {
 public:
  HarmonicFills(const Mesh& mesh, const Fills& fills, const Context& context)
      : to_around_(static_cast<Eigen::Index>(fills.inner.size()),
                   static_cast<Eigen::Index>(fills.around.size())) {
    std::vector<Eigen::Triplet<double>> own, across;
    const auto point = [&](Index v) -> Eigen::Vector3d { return mesh.positions.row(v).transpose(); };
    for (const Index first : fills.corners)
      for (Index k = 0; k < 3; ++k) {
        const Index a = mesh.faces.corners()[first + k], b = mesh.faces.corners()[first + (k + 1) % 3];
        const double weight =
            clamped_cotangent(point(mesh.faces.corners()[first + (k + 2) % 3]), point(a), point(b));
        for (const auto& [v, w] : {std::pair{a, b}, std::pair{b, a}}) {
          const Index row = fills.row[v];
          if (row < 0) continue;
          own.emplace_back(row, row, weight);
          if (const Index other = fills.row[w]; other >= 0)
            own.emplace_back(row, other, -weight);
          else
            across.emplace_back(row, fills.around_row[w], weight);
        }
      }
    to_around_.setFromTriplets(across.begin(), across.end());
    auto matrix = std::make_shared<Sparse>(to_around_.rows(), to_around_.rows());
    matrix->setFromTriplets(own.begin(), own.end());
    solver_ = std::make_shared<Eigen::SimplicialLDLT<Sparse>>();
    run_abandonable([matrix, solver = solver_] { solver->compute(*matrix); }, context);
  }

  bool solvable() const { return solver_->info() == Eigen::Success; }
  Eigen::MatrixXd solve(const Eigen::MatrixXd& around) const { return solver_->solve(to_around_ * around); }

 private:
  Sparse to_around_;
  std::shared_ptr<Eigen::SimplicialLDLT<Sparse>> solver_;
};

void write_value(Attribute& attribute, Index element, Eigen::VectorXd value) {
  if (attribute.interpolation == Interpolation::direction && value.allFinite()) {
    if (!(value.stableNorm() > 0)) return;
    value.stableNormalize();
  }
  for (Eigen::Index k = 0; k < value.size(); ++k)
    attribute.values[element * value.size() + k] = representable(value[k], attribute.type);
}

}  // namespace

void interpolate_in_fills(Mesh& mesh, std::span<const std::uint8_t> is_new, const Context& context) {
  const auto is_smooth = [](const Attribute& attribute) {
    return attribute.interpolation != Interpolation::nearest &&
           (attribute.domain == Domain::vertex || attribute.domain == Domain::corner);
  };
  if (std::none_of(mesh.attributes.begin(), mesh.attributes.end(), is_smooth)) return;
  const Fills fills(mesh, is_new);
  if (fills.inner.empty()) return;
  const HarmonicFills harmonic(mesh, fills, context);
  if (!harmonic.solvable()) return;
  const std::vector<Index>& corners = mesh.faces.corners();
  for (Attribute& attribute : mesh.attributes) {
    if (!is_smooth(attribute)) continue;
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> values(
        attribute.values.data(), static_cast<Eigen::Index>(attribute.values.size()) / attribute.components,
        attribute.components);
    Eigen::MatrixXd around(static_cast<Eigen::Index>(fills.around.size()), attribute.components);
    if (attribute.domain == Domain::vertex)
      for (std::size_t k = 0; k < fills.around.size(); ++k)
        around.row(static_cast<Eigen::Index>(k)) = values.row(fills.around[k]);
    const auto for_each_corner = [&](const auto& body) {
      for (const Index first : fills.corners)
        for (Index c = first; c < first + 3; ++c) body(c, corners[c]);
    };
    if (attribute.domain == Domain::corner)
      for_each_corner([&](Index c, std::size_t v) {
        if (fills.around_row[v] >= 0) around.row(fills.around_row[v]) = values.row(c);
      });
    const Eigen::MatrixXd found = harmonic.solve(around);
    if (attribute.domain == Domain::vertex)
      for (std::size_t k = 0; k < fills.inner.size(); ++k)
        write_value(attribute, fills.inner[k], found.row(static_cast<Eigen::Index>(k)).transpose());
    else
      for_each_corner([&](Index c, std::size_t v) {
        if (fills.row[v] >= 0) write_value(attribute, c, found.row(fills.row[v]).transpose());
      });
  }
}

}  // namespace meshgraft
