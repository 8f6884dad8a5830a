#include "join.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "mesh/facts.h"

namespace meshgraft {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

std::size_t element_count(const Mesh& mesh, Domain domain) {
  switch (domain) {
    case Domain::vertex: return mesh.vertex_count();
    case Domain::face: return mesh.face_count();
    case Domain::corner: break;
  }
  return mesh.faces.corner_count();
}

bool has_all_values(const Mesh& mesh, const Attribute& attribute) {
  return attribute.components > 0 &&
         attribute.values.size() == element_count(mesh, attribute.domain) * attribute.components;
}

// Converts an attribute from one value per vertex to one value per corner.
Attribute per_corner(const Mesh& mesh, const Attribute& attribute) {
  Attribute result = attribute;
  result.domain = Domain::corner;
  result.values.clear();
  const auto components = static_cast<std::ptrdiff_t>(attribute.components);
  for (const Index v : mesh.faces.corners()) {
    if (v < 0 || v >= mesh.vertex_count()) {
      result.values.insert(result.values.end(), components, none);
    } else {
      const auto first = attribute.values.begin() + v * components;
      result.values.insert(result.values.end(), first, first + components);
    }
  }
  return result;
}

// Returns the attributes of `mesh`. Vertex attributes that `other` has per corner (normals) become corner
// attributes, and so do UVs: where the meshes meet, a vertex has those of both.
std::vector<Attribute> attributes_like(const Mesh& mesh, const Mesh& other) {
  std::vector<Attribute> result;
  for (const Attribute& attribute : mesh.attributes) {
    if (!has_all_values(mesh, attribute)) continue;
    const bool is_per_corner =
        attribute.name == "uv" || other.find_attribute(Domain::corner, attribute.name) != nullptr;
    const bool promoted = attribute.domain == Domain::vertex && attribute.name != "colour" && is_per_corner &&
                          mesh.find_attribute(Domain::corner, attribute.name) == nullptr;
    result.push_back(promoted ? per_corner(mesh, attribute) : attribute);
  }
  return result;
}

double largest_of(ScalarType type) {
  return type == ScalarType::uint8 ? 255 : type == ScalarType::uint16 ? 65535 : 1;
}

// Scales a colour by its type's largest value, because files store either whole numbers up to it or
// fractions.
void to_unit_colour(Attribute& colour) {
  const double largest = largest_of(colour.type);
  for (double& value : colour.values) value /= largest;
  colour.type = ScalarType::float32;
}

void add_alpha(Attribute& colour) {
  std::vector<double> values;
  for (std::size_t k = 0; k < colour.values.size(); k += 3) {
    values.insert(values.end(), {colour.values[k], colour.values[k + 1], colour.values[k + 2],
                                 std::isnan(colour.values[k]) ? none : largest_of(colour.type)});
  }
  colour.values = std::move(values);
  colour.components = 4;
  colour.source_names.clear();
}

void match_colours(Attribute& first, Attribute& second) {
  if (first.type != second.type) {
    to_unit_colour(first);
    to_unit_colour(second);
  }
  if (first.components == 3 && second.components == 4) add_alpha(first);
  if (first.components == 4 && second.components == 3) add_alpha(second);
}

// Gives the values of an attribute without labels the names that a writer would give them.
void name_values(Attribute& attribute) {
  if (!attribute.labels.empty()) return;
  std::map<double, double> number;
  for (const double value : attribute.values) {
    if (!std::isnan(value)) number.emplace(value, 0);
  }
  for (auto& [value, k] : number) {
    k = static_cast<double>(attribute.labels.size());
    const bool whole = value == std::round(value) && std::abs(value) < 1e15;
    attribute.labels.push_back(
        attribute.name + "_" +
        (whole ? std::to_string(static_cast<std::int64_t>(value)) : std::to_string(value)));
  }
  for (double& value : attribute.values) {
    if (!std::isnan(value)) value = number[value];
  }
}

std::string free_name(const std::string& name, const std::set<std::string>& taken) {
  std::string candidate = name;
  for (int k = 2; taken.contains(candidate); ++k) candidate = name + "_" + std::to_string(k);
  return candidate;
}

// Renumbers the second's labels to follow the first's. Equal labels denote the same thing, unless `apart` is
// set. Returns the renamed labels with their new names.
std::vector<std::pair<std::string, std::string>> join_labels(Attribute& first, Attribute& second, bool apart) {
  name_values(first);
  name_values(second);
  std::set<std::string> taken(first.labels.begin(), first.labels.end());
  if (apart) {
    for (const std::string& label : second.labels) {
      if (!std::count(first.labels.begin(), first.labels.end(), label)) taken.insert(label);
    }
  }
  std::vector<std::pair<std::string, std::string>> renamed;
  std::vector<double> number;
  for (const std::string& label : second.labels) {
    const auto found = std::find(first.labels.begin(), first.labels.end(), label);
    if (found != first.labels.end() && !apart) {
      number.push_back(static_cast<double>(found - first.labels.begin()));
      continue;
    }
    number.push_back(static_cast<double>(first.labels.size()));
    const bool clashes = found != first.labels.end();
    first.labels.push_back(clashes ? free_name(label, taken) : label);
    taken.insert(first.labels.back());
    if (clashes) renamed.emplace_back(label, first.labels.back());
  }
  for (double& value : second.values) {
    if (std::isnan(value)) continue;
    const auto k = static_cast<std::size_t>(value);
    value = value >= 0 && k < number.size() ? number[k] : none;
  }
  return renamed;
}

bool is_floating(ScalarType type) { return type == ScalarType::float32 || type == ScalarType::float64; }

// Returns a type that holds the values of both.
ScalarType common_type(ScalarType a, ScalarType b) {
  if (a == b) return a;
  return is_floating(a) || is_floating(b) ? ScalarType::float64 : ScalarType::int32;
}

// Returns missing values; but a source without colours becomes white, which files can store.
Attribute missing_like(const Attribute& attribute, std::size_t elements) {
  const double white = is_floating(attribute.type) ? 1 : 255;
  Attribute result = attribute;
  result.values.assign(elements * attribute.components, attribute.name == "colour" ? white : none);
  return result;
}

class Joiner {
 public:
  Joiner(const Mesh& first, const Mesh& second)
      : first_(first),
        second_(second),
        first_sources_(sources_of(first)),
        second_sources_(sources_of(second)) {}

