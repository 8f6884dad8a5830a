#pragma once

#include <span>

#include "server/server.h"

namespace meshgraft::editor {

/// The files of the editor's page.
std::span<const PageFile> page_files();

}  // namespace meshgraft::editor
