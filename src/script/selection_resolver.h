#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/select/selection.h>

#include "resolve_deform.h"

namespace meshgraft {

/// Resolves selections of an edit file to vertices of one mesh. Each named selection is resolved once,
/// however often it is used.
class SelectionResolver {
 public:
  /// The arguments must outlive the resolver.
  SelectionResolver(const EditFile& edit, const SelectionMesh& context, const ProducedSets& produced)
      : edit_(edit), context_(context), produced_(produced) {}

  /// Returns distinct vertices, ascending.
  std::vector<Index> vertices(const EditSelection& spec, const Location& location);

  /// Returns vertices in the order of the path, the loop or the list that the selection is.
  std::vector<Index> ordered(const EditSelection& spec, const Location& location);

  /// Returns the content of a file whose path is relative to the edit file. Throws Error(io), naming
  /// `location`, where it cannot be read.
  std::string read(const std::string& file, const Location& location) const;

 private:
  const EditSelection& definition(const std::string& name) const;
  Location selection_location(const std::string& name) const;
  Location file_location(const std::string& file, const Location& location) const;

  /// Returns the library's selection for `spec`.
  Selection bind(const EditSelection& spec, const Location& location);
  std::shared_ptr<const Selection> bind_child(const EditSelection::Child& child, const Location& location);
  std::vector<Selection> bind_all(const std::vector<EditSelection>& specs, const Location& location);

  template <class Kind>
  Selection bind_kind(const Kind& kind, const Location&) {
    return Selection(kind);
  }
  Selection bind_kind(const EditSelection::Named& named, const Location& location);
  Selection bind_kind(const EditSelection::IndexFile& indices, const Location& location);
  Selection bind_kind(const EditSelection::SelFile& sel, const Location& location);
  Selection bind_kind(const EditSelection::Produced& wanted, const Location& location);
  Selection bind_kind(const EditSelection::Grow& grow, const Location& location);
  Selection bind_kind(const EditSelection::GrowLength& grow, const Location& location);
  Selection bind_kind(const EditSelection::Union& combined, const Location& location);
  Selection bind_kind(const EditSelection::Minus& combined, const Location& location);
  Selection bind_kind(const EditSelection::Intersect& combined, const Location& location);
  Selection bind_kind(const EditSelection::Mirror& mirror, const Location& location);
  Selection bind_kind(const EditSelection::Rim& rim, const Location& location);

  const EditFile& edit_;
  const SelectionMesh& context_;
  const ProducedSets& produced_;
  std::map<std::string, std::vector<Index>> named_;
};

}  // namespace meshgraft
