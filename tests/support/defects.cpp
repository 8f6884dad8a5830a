#include "support/defects.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <random>
#include <set>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

namespace meshgraft::test {

namespace {

using Face = std::vector<Index>;

std::vector<Face> faces_of(const Mesh& mesh) {
  std::vector<Face> faces;
  for (Index f = 0; f < mesh.face_count(); ++f) faces.emplace_back(mesh.faces[f].begin(), mesh.faces[f].end());
  return faces;
}

Mesh with_faces(const Mesh& mesh, const std::vector<Face>& faces) {
  Mesh result;
  result.positions = mesh.positions;
  for (const Face& face : faces) result.faces.push_back(face);
  return result;
}

Index add_vertex(Mesh& mesh, const Eigen::RowVector3d& point) {
  mesh.positions.conservativeResize(mesh.vertex_count() + 1, 3);
  mesh.positions.row(mesh.vertex_count() - 1) = point;
  return mesh.vertex_count() - 1;
}

// Avoids std::uniform_int_distribution, since its results differ between standard libraries.
class RandomDamage {
 public:
  explicit RandomDamage(unsigned seed) : engine_(seed) {}
  Index below(Index n) { return static_cast<Index>(engine_() % static_cast<unsigned>(n)); }
  double symmetric() { return static_cast<double>(engine_()) / 2147483647.5 - 1; }

