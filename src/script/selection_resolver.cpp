#include "selection_resolver.h"

#include <algorithm>
#include <filesystem>
#include <ranges>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "io/file.h"
#include "io/selection_files.h"
#include "script/facts.h"

namespace meshgraft {

std::vector<Index> SelectionResolver::vertices(const EditSelection& spec, const Location& location) {
  std::vector<Index> list = resolve(bind(spec, location), context_, location);
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

std::vector<Index> SelectionResolver::ordered(const EditSelection& spec, const Location& location) {
  if (const auto* named = std::get_if<EditSelection::Named>(&spec.kind))
    return ordered(definition(named->name), selection_location(named->name));
  return resolve(bind(spec, location), context_, location);
}

std::string SelectionResolver::read(const std::string& file, const Location& location) const {
  const std::filesystem::path path = edit_.base_folder / file;
  try {
    return read_file(path);
  } catch (const Error& error) {
    throw error.within(location);
  }
}

const EditSelection& SelectionResolver::definition(const std::string& name) const {
  return std::find_if(edit_.selections.begin(), edit_.selections.end(),
                      [&](const NamedSelection& selection) { return selection.name == name; })
      ->selection;
}

Location SelectionResolver::selection_location(const std::string& name) const {
  return Location::file(edit_.location) / "selections" / Location::field(name);
}

Location SelectionResolver::file_location(const std::string& file, const Location& location) const {
  return location / (edit_.base_folder / file);
}

Selection SelectionResolver::bind(const EditSelection& spec, const Location& location) {
  return std::visit([&](const auto& kind) { return bind_kind(kind, location); }, spec.kind);
}

std::shared_ptr<const Selection> SelectionResolver::bind_child(const EditSelection::Child& child,
                                                               const Location& location) {
  return std::make_shared<const Selection>(bind(*child, location));
}

std::vector<Selection> SelectionResolver::bind_all(const std::vector<EditSelection>& specs,
                                                   const Location& location) {
  std::vector<Selection> selections;
  for (const EditSelection& spec : specs) selections.push_back(bind(spec, location));
  return selections;
}

Selection SelectionResolver::bind_kind(const EditSelection::Named& named, const Location&) {
  const auto known = named_.find(named.name);
  if (known != named_.end()) return Selection(Selection::Indices{known->second});
  std::vector<Index> list = vertices(definition(named.name), selection_location(named.name));
  return Selection(Selection::Indices{named_[named.name] = std::move(list)});
}

Selection SelectionResolver::bind_kind(const EditSelection::IndexFile& indices, const Location& location) {
  const std::string text = read(indices.file, location);
  return Selection(Selection::Indices{
      parse_indices(text, context_.mesh.vertex_count(), file_location(indices.file, location))});
}

Selection SelectionResolver::bind_kind(const EditSelection::SelFile& sel, const Location& location) {
  const std::string text = read(sel.file, location);
  SelRoles parts = parse_sel(text, context_.mesh.vertex_count(), file_location(sel.file, location));
  switch (sel.take) {
    case EditSelection::SelRole::fixed: return Selection(Selection::Indices{std::move(parts.fixed)});
    case EditSelection::SelRole::free: return Selection(Selection::Indices{std::move(parts.free)});
    case EditSelection::SelRole::handle: break;
  }
  return Selection(Selection::Indices{std::move(parts.handle)});
}

Selection SelectionResolver::bind_kind(const EditSelection::Produced& wanted, const Location& location) {
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

Selection SelectionResolver::bind_kind(const EditSelection::Grow& grow, const Location& location) {
  return Selection(Selection::Grow{bind_child(grow.of, location), grow.rings});
}

Selection SelectionResolver::bind_kind(const EditSelection::GrowLength& grow, const Location& location) {
  return Selection(Selection::GrowLength{bind_child(grow.of, location), grow.length});
}

Selection SelectionResolver::bind_kind(const EditSelection::Union& combined, const Location& location) {
  return Selection(Selection::Union{bind_all(combined.of, location)});
}

Selection SelectionResolver::bind_kind(const EditSelection::Minus& combined, const Location& location) {
  return Selection(Selection::Minus{bind_all(combined.of, location)});
}

Selection SelectionResolver::bind_kind(const EditSelection::Intersect& combined, const Location& location) {
  return Selection(Selection::Intersect{bind_all(combined.of, location)});
}

Selection SelectionResolver::bind_kind(const EditSelection::Mirror& mirror, const Location& location) {
  return Selection(Selection::Mirror{bind_child(mirror.of, location), mirror.plane, mirror.tolerance_rel});
}

Selection SelectionResolver::bind_kind(const EditSelection::Rim& rim, const Location& location) {
  return Selection(Selection::Rim{bind_child(rim.of, location), rim.rings});
}

}  // namespace meshgraft
