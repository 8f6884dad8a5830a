#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

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
  std::vector<Index> vertices(const EditSelection& spec, const std::string& location);

  /// Returns vertices in the order of the path, the loop or the list that the selection is.
  std::vector<Index> ordered(const EditSelection& spec, const std::string& location);

  /// Returns the content of a file whose path is relative to the edit file. Throws Error(io), naming
  /// `location`, where it cannot be read.
  std::string read(const std::string& file, const std::string& location) const;

 private:
  const EditSelection& definition(const std::string& name) const;
  std::string selection_location(const std::string& name) const;
  std::string file_location(const std::string& file, const std::string& location) const;

  /// Returns the library's selection for `spec`.
  Selection bind(const EditSelection& spec, const std::string& location);
  std::shared_ptr<const Selection> bind_child(const EditSelection::Child& child, const std::string& location);
  std::vector<Selection> bind_all(const std::vector<EditSelection>& specs, const std::string& location);

  template <class Kind>
  Selection bind_kind(const Kind& kind, const std::string&) {
    return Selection(kind);
  }
  Selection bind_kind(const EditSelection::Named& named, const std::string& location);
  Selection bind_kind(const EditSelection::IndexFile& indices, const std::string& location);
  Selection bind_kind(const EditSelection::SelFile& sel, const std::string& location);
  Selection bind_kind(const EditSelection::Produced& wanted, const std::string& location);
  Selection bind_kind(const EditSelection::Grow& grow, const std::string& location);
  Selection bind_kind(const EditSelection::GrowLength& grow, const std::string& location);
  Selection bind_kind(const EditSelection::Union& combined, const std::string& location);
  Selection bind_kind(const EditSelection::Minus& combined, const std::string& location);
  Selection bind_kind(const EditSelection::Intersect& combined, const std::string& location);
  Selection bind_kind(const EditSelection::Mirror& mirror, const std::string& location);
  Selection bind_kind(const EditSelection::Rim& rim, const std::string& location);

  const EditFile& edit_;
  const SelectionMesh& context_;
  const ProducedSets& produced_;
  std::map<std::string, std::vector<Index>> named_;
};

}  // namespace meshgraft
