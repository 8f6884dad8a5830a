#include "folders.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "editor/facts.h"
#include "io/facts.h"
#include "io/file.h"
#include "server/utf8.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;

namespace {

bool is_below(const fs::path& path, const fs::path& root) {
  return std::mismatch(root.begin(), root.end(), path.begin(), path.end()).first == root.end();
}

// Refuses a file whose name hides its format: a .glb file under another name may still refer to other files
// and is read as .glb.
void require_honest_name(const fs::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".glb" || extension == ".gltf" || extension == ".GLB" || extension == ".GLTF") return;
  std::array<char, 4> start{};
  std::ifstream(path, std::ios::binary).read(start.data(), start.size());
  if (std::string_view(start.data(), start.size()) == "glTF")
    throw Error(facts::editor::GltfByAnotherName{}, path);
}

// Refuses paths with zero bytes, and names that are longer than any file system allows.
void require_sound_name(const fs::path& path) {
  if (path.native().find('\0') != std::string::npos) throw Error(facts::editor::ZeroByte{}, path.filename());
  constexpr std::size_t most_bytes = 255;
  for (const fs::path& part : path)
    if (part.native().size() > most_bytes)
      throw Error(facts::editor::NameTooLong{.bytes = part.native().size(), .most = most_bytes},
                  Location::file(whole_characters(part.string(), 60) + "…"));
}

// Returns the path with the user's home in place of a leading `~`.
fs::path from_home(const fs::path& path) {
  const char* home = std::getenv("HOME");
  if (home == nullptr || path.empty() || *path.begin() != "~") return path;
  return fs::path(home) / path.lexically_relative("~");
}

}  // namespace

void require_file(const fs::path& file, const fs::path& asked) {
  if (fs::is_directory(file)) throw Error(facts::io::IsFolder{}, asked);
  if (!fs::is_regular_file(file))
    throw io::file_error(asked, facts::io::Action::read,
                         std::make_error_code(std::errc::no_such_file_or_directory));
}

Folders::Folders(const std::vector<fs::path>& folders) {
  for (const fs::path& folder : folders) add(fs::absolute(folder));
}

std::vector<fs::path> Folders::roots() const {
  const std::lock_guard lock(mutex_);
  return roots_;
}

fs::path Folders::add(const fs::path& folder) {
  require_sound_name(folder);
  const fs::path whole = from_home(folder);
  if (!whole.is_absolute()) throw Error(facts::editor::PathNotFull{}, folder);
  std::error_code failed;
  const fs::path root = fs::canonical(whole, failed);
  if (failed || !fs::is_directory(root)) throw Error(facts::editor::NoSuchFolder{}, folder);
  if (fs::directory_iterator(root, failed); failed)
    throw io::file_error(folder, facts::io::Action::read, failed);
  const std::lock_guard lock(mutex_);
  if (std::find(roots_.begin(), roots_.end(), root) == roots_.end()) roots_.push_back(root);
  return root;
}

fs::path Folders::inside(const fs::path& path) const {
  require_sound_name(path);
  const std::vector<fs::path> roots = this->roots();
  const fs::path given = path.is_absolute() || roots.empty() ? path : roots.front() / path;
  std::error_code failed;
  const fs::path leads = fs::weakly_canonical(follow_links(given), failed);
  if (!failed && leads.is_absolute())
    for (const fs::path& root : roots)
      if (is_below(leads, root)) return leads;
  throw Error(facts::editor::OutsideFolders{}, path);
}

fs::path Folders::mesh_to_read(const fs::path& path) const {
  const fs::path file = inside(path);
  require_file(file, path);
  require_mesh_format(file);
  require_honest_name(file);
  for (const fs::path& behind : files_behind(file)) inside(behind);
  return file;
}

fs::path Folders::mesh_to_write(const fs::path& path) const {
  const fs::path file = inside(path);
  require_mesh_format(file);
  for (const char* companion : {".mtl", ".bin"}) inside(fs::path(file).replace_extension(companion));
  return file;
}

void Folders::require_inside(const EditFile& edit) const {
  for (const EditInput& input : edit.inputs)
    if (!input.file.empty()) mesh_to_read(edit.base_folder / input.file);
  for (const fs::path& file : referenced_files(edit)) inside(file);
}

fs::path copy_into(const fs::path& folder, const fs::path& file) {
  fs::path copy = folder / file.filename();
  for (int number = 2; fs::exists(copy); ++number) {
    if (fs::is_regular_file(copy) && read_file(copy) == read_file(file)) return copy;
    copy = folder / fmt::format("{}-{}{}", file.stem().string(), number, file.extension().string());
  }
  fs::copy_file(file, copy);
  return copy;
}

namespace {

// Returns a path as the user knows it.
std::string known_as(const std::string& path) {
  const fs::path folder = fs::path(path).parent_path();
  const bool is_upload = folder.is_absolute() &&
                         (folder.filename() == upload_folder_name || folder.extension() == kept_folder_suffix);
  return is_upload ? uploaded_as(fs::path(path).filename()).string() : path;
}

Fact with_upload_names(const Fact& fact) {
  std::vector<FieldValue> values = fact.values();
  for (FieldValue& value : values)
    if (auto* text = std::get_if<std::string>(&value)) *text = known_as(*text);
  return {fact.type(), std::move(values)};
}

}  // namespace

Error with_upload_names(const Error& error) {
  Location location;
  for (const LocationPart& part : error.location().parts()) {
    switch (part.kind) {
      case LocationPart::Kind::file: location = location / Location::file(known_as(part.name)); break;
      case LocationPart::Kind::field: location = location / Location::field(part.name); break;
      case LocationPart::Kind::element: location = location[part.index]; break;
      case LocationPart::Kind::handle: location = location / Location::handle(part.name); break;
      case LocationPart::Kind::pair: location = location / Location::pair(part.index); break;
      case LocationPart::Kind::place: location = location / Location::place(part.name); break;
    }
  }
  Error named(with_upload_names(error.fact()), location);
  for (const Note& note : error.notes()) named = named.with(with_upload_names(note));
  return named;
}

fs::path uploaded_as(const fs::path& upload) {
  const std::string stem = upload.stem().string();
  return stem.substr(0, stem.rfind('-')) + upload.extension().string();
}

}  // namespace meshgraft::editor
