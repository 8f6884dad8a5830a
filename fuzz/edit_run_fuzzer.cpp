// Parses arbitrary text as an edit file and runs it. Only edits of built-in models of a few hundred vertices
// run: there are no files, and larger models would take too long.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <meshgraft/core/error.h>
#include <meshgraft/script/run_edit.h>

namespace {

constexpr int finest = 12;
constexpr std::size_t most_steps = 4;

bool is_small(const meshgraft::EditFile& edit) {
  return edit.steps.size() <= most_steps &&
         std::ranges::all_of(edit.inputs, [](const meshgraft::EditInput& input) {
           return input.sample.empty() || (input.resolution > 0 && input.resolution <= finest);
         });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const meshgraft::EditFile edit = meshgraft::parse_edit(text, "edit.json", "/fuzz");
    if (is_small(edit)) meshgraft::run_edit(edit, {.estimate_condition = false}, {.threads = 1});
  } catch (const meshgraft::Error&) {
  }
  return 0;
}
