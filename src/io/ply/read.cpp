#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>

#include "core/platform/memory.h"
#include "document.h"
#include "io/charged.h"
#include "io/facts.h"
#include "io/number_text.h"
#include "io/up_axis_comment.h"
#include "ply.h"
#include "records.h"

namespace meshgraft::io {

namespace {

/// The properties that make up one attribute, by their names in the files of common programs.
struct NameGroup {
  std::string_view attribute;
  Interpolation interpolation;
  std::array<std::string_view, 4> names;
  std::size_t required;  ///< number of names that must be present
};

constexpr std::array<NameGroup, 10> name_groups = {{
    {"normal", Interpolation::direction, {"nx", "ny", "nz"}, 3},
    {cut_normal_name, Interpolation::direction, {"cut_nx", "cut_ny", "cut_nz"}, 3},
    {"colour", Interpolation::linear, {"red", "green", "blue", "alpha"}, 3},
    {"colour", Interpolation::linear, {"diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"}, 3},
    {"colour", Interpolation::linear, {"r", "g", "b", "a"}, 3},
    {"uv", Interpolation::linear, {"s", "t"}, 2},
    {"uv", Interpolation::linear, {"u", "v"}, 2},
    {"uv", Interpolation::linear, {"texture_u", "texture_v"}, 2},
    {"uv", Interpolation::linear, {"texture_s", "texture_t"}, 2},
    {"uv", Interpolation::linear, {"texcoord_u", "texcoord_v"}, 2},
}};

std::optional<std::size_t> find_property(const PlyElement& element, std::string_view name, bool is_list) {
  for (std::size_t p = 0; p < element.properties.size(); ++p) {
    if (element.properties[p].name == name && element.properties[p].is_list == is_list) return p;
  }
  return std::nullopt;
}

/// Returns whether the attribute name implies a number of components that a single property cannot have.
bool has_fixed_meaning(std::string_view name) { return name == "normal" || name == "colour" || name == "uv"; }

bool has_attribute(const std::vector<Attribute>& attributes, Domain domain, std::string_view name) {
  return std::ranges::any_of(attributes, [&](const Attribute& attribute) {
    return attribute.domain == domain && attribute.name == name;
  });
}

/// Reads a PLY file's records into a mesh, element by element in the file's order.
class PlyReader {
 public:
  PlyReader(std::string content, const std::string& name, MemoryBudget& budget, const Context& context)
      : name_(name), budget_(budget), context_(context), document_(std::make_shared<PlyDocument>()) {
    document_->content = std::move(content);
    document_->path = name;
    document_->header = parse_ply_header(document_->content, name, budget);
  }

  Mesh read() {
    require_vertices();
    require_memory();
    std::size_t offset = document_->header.size;
    const std::vector<PlyElement>& elements = document_->header.elements;
    for (std::size_t e = 0; e < elements.size(); ++e) {
      document_->element_begin.push_back(offset);
      if (elements[e].name == "vertex") {
        offset = read_vertices(e, offset);
      } else if (elements[e].name == "face") {
        offset = read_faces(e, offset);
      } else if (elements[e].name == "tristrips" && !has_faces()) {
        offset = read_strips(e, offset);
      } else {
        PlySinks nothing(budget_);
        nothing.scalars.resize(elements[e].properties.size());
        offset = read_records(elements[e], offset, nothing);
      }
      context_.step("read", static_cast<double>(offset) / static_cast<double>(document_->content.size()));
    }
    document_->element_begin.push_back(offset);
    require_end(offset);
    apply_labels();
    mark_unlabelled();
    document_->remember_topology(mesh_);
    mesh_.source = std::move(document_);
    return std::move(mesh_);
  }

 private:
  void require_vertices() const {
    const std::vector<PlyElement>& elements = document_->header.elements;
    const auto vertices = std::ranges::find(elements, "vertex", &PlyElement::name);
    if (vertices == elements.end())
      throw Error(facts::io::NoVertices{.element = "vertex"}, Location::file(name_));
    for (const std::string_view axis : {"x", "y", "z"}) {
      if (!find_property(*vertices, axis, false))
        throw Error(facts::io::MissingProperty{.element = "vertex", .property = axis}, Location::file(name_));
    }
  }

  /// Refuses a file whose header announces more than the budget allows, before its first record is read.
  void require_memory() const {
    std::uint64_t bytes = 0;
    for (const PlyElement& element : document_->header.elements) {
      if (element.name != "vertex" && element.name != "face") continue;
      const auto scalars =
          static_cast<std::uint64_t>(std::ranges::count(element.properties, false, &PlyProperty::is_list));
      bytes += element.count * (scalars * sizeof(double) + (element.name == "face" ? 4 * sizeof(Index) : 0));
    }
    budget_.require(bytes);
  }

