#include "selections.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "components.h"
#include "core/facts.h"
#include "distributed/facts.h"
#include "io/file.h"
#include "io/selection_files.h"
#include "select/facts.h"

namespace meshgraft::distributed {

Selections::Selections(const Communicator& comm, const LocalMesh& mesh, const Points& positions,
                       const EditFile& edit)
    : comm_(comm), mesh_(mesh), positions_{.positions = positions}, geometry_(positions_), edit_(edit) {}

Flags Selections::resolve(const EditSelection& selection, const Location& location) {
  return std::visit([&](const auto& kind) { return found(kind, location); }, selection.kind);
}

Number Selections::count(const Flags& flags) const {
  return comm_.sum(std::count(flags.begin(), flags.begin() + mesh_.vertices.own(), std::uint8_t{1}));
}

std::string Selections::read(const std::string& file, const Location& location) const {
  std::string content;
  comm_.together([&] {
    if (comm_.rank() != 0) return;
    try {
      content = read_file(edit_.base_folder / file);
    } catch (const Error& error) {
      throw error.within(location);
    }
  });
  return comm_.broadcast(std::move(content));
}

Flags Selections::grow(Flags flags, Number rings) const {
  bool grew = true;
  for (Number ring = 0; ring < rings && comm_.any(grew); ++ring) {
    Flags wider = flags;
    for (Index v = 0; v < mesh_.vertices.own(); ++v)
      wider[v] |=
          std::any_of(mesh_.rings[v].begin(), mesh_.rings[v].end(), [&](Index w) { return flags[w] != 0; });
    mesh_.vertices.update(wider);
    grew = wider != flags;
    flags.swap(wider);
  }
  return flags;
}

Flags Selections::rim(const Flags& flags, Number rings) const {
  Flags outside(flags.size());
  for (std::size_t v = 0; v < flags.size(); ++v) outside[v] = !flags[v];
  Flags near_outside = grow(std::move(outside), rings);
  for (std::size_t v = 0; v < flags.size(); ++v) near_outside[v] = near_outside[v] && flags[v];
  return near_outside;
}

Flags Selections::flags_of(const std::vector<Index>& vertices) const {
  Flags flags(mesh_.vertices.size(), 0);
  for (const Index v : vertices) flags[v] = 1;
  return flags;
}

Flags Selections::by_position(const Selection& selection, const Location& location) const {
  return flags_of(meshgraft::resolve(selection, geometry_, location));
}

Flags Selections::found(const Selection::All&, const Location&) const {
  return Flags(mesh_.vertices.size(), 1);
}

Flags Selections::found(const Selection::Indices& indices, const Location& location) const {
  Flags flags(mesh_.vertices.size(), 0);
  const Number total = mesh_.vertices.total();
  for (std::size_t k = 0; k < indices.vertices.size(); ++k) {
    const Index v = indices.vertices[k];
    if (v < 0 || v >= total)
      throw Error(facts::core::NoSuchVertex{.vertex = v, .count = total}, (location / "indices")[k]);
    if (const Index local = mesh_.vertices.local(v); local >= 0) flags[local] = 1;
  }
  return flags;
}

/// Components are numbered in the order of their smallest vertices.
Flags Selections::found(const Selection::Component& component, const Location& location) const {
  const Index size = mesh_.vertices.size();
  Flags in_faces(size);
  std::vector<Number> names(size);
  for (Index v = 0; v < size; ++v) {
    in_faces[v] = !mesh_.faces_at[v].empty();
    names[v] = mesh_.vertices.number(v);
  }
  const std::vector<Number> labels = find_components(comm_, mesh_, in_faces, names);
  std::vector<Number> smallest;  // of the components that begin at this rank
  for (Index v = 0; v < mesh_.vertices.own(); ++v)
    if (labels[v] == names[v]) smallest.push_back(names[v]);
  const std::vector<Number> starts = comm_.starts(static_cast<Number>(smallest.size()));
  const Number count = starts.back(), wanted = component.number;
  if (count == 0) throw Error(facts::select::NoVertexWithFace{}, location / "component");
  if (wanted < 0 || wanted >= count)
    throw Error(facts::select::NoSuchComponent{.number = wanted, .count = count}, location / "component");
  const bool here = wanted >= starts[comm_.rank()] && wanted < starts[comm_.rank() + 1];
  const Number label = comm_.largest(here ? smallest[wanted - starts[comm_.rank()]] : Number{-1});
  Flags flags(size);
  for (Index v = 0; v < size; ++v) flags[v] = labels[v] == label;
  return flags;
}

/// Flags the local vertices on an edge with one face. Throws Error(input) on all ranks where other than two
/// such edges meet in a vertex, because loops cannot be told apart there without following the faces.
Flags Selections::boundary_vertices() const {
  Flags boundary(mesh_.vertices.size(), 0);
  comm_.together([&] {
    std::vector<Index> ends;
    for (Index v = 0; v < mesh_.vertices.own(); ++v) {
      ends.clear();
      for (const Index t : mesh_.faces_at[v])
        for (const Index w : mesh_.triangles.row(t))
          if (w != v) ends.push_back(w);
      std::sort(ends.begin(), ends.end());
      int edges = 0;
      for (std::size_t k = 0; k < ends.size(); ++k)
        edges += (k == 0 || ends[k - 1] != ends[k]) && (k + 1 == ends.size() || ends[k + 1] != ends[k]);
      boundary[v] = edges > 0;
      if (edges != 0 && edges != 2)
        throw Error(facts::distributed::LoopsTouch{.vertex = mesh_.vertices.number(v)});
    }
  });
  mesh_.vertices.update(boundary);
  return boundary;
}

/// Loops with the most vertices come first, equal ones by their smallest vertex. Two vertices of one loop are
/// neighbours along it only if their edge has one face.
Flags Selections::found(const Selection::Loop& loop, const Location& location) const {
  struct LoopSize {
    Number vertices, smallest;
  };
  LocalMesh boundary = mesh_;  // with the rings along boundary edges alone
  const Flags flagged = boundary_vertices();
  const Index size = mesh_.vertices.size();
  boundary.rings = {};
  for (Index v = 0; v < size; ++v) {
    for (const Index w : mesh_.rings[v]) {
      const auto faces = mesh_.faces_at[v];
      const auto shared = std::count_if(faces.begin(), faces.end(),
                                        [&](Index t) { return (mesh_.triangles.row(t).array() == w).any(); });
      if (flagged[v] && flagged[w] && shared == 1 && (v < mesh_.vertices.own() || w < mesh_.vertices.own()))
        boundary.rings.values.push_back(w);
    }
    boundary.rings.offsets.push_back(static_cast<Index>(boundary.rings.values.size()));
  }
  std::vector<Number> names(size);
  for (Index v = 0; v < size; ++v) names[v] = mesh_.vertices.number(v);
  const std::vector<Number> labels = find_components(comm_, boundary, flagged, names);
  std::map<Number, Number> own_counts;
  for (Index v = 0; v < mesh_.vertices.own(); ++v)
    if (labels[v] >= 0) ++own_counts[labels[v]];
  ByRank<LoopSize> to(comm_.size());
  for (const auto& [label, count] : own_counts)
    for (auto& list : to) list.push_back({count, label});
  std::map<Number, Number> counts;
  for (const auto& list : comm_.exchange(to))
    for (const LoopSize& part : list) counts[part.smallest] += part.vertices;
  std::vector<LoopSize> loops;
  for (const auto& [label, count] : counts) loops.push_back({count, label});
  std::sort(loops.begin(), loops.end(), [](const LoopSize& a, const LoopSize& b) {
    return std::tuple(-a.vertices, a.smallest) < std::tuple(-b.vertices, b.smallest);
  });
  if (loops.empty()) throw Error(facts::select::NoLoops{.number = loop.number}, location / "loop");
  if (loop.number < 0 || loop.number >= std::ssize(loops))
    throw Error(facts::select::NoSuchLoop{.number = loop.number, .count = std::ssize(loops)},
                location / "loop");
  Flags flags(size);
  for (Index v = 0; v < size; ++v) flags[v] = labels[v] == loops[loop.number].smallest;
  return flags;
}

Flags Selections::found(const Selection::NearestVertex& nearest, const Location& location) const {
  if (!nearest.point.allFinite())
    throw Error(facts::core::NotFinite{.what = facts::core::Quantity::coordinate}, location / "nearest");
  double best_distance = std::numeric_limits<double>::infinity();
  Number best = std::numeric_limits<Number>::max();
  for (Index v = 0; v < mesh_.vertices.own(); ++v) {
    const double distance = (positions_.positions.row(v).transpose() - nearest.point).norm();
    if (mesh_.faces_at[v].empty() || !(distance < best_distance)) continue;
    best_distance = distance;
    best = mesh_.vertices.number(v);
  }
  const double smallest = comm_.smallest(best_distance);
  if (!std::isfinite(smallest)) throw Error(facts::select::NoVertexWithFace{}, location / "nearest");
  best = comm_.smallest(best_distance == smallest ? best : std::numeric_limits<Number>::max());
  Flags flags(mesh_.vertices.size(), 0);
  if (const Index local = mesh_.vertices.local(best); local >= 0) flags[local] = 1;
  return flags;
}

namespace {

[[noreturn]] void refuse(const char* kind, const Location& location) {
  throw Error(facts::distributed::SelectionNotDistributed{.kind = kind}, location / kind);
}

}  // namespace

Flags Selections::found(const Selection::Path&, const Location& location) const { refuse("path", location); }
Flags Selections::found(const EditSelection::Mirror&, const Location& location) const {
  refuse("mirror", location);
}
Flags Selections::found(const EditSelection::Produced&, const Location& location) const {
  refuse("produced", location);
}

Flags Selections::found(const EditSelection::Named& named, const Location&) {
  if (const auto known = named_.find(named.name); known != named_.end()) return known->second;
  const auto definition = std::ranges::find(edit_.selections, named.name, &NamedSelection::name);
  const Location where = Location::file(edit_.location) / "selections" / Location::field(named.name);
  return named_[named.name] = resolve(definition->selection, where);
}

Flags Selections::found(const EditSelection::IndexFile& file, const Location& location) const {
  const std::vector<Index> indices =
      parse_indices(read(file.file, location), static_cast<Index>(mesh_.vertices.total()),
                    location / (edit_.base_folder / file.file));
  return found(Selection::Indices{indices}, location);
}

Flags Selections::found(const EditSelection::SelFile& file, const Location& location) const {
  SelRoles roles = parse_sel(read(file.file, location), static_cast<Index>(mesh_.vertices.total()),
                             location / (edit_.base_folder / file.file));
  switch (file.take) {
    case EditSelection::SelRole::fixed: return found(Selection::Indices{std::move(roles.fixed)}, location);
    case EditSelection::SelRole::free: return found(Selection::Indices{std::move(roles.free)}, location);
    case EditSelection::SelRole::handle: break;
  }
  return found(Selection::Indices{std::move(roles.handle)}, location);
}

Flags Selections::found(const EditSelection::Grow& spec, const Location& location) {
  Flags of = resolve(*spec.of, location / "grow" / "of");
  if (spec.rings >= 0) return grow(std::move(of), spec.rings);
  const Flags near_outside = rim(of, -Number{spec.rings});
  for (std::size_t v = 0; v < of.size(); ++v) of[v] = of[v] && !near_outside[v];
  return of;
}

/// Relaxes distances along edges until no rank finds a shorter one.
Flags Selections::found(const EditSelection::GrowLength& spec, const Location& location) {
  if (!std::isfinite(spec.length) || spec.length < 0)
    throw Error(facts::core::NegativeOrNotFinite{.value = spec.length}, location / "grow_length" / "length");
  const Flags of = resolve(*spec.of, location / "grow_length" / "of");
  const Points& p = positions_.positions;
  std::vector<double> distance(of.size());
  for (std::size_t v = 0; v < of.size(); ++v) distance[v] = of[v] ? 0 : std::numeric_limits<double>::infinity();
  for (bool changed = true; comm_.any(changed);) {
    changed = false;
    std::vector<Index> queue;
    for (Index v = 0; v < mesh_.vertices.size(); ++v)
      if (std::isfinite(distance[v])) queue.push_back(v);
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const Index v = queue[next];
      for (const Index w : mesh_.rings[v]) {
        const double reached = distance[v] + (p.row(w) - p.row(v)).norm();
        if (!(reached <= spec.length) || !(reached < distance[w]) || w >= mesh_.vertices.own()) continue;
        distance[w] = reached;
        queue.push_back(w);
        changed = true;
      }
    }
    mesh_.vertices.update(distance);
  }
  Flags flags(of.size());
  for (std::size_t v = 0; v < of.size(); ++v) flags[v] = std::isfinite(distance[v]);
  return flags;
}

