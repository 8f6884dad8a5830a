#include "isosurface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include <Eigen/Geometry>

#include "core/parallel.h"

namespace meshgraft::samples {

Surface::Surface(std::vector<Vec3> points_in, std::vector<std::array<int, 3>> triangles_in)
    : points(std::move(points_in)), triangles(std::move(triangles_in)) {
  outgoing.assign(points.size(), -1);
  on_cut.assign(points.size(), 0);
  twin.assign(3 * triangles.size(), -1);
  // Groups half-edges by their smaller vertex; within a small group, a linear search finds the partners.
  std::vector<int> offsets(points.size() + 1, 0);
  const int half_edges = static_cast<int>(twin.size());
  for (int h = 0; h < half_edges; ++h) ++offsets[std::min(from(h), to(h)) + 1];
  for (std::size_t v = 0; v < points.size(); ++v) offsets[v + 1] += offsets[v];
  std::vector<int> grouped(twin.size()), cursor(offsets.begin(), offsets.end() - 1);
  for (int h = 0; h < half_edges; ++h) {
    grouped[cursor[std::min(from(h), to(h))]++] = h;
    outgoing[from(h)] = h;
  }
  for (std::size_t v = 0; v < points.size(); ++v)
    for (int i = offsets[v]; i < offsets[v + 1]; ++i)
      for (int j = i + 1; j < offsets[v + 1]; ++j) {
        const int g = grouped[i], h = grouped[j];
        if (twin[g] < 0 && from(g) == to(h) && to(g) == from(h)) link(g, h);
      }
}

void Surface::link(int g, int h) {
  twin[g] = h;
  twin[h] = g;
}

int Surface::valence(int vertex) const {
  int count = 0;
  for_each_outgoing(vertex, [&](int) { ++count; });
  return count;
}

bool Surface::adjacent(int a, int b) const {
  bool found = false;
  for_each_outgoing(a, [&](int h) { found = found || to(h) == b; });
  return found;
}

void Surface::flip(int h) {
  const int g = twin[h];
  const int t = h / 3, u = g / 3;
  const int a = from(h), b = to(h), c = from(previous(h)), d = from(previous(g));
  const int bc = twin[next(h)], ca = twin[previous(h)];
  const int ad = twin[next(g)], db = twin[previous(g)];
  triangles[t] = {a, d, c};
  triangles[u] = {b, c, d};
  link(3 * t, ad);
  link(3 * t + 1, 3 * u + 1);
  link(3 * t + 2, ca);
  link(3 * u, bc);
  link(3 * u + 2, db);
  outgoing[a] = 3 * t;
  outgoing[d] = 3 * t + 1;
  outgoing[b] = 3 * u;
  outgoing[c] = 3 * u + 1;
}

int Surface::split(int h, const Vec3& point) {
  const int g = twin[h];
  const int t = h / 3, u = g / 3;
  const int a = from(h), b = to(h), c = from(previous(h)), d = from(previous(g));
  const int bc = twin[next(h)], ca = twin[previous(h)];
  const int ad = twin[next(g)], db = twin[previous(g)];
  const int m = static_cast<int>(points.size());
  const int t2 = static_cast<int>(triangles.size()), u2 = t2 + 1;
  points.push_back(point);
  outgoing.push_back(-1);
  on_cut.push_back(0);
  triangles.resize(triangles.size() + 2);
  twin.resize(twin.size() + 6);
  triangles[t] = {a, m, c};
  triangles[t2] = {m, b, c};
  triangles[u] = {b, m, d};
  triangles[u2] = {m, a, d};
  link(3 * t, 3 * u2);
  link(3 * t + 1, 3 * t2 + 2);
  link(3 * t + 2, ca);
  link(3 * t2, 3 * u);
  link(3 * t2 + 1, bc);
  link(3 * u + 1, 3 * u2 + 2);
  link(3 * u + 2, db);
  link(3 * u2 + 1, ad);
  outgoing[a] = 3 * t;
  outgoing[b] = 3 * u;
  outgoing[m] = 3 * t2;
  outgoing[c] = 3 * t + 2;
  outgoing[d] = 3 * u + 2;
  return m;
}

bool Surface::may_collapse(int h) const {
  const int a = from(h), b = to(h);
  const int c = from(previous(h)), d = from(previous(twin[h]));
  // A collapse must leave each triangle its neighbours: tetrahedra and valence-3 vertices cannot shrink.
  if (valence(c) <= 3 || valence(d) <= 3 || valence(a) + valence(b) < 8) return false;
  int common = 0;
  for_each_outgoing(a, [&](int g) {
    const int v = to(g);
    if (v != b && adjacent(v, b)) ++common;
  });
  return common == 2;
}

void Surface::collapse(int h) {
  const int g = twin[h];
  const int a = from(h), b = to(h), c = from(previous(h)), d = from(previous(g));
  std::vector<int> star;
  for_each_outgoing(a, [&](int k) { star.push_back(k); });
  for (const int k : star) triangles[k / 3][k % 3] = b;
  const int bc = twin[next(h)], ca = twin[previous(h)];
  const int ad = twin[next(g)], db = twin[previous(g)];
  triangles[h / 3] = {-1, -1, -1};
  triangles[g / 3] = {-1, -1, -1};
  link(bc, ca);
  link(ad, db);
  outgoing[a] = -1;
  // ca left a and now leaves b; bc leaves c, and ad leaves d.
  outgoing[b] = ca;
  outgoing[c] = bc;
  outgoing[d] = ad;
}

namespace {

// A triangle with its corners on lattice edges; the keys identify them.
struct CutTriangle {
  std::uint64_t key[3];
  Vec3 point[3];
};

// Cuts the tetrahedra of the lattice. Corners of cells have even coordinates (in half cells), centres have
// odd ones. Each tetrahedron joins two neighbouring centres with an edge of the face between them.
class LatticeBlock {
 public:
  LatticeBlock(const SparseField& field, const SparseField::Block& block)
      : field_(field), base_(2 * SparseField::block_cells * block.position) {
    evaluate(block, 0);
    // Every centre has a corner within half a cell along each axis.
    const double across = std::sqrt(0.75) * field.cell();
    const auto corners = std::span(values_).first(points);
    meets_surface_ = std::ranges::any_of(
        corners, [&](double d) { return (d < 0) != (corners[0] < 0) || !field.is_clear(d, across); });
    if (meets_surface_) evaluate(block, 1);
  }

