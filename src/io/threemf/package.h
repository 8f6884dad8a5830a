#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace meshgraft::io {

/// A file in a package.
struct PackagePart {
  std::string name;  ///< "3D/3dmodel.model"
  std::string content;
};

/// The model parts (.model) of a 3MF package, which is a ZIP archive (ECMA-376, part 2), in the archive's
/// order. `name` is the file's, for messages. Throws Error(input) for what is no archive, holds no model, or
/// unpacks to suspiciously much.
std::vector<PackagePart> model_parts(std::string_view package, const std::string& name);

/// The package with other contents for the parts of these names; all others keep their compressed bytes, and
/// every one its place and time.
std::string with_parts(std::string_view package, const std::vector<PackagePart>& parts);

}  // namespace meshgraft::io