  JoinResult join() {
    join_positions();
    join_faces();
    join_attributes();
    join_sources();
    return std::move(result_);
  }

 private:
  void join_positions() {
    const Index n = first_.vertex_count(), m = second_.vertex_count();
    result_.mesh.positions.resize(n + m, 3);
    result_.mesh.positions << first_.positions, second_.positions;
    result_.first.new_index.resize(n);
    result_.second.new_index.resize(m);
    std::iota(result_.first.new_index.begin(), result_.first.new_index.end(), 0);
    std::iota(result_.second.new_index.begin(), result_.second.new_index.end(), n);
  }

  void join_faces() {
    Faces& faces = result_.mesh.faces;
    faces.reserve(first_.face_count() + second_.face_count(),
                  first_.faces.corner_count() + second_.faces.corner_count());
    add_faces(first_, 0);
    add_faces(second_, first_.vertex_count());
  }

  // An index out of range stays out of range.
  void add_faces(const Mesh& mesh, Index shift) {
    std::vector<Index> face;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      face.assign(mesh.faces[f].begin(), mesh.faces[f].end());
      for (Index& v : face) v = v >= 0 && v < mesh.vertex_count() ? v + shift : -1;
      result_.mesh.faces.push_back(face);
    }
  }

  void join_attributes() {
    std::vector<Attribute> first = attributes_like(first_, second_);
    std::vector<Attribute> second = attributes_like(second_, first_);
    for (Attribute& a : first) {
      const auto b = std::find_if(second.begin(), second.end(), [&](const Attribute& other) {
        return other.domain == a.domain && other.name == a.name;
      });
      if (b == second.end()) {
        add(a, missing_like(a, element_count(second_, a.domain)));
        continue;
      }
      if (a.name == "colour") match_colours(a, *b);
      if (a.components == b->components) {
        add_matching(a, *b);
        second.erase(b);
      } else {
        add(a, missing_like(a, element_count(second_, a.domain)));
      }
    }
    for (Attribute& b : second) {
      std::set<std::string> taken;
      for (const Attribute& a : result_.mesh.attributes) {
        if (a.domain == b.domain) taken.insert(a.name);
      }
      b.name = free_name(b.name, taken);
      add(missing_like(b, element_count(first_, b.domain)), b);
    }
  }