  std::size_t read_vertices(std::size_t e, std::size_t offset) {
    const PlyElement& element = document_->header.elements[e];
    resize_charged(mesh_.positions, element.count, budget_);
    platform::prefer_huge_pages(mesh_.positions.data(), 3 * element.count);

    PlyTable table{e, {}};
    const std::array<std::string_view, 3> axes = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
      const std::size_t property = *find_property(element, axes[axis], false);
      table.bindings.push_back({property, Domain::vertex, {}, axis});
    }
    document_->position_type = element.properties[table.bindings[0].property].type;
    bind_scalars(element, Domain::vertex, table);

    PlySinks sinks = targets_of(element, table);
    document_->tables.push_back(std::move(table));
    return read_records(element, offset, sinks);
  }

  std::size_t read_faces(std::size_t e, std::size_t offset) {
    const PlyElement& element = document_->header.elements[e];
    PlyTable table{e, {}};
    bind_scalars(element, Domain::face, table);
    PlySinks sinks = targets_of(element, table);
    sinks.corners = find_corner_list(element);
    sinks.faces = &mesh_.faces;
    // Most meshes consist of triangles. A wrong guess costs nothing.
    reserve_charged(mesh_.faces, element.count, 3 * element.count, budget_);
    platform::prefer_huge_pages(mesh_.faces.corners().data(), mesh_.faces.corners().capacity());
    platform::prefer_huge_pages(mesh_.faces.offsets().data(), mesh_.faces.offsets().capacity());
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      if (element.properties[p].is_list && p != sinks.corners) sinks.lists.push_back({p, {}, {}});
    }
    offset = read_records(element, offset, sinks);
    for (PlyListValues& list : sinks.lists) {
      bind_corner_list(element, list, table);
      free_charged(list.values, budget_);
      free_charged(list.lengths, budget_);
    }
    document_->tables.push_back(std::move(table));
    return offset;
  }

  bool has_faces() const {
    return std::ranges::any_of(document_->header.elements, [](const PlyElement& element) {
      return element.name == "face" && element.count > 0;
    });
  }

  /// Reads triangle strips, which older scans have instead of faces. Every vertex forms a triangle with the
  /// two before it, and every second triangle is reversed. A negative index begins the next strip.
  std::size_t read_strips(std::size_t e, std::size_t offset) {
    const PlyElement& element = document_->header.elements[e];
    PlySinks sinks(budget_);
    sinks.scalars.resize(element.properties.size());
    if (const auto strips = find_corner_list(element)) sinks.lists.push_back({*strips, {}, {}});
    offset = read_records(element, offset, sinks);
    document_->tables.push_back({e, {}});
    for (PlyListValues& list : sinks.lists) {
      auto value = list.values.begin();
      for (const std::uint32_t length : list.lengths) {
        add_strips({value, length});
        value += length;
      }
      free_charged(list.values, budget_);
      free_charged(list.lengths, budget_);
    }
    return offset;
  }

