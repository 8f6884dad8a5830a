#include "resolve_step.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include <meshgraft/core/error.h>

#include "components.h"
#include "core/facts.h"
#include "deform/facts.h"
#include "distributed/facts.h"
#include "io/selection_files.h"
#include "script/facts.h"
#include "selections.h"

namespace meshgraft::distributed {

namespace {

/// The role of a vertex: the index of a handle, or one of these.
constexpr int outside = -4, nobody = -3, fixed = -2, constrained = -1;

void require_supported(const DeformStep& step, const Location& location) {
  const auto refuse = [&](const char* what) {
    throw Error(facts::distributed::NotDistributed{.what = what}, location / what);
  };
  if (step.symmetry) refuse("symmetry");
  if (!step.features.empty()) refuse("features");
  if (step.settings.deformer.method == DeformMethod::shell)
    throw Error(facts::distributed::NotDistributed{.what = "the method shell"},
                location / "settings" / "method");
  if (step.settings.proxy > 0) refuse("proxy");
  if (step.settings.refine_boundary.value_or(0) > 0) refuse("refine_boundary");
  for (std::size_t h = 0; h < step.handles.size(); ++h)
    if (std::holds_alternative<PoseSpec::Redrawn>(step.handles[h].pose.kind))
      throw Error(facts::distributed::NotDistributed{.what = "curve"},
                  (location / "handles")[h] / "pose" / "curve");
}

class StepResolver {
 public:
  StepResolver(const Communicator& comm, const EditFile& edit, const DeformStep& step, const LocalMesh& mesh,
               const Points& positions, const Location& location)
      : comm_(comm),
        edit_(edit),
        step_(step),
        mesh_(mesh),
        positions_(positions),
        location_(location),
        selections_(comm, mesh, positions, edit),
        role_(mesh.vertices.size(), outside) {}

  ResolvedStep resolve(Number face_count) {
    require_supported(step_, location_);
    require_count(step_.counts.vertices, mesh_.vertices.total(), "vertices");
    require_count(step_.counts.faces, face_count, "faces");
    const Flags inside = selections_.resolve(step_.region, location_ / "region");
    const Number region = selections_.count(inside);
    if (region == 0) throw Error(facts::script::RegionEmpty{}, location_ / "region");
    for (Index v = 0; v < mesh_.vertices.size(); ++v)
      if (inside[v]) role_[v] = nobody;
    const Flags rim = find_fixed(inside);
    for (std::size_t h = 0; h < step_.handles.size(); ++h) hold(static_cast<int>(h));
    find_constraints();
    for (Index v = 0; v < mesh_.vertices.size(); ++v)
      if (rim[v] && role_[v] == nobody) role_[v] = fixed;
    find_anchors();
    finish();
    require_count(step_.counts.region, region, "region");
    require_count(step_.counts.fixed, resolved_.fixed, "fixed");
    require_count(step_.counts.handle, handle_vertices_, "handle");
    require_count(step_.counts.free, region - resolved_.fixed - resolved_.held, "free");
    require_no_refinement();
    require_no_weld();
    return std::move(resolved_);
  }

 private:
  void require_count(const std::optional<Index>& expected, Number found, const char* name) const {
    if (expected && *expected != found)
      throw Error(facts::script::WrongCount{.expected = *expected, .found = found},
                  location_ / "counts" / name);
  }

  Number number(Index v) const { return mesh_.vertices.number(v); }

  /// Returns the selected vertices. Only an empty list of indices may select none.
  Flags vertices_of(const EditSelection& selection, const Location& where) {
    Flags flags = selections_.resolve(selection, where);
    if (selections_.count(flags) == 0 && !std::holds_alternative<Selection::Indices>(selection.kind))
      throw Error(facts::script::SelectionEmpty{}, where);
    return flags;
  }

  /// Returns the rim that is fixed by default where the step names no fixed vertices.
  Flags find_fixed(const Flags& inside) {
    if (step_.fixed) {
      const Flags flags = vertices_of(*step_.fixed, location_ / "fixed");
      for (Index v = 0; v < mesh_.vertices.size(); ++v)
        if (flags[v] && role_[v] == nobody) role_[v] = fixed;
      return Flags(inside.size(), 0);
    }
    if (std::holds_alternative<Selection::All>(step_.region.kind)) return Flags(inside.size(), 0);
    constexpr Number default_rings = 2;
    return selections_.rim(inside, default_rings);
  }

