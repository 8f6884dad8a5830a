#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

namespace meshgraft::editor {

struct EditorOptions {
  std::vector<std::filesystem::path> models;   ///< to offer to the page; their folders may be used
  std::vector<std::filesystem::path> folders;  ///< that may be used beside them
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;     ///< 0: one that is free
  bool or_free_port = false;  ///< one that is free, where `port` is taken
};

/// Serves the editor until a stop is requested. Calls `started` with the address to open, once it is listened
/// to. Throws Error(io) for a model or folder that does not exist, and for an address that cannot be taken.
void run_editor(const EditorOptions& options, const std::function<void(const std::string& url)>& started,
                const std::stop_token& stop);

}  // namespace meshgraft::editor
