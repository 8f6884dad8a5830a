#include "editor.h"

#include <memory>
#include <system_error>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/platform/file.h"
#include "editor/facts.h"
#include "folders.h"
#include "page.h"
#include "server/server.h"
#include "session.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;

namespace {

/// The folder of uploads. It is deleted when the program ends.
class UploadFolder {
 public:
  UploadFolder() {
    std::error_code error;
    path_ = platform::make_private_folder(fs::temp_directory_path() / "meshgraft-uploads-", error);
    if (error) throw Error(facts::editor::NoUploadFolder{}, path_);
    path_ = fs::canonical(path_);
  }
  ~UploadFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  UploadFolder(const UploadFolder&) = delete;
  UploadFolder& operator=(const UploadFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

Shared shared_by_sessions(const EditorOptions& options, const fs::path& uploads) {
  std::vector<fs::path> folders, models;
  for (const fs::path& model : options.models) {
    require_file(model, model);
    models.push_back(fs::absolute(model).lexically_normal());
    folders.push_back(models.back().parent_path());
  }
  folders.insert(folders.end(), options.folders.begin(), options.folders.end());
  folders.push_back(uploads);
  return {Folders(folders), std::move(models), uploads};
}

}  // namespace

void run_editor(const EditorOptions& options, const std::function<void(const std::string&)>& started,
                const std::stop_token& stop) {
  const UploadFolder uploads;
  const Shared shared = shared_by_sessions(options, uploads.path());
  Retirement retirement;
  ServerOptions server_options;
  server_options.address = options.address;
  server_options.port = options.port;
  server_options.or_free_port = options.or_free_port;
  server_options.upload_folder = uploads.path();
  Server server(server_options, page_files(), [&](std::shared_ptr<Channel> channel) {
    return std::make_unique<Session>(std::move(channel), shared, retirement);
  });
  if (started) started(server.url());
  server.run(stop);
}

}  // namespace meshgraft::editor
