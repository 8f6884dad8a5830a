#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <meshgraft/core/error.h>

#include "core/memory_budget.h"
#include "document.h"
#include "gltf.h"
#include "gltf/facts.h"
#include "io/charged.h"
#include "io/check_interval.h"
#include "io/facts.h"
#include "io/number_text.h"

namespace meshgraft::io {

namespace {

/// Extensions that change the triangles. A file that requires any other extension may still be edited.
constexpr std::array<std::string_view, 5> geometry_extensions = {
    "KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression",
    "EXT_mesh_gpu_instancing", "KHR_gaussian_splatting"};

void require_known_geometry(const JsonView& root) {
  const auto required = root.find("extensionsRequired");
  if (!required) return;
  for (std::size_t i = 0; i < required->size(); ++i) {
    const std::string extension = required->at(i).text();
    if (std::ranges::find(geometry_extensions, extension) != geometry_extensions.end())
      required->at(i).fail(facts::gltf::ExtensionNotRead{.extension = extension});
  }
}

void require_version(const JsonView& root) {
  const JsonView version = root.at("asset").at("version");
  if (!version.text().starts_with("2.")) version.fail(facts::gltf::UnknownVersion{.version = version.text()});
}

struct PositionHash {
  std::size_t operator()(const std::array<double, 3>& p) const {
    std::size_t hash = 0;
    for (const double x : p) hash = hash * 0x9E3779B97F4A7C15ULL + std::hash<double>{}(x) + (hash >> 29);
    return hash;
  }
};

/// Builds a mesh from the nodes of the default scene. The triangles are in world space. Vertices of one node
/// at exactly the same position become one vertex. All other attributes are read per corner.
class GltfReader {
 public:
  GltfReader(std::string content, const std::string& name, MemoryBudget& budget, const Context& context)
      : name_(name), context_(context), budget_(budget), document_(std::make_shared<GltfDocument>()) {
    document_->path = name;
    document_->content = std::move(content);
  }

  Mesh read() {
    open();
    for (GltfInstance& instance : document_->instances) read_instance(instance);
    context_.throw_if_stopped();
    fill_positions();
    context_.throw_if_stopped();
    mark_out_of_range();
    context_.throw_if_stopped();
    read_attributes();
    read_labels();
    context_.throw_if_stopped();
    document_->remember_topology(mesh_);
    context_.throw_if_stopped();
    mesh_.source = std::move(document_);
    return std::move(mesh_);
  }

 private:
  void open() {
    GltfDocument& document = *document_;
    document.is_glb = has_glb_signature(document.content);
    if (document.is_glb) document.layout = parse_glb(document.content, name_);
    document.json = parse_gltf_json(document.json_text(), name_, &budget_);
    const JsonView root = view();
    require_version(root);
    require_known_geometry(root);
    document.buffers = load_buffers(root, document.layout, budget_);
    bytes_ = document.bytes();
    const std::size_t named = root.count("nodes") + root.count("meshes") + root.count("materials");
    budget_.charge(named * (3 * sizeof(GltfInstance) + bytes_of_label));
    document.instances = instances_of(root);
    reserve();
  }

  /// Reserves memory for the corners, which are counted first. Refuses files that show too many triangles, and
  /// those whose attributes exceed the budget. A small file can show one mesh any number of times.
  void reserve() {
    constexpr std::uint64_t most_corners = 300'000'000;
    std::map<std::size_t, std::uint64_t> corners_of_mesh;
    std::map<std::string, std::size_t> components_of;  // of attributes
    std::uint64_t corners = 0;
    for (const GltfInstance& instance : document_->instances) {
      const auto [known, is_new] = corners_of_mesh.try_emplace(instance.mesh, 0);
      if (is_new)
        known->second = corners_of(view().at("meshes").at(instance.mesh).at("primitives"), components_of);
      corners += known->second;
    }
    if (corners > most_corners) view().fail(facts::gltf::TooManyTriangles{.millions = corners / 3'000'000});
    std::uint64_t values = 0;
    for (const auto& [attribute, components] : components_of) values += components;
    budget_.require(corners * (sizeof(double) * values + 2 * sizeof(Index)));
    const auto count = static_cast<std::size_t>(corners);
    reserve_charged(mesh_.faces, count / 3, count, budget_);
    reserve_charged(document_->corner_elements, count, budget_);
  }