  /// Throws where a vertex, which is inside, has a role.
  void require_free(Index v, const Location& where) const {
    if (role_[v] == nobody) return;
    if (role_[v] >= 0)
      throw Error(
          facts::deform::VertexOfTwoHandles{.vertex = number(v),
                                            .handle = step_.handles[static_cast<std::size_t>(role_[v])].name},
          where);
    throw Error(facts::deform::VertexAlsoFixed{.vertex = number(v)}, where);
  }

  void hold(int h) {
    const HandleSpec& spec = step_.handles[static_cast<std::size_t>(h)];
    const Location where = (location_ / "handles")[static_cast<std::size_t>(h)], select = where / "select";
    const Flags flags = selections_.resolve(spec.select, select);
    const Number count = selections_.count(flags);
    if (count == 0) throw Error(facts::script::HandleEmpty{.handle = spec.name}, select);
    if (spec.shape == HandleShape::vertex && count != 1)
      throw Error(facts::script::NotOneVertex{.handle = spec.name, .count = count}, select);
    Number beyond = 0;
    comm_.together([&] {
      for (Index v = 0; v < mesh_.vertices.own(); ++v) {
        if (!flags[v]) continue;
        if (!positions_.row(v).allFinite())
          throw Error(facts::script::HandleNotFinite{.handle = spec.name, .vertex = number(v)}, select);
        beyond += role_[v] == outside;
      }
    });
    beyond = comm_.sum(beyond);
    if (beyond > 0)
      throw Error(facts::script::HandleOutsideRegion{.handle = spec.name, .outside = beyond, .all = count},
                  select);
    comm_.together([&] {
      for (Index v = 0; v < mesh_.vertices.own(); ++v)
        if (flags[v]) require_free(v, select);
    });
    const HandlePose pose = pose_of(spec.pose, flags, where / "pose");
    for (Index v = 0; v < mesh_.vertices.size(); ++v)
      if (flags[v]) role_[v] = h;
    Handle handle{.name = spec.name,
                  .vertices = {},
                  .constrain_position = spec.constrain_position,
                  .constrain_transform = spec.constrain_transform};
    for (Index v = 0; v < mesh_.vertices.own(); ++v)
      if (flags[v]) handle.vertices.push_back(v);
    const Points normals;
    const auto held = handle_constraints(handle, pose, {positions_, normals});
    resolved_.problem.constraints.insert(resolved_.problem.constraints.end(), held.begin(), held.end());
    resolved_.handles.push_back(spec.name);
    handle_vertices_ += count;
  }

  HandlePose pose_of(const PoseSpec& spec, const Flags& handle, const Location& location) {
    if (const auto* motion = std::get_if<HandleMotion>(&spec.kind)) {
      const Eigen::Vector3d pivot = motion->pivot ? *motion->pivot : pivot_of(handle);
      return make_pose(*motion, pivot);
    }
    HandlePose pose;
    if (const auto* def = std::get_if<PoseSpec::DefFile>(&spec.kind)) {
      const Location where = location / "def" / (edit_.base_folder / def->file);
      pose.transform.matrix() = parse_def(selections_.read(def->file, location / "def"), where);
    } else {
      pose.transform.matrix() = std::get<Eigen::Matrix4d>(spec.kind);
    }
    return pose;
  }

  /// Returns the mean of the handle's vertices with a neighbour outside it, or of all of them, as
  /// `handle_pivot`.
  Eigen::Vector3d pivot_of(const Flags& handle) const {
    const auto is_boundary = [&](Index v) {
      return std::any_of(mesh_.rings[v].begin(), mesh_.rings[v].end(), [&](Index w) { return !handle[w]; });
    };
    constexpr Number none = std::numeric_limits<Number>::max();
    std::array<Number, 2> first{none, none};  // the first vertex of all, and of the boundary
    for (Index v = mesh_.vertices.own() - 1; v >= 0; --v) {
      if (!handle[v]) continue;
      first[0] = number(v);
      if (is_boundary(v)) first[1] = number(v);
    }
    const Number boundary_first = comm_.smallest(first[1]);
    const bool has_boundary = boundary_first != none;
    const Number origin_number = has_boundary ? boundary_first : comm_.smallest(first[0]);
    // Sums differences to the first vertex, which keeps precision far from the origin.
    Eigen::VectorXd origin = Eigen::VectorXd::Zero(3), sum = Eigen::VectorXd::Zero(4);
    if (const Index local = mesh_.vertices.local(origin_number); local >= 0 && local < mesh_.vertices.own())
      origin = positions_.row(local).transpose();
    origin = comm_.sum(origin);
    for (Index v = 0; v < mesh_.vertices.own(); ++v) {
      if (!handle[v] || (has_boundary && !is_boundary(v))) continue;
      sum.head<3>() += positions_.row(v).transpose() - origin;
      sum[3] += 1;
    }
    sum = comm_.sum(sum);
    return origin + sum.head<3>() / sum[3];
  }

