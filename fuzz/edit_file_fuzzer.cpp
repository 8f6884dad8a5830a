// Parses arbitrary text as an edit file. An accepted edit must be written the same after parsing its own
// text.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include <meshgraft/core/error.h>
#include <meshgraft/script/edit_file.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  meshgraft::EditFile edit;
  try {
    edit = meshgraft::parse_edit(text, "edit.json", "/fuzz");
  } catch (const meshgraft::Error&) {
    return 0;
  }
  const std::string once = meshgraft::write_edit(edit);
  if (meshgraft::write_edit(meshgraft::parse_edit(once, "edit.json", "/fuzz")) != once) std::abort();
  return 0;
}