 private:
  std::mt19937 engine_;
};

// Returns up to `count` faces whose two-ring neighbourhoods share no vertex.
std::vector<Index> spread_faces(const Mesh& mesh, int count, unsigned seed) {
  RandomDamage random(seed);
  std::vector<char> used(mesh.vertex_count(), 0);
  const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
  std::vector<Index> chosen;
  for (int attempt = 0; attempt < 100 * count && static_cast<int>(chosen.size()) < count; ++attempt) {
    const Index f = random.below(mesh.face_count());
    const auto face = mesh.faces[f];
    const auto around = grow_rings(face, 2, rings);
    if (std::any_of(around.begin(), around.end(), [&](Index v) { return used[v] != 0; })) continue;
    for (const Index v : around) used[v] = 1;
    chosen.push_back(f);
  }
  return chosen;
}

double box_diagonal(const Mesh& mesh) {
  return (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).norm();
}

// Returns the face on the other side of the edge from `a` to `b`, or -1.
Index face_across(const std::vector<Face>& faces, Index f, Index a, Index b) {
  for (Index g = 0; g < static_cast<Index>(faces.size()); ++g) {
    if (g == f) continue;
    const bool has_a = std::count(faces[g].begin(), faces[g].end(), a) > 0;
    if (has_a && std::count(faces[g].begin(), faces[g].end(), b) > 0) return g;
  }
  return -1;
}

// Returns the first face without a boundary vertex, from the middle of the list on, or -1.
Index inner_face(const Mesh& mesh) {
  std::vector<char> rim(mesh.vertex_count(), 0);
  for (const auto& loop : boundary_loops(mesh))
    for (const Index v : loop) rim[v] = 1;
  const Index count = mesh.face_count();
  for (Index k = 0; k < count; ++k) {
    const Index f = (count / 2 + k) % count;
    const auto face = mesh.faces[f];
    if (std::none_of(face.begin(), face.end(), [&](Index v) { return rim[v] != 0; })) return f;
  }
  return -1;
}

bool is_closed(const Mesh& mesh) { return summarise_topology(mesh).closed; }

}  // namespace

const std::vector<FindingKind>& defect_kinds() {
  static const std::vector<FindingKind> kinds{
      FindingKind::non_finite,       FindingKind::outlying_vertex,      FindingKind::index_out_of_range,
      FindingKind::degenerate_face,  FindingKind::zero_area_face,       FindingKind::isolated_vertex,
      FindingKind::duplicate_vertex, FindingKind::non_manifold_edge,    FindingKind::non_manifold_vertex,
      FindingKind::duplicate_face,   FindingKind::inconsistent_winding, FindingKind::inward_facing_component};
  return kinds;
}

Defective inject(const Mesh& clean, FindingKind kind) {
  Defective result{.mesh = with_faces(clean, faces_of(clean)), .indices = {}};
  Mesh& mesh = result.mesh;
  std::vector<Face> faces = faces_of(clean);
  const Index middle = clean.face_count() / 2;
  const Face face = faces[middle];
  const auto expect = [&](Domain domain, std::vector<Index> indices, Index count = -1) {
    std::sort(indices.begin(), indices.end());
    result.domain = domain;
    result.count = count < 0 ? static_cast<Index>(indices.size()) : count;
    result.indices = std::move(indices);
  };
  if (kind == FindingKind::non_finite) {
    mesh.positions(face[0], 1) = std::numeric_limits<double>::quiet_NaN();
    expect(Domain::vertex, {face[0]});
  } else if (kind == FindingKind::outlying_vertex) {
    mesh.positions(face[0], 1) += 1e30 * (1 + box_diagonal(clean));
    expect(Domain::vertex, {face[0]});
  } else if (kind == FindingKind::index_out_of_range) {
    mesh.faces.push_back(Face{face[0], face[1], clean.vertex_count()});
    expect(Domain::face, {clean.face_count()});
  } else if (kind == FindingKind::degenerate_face) {
    mesh.faces.push_back(Face{face[0], face[0], face[0]});
    expect(Domain::face, {clean.face_count()});
  } else if (kind == FindingKind::zero_area_face) {
    // The collinear triangle is a component of its own, so that there is no other defect.
    const Eigen::RowVector3d p = clean.positions.row(face[0]);
    const Eigen::RowVector3d way = clean.positions.row(face[1]) - p, apart(0, 0, 10 * box_diagonal(clean));
    const Index a = add_vertex(mesh, p + apart), b = add_vertex(mesh, p + apart + way);
    const Index c = add_vertex(mesh, p + apart + 2 * way);
    mesh.faces.push_back(Face{a, b, c});
    expect(Domain::face, {clean.face_count()});
  } else if (kind == FindingKind::isolated_vertex) {
    const Index alone = add_vertex(mesh, clean.positions.row(face[0]));
    expect(Domain::vertex, {alone});
  } else if (kind == FindingKind::duplicate_vertex) {
    // Cuts off an inner face along all its edges.
    const Index inner = inner_face(clean);
    if (inner < 0) return result;
    std::vector<Index> named = faces[inner];
    for (Index& v : faces[inner]) v = add_vertex(mesh, Eigen::RowVector3d(clean.positions.row(v)));
    named.insert(named.end(), faces[inner].begin(), faces[inner].end());
    mesh = with_faces(mesh, faces);
    expect(Domain::vertex, named);
  } else if (kind == FindingKind::non_manifold_edge) {
    for (int k = 0; k < 3; ++k) {
      const Index a = face[k], b = face[(k + 1) % 3];
      if (face_across(faces, middle, a, b) < 0) continue;
      const Eigen::RowVector3d p = clean.positions.row(a), way = clean.positions.row(b) - p;
      const Index tip =
          add_vertex(mesh, p + 7 * box_diagonal(clean) * way.cross(Eigen::RowVector3d(3, 1, 2)).normalized());
      mesh.faces.push_back(Face{a, b, tip});
      expect(Domain::vertex, {a, b}, 1);
      break;
    }
  } else if (kind == FindingKind::non_manifold_vertex) {
    const Eigen::RowVector3d p = clean.positions.row(face[0]);
    const double size = box_diagonal(clean);
    const Index a = add_vertex(mesh, p + Eigen::RowVector3d(size, 0, 5 * size));
    const Index b = add_vertex(mesh, p + Eigen::RowVector3d(0, size, 5 * size));
    mesh.faces.push_back(Face{face[0], a, b});
    expect(Domain::vertex, {face[0]});
  } else if (kind == FindingKind::duplicate_face) {
    mesh.faces.push_back(Face{face[1], face[0], face[2]});
    expect(Domain::face, {clean.face_count()});
  } else if (kind == FindingKind::inconsistent_winding) {
    std::set<Index> ends;
    Index edges = 0;
    for (int k = 0; k < 3; ++k) {
      if (face_across(faces, middle, face[k], face[(k + 1) % 3]) < 0) continue;
      ends.insert({face[k], face[(k + 1) % 3]});
      ++edges;
    }
    std::swap(faces[middle][1], faces[middle][2]);
    mesh = with_faces(mesh, faces);
    expect(Domain::vertex, {ends.begin(), ends.end()}, edges);
  } else if (kind == FindingKind::inward_facing_component) {
    if (!is_closed(clean)) return result;
    for (Face& some : faces) std::swap(some[1], some[2]);
    mesh = with_faces(mesh, faces);
    // A component's finding names its first vertex; isolated vertices before it do not count.
    Index count = 0;
    const std::vector<Index> component = connected_components(clean, &count);
    std::vector<Index> firsts(static_cast<std::size_t>(count), -1);
    for (Index v = clean.vertex_count() - 1; v >= 0; --v)
      if (component[v] >= 0) firsts[component[v]] = v;
    expect(Domain::vertex, firsts);
  }
  return result;
}

Mesh as_soup(const Mesh& mesh) {
  Mesh soup;
  soup.positions.resize(mesh.faces.corner_count(), 3);
  Index next = 0;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    Face face;
    for (const Index v : mesh.faces[f]) {
      soup.positions.row(next) = mesh.positions.row(v);
      face.push_back(next++);
    }
    soup.faces.push_back(face);
  }
  return soup;
}