  void add_strips(std::span<const double> values) {
    std::size_t begin = 0;
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (values[k] > std::numeric_limits<Index>::max())
        throw Error(facts::io::IndexTooLarge{.index = static_cast<std::int64_t>(values[k])},
                    Location::file(name_));
      if (values[k] < 0) begin = k + 1;
      if (values[k] < 0 || k < begin + 2) continue;
      std::array<Index, 3> face;
      for (std::size_t i = 0; i < 3; ++i) face[i] = static_cast<Index>(values[k - 2 + i]);
      if ((k - begin) % 2 == 1) std::swap(face[0], face[1]);
      const bool is_turn = face[0] == face[1] || face[1] == face[2] || face[2] == face[0];
      if (is_turn) continue;  // a repeated vertex reverses the strip and makes no triangle
      if (mesh_.faces.corner_count() > std::numeric_limits<Index>::max() - 3)
        throw Error(facts::io::TooMany{.elements = facts::io::Elements::corners,
                                       .most = std::numeric_limits<Index>::max()},
                    Location::file(name_));
      push_charged(mesh_.faces, face, budget_);
    }
  }

  std::optional<std::size_t> find_corner_list(const PlyElement& element) const {
    for (const std::string_view list_name : {"vertex_indices", "vertex_index"}) {
      const std::optional<std::size_t> property = find_property(element, list_name, true);
      if (!property) continue;
      if (is_integer(element.properties[*property].type)) return property;
      throw Error(
          facts::io::NonIntegerType{
              .element = element.name, .list = list_name, .part = facts::io::ListPart::values},
          Location::file(name_));
    }
    if (element.count == 0) return std::nullopt;
    throw Error(facts::io::MissingProperty{.element = element.name, .property = "vertex_indices"},
                Location::file(name_));
  }

  /// Binds every scalar property that the mesh can hold to an attribute: known groups first, then each of the
  /// others alone. Duplicates stay in the file only.
  void bind_scalars(const PlyElement& element, Domain domain, PlyTable& table) {
    Flags bound(element.properties.size(), false);
    for (const PlyBinding& binding : table.bindings) bound[binding.property] = true;

    for (const NameGroup& group : name_groups) {
      std::vector<std::size_t> members;
      for (const std::string_view member : group.names) {
        const std::optional<std::size_t> property =
            member.empty() ? std::nullopt : find_property(element, member, false);
        if (!property || bound[*property]) break;
        if (!members.empty() && element.properties[*property].type != element.properties[members[0]].type)
          break;
        members.push_back(*property);
      }
      if (members.size() < group.required || has_attribute(mesh_.attributes, domain, group.attribute)) continue;
      add_attribute(element, domain, std::string(group.attribute), group.interpolation, members, table);
      for (const std::size_t property : members) bound[property] = true;
    }
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (bound[p] || property.is_list || has_fixed_meaning(property.name)) continue;
      if (has_attribute(mesh_.attributes, domain, property.name)) continue;
      const auto interpolation = is_integer(property.type) ? Interpolation::nearest : Interpolation::linear;
      add_attribute(element, domain, property.name, interpolation, {p}, table);
    }
  }

  void add_attribute(const PlyElement& element, Domain domain, std::string attribute_name,
                     Interpolation interpolation, const std::vector<std::size_t>& members, PlyTable& table) {
    Attribute attribute;
    attribute.name = std::move(attribute_name);
    attribute.domain = domain;
    attribute.interpolation = interpolation;
    attribute.type = element.properties[members[0]].type;
    attribute.components = static_cast<int>(members.size());
    budget_.charge(bytes_of_label);
    resize_charged(attribute.values, element.count * members.size(), 0.0, budget_);
    for (std::size_t k = 0; k < members.size(); ++k) {
      attribute.source_names.push_back(element.properties[members[k]].name);
      table.bindings.push_back({members[k], domain, attribute.name, static_cast<int>(k)});
    }
    mesh_.attributes.push_back(std::move(attribute));
  }

  /// Returns pointers into the mesh for the bindings. They are valid until an attribute is added.
  PlySinks targets_of(const PlyElement& element, const PlyTable& table) {
    PlySinks sinks(budget_);
    sinks.scalars.resize(element.properties.size());
    if (element.count == 0) return sinks;
    for (const PlyBinding& binding : table.bindings) {
      PlyTarget& target = sinks.scalars[binding.property];
      if (binding.attribute.empty()) {
        target = {mesh_.positions.data() + binding.component, 3};
        continue;
      }
      for (Attribute& attribute : mesh_.attributes) {
        if (attribute.domain != binding.domain || attribute.name != binding.attribute) continue;
        target = {attribute.values.data() + binding.component, static_cast<std::size_t>(attribute.components)};
      }
    }
    return sinks;
  }

  /// Makes a list with k values for every corner of every face a corner attribute. Faces with an empty list
  /// have no values. Other lists stay in the file only.
  void bind_corner_list(const PlyElement& element, const PlyListValues& list, PlyTable& table) {
    const PlyProperty& property = element.properties[list.property];
    const std::string attribute_name = property.name == "texcoord" ? "uv" : property.name;
    if (has_attribute(mesh_.attributes, Domain::corner, attribute_name)) return;
    std::size_t components = 0;
    for (Index f = 0; f < mesh_.faces.size(); ++f) {
      const std::size_t corners = mesh_.faces[f].size();
      const std::size_t length = list.lengths[f];
      if (length == 0) continue;
      if (corners == 0 || length % corners != 0) return;
      if (components == 0) components = length / corners;
      if (length != components * corners) return;
    }
    if (components == 0 || components > 4) return;
    if (attribute_name == "uv" && components != 2) return;
    if (attribute_name == "normal" && components != 3) return;

    Attribute attribute;
    attribute.name = attribute_name;
    attribute.domain = Domain::corner;
    attribute.type = property.type;
    attribute.components = static_cast<int>(components);
    attribute.source_names = {property.name};
    attribute.interpolation = is_integer(property.type) ? Interpolation::nearest : Interpolation::linear;
    if (attribute_name == "uv") attribute.interpolation = Interpolation::linear;
    if (attribute_name == "normal") attribute.interpolation = Interpolation::direction;
    resize_charged(attribute.values, static_cast<std::size_t>(mesh_.faces.corner_count()) * components,
                   no_value, budget_);
    auto from = list.values.begin();
    for (Index f = 0; f < mesh_.faces.size(); ++f) {
      const auto to =
          attribute.values.begin() +
          static_cast<std::ptrdiff_t>(static_cast<std::size_t>(mesh_.faces.first_corner(f)) * components);
      std::copy(from, from + list.lengths[f], to);
      from += list.lengths[f];
    }
    mesh_.attributes.push_back(std::move(attribute));
    table.bindings.push_back({list.property, Domain::corner, attribute_name, 0});
  }

  std::size_t read_records(const PlyElement& element, std::size_t offset, PlySinks& sinks) const {
    return read_ply_records(*document_, element, offset, sinks, context_);
  }

  /// Refuses data behind the last announced record: either the data or the header is wrong.
  void require_end(std::size_t offset) const {
    const std::string_view content = document_->content;
    const std::size_t rest = content.find_first_not_of(" \t\r\n\v\f", offset);
    if (rest == std::string_view::npos) return;
    const std::string location = document_->header.encoding == PlyEncoding::ascii
                                     ? line_name(content, rest)
                                     : "byte " + std::to_string(rest);
    throw Error(facts::io::TrailingData{.element = document_->header.elements.back().name},
                Location::file(name_) / Location::place(location));
  }

  /// Restores label names from comments "label NAME VALUE TEXT", which are written for meshes with named
  /// groups.
  void apply_labels() {
    for (const std::string& comment : document_->header.comments) {
      std::array<std::string_view, 3> words;
      std::string_view rest = comment;
      for (std::string_view& word : words) {
        const std::size_t end = std::min(rest.find(' '), rest.size());
        word = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
      }
      const ParsedNumber value = parse_number(words[2], ScalarType::int32);
      if (words[0] != "label" || value.fault != NumberFault::none || value.value < 0) continue;
      for (Attribute& attribute : mesh_.attributes) {
        if (attribute.domain != Domain::face || attribute.name != words[1] || attribute.components != 1)
          continue;
        // Labels must be numbered without gaps, so that a wrong number cannot claim memory.
        if (value.value == static_cast<double>(attribute.labels.size())) attribute.labels.emplace_back(rest);
      }
    }
  }

  /// Replaces -1 by NaN in labelled attributes. Integers have no NaN, so -1 means "none".
  void mark_unlabelled() {
    for (Attribute& attribute : mesh_.attributes) {
      if (attribute.labels.empty()) continue;
      std::ranges::replace(attribute.values, -1.0, std::numeric_limits<double>::quiet_NaN());
    }
  }

  const std::string& name_;
  MemoryBudget& budget_;
  const Context& context_;
  std::shared_ptr<PlyDocument> document_;
  Mesh mesh_;
};

}  // namespace