  void cut(std::vector<CutTriangle>& out) const {
    if (!meets_surface_) return;
    for (int z = 0; z < SparseField::block_cells; ++z)
      for (int y = 0; y < SparseField::block_cells; ++y)
        for (int x = 0; x < SparseField::block_cells; ++x)
          for (int axis = 0; axis < 3; ++axis) {
            const Eigen::Vector3i centre = 2 * Eigen::Vector3i(x, y, z) + Eigen::Vector3i::Ones();
            Eigen::Vector3i other = centre;
            other[axis] += 2;
            static constexpr int around[5][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}};
            for (int m = 0; m < 4; ++m) {
              Eigen::Vector3i p = centre, q = centre;
              p[axis] += 1;
              q[axis] += 1;
              p[(axis + 1) % 3] += around[m][0];
              p[(axis + 2) % 3] += around[m][1];
              q[(axis + 1) % 3] += around[m + 1][0];
              q[(axis + 2) % 3] += around[m + 1][1];
              cut_tetrahedron({centre, other, p, q}, out);
            }
          }
  }

 private:
  static constexpr int n = SparseField::block_cells + 1, points = n * n * n;

  // Evaluates the field at the corners of cells (0) or at their centres (1).
  void evaluate(const SparseField::Block& block, int odd) {
    constexpr int together = 8;
    for (int first = 0; first < points; first += together) {
      PointBatch<together> batch;
      for (int i = 0; i < together; ++i) {
        const int at = std::min(first + i, points - 1);
        const Eigen::Vector3i local =
            2 * Eigen::Vector3i(at % n, at / n % n, at / (n * n)) + Eigen::Vector3i::Constant(odd);
        batch.set(i, field_.lattice_point(base_ + local));
      }
      const Values<together> d = field_.distances(batch, block);
      std::copy_n(d.data(), std::min(together, points - first), values_.begin() + odd * points + first);
    }
  }