Flags Selections::found(const EditSelection::Union& combined, const Location& location) {
  Flags flags(mesh_.vertices.size(), 0);
  for (std::size_t k = 0; k < combined.of.size(); ++k) {
    const Flags of = resolve(combined.of[k], (location / "union")[k]);
    for (std::size_t v = 0; v < flags.size(); ++v) flags[v] |= of[v];
  }
  return flags;
}

Flags Selections::found(const EditSelection::Intersect& combined, const Location& location) {
  Flags flags(mesh_.vertices.size(), 1);
  for (std::size_t k = 0; k < combined.of.size(); ++k) {
    const Flags of = resolve(combined.of[k], (location / "intersect")[k]);
    for (std::size_t v = 0; v < flags.size(); ++v) flags[v] = flags[v] && of[v];
  }
  return flags;
}

Flags Selections::found(const EditSelection::Minus& combined, const Location& location) {
  if (combined.of.empty()) throw Error(facts::select::NoSelection{}, location / "minus");
  Flags flags = resolve(combined.of[0], (location / "minus")[0]);
  for (std::size_t k = 1; k < combined.of.size(); ++k) {
    const Flags of = resolve(combined.of[k], (location / "minus")[k]);
    for (std::size_t v = 0; v < flags.size(); ++v) flags[v] = flags[v] && !of[v];
  }
  return flags;
}

Flags Selections::found(const EditSelection::Rim& spec, const Location& location) {
  if (spec.rings < 1) throw Error(facts::select::NoRings{}, location / "rim" / "rings");
  return rim(resolve(*spec.of, location / "rim" / "of"), spec.rings);
}

}  // namespace meshgraft::distributed
