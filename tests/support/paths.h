#pragma once

#include <filesystem>

namespace meshgraft::test {

/// Returns the path of a file or folder of the repository.
std::filesystem::path source_path(const std::filesystem::path& below);

/// Returns the folder of the public test data: $MESHGRAFT_DATA, or one beside the repository. It need not
/// exist.
std::filesystem::path data_folder();

/// Returns the path of the built program, "" in a build without it.
const char* program();

/// Returns the path of the Python interpreter that the tests use.
const char* python();

}  // namespace meshgraft::test