Mesh with_noise(Mesh mesh, double size_rel, unsigned seed) {
  RandomDamage random(seed);
  const double size = size_rel * box_diagonal(mesh);
  for (Eigen::Index k = 0; k < mesh.positions.size(); ++k)
    mesh.positions.data()[k] += size * random.symmetric();
  return mesh;
}

Mesh rounded(Mesh mesh, int digits) {
  const double scale = std::pow(10.0, digits);
  for (Eigen::Index k = 0; k < mesh.positions.size(); ++k) {
    double& x = mesh.positions.data()[k];
    if (x == 0) continue;
    const double unit = scale / std::pow(10.0, std::ceil(std::log10(std::abs(x))));
    x = std::round(x * unit) / unit;
  }
  return mesh;
}

Mesh without_faces(const Mesh& mesh, int spots, int rings, unsigned seed) {
  const IndexLists lists = vertex_rings(mesh.vertex_count(), mesh.faces);
  std::vector<char> gone(mesh.face_count(), 0);
  for (const Index f : spread_faces(mesh, spots, seed)) {
    gone[f] = 1;
    if (rings == 0) continue;
    const auto patch = grow_rings(std::array{mesh.faces[f][0]}, rings, lists);
    for (Index g = 0; g < mesh.face_count(); ++g) {
      const auto face = mesh.faces[g];
      if (std::all_of(face.begin(), face.end(),
                      [&](Index v) { return std::binary_search(patch.begin(), patch.end(), v); }))
        gone[g] = 1;
    }
  }
  std::vector<Face> kept;
  const std::vector<Face> faces = faces_of(mesh);
  for (std::size_t f = 0; f < faces.size(); ++f)
    if (!gone[f]) kept.push_back(faces[f]);
  return with_faces(mesh, kept);
}

Mesh with_turned_patches(const Mesh& mesh, int patches, int rings, unsigned seed) {
  const IndexLists lists = vertex_rings(mesh.vertex_count(), mesh.faces);
  std::vector<Face> faces = faces_of(mesh);
  std::vector<char> turned(faces.size(), 0);
  for (const Index f : spread_faces(mesh, patches, seed)) {
    const auto patch = grow_rings(std::array{mesh.faces[f][0]}, rings, lists);
    for (std::size_t g = 0; g < faces.size(); ++g)
      if (std::all_of(faces[g].begin(), faces[g].end(),
                      [&](Index v) { return std::binary_search(patch.begin(), patch.end(), v); }))
        turned[g] = 1;
  }
  for (std::size_t g = 0; g < faces.size(); ++g)
    if (turned[g]) std::reverse(faces[g].begin(), faces[g].end());
  return with_faces(mesh, faces);
}

namespace {

// Calls `replace` for `count` triangles with a neighbour across the edge from corner 0 to corner 1.
template <class Replace>
Mesh at_edges(const Mesh& mesh, int count, unsigned seed, const Replace& replace) {
  Mesh result = with_faces(mesh, faces_of(mesh));
  std::vector<Face> faces = faces_of(mesh);
  for (const Index f : spread_faces(mesh, count, seed)) {
    const Index across = face_across(faces, f, faces[f][0], faces[f][1]);
    if (across >= 0) replace(result, faces, f, across);
  }
  return with_faces(result, faces);
}

}  // namespace

