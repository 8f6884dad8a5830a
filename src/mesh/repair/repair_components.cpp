// Repair of whole connected components: those that lie on another one, and floating debris.

#include <algorithm>
#include <map>
#include <numeric>

#include "mesh/coincident.h"
#include "mesh/face_keys.h"
#include "mesh/facts.h"
#include "repair_surface.h"

namespace meshgraft {

ConnectedComponents components_of(const RepairSurface& surface) {
  DisjointSets sets(surface.mesh().vertex_count());
  for (const auto& ends : surface.edges().ends) sets.unite(ends[0], ends[1]);
  ConnectedComponents components;
  const Index vertices = surface.mesh().vertex_count();
  std::vector<Index> number(static_cast<std::size_t>(vertices) + 1, -1);  // last: faces without corners
  for (Index f = 0; f < surface.faces().size(); ++f) {
    const auto face = surface.faces()[f];
    Index& component = number[face.empty() ? vertices : sets.root(face[0])];
    if (component < 0) {
      component = static_cast<Index>(components.faces.size());
      components.faces.push_back(0);
      components.area.push_back(0);
    }
    components.of_face.push_back(component);
    ++components.faces[component];
    components.area[component] += surface.face_area(f);
  }
  return components;
}

namespace {

bool remove_components(RepairSurface& surface, const ConnectedComponents& components, const Flags& doomed,
                       RepairChangeKind kind) {
  const auto count = static_cast<Index>(std::count(doomed.begin(), doomed.end(), 1));
  if (count == 0) return false;
  Flags faces(components.of_face.size());
  std::vector<Index> given;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    faces[f] = doomed[components.of_face[f]];
    if (faces[f] && !surface.traced().is_new[f]) given.push_back(surface.traced().origin[f]);
  }
  surface.report(kind, Domain::face, std::move(given), count);
  surface.remove_faces(faces);
  return true;
}

}  // namespace

bool remove_duplicate_shells(RepairSurface& surface) {
  if (surface.faces().size() == 0) return false;
  const ConnectedComponents components = components_of(surface);
  if (components.faces.size() < 2) return false;
  std::vector<Index> all(surface.mesh().vertex_count());
  std::iota(all.begin(), all.end(), 0);
  const std::vector<Index> representative = coincident_classes(surface.positions(), all);
  const auto groups = same_faces(surface.faces(), surface.mesh().vertex_count(), representative);
  if (groups.empty()) return false;
  std::vector<std::vector<Index>> groups_of(components.faces.size());
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (const Index f : groups[g]) groups_of[components.of_face[f]].push_back(static_cast<Index>(g));

  // Larger components first: one is removed if each of its faces lies on a face of a component that stays.
  std::vector<Index> order(components.faces.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return components.faces[a] > components.faces[b]; });
  Flags covered(groups.size(), 0), doomed(components.faces.size(), 0);
  for (const Index component : order) {
    const auto& own = groups_of[component];
    const auto lying = std::count_if(own.begin(), own.end(), [&](Index g) { return covered[g] != 0; });
    if (lying == components.faces[component])
      doomed[component] = 1;
    else
      for (const Index g : own) covered[g] = 1;
  }
  return remove_components(surface, components, doomed, RepairChangeKind::removed_duplicate_shell);
}

bool remove_debris(RepairSurface& surface, double debris_rel) {
  if (surface.faces().size() == 0) return false;
  const ConnectedComponents components = components_of(surface);
  const double most_faces = *std::max_element(components.faces.begin(), components.faces.end());
  const double largest_area = *std::max_element(components.area.begin(), components.area.end());
  Flags doomed(components.faces.size(), 0);
  for (std::size_t component = 0; component < doomed.size(); ++component)
    doomed[component] = components.faces[component] < debris_rel * most_faces &&
                        components.area[component] < debris_rel * largest_area;
  return remove_components(surface, components, doomed, RepairChangeKind::removed_debris);
}

}  // namespace meshgraft