std::vector<Note> PlyDocument::beside_the_mesh() const {
  std::vector<Note> notes;
  const auto add = [&](const std::string& content, std::uint64_t count) {
    notes.push_back(facts::io::LeftOut{.file = path.filename(), .content = content, .count = count});
  };
  for (std::size_t e = 0; e < header.elements.size(); ++e) {
    const PlyElement& element = header.elements[e];
    const auto table = std::ranges::find(tables, e, &PlyTable::element);
    if (table == tables.end()) {
      if (element.count > 0) add(element.name, element.count);
      continue;
    }
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      const std::string& property = element.properties[p].name;
      if (std::ranges::find(table->bindings, p, &PlyBinding::property) == table->bindings.end() &&
          property != "vertex_indices" && property != "vertex_index")
        add(element.name + " " + property, element.count);
    }
  }
  for (const std::string& comment : header.comments)
    if (comment.starts_with("TextureFile")) add(comment, 1);
  return notes;
}

std::optional<UpAxis> PlyDocument::stated_up_axis() const {
  for (const std::string& comment : header.comments)
    if (const auto axis = up_axis_in(comment)) return axis;
  return std::nullopt;
}

std::vector<std::filesystem::path> texture_files(const PlyDocument& document) {
  constexpr std::string_view key = "TextureFile ";
  std::vector<std::filesystem::path> files;
  for (const std::string& comment : document.header.comments)
    if (comment.starts_with(key)) files.push_back(document.path.parent_path() / comment.substr(key.size()));
  return files;
}

Mesh read_ply(std::string content, const std::string& name, MemoryBudget& budget, const Context& context) {
  return PlyReader(std::move(content), name, budget, context).read();
}

}  // namespace meshgraft::io
