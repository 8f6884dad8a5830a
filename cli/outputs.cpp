#include "outputs.h"

#include <system_error>

#include <meshgraft/core/error.h>

namespace meshgraft::cli {

void require_not_an_input(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs,
                          const std::string& remedy) {
  for (const std::filesystem::path& input : inputs) {
    std::error_code missing;
    if (std::filesystem::equivalent(output, input, missing) && !missing)
      throw Error(ErrorCode::usage, "this is an input", output.string(), remedy);
  }
}

void require_png(const std::filesystem::path& output) {
  if (output.extension() != ".png" && output.extension() != ".PNG")
    throw Error(ErrorCode::usage, "pictures are PNG files", output.string(),
                "Give it a name that ends in .png.");
}

void require_folder(const std::filesystem::path& output) {
  const std::filesystem::path folder = output.has_parent_path() ? output.parent_path() : ".";
  if (!std::filesystem::is_directory(folder))
    throw Error(ErrorCode::io, "there is no such folder", folder.string(), "Make it first.");
}

void require_outputs(const std::vector<std::filesystem::path>& outputs,
                     const std::vector<std::filesystem::path>& inputs, const std::filesystem::path& edit,
                     bool force) {
  for (auto output = outputs.begin(); output != outputs.end(); ++output) {
    if (output->empty()) continue;
    require_folder(*output);
    for (auto other = outputs.begin(); other != output; ++other)
      if (!other->empty() &&
          std::filesystem::weakly_canonical(*output) == std::filesystem::weakly_canonical(*other))
        throw Error(ErrorCode::usage, "two outputs have this name", output->string());
    if (!edit.empty()) require_not_an_input(*output, {edit});
    if (output != outputs.begin())
      require_not_an_input(*output, inputs);
    else if (!force)
      require_not_an_input(*output, inputs, "Choose another name, or give --force to replace it.");
  }
}

}  // namespace meshgraft::cli