  /// Counts the corners of primitives, and adds their attributes to `components_of`.
  std::uint64_t corners_of(const JsonView& primitives, std::map<std::string, std::size_t>& components_of) {
    std::uint64_t corners = 0;
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const JsonView primitive = primitives.at(p);
      const auto positions = primitive.at("attributes").find("POSITION");
      if (!has_triangles(primitive.json()) || !positions) continue;
      const auto indices = primitive.find("indices");
      const std::size_t elements = accessor(accessor_index(*positions)).count;
      const std::uint64_t count = indices ? accessor(accessor_index(*indices)).count : elements;
      corners += primitive.whole("mode", 4) == 4 ? count : 3 * count;
      const JsonView attributes = primitive.at("attributes");
      for (const auto& member : attributes.json().items()) {
        const auto channel = channel_of(member.key());
        if (!channel || channel->attribute.empty()) continue;
        std::size_t& components = components_of[channel->attribute];
        components = std::max(components, accessor(accessor_index(attributes.at(member.key()))).components);
      }
    }
    return corners;
  }

  JsonView view() const { return JsonView(document_->json, "", name_); }

  void read_instance(GltfInstance& instance) {
    const JsonView primitives = view().at("meshes").at(instance.mesh).at("primitives");
    forget_welded();
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      const JsonView primitive = primitives.at(p);
      const JsonView attributes = primitive.at("attributes");
      if (const auto mode = primitive.find("mode"); mode && mode->whole() > 6)
        mode->fail(facts::gltf::UnknownConstant{.value = std::to_string(mode->whole())});
      const auto positions = attributes.find("POSITION");
      if (!has_triangles(primitive.json()) || !positions) continue;
      if (const auto extensions = primitive.find("extensions"))
        if (extensions->find("KHR_draco_mesh_compression"))
          primitive.fail(facts::gltf::Compressed{.extension = "KHR_draco_mesh_compression"});
      budget_.charge(2 * (sizeof(GltfPart) + sizeof(GltfElementMap)));
      GltfPart part{p, map_of(instance, accessor_index(*positions)), mesh_.faces.corner_count(), 0};
      read_triangles(primitive, instance, part);
      part.corner_count = mesh_.faces.corner_count() - part.first_corner;
      instance.parts.push_back(part);
    }
  }

  std::size_t accessor_index(const JsonView& reference) const {
    return reference.index(view().count("accessors"), "accessors");
  }

  const GltfAccessor& accessor(std::size_t index) {
    const auto known = accessors_.find(index);
    if (known != accessors_.end()) return known->second;
    return accessors_.emplace(index, resolve_accessor(view(), index, bytes_, &budget_)).first->second;
  }

  const GltfAccessor& accessor(const JsonView& reference, std::size_t components) {
    const GltfAccessor& found = accessor(accessor_index(reference));
    if (found.components != components)
      reference.fail(facts::gltf::WrongSize{
          .what = facts::gltf::Quantity::components, .given = found.components, .needed = components});
    return found;
  }

  static std::size_t map_of(GltfInstance& instance, std::size_t accessor) {
    const auto known = std::ranges::find(instance.maps, accessor, &GltfElementMap::accessor);
    if (known == instance.maps.end()) instance.maps.push_back({accessor, {}});
    return static_cast<std::size_t>(std::ranges::find(instance.maps, accessor, &GltfElementMap::accessor) -
                                    instance.maps.begin());
  }

