#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

namespace meshgraft::editor {

struct EditorOptions {
  std::vector<std::filesystem::path> models;   ///< offered to the page; files in their folders may be used
  std::vector<std::filesystem::path> folders;  ///< further folders whose files may be used
  std::uint16_t port = 0;                      ///< 0: any free port
  bool or_free_port = false;                   ///< any free port where `port` is taken
  /// For a program that waits for the result: an edit file, which is written with every change. The page has a
  /// command to end the editor, and the editor ends when its last page was closed. Empty: none of this.
  std::filesystem::path result;
  /// How long the last page must be gone for that. A page that is loaded again is back at once.
  std::chrono::milliseconds linger = std::chrono::seconds(5);
  std::vector<std::string> frame_origins;  ///< origins whose pages may frame the editor's, SCHEME://HOST:PORT
};

/// The reason why the editor ended.
enum class EditorEnd {
  stopped,  ///< a stop was requested
  done,     ///< the user said in the page that the work is done
  closed,   ///< the last page was closed
};

/// The address of the editor for a browser.
struct EditorAddress {
  std::string url;  ///< contains the token
  /// A web page that leads to `url`, which only this user may read. Programs take it as an argument, because
  /// everybody on the machine may read arguments.
  std::filesystem::path page;
};

/// Serves the editor until a stop is requested. Calls `started` as soon as the server listens. Throws Error(io)
/// for a model or folder that does not exist, and for a port that cannot be bound; Error(usage) for a text that
/// is no origin.
EditorEnd run_editor(const EditorOptions& options, const std::function<void(const EditorAddress&)>& started,
                     const std::stop_token& stop);

}  // namespace meshgraft::editor
