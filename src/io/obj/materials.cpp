#include "materials.h"

#include <algorithm>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "io/facts.h"
#include "io/file.h"
#include "mesh/join.h"
#include "mtl.h"

namespace meshgraft::io {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view own_mark = "# Materials, put together by meshgraft for ";

/// Returns the texts of the mtllib lines, each once.
std::vector<std::string> library_lines(std::string_view obj) {
  std::vector<std::string> lines;
  ObjCursor cursor(obj);
  while (cursor.next_line()) {
    if (cursor.keyword() != "mtllib") continue;
    const std::string line(cursor.rest_of_line());
    if (!line.empty() && std::ranges::find(lines, line) == lines.end()) lines.push_back(line);
  }
  return lines;
}

/// Returns the names in an mtllib line. It holds one name that may contain blanks, or several names between
/// blanks.
std::vector<std::string> library_names(const std::string& line, const fs::path& folder) {
  std::error_code ignored;
  if (fs::exists(folder / line, ignored)) return {line};
  std::vector<std::string> names;
  for (std::size_t begin = 0; begin < line.size();) {
    const std::size_t end = std::min(line.find_first_of(" \t", begin), line.size());
    if (end > begin) names.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  const bool any =
      std::ranges::any_of(names, [&](const std::string& name) { return fs::exists(folder / name, ignored); });
  return any ? names : std::vector<std::string>{line};
}

/// Returns the names in all mtllib lines.
std::vector<std::string> library_names_of(std::string_view obj, const fs::path& folder) {
  std::vector<std::string> all;
  for (const std::string& line : library_lines(obj)) {
    const std::vector<std::string> names = library_names(line, folder);
    all.insert(all.end(), names.begin(), names.end());
  }
  return all;
}

bool same_folder(const fs::path& a, const fs::path& b) {
  const auto whole = [](const fs::path& path) {
    return fs::weakly_canonical(fs::absolute(path)).parent_path();
  };
  return whole(a) == whole(b);
}

bool is_file(const fs::path& a, const fs::path& b) {
  std::error_code missing;
  return fs::equivalent(a, b, missing) && !missing;
}

/// Returns the materials that at least one face has.
std::vector<std::string> used_materials(const Mesh& mesh) {
  const Attribute* material = mesh.find_attribute(Domain::face, "material");
  if (material == nullptr) return {};
  Flags used(material->labels.size(), false);
  for (const double value : material->values)
    if (value >= 0 && value < static_cast<double>(used.size())) used[static_cast<std::size_t>(value)] = true;
  std::vector<std::string> names;
  for (std::size_t k = 0; k < used.size(); ++k)
    if (used[k]) names.push_back(material->labels[k]);
  return names;
}

/// Returns the reason that the system gave for an error of `read_file`.
std::string reason_of(const Error& error) {
  if (error.id() == facts::io::IsFolder::id) return std::make_error_code(std::errc::is_a_directory).message();
  return error.fact().get<std::string>("reason");
}

/// Composes a material library, definition by definition.
class Library {
 public:
  Library(const Mesh& mesh, const fs::path& path) : path_(path), used_(used_materials(mesh)) {}

  void add(const JoinedSources::File& source, const ObjDocument& document) {
    const fs::path folder = document.path.parent_path();
    for (const std::string& name : library_names_of(document.content, folder)) {
      const fs::path library = folder / name;
      libraries_.push_back(library);
      try {
        add(source, parse_mtl(read_file(library)), library.parent_path());
      } catch (const Error& error) {
        if (std::ranges::find(unread_, name) == unread_.end()) unread_.push_back(name);
        add_note(facts::io::LibraryNotRead{
            .file = document.path.filename(), .library = library, .reason = reason_of(error)});
      }
    }
  }

  ObjMaterials finish() && {
    ObjMaterials materials;
    for (const std::string& name : used_)
      if (!defined_.contains(name) && notes_.empty())
        materials.notes.push_back(facts::io::MaterialUndefined{.material = name});
    materials.notes.insert(materials.notes.begin(), notes_.begin(), notes_.end());
    materials.libraries = unread_;
    if (defined_.empty()) return materials;
    const fs::path file = free_path();
    materials.libraries.push_back(file.filename().string());
    materials.library =
        NewFile{file, std::string(own_mark) + path_.filename().string() + "\n" + std::move(text_)};
    return materials;
  }

 private:
  void add_note(Note note) {
    if (std::ranges::find(notes_, note) == notes_.end()) notes_.push_back(std::move(note));
  }

  void add(const JoinedSources::File& source, const std::vector<MtlMaterial>& definitions,
           const fs::path& folder) {
    for (const auto& [in_file, now] : source.materials) {
      const auto definition = std::ranges::find(definitions, in_file, &MtlMaterial::name);
      if (definition == definitions.end() || std::ranges::find(used_, now) == used_.end()) continue;
      if (!defined_.insert(now).second) continue;
      text_ += "\nnewmtl " + now + "\n";
      for (const std::string& line : definition->lines) text_ += seen_from_here(line, folder) + "\n";
    }
  }

  std::string seen_from_here(const std::string& line, const fs::path& folder) const {
    const std::string_view texture = texture_in(line);
    if (texture.empty()) return line;
    const auto begin = static_cast<std::size_t>(texture.data() - line.data());
    return line.substr(0, begin) + texture_from(path_.parent_path(), folder, texture);
  }

  /// Returns a free file name beside the OBJ, after its name. An existing file is replaced only if meshgraft
  /// wrote it and it is not an input.
  fs::path free_path() const {
    for (int k = 1;; ++k) {
      fs::path candidate = path_;
      candidate.replace_filename(path_.stem().string() + (k == 1 ? "" : fmt::format("_{}", k)) + ".mtl");
      if (!fs::exists(fs::symlink_status(candidate))) return candidate;
      const bool is_input =
          std::ranges::any_of(libraries_, [&](const fs::path& library) { return is_file(candidate, library); });
      if (!is_input && fs::is_regular_file(candidate) && read_file(candidate).starts_with(own_mark))
        return candidate;
    }
  }

  fs::path path_;
  std::vector<std::string> used_;
  std::set<std::string> defined_;
  std::vector<Note> notes_;  // each once
  std::vector<fs::path> libraries_;
  std::vector<std::string> unread_;  // libraries that could not be read; their names stay
  std::string text_;
};

bool keeps_names(const JoinedSources::File& source) {
  return std::ranges::all_of(source.materials, [](const auto& names) { return names.first == names.second; });
}

}  // namespace

ObjMaterials materials_for(const Mesh& mesh, const fs::path& path) {
  const auto sources = sources_of(mesh);
  if (!sources) return {};
  std::vector<std::pair<const JoinedSources::File*, const ObjDocument*>> files;
  std::set<const ObjDocument*> documents;
  for (const JoinedSources::File& source : sources->files) {
    const auto* document = dynamic_cast<const ObjDocument*>(source.document.get());
    if (document == nullptr || library_lines(document->content).empty()) continue;
    files.emplace_back(&source, document);
    documents.insert(document);
  }
  if (documents.empty()) return {};
  const bool as_it_was = documents.size() == 1 && same_folder((*documents.begin())->path, path) &&
                         std::ranges::all_of(files, [](const auto& file) { return keeps_names(*file.first); });
  if (as_it_was) return {library_lines((*documents.begin())->content), std::nullopt, {}};
  Library library(mesh, path);
  for (const auto& [source, document] : files) library.add(*source, *document);
  return std::move(library).finish();
}

std::vector<std::string> material_libraries_of(const Mesh& mesh) {
  std::vector<std::string> names;
  if (used_materials(mesh).empty()) return names;
  for (const FileDocument* file : documents_of(mesh))
    if (const auto* document = dynamic_cast<const ObjDocument*>(file))
      for (const std::string& line : library_lines(document->content)) names.push_back(line);
  return names;
}

std::vector<std::string> libraries_to_copy(const ObjDocument& document, const fs::path& path) {
  std::vector<std::string> names;
  if (same_folder(document.path, path)) return names;
  std::error_code ignored;
  const fs::path folder = document.path.parent_path();
  for (const std::string& name : library_names_of(document.content, folder))
    if (fs::exists(folder / name, ignored) && !fs::exists(path.parent_path() / name, ignored))
      names.push_back(name);
  return names;
}

std::vector<MaterialTexture> textures_of(const ObjDocument& document) {
  std::vector<MaterialTexture> textures;
  std::error_code ignored;
  const fs::path folder = document.path.parent_path();
  for (const std::string& name : library_names_of(document.content, folder)) {
    const fs::path library = folder / name, around = library.parent_path();
    if (!fs::is_regular_file(library, ignored)) continue;
    for (const MtlMaterial& material : parse_mtl(read_file(library)))
      for (const std::string& line : material.lines) {
        const std::string_view texture = line.starts_with("map_Kd") ? texture_in(line) : std::string_view();
        const fs::path file = around / texture_from(around, around, texture);
        if (texture.empty() || !fs::is_regular_file(file, ignored)) continue;
        textures.push_back({material.name, file, {}});
        break;
      }
  }
  return textures;
}

std::vector<fs::path> files_of_materials(const fs::path& path) {
  std::vector<fs::path> files;
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return files;
  const std::string content = read_file(path);
  const auto add = [&](const fs::path& file) {
    if (fs::exists(file, ignored)) files.push_back(file);
  };
  for (const std::string& name : library_names_of(content, path.parent_path())) {
    const fs::path library = path.parent_path() / name;
    add(library);
    if (!fs::is_regular_file(library, ignored)) continue;
    for (const MtlMaterial& material : parse_mtl(read_file(library)))
      for (const std::string& line : material.lines)
        if (const std::string_view texture = texture_in(line); !texture.empty())
          add(library.parent_path() / texture_from(library.parent_path(), library.parent_path(), texture));
  }
  return files;
}

}  // namespace meshgraft::io
