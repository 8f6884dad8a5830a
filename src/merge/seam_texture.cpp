#include "seam_texture.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace meshgraft {

namespace {

using Uv = Eigen::RowVector2d;

bool is_texture(const Attribute& attribute) {
  return attribute.domain == Domain::corner && attribute.components == 2 &&
         attribute.interpolation == Interpolation::linear && attribute.name.starts_with("uv");
}

/// The texture coordinates of one attribute.
class Texture {
 public:
  Texture(const Mesh& mesh, Attribute& attribute) : mesh_(mesh), values_(attribute.values) {}

  Uv at(Index corner) const { return {values_[2 * corner], values_[2 * corner + 1]}; }
  void set(Index corner, const Uv& uv) {
    std::copy_n(uv.data(), 2, values_.begin() + 2 * std::ptrdiff_t{corner});
  }

  /// Returns the corner of a face at a vertex, or -1.
  Index corner_of(Index face, Index vertex) const {
    for (Index c = mesh_.faces.first_corner(face); c < mesh_.faces.first_corner(face + 1); ++c)
      if (mesh_.faces.corners()[c] == vertex) return c;
    return -1;
  }

  /// Extrapolates the map of a face from the corner at one of its vertices, which is affine there.
  Uv extrapolated(Index face, Index vertex, const Eigen::RowVector3d& point) const {
    const Index first = mesh_.faces.first_corner(face), count = mesh_.faces.first_corner(face + 1) - first;
    const Index here = corner_of(face, vertex), next = first + (here - first + 1) % count,
                before = first + (here - first + count - 1) % count;
    const auto position = [&](Index c) { return mesh_.positions.row(mesh_.faces.corners()[c]); };
    Eigen::Matrix<double, 3, 2> edges;
    edges << (position(next) - position(here)).transpose(), (position(before) - position(here)).transpose();
    const Eigen::Matrix2d gram = edges.transpose() * edges;
    const double area = gram.determinant();
    if (!(area > 1e-20 * gram(0, 0) * gram(1, 1))) return at(here);  // a face without area
    const Eigen::Vector2d along = gram.inverse() * (edges.transpose() * (point - position(here)).transpose());
    return at(here) + along[0] * (at(next) - at(here)) + along[1] * (at(before) - at(here));
  }

 private:
  const Mesh& mesh_;
  std::vector<double>& values_;
};

/// Numbers the charts of a strip: triangles that share an edge across the gap are of one chart where their
/// neighbours have the same coordinates at its end on the target.
std::vector<std::size_t> charts_of_strip(const Mesh& mesh, const Texture& texture, Index first_new,
                                         std::span<const Index> neighbour) {
  std::vector<std::size_t> chart(neighbour.size());
  std::iota(chart.begin(), chart.end(), std::size_t{0});
  const auto root = [&](std::size_t t) {
    while (chart[t] != t) t = chart[t] = chart[chart[t]];
    return t;
  };
  std::map<std::pair<Index, Index>, std::size_t> first_at;  // triangle at each edge
  for (std::size_t t = 0; t < neighbour.size(); ++t) {
    const auto face = mesh.faces[first_new + static_cast<Index>(t)];
    for (int k = 0; k < 3; ++k) {
      const auto [one, other] = std::minmax(face[k], face[(k + 1) % 3]);  // the target's vertices come first
      const auto [entry, is_new] = first_at.emplace(std::pair(one, other), t);
      if (is_new) continue;
      const Index here = texture.corner_of(neighbour[t], one),
                  there = texture.corner_of(neighbour[entry->second], one);
      if (here >= 0 && there >= 0 && texture.at(here) == texture.at(there))
        chart[root(t)] = root(entry->second);
    }
  }
  for (std::size_t t = 0; t < chart.size(); ++t) chart[t] = root(t);
  return chart;
}

}  // namespace

void continue_texture(Mesh& mesh, Index first_new, std::span<const Index> neighbour) {
  for (Attribute& attribute : mesh.attributes) {
    if (!is_texture(attribute)) continue;
    Texture texture(mesh, attribute);
    const std::vector<std::size_t> chart = charts_of_strip(mesh, texture, first_new, neighbour);
    struct Mean {
      Uv sum = Uv::Zero();
      int count = 0;
    };
    std::map<std::pair<Index, std::size_t>, Mean> of_source;  // by vertex and chart
    std::vector<std::pair<Index, std::pair<Index, std::size_t>>> open;
    for (std::size_t t = 0; t < neighbour.size(); ++t) {
      const Index face = first_new + static_cast<Index>(t);
      const auto vertices = mesh.faces[face];
      const auto on_both =
          std::ranges::find_if(vertices, [&](Index v) { return texture.corner_of(neighbour[t], v) >= 0; });
      for (int k = 0; k < 3; ++k) {
        const Index corner = mesh.faces.first_corner(face) + k, v = vertices[k];
        if (const Index there = texture.corner_of(neighbour[t], v); there >= 0) {
          texture.set(corner, texture.at(there));
          continue;
        }
        Mean& mean = of_source[{v, chart[t]}];
        mean.sum += texture.extrapolated(neighbour[t], *on_both, mesh.positions.row(v));
        ++mean.count;
        open.push_back({corner, {v, chart[t]}});
      }
    }
    for (const auto& [corner, key] : open) {
      const Mean& mean = of_source.at(key);
      texture.set(corner, mean.sum / mean.count);
    }
  }
}

}  // namespace meshgraft