  void read_triangles(const JsonView& primitive, GltfInstance& instance, const GltfPart& part) {
    const GltfAccessor& positions = accessor(primitive.at("attributes").at("POSITION"), 3);
    GltfElementMap& map = instance.maps[part.map];
    resize_charged(map.vertex, positions.count, Index{-1}, budget_);
    const GltfAccessor* indices = nullptr;
    if (const auto reference = primitive.find("indices")) {
      indices = &accessor(*reference, 1);
      if (!is_index_type(indices->type) || indices->normalized)
        reference->fail(facts::gltf::NotForIndices{.what = facts::gltf::Storage::accessor});
    }
    const std::size_t count = indices != nullptr ? indices->count : positions.count;
    const std::uint64_t mode = primitive.whole("mode", 4);
    const std::size_t triangles = mode == 4 ? count / 3 : count < 3 ? 0 : count - 2;
    constexpr auto most_corners = static_cast<std::size_t>(std::numeric_limits<Index>::max());
    if (triangles > (most_corners - document_->corner_elements.size()) / 3)
      primitive.fail(facts::io::TooMany{.elements = facts::io::Elements::corners, .most = most_corners});
    const auto element = [&](std::size_t i) {
      return indices != nullptr ? static_cast<std::size_t>(load_component(*indices, i, 0, bytes_)) : i;
    };
    for (std::size_t t = 0; t < triangles; ++t) {
      if (t % elements_per_check == 0) context_.throw_if_stopped();
      std::array<std::size_t, 3> corners = {element(t), element(t + 1), element(t + 2)};
      if (mode == 4) corners = {element(3 * t), element(3 * t + 1), element(3 * t + 2)};
      if (mode == 5 && t % 2 == 1) std::swap(corners[1], corners[2]);
      if (mode == 6) corners = {element(0), element(t + 1), element(t + 2)};
      // Triangles without area join the pieces of a strip.
      const bool joins_strips =
          mode != 4 && (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]);
      if (joins_strips) continue;
      if (instance.placement.mirrors()) std::swap(corners[1], corners[2]);
      add_triangle(corners, positions, instance.placement, map);
    }
  }

  void add_triangle(const std::array<std::size_t, 3>& elements, const GltfAccessor& positions,
                    const GltfPlacement& placement, GltfElementMap& map) {
    std::array<Index, 3> face{};
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t element = elements[k];
      if (element >= positions.count) {
        face[k] = std::numeric_limits<Index>::max();  // reported by check_mesh
        push_charged(document_->corner_elements, no_element, budget_);
        continue;
      }
      if (map.vertex[element] < 0)
        map.vertex[element] = weld(load_value(positions, element, bytes_), placement);
      face[k] = map.vertex[element];
      push_charged(document_->corner_elements, static_cast<std::uint32_t>(element), budget_);
    }
    push_charged(mesh_.faces, face, budget_);
  }

  Index weld(const GltfValue& local, const GltfPlacement& placement) {
    const std::array<double, 3> key = {local[0] + 0.0, local[1] + 0.0, local[2] + 0.0};  // turns -0 into 0
    const auto next = static_cast<Index>(vertices_.size() / 3);
    const bool is_finite = std::isfinite(key[0]) && std::isfinite(key[1]) && std::isfinite(key[2]);
    const auto [entry, is_new] = is_finite ? welded_.try_emplace(key, next) : std::pair(welded_.end(), true);
    if (is_new) {
      if (is_finite && (welded_.size() - 1) % entries_per_charge == 0)
        budget_.charge(entries_per_charge * bytes_of_entry);
      make_room(vertices_, 3, budget_);
      const GltfValue world = placement.to_mesh(GltfChannel::Kind::position, local);
      vertices_.insert(vertices_.end(), world.begin(), world.begin() + 3);
    }
    return is_new ? next : entry->second;
  }

  void forget_welded() {
    budget_.release((welded_.size() + entries_per_charge - 1) / entries_per_charge * entries_per_charge *
                    bytes_of_entry);
    welded_ = {};
  }

  void fill_positions() {
    forget_welded();
    const std::size_t count = vertices_.size() / 3;
    resize_charged(mesh_.positions, count, budget_);
    mesh_.positions = Eigen::Map<const Points>(vertices_.data(), static_cast<Eigen::Index>(count), 3);
    free_charged(vertices_, budget_);
  }

  /// Refuses so many vertices that the marker of an index out of range would be a valid index.
  void mark_out_of_range() const {
    constexpr Index marker = std::numeric_limits<Index>::max();
    if (mesh_.vertex_count() == marker)
      view().fail(facts::io::TooMany{.elements = facts::io::Elements::vertices, .most = marker - 1});
  }

  // --- attributes ---

  void read_attributes() {
    for (const GltfInstance& instance : document_->instances) {
      for (const GltfPart& part : instance.parts) {
        const JsonView attributes = primitive_of(instance, part).at("attributes");
        if (!attributes.json().is_object())
          attributes.fail(facts::gltf::WrongType{.needed = facts::gltf::Type::object});
        for (const auto& member : attributes.json().items())
          if (const auto channel = channel_of(member.key()); channel && !channel->attribute.empty())
            read_channel(*channel, attributes.at(member.key()), instance, part);
      }
    }
    for (auto& [name, attribute] : corner_attributes_)
      if (!move_to_vertices(attribute)) mesh_.attributes.push_back(std::move(attribute));
  }

  JsonView primitive_of(const GltfInstance& instance, const GltfPart& part) const {
    return view().at("meshes").at(instance.mesh).at("primitives").at(part.primitive);
  }

  static std::pair<std::size_t, std::size_t> allowed_components(const GltfChannel& channel) {
    if (channel.kind == GltfChannel::Kind::normal) return {3, 3};
    if (channel.kind == GltfChannel::Kind::tangent) return {4, 4};
    if (channel.kind == GltfChannel::Kind::uv) return {2, 2};
    if (channel.attribute.starts_with("colour")) return {3, 4};
    return {1, 4};
  }

  void read_channel(const GltfChannel& channel, const JsonView& reference, const GltfInstance& instance,
                    const GltfPart& part) {
    const GltfAccessor& values = accessor(accessor_index(reference));
    const auto [least, most] = allowed_components(channel);
    if (values.components < least || values.components > most)
      reference.fail(facts::gltf::WrongSize{
          .what = facts::gltf::Quantity::components, .given = values.components, .needed = most});
    Attribute& attribute = corner_attribute(channel, values.components);
    const auto components = static_cast<std::size_t>(attribute.components);
    for (Index c = part.first_corner; c < part.first_corner + part.corner_count; ++c) {
      const std::uint32_t element = document_->corner_elements[c];
      if (element == no_element || element >= values.count) continue;
      GltfValue value = instance.placement.to_mesh(channel.kind, load_value(values, element, bytes_));
      if (values.components == 3 && components == 4) value[3] = 1;  // opaque
      std::copy_n(
          value.begin(), std::min<std::size_t>(components, 4),
          attribute.values.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(c) * components));
    }
  }

  /// Returns the corner attribute of a channel. Widens it if this primitive has more components than earlier
  /// ones.
  Attribute& corner_attribute(const GltfChannel& channel, std::size_t components) {
    const auto corners = static_cast<std::size_t>(mesh_.faces.corner_count());
    const auto [entry, is_new] = corner_attributes_.try_emplace(channel.attribute);
    Attribute& attribute = entry->second;
    if (is_new) {
      attribute.name = channel.attribute;
      attribute.domain = Domain::corner;
      const bool is_direction = channel.kind == GltfChannel::Kind::normal;
      if (is_direction) attribute.interpolation = Interpolation::direction;
      attribute.type = channel.kind == GltfChannel::Kind::uv ? ScalarType::float64 : ScalarType::float32;
      attribute.components = static_cast<int>(components);
      resize_charged(attribute.values, corners * components, no_value, budget_);
    } else if (static_cast<std::size_t>(attribute.components) < components) {
      const auto old_components = static_cast<std::size_t>(attribute.components);
      std::vector<double> wide;
      resize_charged(wide, corners * components, no_value, budget_);
      for (std::size_t c = 0; c < corners; ++c) {
        for (std::size_t k = 0; k < old_components; ++k)
          wide[c * components + k] = attribute.values[c * old_components + k];
        if (!std::isnan(wide[c * components]))
          std::fill_n(wide.begin() + static_cast<std::ptrdiff_t>(c * components + old_components),
                      components - old_components, 1.0);
      }
      free_charged(attribute.values, budget_);
      attribute.values = std::move(wide);
      attribute.components = static_cast<int>(components);
    }
    return attribute;
  }

  /// Moves the attribute to the vertices if the corners of each vertex agree, so that there is no seam.
  /// Otherwise returns false.
  bool move_to_vertices(Attribute& of_corners) {
    const auto components = static_cast<std::size_t>(of_corners.components);
    std::vector<double> values;
    Flags seen;
    resize_charged(values, static_cast<std::size_t>(mesh_.vertex_count()) * components, no_value, budget_);
    resize_charged<std::uint8_t>(seen, static_cast<std::size_t>(mesh_.vertex_count()), false, budget_);
    const bool agree = values_per_vertex(of_corners, values, seen);
    free_charged(seen, budget_);
    free_charged(agree ? of_corners.values : values, budget_);
    if (!agree) return false;
    of_corners.domain = Domain::vertex;
    of_corners.values = std::move(values);
    mesh_.attributes.push_back(std::move(of_corners));
    return true;
  }

  bool values_per_vertex(const Attribute& of_corners, std::vector<double>& values, Flags& seen) const {
    const auto components = static_cast<std::size_t>(of_corners.components);
    const std::vector<Index>& corners = mesh_.faces.corners();
    for (std::size_t c = 0; c < corners.size(); ++c) {
      if (corners[c] >= mesh_.vertex_count()) continue;
      const auto v = static_cast<std::size_t>(corners[c]);
      for (std::size_t k = 0; k < components; ++k) {
        const double value = of_corners.values[c * components + k];
        double& kept = values[v * components + k];
        if (seen[v] && !same_value(kept, value)) return false;
        kept = value;
      }
      seen[v] = true;
    }
    return true;
  }

  void read_labels() {
    Attribute material = face_attribute("material");
    Attribute object = face_attribute("object");
    material.labels = gltf_labels(view(), "materials", "material");
    object.labels = gltf_labels(view(), "nodes", "node");
    const auto face_count = static_cast<std::size_t>(mesh_.face_count());
    reserve_charged(material.values, face_count, budget_);
    reserve_charged(object.values, face_count, budget_);
    bool any_material = false;
    bool any_node = false;
    for (const GltfInstance& instance : document_->instances) {
      for (const GltfPart& part : instance.parts) {
        const auto faces = static_cast<std::size_t>(part.corner_count / 3);
        const auto reference = primitive_of(instance, part).find("material");
        const double value =
            reference ? static_cast<double>(reference->index(material.labels.size(), "materials")) : no_value;
        material.values.insert(material.values.end(), faces, value);
        object.values.insert(object.values.end(), faces,
                             instance.node ? static_cast<double>(*instance.node) : no_value);
        any_material = any_material || reference.has_value();
        any_node = any_node || instance.node.has_value();
      }
    }
    if (any_material) mesh_.attributes.push_back(std::move(material));
    if (any_node) mesh_.attributes.push_back(std::move(object));
  }

  static Attribute face_attribute(const char* name) {
    Attribute attribute;
    attribute.name = name;
    attribute.domain = Domain::face;
    attribute.interpolation = Interpolation::nearest;
    attribute.type = ScalarType::int32;
    return attribute;
  }

  const std::string& name_;
  const Context& context_;
  // A node of the hash table: a position, a number, a hash, a pointer, and its share of the buckets.
  static constexpr std::uint64_t bytes_of_entry = 80;
  static constexpr std::size_t entries_per_charge = 1024;

  MemoryBudget& budget_;
  std::shared_ptr<GltfDocument> document_;
  GltfBytes bytes_;
  Mesh mesh_;
  std::vector<double> vertices_;
  std::unordered_map<std::array<double, 3>, Index, PositionHash> welded_;  // of the current instance
  std::unordered_map<std::size_t, GltfAccessor> accessors_;
  std::map<std::string, Attribute> corner_attributes_;
};

}  // namespace

Mesh read_gltf(std::string content, const std::string& name, MemoryBudget& budget, const Context& context) {
  return GltfReader(std::move(content), name, budget, context).read();
}

}  // namespace meshgraft::io
