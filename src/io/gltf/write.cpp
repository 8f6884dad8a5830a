#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <meshgraft/core/error.h>

#include "compose.h"
#include "core/sparse_checks.h"
#include "demands.h"
#include "edit.h"
#include "gltf.h"
#include "gltf/facts.h"
#include "io/number_text.h"
#include "morph.h"

namespace meshgraft::io {

namespace {

/// The bytes of an accessor's elements: `size` bytes every `stride` bytes, from `begin` to `end`.
struct Span {
  std::size_t accessor, buffer, begin, end, stride, size;
};

bool overlap(const Span& a, const Span& b) {
  if (a.buffer != b.buffer || a.end <= b.begin || b.end <= a.begin) return false;
  if (a.stride != b.stride) return true;
  // Interleaved accessors share bytes only if their elements overlap within a stride.
  const std::size_t offset = (b.begin + a.stride - a.begin % a.stride) % a.stride;
  return offset < a.size || a.stride - offset < b.size;
}

/// Counts the references to each accessor and finds accessors that share bytes. Only an accessor without
/// other users may be written in place.
class Usage {
 public:
  explicit Usage(const GltfEdit& edit) : edit_(edit) {
    count_references();
    for (std::size_t a = 0; a < edit.view().count("accessors"); ++a)
      if (references_.contains(a)) add_spans(a);
  }

  std::size_t references(std::size_t accessor) const {
    const auto found = references_.find(accessor);
    return found == references_.end() ? 0 : found->second;
  }

  bool shares_bytes(std::size_t accessor) const {
    for (const Span& own : spans_)
      if (own.accessor == accessor)
        for (const Span& other : spans_)
          if (other.accessor != accessor && overlap(own, other)) return true;
    return false;
  }

 private:
  void count(const Json& owner, const char* key) {
    if (!owner.is_object()) return;
    const auto reference = owner.find(key);
    if (reference != owner.end() && reference->is_number_unsigned())
      ++references_[reference->get<std::size_t>()];
  }

  void count_all(const Json& attributes) {
    if (!attributes.is_object()) return;
    for (const auto& member : attributes.items())
      if (member.value().is_number_unsigned()) ++references_[member.value().get<std::size_t>()];
  }

  static const Json& list(const Json& owner, const char* key) {
    static const Json nothing = Json::array();
    if (!owner.is_object()) return nothing;
    const auto found = owner.find(key);
    return found == owner.end() || !found->is_array() ? nothing : *found;
  }

  void count_references() {
    for (const Json& mesh : list(edit_.json, "meshes")) {
      for (const Json& primitive : list(mesh, "primitives")) {
        if (primitive.contains("attributes")) count_all(primitive["attributes"]);
        count(primitive, "indices");
        for (const Json& target : list(primitive, "targets")) count_all(target);
      }
    }
    for (const Json& skin : list(edit_.json, "skins")) count(skin, "inverseBindMatrices");
    for (const Json& animation : list(edit_.json, "animations"))
      for (const Json& sampler : list(animation, "samplers")) {
        count(sampler, "input");
        count(sampler, "output");
      }
    count_in_extensions(edit_.json, false);
  }

  /// Counts possible references within extensions. Only the extension defines where it names accessors, so
  /// every candidate counts.
  void count_in_extensions(const Json& json, bool within) {
    if (!json.is_structured()) return;
    for (const auto& member : json.items()) {
      const Json& value = member.value();
      if (within && json.is_object()) {
        if (member.key() == "attributes") count_all(value);
        for (const char* key : {"accessor", "indices", "input", "output"})
          if (member.key() == key) count(json, key);
      }
      count_in_extensions(value, within || (json.is_object() && member.key() == "extensions"));
    }
  }

  void add_spans(std::size_t index) {
    try {
      const GltfAccessor accessor = edit_.accessor(index);
      if (accessor.dense) add_span(index, *accessor.dense, accessor.count, accessor.element_size());
      for (std::size_t k = 0; k < accessor.sparse_parts.size(); ++k)
        add_span(index, accessor.sparse_parts[k], accessor.sparse_count,
                 k == 0 ? size_of(accessor.sparse_index_type) : accessor.element_size());
    } catch (const Error&) {
      return;  // matrices, and accessors that the reader does not need to understand
    }
  }

  void add_span(std::size_t accessor, const GltfAccessor::Strided& at, std::size_t count, std::size_t size) {
    if (count == 0) return;
    const std::size_t end = at.begin.byte + (count - 1) * at.stride + size;
    spans_.push_back({accessor, at.begin.buffer, at.begin.byte, end, at.stride, size});
  }

