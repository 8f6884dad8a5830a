#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/context.h>

#include "core/memory_budget.h"

namespace meshgraft::io {

/// A file in a package.
struct PackagePart {
  std::string name;  ///< "3D/3dmodel.model"
  std::string content;
};

/// Returns the model parts (.model) of a 3MF package, in the archive's order. A package is a ZIP archive
/// (ECMA-376, part 2). `name` is the file's, for messages. Charges the unpacked sizes of all parts: models are
/// unpacked here, others by lib3mf. Throws Error(input) if it is no archive, holds no model, or unpacks to a
/// suspicious size, and Error(memory) beyond the budget.
std::vector<PackagePart> model_parts(std::string_view package, const std::string& name, MemoryBudget& budget,
                                     const Context& context);

/// Returns the package with new contents for the parts of these names. All others keep their compressed
/// bytes. Every part keeps its position in the archive and its time.
std::string with_parts(std::string_view package, const std::vector<PackagePart>& parts, const Context& context);

}  // namespace meshgraft::io