  static std::size_t slot(const Eigen::Vector3i& local) {
    const int odd = local.x() & 1;
    return ((odd * n + local.z() / 2) * n + local.y() / 2) * n + local.x() / 2;
  }

  // Emits the surface in a positively oriented tetrahedron, with its normal towards the outside.
  void cut_tetrahedron(std::array<Eigen::Vector3i, 4> v, std::vector<CutTriangle>& out) const {
    int inside = 0;
    for (const auto& p : v) inside += values_[slot(p)] < 0.0;
    if (inside == 0 || inside == 4) return;
    // Bring the corners of the rarer sign to the front by exchanges; each pair of exchanges keeps the
    // orientation.
    const bool front_inside = inside <= 2;
    const int front = inside == 2 ? 2 : 1;
    bool mirrored = false;
    for (int i = 0; i < front; ++i)
      for (int j = i; j < 4; ++j)
        if ((values_[slot(v[j])] < 0.0) == front_inside) {
          if (i != j) {
            std::swap(v[i], v[j]);
            mirrored = !mirrored;
          }
          break;
        }
    if (!front_inside) mirrored = !mirrored;
    if (front == 1) {
      emit(v, {{{0, 1}, {0, 2}, {0, 3}}}, mirrored, out);
    } else {
      emit(v, {{{0, 2}, {0, 3}, {1, 3}}}, mirrored, out);
      emit(v, {{{0, 2}, {1, 3}, {1, 2}}}, mirrored, out);
    }
  }

  void emit(const std::array<Eigen::Vector3i, 4>& v, const std::array<std::array<int, 2>, 3>& edges,
            bool mirrored, std::vector<CutTriangle>& out) const {
    CutTriangle triangle;
    for (int c = 0; c < 3; ++c) {
      const auto& edge = edges[mirrored ? 2 - c : c];
      Eigen::Vector3i a = v[edge[0]], b = v[edge[1]];
      const Eigen::Vector3i step = b - a;
      // Starts at the end first in (z, y, x) order, so that both users of an edge agree to the bit.
      if (std::array{step.z(), step.y(), step.x()} < std::array{0, 0, 0}) std::swap(a, b);
      const double fa = values_[slot(a)], fb = values_[slot(b)];
      const double t = fa / (fa - fb);
      triangle.key[c] = edge_key(a, b);
      triangle.point[c] = (1.0 - t) * field_.lattice_point(base_ + a) + t * field_.lattice_point(base_ + b);
    }
    out.push_back(triangle);
  }

  std::uint64_t edge_key(const Eigen::Vector3i& a, const Eigen::Vector3i& b) const {
    const std::uint64_t side = 2 * static_cast<std::uint64_t>(field_.cells_per_side()) + 4;
    const Eigen::Vector3i p = base_ + a, step = b - a;
    const std::uint64_t point =
        (static_cast<std::uint64_t>(p.z()) * side + static_cast<std::uint64_t>(p.y())) * side +
        static_cast<std::uint64_t>(p.x());
    const auto sign = [](int value) { return std::uint64_t{value < 0 ? 0U : value > 0 ? 2U : 1U}; };
    return point * 27 + sign(step.z()) * 9 + sign(step.y()) * 3 + sign(step.x());
  }

  const SparseField& field_;
  Eigen::Vector3i base_;
  std::array<double, 2 * points> values_{};
  bool meets_surface_ = true;
};

}  // namespace

Surface polygonise(const SparseField& field, const Context& context) {
  const auto& blocks = field.blocks();
  std::vector<std::vector<CutTriangle>> cut(blocks.size());
  parallel_blocks(
      blocks.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) LatticeBlock(field, blocks[b]).cut(cut[b]);
      },
      context, 64);

  std::vector<std::uint64_t> keys;
  for (const auto& list : cut)
    for (const auto& triangle : list) keys.insert(keys.end(), triangle.key, triangle.key + 3);
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  context.throw_if_stopped();

  std::vector<Vec3> points(keys.size());
  std::vector<std::array<int, 3>> triangles;
  for (const auto& list : cut)
    for (const auto& triangle : list) {
      std::array<int, 3> corners{};
      for (std::size_t c = 0; c < 3; ++c) {
        corners[c] =
            static_cast<int>(std::lower_bound(keys.begin(), keys.end(), triangle.key[c]) - keys.begin());
        points[corners[c]] = triangle.point[c];
      }
      triangles.push_back(corners);
    }
  return Surface(std::move(points), std::move(triangles));
}

