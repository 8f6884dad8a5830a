#include <meshgraft/io/mesh_io.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/memory_budget.h"
#include "file.h"
#include "file_document.h"
#include "format.h"
#include "gltf/gltf.h"
#include "io/facts.h"
#include "obj/obj.h"
#include "off/off.h"
#include "ply/ply.h"
#include "stl/stl.h"
#include "threemf/threemf.h"

namespace meshgraft {

namespace io {

std::span<const Format> formats() {
  static const std::vector<Format> all = {
      stl_format(),  // first: its header of 80 bytes may begin with the signature of any other format
      ply_format(),     obj_format(), off_format(), gltf_format(),
#ifdef MESHGRAFT_HAS_3MF
      threemf_format(),
#endif
  };
  return all;
}

}  // namespace io

namespace {

std::string lower_case_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

std::vector<std::string_view> known_extensions() {
  std::vector<std::string_view> list;
  for (const io::Format& format : io::formats())
    list.insert(list.end(), format.extensions.begin(), format.extensions.end());
  return list;
}

/// Returns the format that the file's extension names, or null.
const io::Format* format_named_by(const std::filesystem::path& path) {
  const std::string extension = lower_case_extension(path);
  for (const io::Format& format : io::formats())
    if (std::ranges::find(format.extensions, extension) != format.extensions.end()) return &format;
  return nullptr;
}

const io::Format& format_of_extension(const std::filesystem::path& path) {
  if (const io::Format* format = format_named_by(path)) return *format;
  const std::string extension = lower_case_extension(path);
  if (extension.empty()) throw Error(facts::io::NoExtension{.known = known_extensions()}, path);
  throw Error(facts::io::UnknownExtension{.extension = extension, .known = known_extensions()}, path);
}

const io::Format& format_of_content(std::string_view content, const std::filesystem::path& path) {
  for (const io::Format& format : io::formats()) {
    if (format.has_signature != nullptr && format.has_signature(content)) return format;
  }
  return format_of_extension(path);
}

Mesh read_as(const io::Format& format, std::string content, const std::filesystem::path& path,
             MemoryBudget& budget, const Context& context) try {
  return format.read(std::move(content), path.string(), budget, context);
} catch (const Error& error) {
  if (error.id() == facts::core::OverBudget::id && error.location().empty()) throw error.at(path);
  throw;
}

void require_morph_target(const MorphTarget& target, const Mesh& mesh, const std::filesystem::path& path) {
  require_morph_targets(path);
  if (target.rest.rows() != mesh.positions.rows())
    throw Error(facts::io::MorphTargetSize{.rows = target.rest.rows(), .vertices = mesh.positions.rows()},
                path);
}

}  // namespace

Mesh read_mesh(const std::filesystem::path& path, const Context& context) {
  context.step("read", 0);
  MemoryBudget budget(context);
  std::string content = read_file(path, budget, context);
  if (content.empty()) throw Error(facts::io::EmptyFile{}, path);
  const io::Format& format = format_of_content(content, path);
  Mesh mesh = read_as(format, std::move(content), path, budget, context);
  context.step("read", 1);
  return mesh;
}

WriteResult write_mesh(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
                       const Context& context) {
  context.step("write", 0);
  const io::Format& format = format_of_extension(path);
  if (options.morph_target) require_morph_target(*options.morph_target, mesh, path);
  io::Written written;
  try {
    written = format.write(mesh, path, options, context);
  } catch (const Error& error) {
    throw error.code() == ErrorCode::cancelled ? error : error.within(path);
  }
  context.throw_if_stopped();
  WriteResult result{{path}, std::move(written.notes)};
  // All files are written to the disk before the first one appears.
  std::vector<io::PendingFile> files;
  for (const io::NewFile& companion : written.companions) {
    files.emplace_back(companion.path, companion.content, io::Existing::replace, context.stop_token);
    result.files.push_back(companion.path);
  }
  files.emplace_back(path, written.content, options.overwrite ? io::Existing::replace : io::Existing::refuse,
                     context.stop_token);
  for (io::PendingFile& file : files) file.appear(context.stop_token);
  context.step("write", 1);
  return result;
}

std::vector<Note> notes_on_files(const Mesh& mesh) {
  std::vector<Note> notes;
  for (const io::FileDocument* document : io::documents_of(mesh)) {
    const io::Format* named = format_named_by(document->path);
    if (named != nullptr && named->name != document->format())
      notes.push_back(facts::io::OtherFormat{
          .file = document->path.filename(), .format = document->format(), .named = named->name});
  }
  return notes;
}

std::string unit_of(const Mesh& mesh) {
  const auto* document = dynamic_cast<const io::FileDocument*>(mesh.source.get());
  return document == nullptr ? std::string() : document->unit();
}

void require_mesh_format(const std::filesystem::path& path) { format_of_extension(path); }

void require_morph_targets(const std::filesystem::path& path) {
  if (!format_of_extension(path).has_morph_targets) throw Error(facts::io::NoMorphTargets{}, path);
}

std::vector<std::filesystem::path> files_behind(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> files{path};
  const io::Format* format = format_named_by(path);
  if (format != nullptr && format->companions != nullptr)
    for (std::filesystem::path& companion : format->companions(path)) files.push_back(std::move(companion));
  return files;
}

}  // namespace meshgraft
