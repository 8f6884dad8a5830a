#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/script/edit_file.h>

namespace meshgraft::cli {

/// The forms that `selection_from` reads, apart from JSON, for a help text.
inline constexpr std::array<std::string_view, 5> selection_forms{
    "loop:N", "indices:A,B,…", "file:PATH", "box:X,Y,Z,X,Y,Z",
    "beyond:LENGTH (farther along edges than that from the loops)"};

/// Parses a selection given as an option. `beyond` starts from `loops`. Throws Error(usage) and Error(input)
/// that name `option`.
EditSelection selection_from(const std::string& text, const std::vector<Index>& loops,
                             const std::string& option);

}  // namespace meshgraft::cli
