#include "page.h"

#include <array>

namespace meshgraft::editor {

std::span<const PageFile> page_files() {
  static constexpr std::array<PageFile, 1> files{
      {{"/index.html", "text/html; charset=utf-8",
        "<!doctype html>\n<html lang=\"en\">\n<title>meshgraft</title>\n"
        "<p>This build of meshgraft has no page yet. The engine behind it "
        "runs, and answers on its WebSocket.</p>\n</html>\n"}}};
  return files;
}

}  // namespace meshgraft::editor
