// Replaces the page where it is left out (MESHGRAFT_WITH_PAGE=OFF): for builds that test the engine.
#include <array>

#include "page.h"

namespace meshgraft::editor {

std::span<const PageFile> page_files() {
  static constexpr std::array<PageFile, 1> files{
      {{"/index.html", "text/html; charset=utf-8",
        "<!doctype html>\n<html lang=\"en\">\n<title>meshgraft</title>\n"
        "<p>This program was built without the editor's page (MESHGRAFT_WITH_PAGE=OFF). The engine behind it "
        "runs, and answers on its WebSocket.</p>\n</html>\n"}}};
  return files;
}

}  // namespace meshgraft::editor