Mesh with_needles(const Mesh& mesh, int count, unsigned seed) {
  return at_edges(mesh, count, seed, [](Mesh& all, std::vector<Face>& faces, Index f, Index) {
    // Face (a, b, c) becomes (a, b', c). The needle (a, b, b') lies between it and the face beyond a–b. A
    // second needle, (b, c, b'), closes the gap along b–c.
    const Face face = faces[f];
    const Eigen::RowVector3d b = all.positions.row(face[1]);
    const Eigen::RowVector3d towards = (all.positions.row(face[0]) + all.positions.row(face[2])) / 2 - b;
    const Index twin = add_vertex(all, b + 1e-13 * towards);
    faces[f] = {face[0], twin, face[2]};
    faces.push_back({face[0], face[1], twin});
    faces.push_back({face[1], face[2], twin});
  });
}

Mesh with_caps(const Mesh& mesh, int count, unsigned seed) {
  return at_edges(mesh, count, seed, [](Mesh& all, std::vector<Face>& faces, Index f, Index) {
    const Face face = faces[f];
    const Index m = add_vertex(all, (all.positions.row(face[0]) + all.positions.row(face[1])) / 2);
    faces[f] = {face[0], m, face[2]};
    faces.push_back({m, face[1], face[2]});
    faces.push_back({face[0], face[1], m});
  });
}

Mesh with_t_junctions(const Mesh& mesh, int count, unsigned seed) {
  return at_edges(mesh, count, seed, [](Mesh& all, std::vector<Face>& faces, Index f, Index) {
    const Face face = faces[f];
    const Index m = add_vertex(all, 0.4 * all.positions.row(face[0]) + 0.6 * all.positions.row(face[1]));
    faces[f] = {face[0], m, face[2]};
    faces.push_back({m, face[1], face[2]});
  });
}

Mesh with_floating_bits(const Mesh& mesh, int count, unsigned seed) {
  Mesh result = with_faces(mesh, faces_of(mesh));
  RandomDamage random(seed);
  const double size = box_diagonal(mesh);
  const Eigen::RowVector3d centre =
      (mesh.positions.colwise().maxCoeff() + mesh.positions.colwise().minCoeff()) / 2;
  for (int k = 0; k < count; ++k) {
    const Eigen::RowVector3d at =
        centre + size * Eigen::RowVector3d(random.symmetric(), random.symmetric(), random.symmetric()) / 2;
    std::array<Index, 4> v{};
    for (int c = 0; c < 4; ++c)
      v[c] = add_vertex(result, at + 0.004 * size * Eigen::RowVector3d(c == 1, c == 2, c == 3));
    for (const auto& [a, b, c] :
         {std::array{0, 2, 1}, std::array{0, 1, 3}, std::array{1, 2, 3}, std::array{0, 3, 2}})
      result.faces.push_back(Face{v[a], v[b], v[c]});
  }
  return result;
}

Mesh with_repeated_faces(const Mesh& mesh, int count, unsigned seed) {
  std::vector<Face> faces = faces_of(mesh);
  bool turn = false;
  for (const Index f : spread_faces(mesh, count, seed)) {
    Face copy = faces[f];
    std::rotate(copy.begin(), copy.begin() + 1, copy.end());
    if (turn) std::reverse(copy.begin(), copy.end());
    turn = !turn;
    faces.push_back(copy);
  }
  return with_faces(mesh, faces);
}

Mesh with_fins(const Mesh& mesh, int count, unsigned seed) {
  Mesh result = with_faces(mesh, faces_of(mesh));
  for (const Index f : spread_faces(mesh, count, seed)) {
    const auto face = mesh.faces[f];
    const Eigen::RowVector3d a = mesh.positions.row(face[0]), b = mesh.positions.row(face[1]),
                             c = mesh.positions.row(face[2]);
    const Eigen::RowVector3d out = (b - a).cross(c - a).normalized() * (b - a).norm();
    const Index tip = add_vertex(result, (a + b) / 2 + out);
    result.faces.push_back(Face{face[0], face[1], tip});
  }
  return result;
}

Mesh with_bow_ties(const Mesh& mesh, int count, unsigned seed) {
  const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
  std::vector<Face> faces = faces_of(mesh);
  for (const Index f : spread_faces(mesh, count, seed)) {
    const Index v = mesh.faces[f][0];
    const auto near = grow_rings(std::array{v}, 2, rings), far = grow_rings(std::array{v}, 3, rings);
    for (const Index w : far) {
      if (std::binary_search(near.begin(), near.end(), w)) continue;
      for (Face& face : faces) std::replace(face.begin(), face.end(), w, v);
      break;
    }
  }
  return with_faces(mesh, faces);
}