namespace {

Vec3 triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

class Remesher {
 public:
  Remesher(Surface& surface, const SparseField& field, double length, const Context& context)
      : s_(surface), field_(field), length_(length), context_(context) {}

  void split_long_edges() {
    const double limit2 = std::pow(4.0 / 3.0 * length_, 2);
    for (int h = 0; h < static_cast<int>(s_.twin.size()); ++h) {
      if (!s_.alive(h) || h > s_.twin[h]) continue;
      const int a = s_.from(h), b = s_.to(h);
      if ((s_.points[a] - s_.points[b]).squaredNorm() <= limit2) continue;
      const char on_cut = s_.on_cut[a] && s_.on_cut[b];
      const int m = s_.split(h, 0.5 * (s_.points[a] + s_.points[b]));
      s_.on_cut[m] = on_cut;
    }
  }

  void collapse_short_edges() {
    const double limit2 = std::pow(4.0 / 5.0 * length_, 2);
    for (int h = 0; h < static_cast<int>(s_.twin.size()); ++h) {
      if (h % 4096 == 0) context_.throw_if_stopped();
      if (!s_.alive(h)) continue;
      const Vec3 edge = s_.points[s_.to(h)] - s_.points[s_.from(h)];
      if (edge.squaredNorm() < limit2 && worth_collapsing(h)) s_.collapse(h);
    }
  }

  // Flips edges towards valence 6, unless that folds the surface.
  void flip_edges() {
    for (int h = 0; h < static_cast<int>(s_.twin.size()); ++h) {
      if (!s_.alive(h) || h > s_.twin[h]) continue;
      const int g = s_.twin[h];
      const int a = s_.from(h), b = s_.to(h), c = s_.from(Surface::previous(h)),
                d = s_.from(Surface::previous(g));
      if (s_.on_cut[a] && s_.on_cut[b]) continue;
      if (s_.on_cut[c] && s_.on_cut[d]) continue;
      const int va = s_.valence(a), vb = s_.valence(b), vc = s_.valence(c), vd = s_.valence(d);
      const auto off = [](int valence) { return (valence - 6) * (valence - 6); };
      const int gain =
          off(va) + off(vb) + off(vc) + off(vd) - off(va - 1) - off(vb - 1) - off(vc + 1) - off(vd + 1);
      if (gain <= 0 || va <= 3 || vb <= 3 || s_.adjacent(c, d)) continue;
      const Vec3 before =
          triangle_normal(point(a), point(b), point(c)) + triangle_normal(point(b), point(a), point(d));
      const Vec3 n1 = triangle_normal(point(a), point(d), point(c)),
                 n2 = triangle_normal(point(b), point(c), point(d));
      if (n1.dot(before) < 0.5 * n1.norm() * before.norm() || n2.dot(before) < 0.5 * n2.norm() * before.norm())
        continue;
      s_.flip(h);
    }
  }

