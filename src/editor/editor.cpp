#include "editor.h"

#include <atomic>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "core/platform/file.h"
#include "editor/facts.h"
#include "folders.h"
#include "page.h"
#include "server/access.h"
#include "server/server.h"
#include "session.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view folder_stem = "meshgraft-editor-", new_folder_stem = "meshgraft-new-editor-";

/// A folder that only this user may read, for uploads and the page that leads to the editor. It is deleted when
/// the program ends. Folders of programs that were killed are deleted by the next one.
class PrivateFolder {
 public:
  PrivateFolder() {
    remove_forsaken();
    std::error_code error;
    path_ = platform::make_private_folder(fs::temp_directory_path() / new_folder_stem, error);
    if (!error) lock_ = platform::File(path_ / "lock", platform::OpenMode::append_or_create, error);
    if (!error) error = lock_.try_lock();
    if (!error) fs::create_directory(uploads(), error);
    if (!error) take_final_name(error);
    if (error) throw Error(facts::editor::NoPrivateFolder{}, path_);
    path_ = fs::canonical(path_);
  }
  ~PrivateFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;

  fs::path uploads() const { return path_ / upload_folder_name; }

  /// Writes a page that leads to the address.
  fs::path write_page(const std::string& url) const {
    const fs::path page = path_ / "editor.html";
    std::error_code error;
    platform::File file(page, platform::OpenMode::append_or_create, error);
    if (!error)
      error =
          file.write(fmt::format("<!doctype html><meta charset=\"utf-8\"><title>meshgraft</title>"
                                 "<meta http-equiv=\"refresh\" content=\"0; url={0}\">"
                                 "<a href=\"{0}\">Open the editor</a>\n",
                                 url));
    if (error) throw Error(facts::editor::NoPrivateFolder{}, page);
    return page;
  }

 private:
  // Only folders whose lock is held have the final name, so that no program takes a new one for forsaken.
  void take_final_name(std::error_code& error) {
    const std::string random = path_.filename().string().substr(new_folder_stem.size());
    const fs::path final_path = path_.parent_path() / (std::string(folder_stem) + random);
    fs::rename(path_, final_path, error);
    if (!error) path_ = final_path;
  }

  // A running program holds the lock in its folder. Folders of other users cannot be entered.
  static void remove_forsaken() {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(fs::temp_directory_path(ignored), ignored)) {
      if (!entry.path().filename().string().starts_with(folder_stem) || entry.is_symlink(ignored)) continue;
      std::error_code error;
      platform::File lock(entry.path() / "lock", platform::OpenMode::append, error);
      if (!error && !lock.try_lock()) fs::remove_all(entry.path(), ignored);
    }
  }

  fs::path path_;
  platform::File lock_;
};

Shared shared_by_sessions(const EditorOptions& options, const fs::path& uploads) {
  std::vector<fs::path> folders, models;
  for (const fs::path& model : options.models) {
    require_file(model, model);
    if (model.extension() != ".json") require_mesh_format(model);
    models.push_back(fs::absolute(model).lexically_normal());
    folders.push_back(models.back().parent_path());
  }
  folders.insert(folders.end(), options.folders.begin(), options.folders.end());
  folders.push_back(uploads);
  for (const std::string& origin : options.frame_origins)
    if (!is_origin(origin)) throw Error(facts::editor::NotAnOrigin{.text = origin});
  const fs::path result = options.result.empty() ? fs::path() : fs::absolute(options.result).lexically_normal();
  if (!result.empty() && !fs::is_directory(result.parent_path()))
    throw Error(facts::editor::NoSuchFolder{}, result.parent_path());
  return {Folders(folders), std::move(models), uploads, result, {}};
}

}  // namespace

EditorEnd run_editor(const EditorOptions& options, const std::function<void(const EditorAddress&)>& started,
                     const std::stop_token& stop) {
  const PrivateFolder folder;
  Shared shared = shared_by_sessions(options, folder.uploads());
  std::atomic<bool> done = false;
  Retirement retirement;
  ServerOptions server_options;
  server_options.port = options.port;
  server_options.or_free_port = options.or_free_port;
  server_options.upload_folder = folder.uploads();
  server_options.frame_origins = options.frame_origins;
  if (!options.result.empty()) server_options.linger = options.linger;
  Server server(server_options, page_files(), [&](std::shared_ptr<Channel> channel) {
    return std::make_unique<Session>(std::move(channel), shared, retirement);
  });
  shared.end = [&] {
    done = true;
    server.end_after_pages();
  };
  if (started) started({server.url(), folder.write_page(server.url())});
  server.run(stop);
  return done ? EditorEnd::done : stop.stop_requested() ? EditorEnd::stopped : EditorEnd::closed;
}

}  // namespace meshgraft::editor