Mesh with_cracks(const Mesh& mesh, int patches, double width, bool apart) {
  const Eigen::RowVector3d centre = mesh.positions.colwise().mean();
  std::vector<Face> faces = faces_of(mesh);
  // Per vertex and patch: its faces' mean point; its first patch keeps it.
  std::vector<std::map<int, std::pair<Eigen::RowVector3d, int>>> at(mesh.vertex_count());
  std::vector<int> patch;
  for (const Face& face : faces) {
    Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
    for (const Index v : face) middle += mesh.positions.row(v) / static_cast<double>(face.size());
    const double turns = std::atan2(middle[1] - centre[1], middle[0] - centre[0]) / (2 * M_PI) + 0.5;
    patch.push_back(std::min(patches - 1, static_cast<int>(turns * patches)));
    for (const Index v : face) {
      auto& [sum, count] = at[v].try_emplace(patch.back(), Eigen::RowVector3d::Zero(), 0).first->second;
      sum += middle;
      ++count;
    }
  }
  Mesh result = with_faces(mesh, faces);
  std::map<std::pair<Index, int>, Index> copies;
  const IndexLists rings = vertex_rings(mesh.vertex_count(), mesh.faces);
  std::vector<std::vector<Index>> run_of(mesh.vertex_count());  // per torn vertex: its run
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (at[v].size() < 2) continue;
    std::set<Index> run{v};
    for (const Index w : rings[v]) run.insert(run_of[w].begin(), run_of[w].end());
    const bool torn = at[v].size() == 2 && run.size() <= 3;
    if (torn)
      for (const Index w : run) run_of[w].assign(run.begin(), run.end());
    if (!torn && !apart) continue;
    for (auto here = std::next(at[v].begin()); here != at[v].end(); ++here) {
      const auto& [sum, count] = here->second;
      const Eigen::RowVector3d p = mesh.positions.row(v);
      copies[{v, here->first}] = add_vertex(result, torn ? p + width * (sum / count - p) : p);
    }
  }
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (Index& v : faces[f])
      if (const auto copy = copies.find({v, patch[f]}); copy != copies.end()) v = copy->second;
  return with_faces(result, faces);
}

Mesh with_non_finite(Mesh mesh, int count, unsigned seed) {
  int k = 0;
  for (const Index f : spread_faces(mesh, count, seed))
    mesh.positions(mesh.faces[f][0], k++ % 3) = std::numeric_limits<double>::quiet_NaN();
  return mesh;
}

Mesh with_outlying(Mesh mesh, const std::vector<Index>& vertices, double distance) {
  for (std::size_t k = 0; k < vertices.size(); ++k)
    mesh.positions.row(vertices[k]) += Eigen::RowVector3d(k % 2 == 0 ? distance : -distance, distance / 3, 0);
  return mesh;
}

Mesh with_bad_indices(const Mesh& mesh, int count, unsigned seed) {
  Mesh result = with_faces(mesh, faces_of(mesh));
  RandomDamage random(seed);
  for (int k = 0; k < count; ++k)
    result.faces.push_back(Face{random.below(mesh.vertex_count()), k % 2 ? -1 : mesh.vertex_count() + k,
                                random.below(mesh.vertex_count())});
  return result;
}

Mesh with_isolated(const Mesh& mesh, int count, unsigned seed) {
  Mesh result = with_faces(mesh, faces_of(mesh));
  RandomDamage random(seed);
  for (int k = 0; k < count; ++k)
    add_vertex(result, Eigen::RowVector3d(random.symmetric(), random.symmetric(), random.symmetric()));
  return result;
}

Mesh both(const Mesh& first, const Mesh& second) {
  Mesh result = with_faces(first, faces_of(first));
  const Index shift = first.vertex_count();
  result.positions.conservativeResize(shift + second.vertex_count(), 3);
  result.positions.bottomRows(second.vertex_count()) = second.positions;
  for (Face face : faces_of(second)) {
    for (Index& v : face) v += shift;
    result.faces.push_back(face);
  }
  return result;
}

}  // namespace meshgraft::test