  /// Joins targets and transforms to constraints of single vertices.
  void find_constraints() {
    std::map<Index, VertexConstraint> found;  // of own vertices
    comm_.together([&] {
      const auto at = [&](Index vertex, const Location& where) -> VertexConstraint* {
        const Number total = mesh_.vertices.total();
        if (vertex >= total) throw Error(facts::core::NoSuchVertex{.vertex = vertex, .count = total}, where);
        const Index v = mesh_.vertices.local(vertex);
        if (v < 0 || v >= mesh_.vertices.own()) return nullptr;
        const auto [entry, is_new] = found.try_emplace(v);
        if (is_new) {
          if (role_[v] == outside) throw Error(facts::script::VertexOutsideRegion{.vertex = vertex}, where);
          require_free(v, where);
          role_[v] = constrained;
          entry->second.vertex = v;
        }
        return &entry->second;
      };
      for (std::size_t k = 0; k < step_.targets.size(); ++k) {
        const Location where = (location_ / "targets")[k];
        VertexConstraint* constraint = at(step_.targets[k].vertex, where);
        if (constraint == nullptr) continue;
        if (constraint->position)
          throw Error(facts::script::TwoTargets{.vertex = step_.targets[k].vertex}, where);
        constraint->position = step_.targets[k].position;
      }
      for (std::size_t k = 0; k < step_.transforms.size(); ++k) {
        const Location where = (location_ / "transforms")[k];
        VertexConstraint* constraint = at(step_.transforms[k].vertex, where);
        if (constraint == nullptr) continue;
        if (constraint->transform)
          throw Error(facts::script::TwoTransforms{.vertex = step_.transforms[k].vertex}, where);
        constraint->transform = step_.transforms[k].matrix;
      }
    });
    mesh_.vertices.update(role_);
    for (const auto& [v, constraint] : found) resolved_.problem.constraints.push_back(constraint);
    resolved_.held = handle_vertices_ + comm_.sum(static_cast<Number>(found.size()));
  }

  void find_anchors() {
    std::map<Index, Anchor> anchors;
    for (std::size_t k = 0; k < step_.anchors.size(); ++k) {
      const Location where = (location_ / "anchors")[k] / "select";
      const Flags flags = vertices_of(step_.anchors[k].select, where);
      comm_.together([&] {
        for (Index v = 0; v < mesh_.vertices.own(); ++v)
          if (flags[v] && role_[v] == nobody &&
              !anchors.try_emplace(v, Anchor{v, step_.anchors[k].weight, {}}).second)
            throw Error(facts::script::AnchoredTwice{.vertex = number(v)}, where);
      });
    }
    for (const auto& [v, anchor] : anchors) resolved_.problem.anchors.push_back(anchor);
  }

  void finish() {
    Number fixed_count = 0;
    resolved_.problem.movable.assign(mesh_.vertices.own(), 0);
    for (Index v = 0; v < mesh_.vertices.own(); ++v) {
      resolved_.problem.movable[v] = role_[v] != outside && role_[v] != fixed;
      fixed_count += role_[v] == fixed;
    }
    resolved_.fixed = comm_.sum(fixed_count);
  }

  /// Throws where one machine would refine the mesh around sparse handles: pieces of a handle, or of single
  /// constraints, without a vertex off the free vertices.
  void require_no_refinement() const {
    if (step_.settings.refine_boundary) return;
    Flags is_rim(mesh_.vertices.size(), 0);
    for (const auto& corners : mesh_.triangles.rowwise()) {
      const auto free =
          std::count_if(corners.begin(), corners.end(), [&](Index v) { return role_[v] == nobody; });
      if (free == 1 || free == 2)
        for (const Index v : corners) is_rim[v] = 1;
    }
    mesh_.vertices.update(is_rim);
    Number free = 0;
    for (Index v = 0; v < mesh_.vertices.own(); ++v) free += role_[v] == nobody;
    constexpr Number few = 8, free_per_sparse = 100;
    const Number most = std::max(few, comm_.sum(free) / free_per_sparse);
    for (int holder = constrained; holder < static_cast<int>(step_.handles.size()); ++holder) {
      if (holder >= 0 && step_.handles[static_cast<std::size_t>(holder)].shape == HandleShape::curve) continue;
      const Number smallest = smallest_sparse_piece(holder, is_rim);
      if (smallest > 0 && smallest <= most)
        throw Error(facts::distributed::RefinementNotDistributed{}, location_ / "refine_boundary");
    }
  }