  // The surface is never far away: one Newton step per pass suffices, with more at the end.
  void relax(int newton_steps) {
    std::vector<Vec3> moved(s_.points.size());
    parallel_blocks(
        s_.points.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t v = begin; v < end; ++v)
            if (s_.outgoing[v] >= 0)
              moved[v] = project(relaxed(static_cast<int>(v)), newton_steps, s_.on_cut[v] != 0);
        },
        context_);
    s_.points = std::move(moved);
  }

 private:
  const Vec3& point(int v) const { return s_.points[v]; }

  bool worth_collapsing(int h) const {
    const int a = s_.from(h), b = s_.to(h);
    if (s_.on_cut[a] && !s_.on_cut[b]) return false;
    if (!s_.may_collapse(h)) return false;
    const int c = s_.from(Surface::previous(h)), d = s_.from(Surface::previous(s_.twin[h]));
    const double longest2 = std::pow(4.0 / 3.0 * length_, 2);
    bool good = true;
    s_.for_each_outgoing(a, [&](int g) {
      const int v = s_.to(g);
      if (v == b) return;
      if ((point(v) - point(b)).squaredNorm() > longest2) good = false;
      // Forbids a chord between two vertices of the cut.
      if (s_.on_cut[v] && s_.on_cut[b] && !s_.on_cut[a] && v != c && v != d) good = false;
      const int w = s_.from(Surface::previous(g));
      if (w == b) return;
      const Vec3 before = triangle_normal(point(a), point(v), point(w));
      const Vec3 after = triangle_normal(point(b), point(v), point(w));
      if (before.dot(after) < 0.3 * before.norm() * after.norm()) good = false;
    });
    return good;
  }

  // Returns a position nearer to the centre of the ring, or along the curve for vertices of a cut.
  Vec3 relaxed(int v) const {
    Vec3 sum = Vec3::Zero(), normal = Vec3::Zero();
    double weight = 0.0;
    const bool curve = s_.on_cut[v] != 0;
    s_.for_each_outgoing(v, [&](int h) {
      const int a = s_.to(h), b = s_.from(Surface::previous(h));
      if (curve && !s_.on_cut[a]) return;
      if (curve) {
        sum += point(a);
        weight += 1.0;
        return;
      }
      const Vec3 n = triangle_normal(point(v), point(a), point(b));
      const double area = n.norm();
      sum += area * (point(v) + point(a) + point(b)) / 3.0;
      weight += area;
      normal += n;
    });
    if (weight <= 0.0) return point(v);
    const Vec3 target = sum / weight;
    if (curve) return {0.5 * (target.x() + point(v).x()), 0.5 * (target.y() + point(v).y()), point(v).z()};
    normal.normalize();
    const Vec3 move = target - point(v);
    return point(v) + move - normal * normal.dot(move);
  }

  // Runs Newton steps along the gradient, within the plane for vertices of a cut.
  Vec3 project(Vec3 x, int steps, bool in_plane) const {
    for (int step = 0; step < steps; ++step) {
      Vec3 gradient;
      const double d = field_.distance_and_gradient(x, gradient);
      if (in_plane) gradient.z() = 0.0;
      const double slope2 = gradient.squaredNorm();
      if (slope2 < 1e-4) break;
      Vec3 move = -d / slope2 * gradient;
      const double size = move.norm();
      if (size > 0.4 * length_) move *= 0.4 * length_ / size;
      x += move;
    }
    return x;
  }

  Surface& s_;
  const SparseField& field_;
  double length_;
  const Context& context_;
};

}  // namespace

void remesh(Surface& surface, const SparseField& field, const RemeshOptions& options, const Context& context) {
  Remesher remesher(surface, field, options.edge_length, context);
  for (int i = 0; i < options.iterations; ++i) {
    context.step("shape_triangles", static_cast<double>(i) / options.iterations);
    remesher.split_long_edges();
    remesher.collapse_short_edges();
    remesher.flip_edges();
    remesher.relax(1);
  }
  remesher.flip_edges();
  remesher.relax(3);
}

void mark_cut(Surface& surface, double height, const RemeshOptions& options) {
  auto& points = surface.points;
  // Vertices very near the plane move into it, unless a whole triangle would lie in the plane.
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (surface.outgoing[v] < 0 || std::abs(points[v].z() - height) > 0.15 * options.edge_length) continue;
    bool whole = false;
    surface.for_each_outgoing(static_cast<int>(v), [&](int h) {
      const int a = surface.to(h), b = surface.from(Surface::previous(h));
      whole = whole || (surface.on_cut[a] && surface.on_cut[b]);
    });
    if (whole) continue;
    points[v].z() = height;
    surface.on_cut[v] = 1;
  }
  for (int h = 0; h < static_cast<int>(surface.twin.size()); ++h) {
    if (!surface.alive(h)) continue;
    const int a = surface.from(h), b = surface.to(h);
    if (surface.on_cut[a] || surface.on_cut[b]) continue;
    const double za = points[a].z() - height, zb = points[b].z() - height;
    if ((za < 0.0) == (zb < 0.0)) continue;
    Vec3 crossing = points[a] + za / (za - zb) * (points[b] - points[a]);
    crossing.z() = height;
    surface.on_cut[surface.split(h, crossing)] = 1;
  }
}

}  // namespace meshgraft::samples
