#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <ranges>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/select/selection.h>

#include "io/selection_files.h"
#include "resolve_deform.h"
#include "script/facts.h"

namespace meshgraft {

/// Resolves selections of an edit file to vertices of one mesh. Each named selection is resolved once,
/// however often it is used.
class SelectionResolver {
 public:
  /// The arguments must outlive the resolver.
  SelectionResolver(const EditFile& edit, const SelectionMesh& context, const ProducedSets& produced)
      : edit_(edit), context_(context), produced_(produced) {}

  /// Returns distinct vertices, ascending.
  std::vector<Index> vertices(const EditSelection& spec, const std::string& location) {
    std::vector<Index> list = resolve(bind(spec, location), context_, location);
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    return list;
  }

  /// Returns vertices in the order of the path, the loop or the list that the selection is.
  std::vector<Index> ordered(const EditSelection& spec, const std::string& location) {
    if (const auto* named = std::get_if<EditSelection::Named>(&spec.kind))
      return ordered(definition(named->name), selection_location(named->name));
    return resolve(bind(spec, location), context_, location);
  }

  std::string read(const std::string& file, const std::string& location) const {
    const std::filesystem::path path = edit_.base_folder / file;
    try {
      return read_file(path);
    } catch (const Error& error) {
      throw error.within(location);
    }
  }

 private:
  const EditSelection& definition(const std::string& name) const {
    return std::find_if(edit_.selections.begin(), edit_.selections.end(),
                        [&](const NamedSelection& selection) { return selection.name == name; })
        ->selection;
  }

  std::string selection_location(const std::string& name) const {
    return fmt::format("{}: selections.{}", edit_.location, name);
  }

  Index vertex_count() const { return context_.mesh.vertex_count(); }

  std::string file_location(const std::string& file, const std::string& location) const {
    return fmt::format("{}: {}", location, (edit_.base_folder / file).string());
  }

  // Returns the library's selection for `spec`.
  Selection bind(const EditSelection& spec, const std::string& location) {
    return std::visit([&](const auto& kind) { return bind_kind(kind, location); }, spec.kind);
  }

  std::shared_ptr<const Selection> bind_child(const EditSelection::Child& child, const std::string& location) {
    return std::make_shared<const Selection>(bind(*child, location));
  }

  std::vector<Selection> bind_all(const std::vector<EditSelection>& specs, const std::string& location) {
    std::vector<Selection> selections;
    for (const EditSelection& spec : specs) selections.push_back(bind(spec, location));
    return selections;
  }

  template <class Kind>
  Selection bind_kind(const Kind& kind, const std::string&) {
    return Selection(kind);
  }
  Selection bind_kind(const EditSelection::Named& named, const std::string&) {
    const auto known = named_.find(named.name);
    if (known != named_.end()) return Selection(Selection::Indices{known->second});
    std::vector<Index> list = vertices(definition(named.name), selection_location(named.name));
    return Selection(Selection::Indices{named_[named.name] = std::move(list)});
  }
  Selection bind_kind(const EditSelection::IndexFile& indices, const std::string& location) {
    const std::string text = read(indices.file, location);
    return Selection(
        Selection::Indices{parse_indices(text, vertex_count(), file_location(indices.file, location))});
  }
  Selection bind_kind(const EditSelection::SelFile& sel, const std::string& location) {
    const std::string text = read(sel.file, location);
    SelRoles parts = parse_sel(text, vertex_count(), file_location(sel.file, location));
    switch (sel.take) {
      case EditSelection::SelRole::fixed: return Selection(Selection::Indices{std::move(parts.fixed)});
      case EditSelection::SelRole::free: return Selection(Selection::Indices{std::move(parts.free)});
      case EditSelection::SelRole::handle: break;
    }
    return Selection(Selection::Indices{std::move(parts.handle)});
  }
  Selection bind_kind(const EditSelection::Produced& wanted, const std::string& location) {
    const auto step = produced_.find(wanted.step);
    if (step != produced_.end())
      if (const auto set = step->second.find(wanted.what); set != step->second.end())
        return Selection(Selection::Indices{set->second});
    if (step != produced_.end())
      throw Error(
          facts::script::NoSuchProduct{
              .step = wanted.step, .what = wanted.what, .known = std::views::keys(step->second)},
          location);
    const bool exists = std::any_of(edit_.steps.begin(), edit_.steps.end(),
                                    [&](const EditStep& other) { return other.name == wanted.step; });
    if (exists) throw Error(facts::script::NothingProduced{.step = wanted.step}, location);
    if (produced_.empty()) throw Error(facts::script::NoProducingSteps{.step = wanted.step}, location);
    throw Error(facts::script::NoSuchStep{.step = wanted.step, .known = std::views::keys(produced_)}, location);
  }
  Selection bind_kind(const EditSelection::Grow& grow, const std::string& location) {
    return Selection(Selection::Grow{bind_child(grow.of, location), grow.rings});
  }
  Selection bind_kind(const EditSelection::GrowLength& grow, const std::string& location) {
    return Selection(Selection::GrowLength{bind_child(grow.of, location), grow.length});
  }
  Selection bind_kind(const EditSelection::Union& combined, const std::string& location) {
    return Selection(Selection::Union{bind_all(combined.of, location)});
  }
  Selection bind_kind(const EditSelection::Minus& combined, const std::string& location) {
    return Selection(Selection::Minus{bind_all(combined.of, location)});
  }
  Selection bind_kind(const EditSelection::Intersect& combined, const std::string& location) {
    return Selection(Selection::Intersect{bind_all(combined.of, location)});
  }
  Selection bind_kind(const EditSelection::Mirror& mirror, const std::string& location) {
    return Selection(
        Selection::Mirror{bind_child(mirror.of, location), mirror.point, mirror.normal, mirror.tolerance_rel});
  }
  Selection bind_kind(const EditSelection::Rim& rim, const std::string& location) {
    return Selection(Selection::Rim{bind_child(rim.of, location), rim.rings});
  }

  const EditFile& edit_;
  const SelectionMesh& context_;
  const ProducedSets& produced_;
  std::map<std::string, std::vector<Index>> named_;
};

}  // namespace meshgraft