  const GltfEdit& edit_;
  std::map<std::size_t, std::size_t> references_;
  std::vector<Span> spans_;
};

/// A demand, and the mesh of the JSON that it applies to.
struct PlacedDemand {
  std::size_t mesh = 0;
  const GltfDemand* demand = nullptr;
};

/// Counts the primitives that use the demand's accessor. Points and lines of the mesh follow its triangles.
std::size_t references_in(const Json& mesh, const GltfDemand& demand) {
  std::size_t count = 0;
  for (const Json& primitive : mesh["primitives"]) {
    if (!primitive.contains("attributes")) continue;
    const auto reference = primitive["attributes"].find(demand.channel.semantic);
    if (reference != primitive["attributes"].end() && *reference == demand.accessor) ++count;
  }
  return count;
}

void redirect(Json& mesh, const GltfDemand& demand, std::size_t accessor) {
  for (Json& primitive : mesh["primitives"]) {
    if (!primitive.contains("attributes")) continue;
    Json& attributes = primitive["attributes"];
    const auto reference = attributes.find(demand.channel.semantic);
    if (reference != attributes.end() && *reference == demand.accessor) *reference = accessor;
  }
}

/// Unites the changes that all demands make to an accessor. Returns false if one demand keeps an element that
/// another changes, or if their values differ.
bool unite(const std::vector<PlacedDemand>& demands, GltfChanges& united, const Context& context) {
  SparseChecks check(context);
  for (const PlacedDemand& placed : demands)
    for (const auto& [element, value] : placed.demand->changes) {
      check();
      united.try_emplace(element, value);
    }
  return std::ranges::all_of(demands, [&](const PlacedDemand& placed) {
    return std::ranges::all_of(united, [&](const auto& change) {
      check();
      const auto own = placed.demand->changes.find(change.first);
      if (own == placed.demand->changes.end()) return !placed.demand->is_used[change.first];
      return nearly_equal(own->second, change.second);
    });
  });
}

void apply(GltfEdit& edit, const std::vector<GltfTarget>& targets, const std::vector<GltfDemands>& demands,
           const Context& context) {
  std::map<std::size_t, std::vector<PlacedDemand>> by_accessor;
  for (const GltfTarget& target : targets)
    for (const GltfDemand& demand : demands[target.instance])
      by_accessor[demand.accessor].push_back({target.mesh, &demand});
  std::erase_if(by_accessor, [](const auto& entry) {
    return std::ranges::all_of(entry.second,
                               [](const PlacedDemand& placed) { return placed.demand->is_met(); });
  });
  if (by_accessor.empty()) return;
  const Usage usage(edit);
  bool became_floats = false;
  for (const auto& [accessor_index, placed] : by_accessor) {
    const GltfAccessor accessor = edit.accessor(accessor_index);
    std::size_t own_references = 0;
    for (const PlacedDemand& one : placed)
      own_references += references_in(edit.json["meshes"][one.mesh], *one.demand);
    GltfChanges united;
    const bool in_place = unite(placed, united, context) &&
                          own_references == usage.references(accessor_index) &&
                          !usage.shares_bytes(accessor_index) && GltfEdit::can_store(accessor, united);
    context.throw_if_stopped();
    if (in_place) {
      edit.store(accessor_index, united);
      continue;
    }
    for (const PlacedDemand& one : placed) {
      if (one.demand->is_met()) continue;
      const std::size_t copy = edit.store_copy(accessor_index, one.demand->changes);
      became_floats = became_floats || edit.accessor(copy).type != accessor.type;
      redirect(edit.json["meshes"][one.mesh], *one.demand, copy);
    }
  }
  if (became_floats) edit.notes.push_back(facts::gltf::WrittenAsFloats{});
}

bool is_unchanged(const GltfDocument* document, const Mesh& mesh) {
  return document != nullptr && document->has_topology_of(mesh);
}

}  // namespace

Format gltf_format() {
  static constexpr std::array<std::string_view, 2> extensions = {".glb", ".gltf"};
  return {"glTF", extensions, has_glb_signature, read_gltf, write_gltf, files_of_gltf, true};
}

Written write_gltf(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
                   const Context& context) {
  const auto* document = dynamic_cast<const GltfDocument*>(mesh.source.get());
  if (!is_unchanged(document, mesh)) return compose_gltf(mesh, path, options.morph_target, context);
  try {
    GltfEdit edit(*document);
    if (options.morph_target) require_rest_of_file(*document, mesh, *options.morph_target, context);
    const std::vector<GltfDemands> demands = demands_of(*document, mesh, edit.notes, context);
    const std::vector<GltfTarget> targets = part_instances(edit, *document, demands);
    if (options.morph_target)
      add_morph_target(edit, targets, demands, options.morph_target->name);
    else
      apply(edit, targets, demands, context);
    context.throw_if_stopped();
    return edit.finish(path);
  } catch (const Json::exception&) {
    // The reader ignores animations, skins and images, so they may have any type.
    throw Error(facts::gltf::MemberOfAnotherType{}, document->path);
  }
}

}  // namespace meshgraft::io