  void add_matching(Attribute& a, Attribute& b) {
    const bool is_material = a.name == "material";
    if (is_material || a.name == "group" || !a.labels.empty() || !b.labels.empty()) {
      for (const auto& [old_name, new_name] : join_labels(a, b, is_material && !same_source())) {
        result_.notes.push_back(
            facts::mesh::RenamedLabel{.attribute = a.name, .name = old_name, .new_name = new_name});
        if (is_material) renamed_materials_[old_name] = new_name;
      }
    }
    a.type = a.labels.empty() ? common_type(a.type, b.type) : ScalarType::int32;
    if (a.interpolation != b.interpolation) a.interpolation = Interpolation::nearest;
    if (a.source_names != b.source_names) a.source_names.clear();
    add(a, b);
  }

  void add(Attribute a, const Attribute& b) {
    a.values.insert(a.values.end(), b.values.begin(), b.values.end());
    result_.mesh.attributes.push_back(std::move(a));
  }

  // Returns whether both meshes come from one file, and so name the same materials.
  bool same_source() const {
    const auto one_file = [](const JoinedSources* sources) -> const SourceDocument* {
      return sources && sources->files.size() == 1 ? sources->files.front().document.get() : nullptr;
    };
    const SourceDocument* file = one_file(first_sources_.get());
    return file && file == one_file(second_sources_.get());
  }

  void join_sources() {
    if (!first_sources_ && !second_sources_) return;
    auto joined = std::make_shared<JoinedSources>();
    if (first_sources_) joined->origin = first_sources_->origin;
    const auto add = [&](const JoinedSources* sources) {
      if (!sources) return;
      joined->files.insert(joined->files.end(), sources->files.begin(), sources->files.end());
      joined->notes.insert(joined->notes.end(), sources->notes.begin(), sources->notes.end());
    };
    add(first_sources_.get());
    const std::size_t first_files = joined->files.size();
    add(second_sources_.get());
    for (std::size_t p = first_files; p < joined->files.size(); ++p)
      for (auto& [in_file, now] : joined->files[p].materials)
        if (const auto renamed = renamed_materials_.find(now); renamed != renamed_materials_.end())
          now = renamed->second;
    joined->notes.insert(joined->notes.end(), result_.notes.begin(), result_.notes.end());
    result_.mesh.source = std::move(joined);
  }

  const Mesh& first_;
  const Mesh& second_;
  const std::shared_ptr<const JoinedSources> first_sources_, second_sources_;
  std::map<std::string, std::string> renamed_materials_;  // of the second mesh
  JoinResult result_;
};

}  // namespace

std::shared_ptr<const JoinedSources> sources_of(const Mesh& mesh) {
  if (!mesh.source) return nullptr;
  if (auto several = std::dynamic_pointer_cast<const JoinedSources>(mesh.source)) return several;
  auto one = std::make_shared<JoinedSources>();
  one->origin = mesh.source;
  one->files.push_back({mesh.source, {}});
  if (const Attribute* material = mesh.find_attribute(Domain::face, "material"))
    for (const std::string& name : material->labels) one->files.front().materials.emplace_back(name, name);
  return one;
}

JoinResult join(const Mesh& first, const Mesh& second) { return Joiner(first, second).join(); }

}  // namespace meshgraft