  /// Returns the number of vertices of the smallest piece of a holder without an interior vertex, or 0.
  Number smallest_sparse_piece(int holder, const Flags& is_rim) const {
    Flags held(mesh_.vertices.size());
    std::vector<Number> names(held.size());
    for (Index v = 0; v < mesh_.vertices.size(); ++v) {
      held[v] = role_[v] == holder;
      names[v] = number(v);
    }
    if (selections_.count(held) == 0) return 0;
    const std::vector<Number> labels = find_components(comm_, mesh_, held, names);
    struct Piece {
      Number label, vertices, interior;
    };
    std::map<Number, Piece> own;
    for (Index v = 0; v < mesh_.vertices.own(); ++v) {
      if (labels[v] < 0) continue;
      Piece& piece = own.try_emplace(labels[v], Piece{labels[v], 0, 0}).first->second;
      ++piece.vertices;
      piece.interior += !is_rim[v];
    }
    ByRank<Piece> to(comm_.size());
    for (const auto& [label, piece] : own) to[label % comm_.size()].push_back(piece);
    std::map<Number, Piece> sums;
    for (const auto& list : comm_.exchange(to))
      for (const Piece& piece : list) {
        Piece& sum = sums.try_emplace(piece.label, Piece{piece.label, 0, 0}).first->second;
        sum.vertices += piece.vertices;
        sum.interior += piece.interior;
      }
    constexpr Number none = std::numeric_limits<Number>::max();
    Number smallest = none;
    for (const auto& [label, piece] : sums)
      if (piece.interior == 0) smallest = std::min(smallest, piece.vertices);
    smallest = comm_.smallest(smallest);
    return smallest == none ? 0 : smallest;
  }

  /// Throws where boundary edges coincide, whose vertices one machine would weld.
  void require_no_weld() const {
    if (!step_.settings.weld) return;
    struct Edge {
      std::array<double, 6> ends;
      Number vertex;
      bool operator<(const Edge& other) const { return ends < other.ends; }
    };
    ByRank<Edge> to(comm_.size());
    const auto lies_in_one_face = [&](Index v, Index w) {
      const auto faces = mesh_.faces_at[v];
      return std::count_if(faces.begin(), faces.end(),
                           [&](Index t) { return (mesh_.triangles.row(t).array() == w).any(); }) == 1;
    };
    for (Index v = 0; v < mesh_.vertices.own(); ++v)
      for (const Index w : mesh_.rings[v]) {
        if (number(w) < number(v) || !lies_in_one_face(v, w)) continue;
        std::array<double, 3> a{}, b{};
        for (int k = 0; k < 3; ++k) {
          a[static_cast<std::size_t>(k)] = positions_(v, k) + 0.0;  // −0 and 0 are one coordinate
          b[static_cast<std::size_t>(k)] = positions_(w, k) + 0.0;
        }
        if (b < a) std::swap(a, b);
        const std::size_t hash =
            std::hash<double>()(a[0] + 3 * a[1] + 7 * a[2] + 11 * b[0] + 13 * b[1] + 17 * b[2]);
        to[hash % static_cast<std::size_t>(comm_.size())].push_back(
            {{a[0], a[1], a[2], b[0], b[1], b[2]}, number(v)});
      }
    std::vector<Edge> edges;
    for (const auto& list : comm_.exchange(to)) edges.insert(edges.end(), list.begin(), list.end());
    std::sort(edges.begin(), edges.end());
    const auto twice = std::adjacent_find(edges.begin(), edges.end(),
                                          [](const Edge& a, const Edge& b) { return a.ends == b.ends; });
    comm_.together([&] {
      if (twice != edges.end())
        throw Error(facts::distributed::WeldNotDistributed{.vertex = twice->vertex}, location_ / "weld");
    });
  }

  const Communicator& comm_;
  const EditFile& edit_;
  const DeformStep& step_;
  const LocalMesh& mesh_;
  const Points& positions_;
  const Location& location_;
  Selections selections_;
  std::vector<int> role_;  ///< per local vertex
  Number handle_vertices_ = 0;
  ResolvedStep resolved_;
};

}  // namespace

ResolvedStep resolve_step(const Communicator& comm, const EditFile& edit, const DeformStep& step,
                          const LocalMesh& mesh, const Points& positions, Number face_count,
                          const Location& location) {
  return StepResolver(comm, edit, step, mesh, positions, location).resolve(face_count);
}

}  // namespace meshgraft::distributed
