#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "document.h"
#include "io/charged.h"
#include "threemf.h"
#include "threemf/facts.h"

namespace meshgraft::io {

namespace {

// Returns whether the vertices agree up to a tolerance. lib3mf parses them as floats by arithmetic of its own.
bool same_vertices(const ThreemfVertices& vertices, const ThreemfModel::Object& object) {
  if (vertices.positions.rows() != static_cast<Eigen::Index>(object.vertices.size())) return false;
  if (object.vertices.empty()) return true;
  constexpr double tolerance_rel = 1e-6;
  const double tolerance = tolerance_rel * vertices.positions.cwiseAbs().maxCoeff();
  for (std::size_t v = 0; v < object.vertices.size(); ++v)
    for (std::size_t k = 0; k < 3; ++k) {
      const double exact = vertices.positions(static_cast<Eigen::Index>(v), static_cast<Eigen::Index>(k));
      if (!(std::abs(exact - static_cast<double>(object.vertices[v][k])) <= tolerance)) return false;
    }
  return true;
}

/// Finds the part and the mesh in which each object is written. lib3mf does not tell the part of an object.
/// It reads the parts that are referred to first, then the part with the build, each in its order.
///
/// Returns an empty list if an object is not found, or if unmatched meshes in two referenced parts have the
/// same vertices.
std::vector<ThreemfDocument::Source> match(const std::vector<ThreemfPart>& parts,
                                           const std::vector<ThreemfModel::Object>& objects) {
  std::vector<std::size_t> order(parts.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_partition(order, [&](std::size_t p) { return parts[p].items.empty(); });
  std::vector<Flags> taken;
  for (const ThreemfPart& part : parts) taken.emplace_back(part.meshes.size(), false);

  const auto find_in = [&](std::size_t p, const ThreemfModel::Object& object) -> std::optional<std::size_t> {
    for (std::size_t m = 0; m < parts[p].meshes.size(); ++m)
      if (!taken[p][m] && same_vertices(parts[p].meshes[m], object)) return m;
    return std::nullopt;
  };
  std::vector<ThreemfDocument::Source> sources;
  for (const ThreemfModel::Object& object : objects) {
    std::optional<ThreemfDocument::Source> found;
    for (const std::size_t p : order) {
      const bool is_root = !parts[p].items.empty();
      if (found && is_root) break;
      const auto mesh = find_in(p, object);
      if (mesh && found) return {};
      if (mesh) found = {p, *mesh};
    }
    if (!found) return {};
    taken[found->part][found->mesh] = true;
    sources.push_back(*found);
  }
  return sources;
}

/// Counts the copies that a build makes. A few nested components can name more copies than any machine can
/// hold, and lib3mf would walk through all of them.
class CopyCounter {
 public:
  CopyCounter(const std::vector<PackagePart>& parts, const std::vector<ThreemfPart>& scanned) {
    for (std::size_t p = 0; p < parts.size(); ++p) scanned_["/" + parts[p].name] = &scanned[p];
  }

  double copies() {
    double sum = 0;
    for (const auto& [path, part] : scanned_)
      for (const ThreemfReference& item : part->items) sum += copies_of(path, item, 0);
    return sum;
  }

 private:
  double copies_of(const std::string& path, const ThreemfReference& reference, int depth) {
    constexpr int deepest = 32;
    if (depth > deepest) throw Error(facts::threemf::ComponentsTooDeep{.deepest = deepest});
    const std::string& own = reference.path.empty() ? path : reference.path;
    const auto known = copies_.find({own, reference.id});
    if (known != copies_.end()) return known->second;
    double sum = 1;
    const auto part = scanned_.find(own);
    if (part != scanned_.end())
      if (const auto object = part->second->components.find(reference.id);
          object != part->second->components.end())
        for (const ThreemfReference& component : object->second) sum += copies_of(own, component, depth + 1);
    return copies_[{own, reference.id}] = sum;
  }

  std::map<std::string, const ThreemfPart*> scanned_;
  std::map<std::pair<std::string, std::string>, double> copies_;
};

void require_sensible_build(const ThreemfDocument& document, const std::string& name) try {
  constexpr int most = 10'000;  // lib3mf's time grows with the square
  if (CopyCounter(document.parts, document.scanned).copies() > most)
    throw Error(facts::threemf::BuildTooLarge{.what = facts::threemf::Content::copies, .most = most});
} catch (const Error& error) {
  throw error.within(Location::file(name));
}

/// Composes one mesh from the placed objects.
class Assembler {
 public:
  Assembler(const ThreemfModel& model, const ThreemfDocument& document, MemoryBudget& budget)
      : model_(model), document_(document), budget_(budget) {}

  Mesh assemble() {
    add_attributes();
    reserve();
    for (std::size_t p = 0; p < model_.placements.size(); ++p) add(p);
    return std::move(mesh_);
  }

 private:
  void reserve() {
    std::size_t vertices = 0, triangles = 0;
    for (const auto& placement : model_.placements) {
      vertices += model_.objects[placement.object].vertices.size();
      triangles += model_.objects[placement.object].triangles.size();
    }
    resize_charged(mesh_.positions, vertices, budget_);
    reserve_charged(mesh_.faces, triangles, 3 * triangles, budget_);
    if (has_objects_) reserve_charged(objects_->values, triangles, budget_);
    if (has_materials_) reserve_charged(materials_->values, triangles, budget_);
    if (has_colours_) reserve_charged(colours_->values, 12 * triangles, budget_);
  }

  template <class Has>
  bool any_object(const Has& has) const {
    return std::ranges::any_of(model_.placements, [&](const auto& p) { return has(model_.objects[p.object]); });
  }

  void add_attributes() {
    has_objects_ = model_.placements.size() > 1;
    has_materials_ = any_object([](const auto& object) { return !object.materials.empty(); });
    has_colours_ = any_object([](const auto& object) { return !object.colours.empty(); });
    // Pointers into the list are taken below, so it must not grow.
    mesh_.attributes.reserve(3);
    if (has_objects_)
      objects_ = &mesh_.attributes.emplace_back(Attribute{.name = "object",
                                                          .domain = Domain::face,
                                                          .interpolation = Interpolation::nearest,
                                                          .type = ScalarType::int32});
    if (has_materials_)
      materials_ = &mesh_.attributes.emplace_back(Attribute{.name = "material",
                                                            .domain = Domain::face,
                                                            .interpolation = Interpolation::nearest,
                                                            .type = ScalarType::int32,
                                                            .labels = model_.material_names});
    if (has_colours_)
      colours_ = &mesh_.attributes.emplace_back(
          Attribute{.name = "colour", .domain = Domain::corner, .type = ScalarType::uint8, .components = 4});
  }

  void add(std::size_t number) {
    const ThreemfModel::Placement& placement = model_.placements[number];
    const ThreemfModel::Object& object = model_.objects[placement.object];
    const Index first = next_vertex_;
    // A mirroring transform reverses the orientation of the triangles.
    const bool is_mirrored = placement.transform.linear().determinant() < 0;
    const std::array<std::size_t, 3> corners =
        is_mirrored ? std::array<std::size_t, 3>{0, 2, 1} : std::array<std::size_t, 3>{0, 1, 2};
    for (std::size_t v = 0; v < object.vertices.size(); ++v)
      mesh_.positions.row(next_vertex_++) = placed(placement.transform, position(placement.object, v));
    for (std::size_t t = 0; t < object.triangles.size(); ++t) {
      std::array<Index, 3> face;
      for (std::size_t c = 0; c < 3; ++c) face[c] = first + static_cast<Index>(object.triangles[t][corners[c]]);
      mesh_.faces.push_back(face);
      if (has_objects_) objects_->values.push_back(static_cast<double>(number));
      if (has_materials_) materials_->values.push_back(material_of(object, t));
      if (has_colours_) add_colour(object, t, corners);
    }
    if (has_objects_) objects_->labels.push_back(label(object, number));
  }

  Eigen::RowVector3d position(std::size_t object, std::size_t vertex) const {
    if (!document_.sources.empty())
      return document_.vertices(object).positions.row(static_cast<Eigen::Index>(vertex));
    const auto& v = model_.objects[object].vertices[vertex];
    return {v[0], v[1], v[2]};
  }

  static double material_of(const ThreemfModel::Object& object, std::size_t triangle) {
    const std::int32_t material = object.materials.empty() ? ThreemfModel::none : object.materials[triangle];
    return material == ThreemfModel::none ? std::nan("") : material;
  }

  void add_colour(const ThreemfModel::Object& object, std::size_t triangle,
                  const std::array<std::size_t, 3>& corners) {
    for (const std::size_t c : corners)
      for (std::size_t k = 0; k < 4; ++k)
        colours_->values.push_back(object.colours.empty() ? 255 : object.colours[triangle][4 * c + k]);
  }

  std::string label(const ThreemfModel::Object& object, std::size_t number) {
    const std::string name = object.name.empty() ? "object" : object.name;
    const std::string numbered = fmt::format("{}_{}", name, number + 1);
    const bool takes_number = object.name.empty() || labels_.contains(name);
    return *labels_.insert(takes_number ? numbered : name).first;
  }

  const ThreemfModel& model_;
  const ThreemfDocument& document_;
  MemoryBudget& budget_;
  Mesh mesh_;
  Index next_vertex_ = 0;
  std::set<std::string> labels_;
  bool has_objects_ = false, has_materials_ = false, has_colours_ = false;
  Attribute *objects_ = nullptr, *materials_ = nullptr, *colours_ = nullptr;
};

/// The memory of lib3mf per vertex, triangle and object, such that the whole count meets the measured peak of
/// sheets of a million triangles within an eighth.
constexpr std::uint64_t bytes_of_vertex = 40, bytes_of_triangle = 60, bytes_of_object = 4096;
/// The memory of a vertex and a triangle in the model that is read.
constexpr std::uint64_t bytes_of_read_vertex = 12, bytes_of_read_triangle = 12 + 4 + 12;

/// Reads the model by lib3mf. Charges the memory of lib3mf, which is free again when this returns, and that of
/// the result.
ThreemfModel read_model(const ThreemfDocument& document, const std::string& name, MemoryBudget& budget,
                        const Context& context) {
  std::uint64_t vertices = 0, triangles = 0, objects = 0;
  for (const ThreemfPart& part : document.scanned) {
    objects += part.meshes.size() + part.components.size() + part.items.size();
    triangles += part.triangles;
    for (const ThreemfVertices& mesh : part.meshes) vertices += mesh.tag_begin.size();
  }
  budget.charge(vertices * bytes_of_read_vertex + triangles * bytes_of_read_triangle);
  const std::uint64_t of_lib3mf =
      vertices * bytes_of_vertex + triangles * bytes_of_triangle + objects * bytes_of_object;
  budget.charge(of_lib3mf);
  ThreemfModel model = read_threemf_model(document.package, name, context);
  budget.release(of_lib3mf);
  return model;
}

}  // namespace

std::vector<Note> ThreemfDocument::beside_the_mesh() const {
  std::vector<Note> notes = {facts::threemf::PackageLeftOut{.file = path.filename()}};
  if (unplaced > 0) notes.push_back(facts::threemf::ObjectsLeftOut{.file = path.filename(), .count = unplaced});
  return notes;
}

Mesh read_threemf(std::string content, const std::string& name, MemoryBudget& budget, const Context& context) {
  auto document = std::make_shared<ThreemfDocument>();
  document->path = name;
  document->package = std::move(content);
  document->parts = model_parts(document->package, name, budget, context);
  context.step("read", 0.2);
  for (const PackagePart& part : document->parts) {
    document->scanned.push_back(
        scan_part(part.content, fmt::format("{}, {}", name, part.name), budget, context));
    context.throw_if_stopped();
  }
  require_sensible_build(*document, name);
  context.step("read", 0.5);
  const ThreemfModel model = read_model(*document, name, budget, context);
  if (std::ranges::none_of(document->parts,
                           [](const PackagePart& part) { return has_utf16_mark(part.content); }))
    document->sources = match(document->scanned, model.objects);
  document->length_unit = model.unit;
  document->placements = model.placements;
  Flags used(model.objects.size(), false);
  for (const ThreemfModel::Placement& placement : model.placements) used[placement.object] = true;
  document->unplaced = static_cast<std::size_t>(std::ranges::count(used, false));

  context.throw_if_stopped();
  Mesh mesh = Assembler(model, *document, budget).assemble();
  context.throw_if_stopped();
  document->remember_topology(mesh);
  mesh.source = std::move(document);
  return mesh;
}

}  // namespace meshgraft::io
