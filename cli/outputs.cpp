#include "outputs.h"

#include <algorithm>
#include <chrono>
#include <system_error>

#include <meshgraft/core/error.h>

#include "cli/facts.h"
#include "core/platform/file.h"
#include "io/facts.h"
#include "io/file.h"

namespace meshgraft::cli {

namespace {

namespace fs = std::filesystem;

// Returns whether two paths name the same file, however they are spelled, and through links.
bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code missing;
  if (fs::equivalent(a, b, missing) && !missing) return true;
  const auto whole = [](const fs::path& path) {
    std::error_code error;  // /dev/stdout may lead to no path, and links may form a cycle
    const fs::path end = fs::absolute(follow_links(path));
    const fs::path canonical = fs::weakly_canonical(end, error);
    return error ? end.lexically_normal() : canonical;
  };
  return whole(a) == whole(b);
}

fs::path folder_of(const fs::path& output) { return output.has_parent_path() ? output.parent_path() : "."; }

void require_access(const std::error_code& error, const fs::path& output) {
  if (error) throw io::file_error(output, facts::io::Action::write, error);
}

// Returns whether `output` is the material library beside an OBJ or the buffer beside a .gltf.
bool is_companion_of(const fs::path& mesh, const fs::path& output) {
  const fs::path extension = mesh.extension();
  const bool is_obj = extension == ".obj" || extension == ".OBJ";
  const bool is_gltf = extension == ".gltf" || extension == ".GLTF";
  return (is_obj && same_file(output, fs::path(mesh).replace_extension(".mtl"))) ||
         (is_gltf && same_file(output, fs::path(mesh).replace_extension(".bin")));
}

void require_distinct(const Outputs& outputs) {
  const std::vector<fs::path> all = outputs.all();
  for (auto output = all.begin(); output != all.end(); ++output) {
    if (std::any_of(all.begin(), output, [&](const fs::path& other) { return same_file(*output, other); }))
      throw Error(facts::cli::OutputsOfOneName{}, *output);
    for (const fs::path& mesh : outputs.meshes())
      if (is_companion_of(mesh, *output)) throw Error(facts::cli::CompanionOfOutput{.mesh = mesh}, *output);
  }
}

}  // namespace

std::vector<fs::path> Outputs::all() const {
  std::vector<fs::path> list = meshes();
  for (const fs::path& output : {picture, report, edit})
    if (!output.empty()) list.push_back(output);
  return list;
}

std::vector<fs::path> Outputs::meshes() const {
  std::vector<fs::path> list = more_meshes;
  if (!mesh.empty()) list.insert(list.begin(), mesh);
  return list;
}

void require_not_an_input(const fs::path& output, const std::vector<fs::path>& inputs, const Fact& error) {
  if (std::any_of(inputs.begin(), inputs.end(),
                  [&](const fs::path& input) { return same_file(output, input); }))
    throw Error(error, output);
}

bool names_a_mesh(const fs::path& file) {
  try {
    require_mesh_format(file);
    return true;
  } catch (const Error&) {
    return false;
  }
}

void require_png(const fs::path& output) {
  if (output.extension() != ".png" && output.extension() != ".PNG")
    throw Error(facts::cli::NotAPicture{}, output);
}

void require_writable(const fs::path& output) {
  const fs::path folder = folder_of(output);
  if (fs::exists(folder) && !fs::is_directory(folder)) throw Error(facts::cli::NotAFolder{}, folder);
  if (!fs::exists(folder)) throw Error(facts::cli::NoSuchFolder{}, folder);
  if (!output.has_filename() || fs::is_directory(output)) throw Error(facts::io::IsFolder{}, output);
  if (fs::exists(output)) require_access(platform::check_may_write(output), output);
  if (!fs::exists(output) || fs::is_regular_file(output))
    require_access(platform::check_may_create_in(folder), output);
}

void require_outputs(const Outputs& outputs, const std::vector<fs::path>& inputs, const fs::path& edit,
                     bool force) {
  if (!outputs.picture.empty()) require_png(outputs.picture);
  require_distinct(outputs);
  const std::vector<fs::path> meshes = outputs.meshes();
  for (const fs::path& output : outputs.all()) {
    require_writable(output);
    if (!edit.empty()) require_not_an_input(output, {edit});
    const bool is_mesh = std::find(meshes.begin(), meshes.end(), output) != meshes.end();
    if (!is_mesh)
      require_not_an_input(output, inputs);
    else if (!force)
      require_not_an_input(output, inputs, facts::cli::OutputIsInputMesh{});
    if (!fs::exists(output)) continue;
    for (const fs::path& input : inputs) {
      std::vector<fs::path> behind = files_behind(input);
      behind.erase(behind.begin());
      if (std::any_of(behind.begin(), behind.end(),
                      [&](const fs::path& file) { return same_file(output, file); }))
        throw Error(facts::cli::BelongsToInput{.input = input}, output);
    }
  }
  for (const fs::path& mesh : meshes) require_mesh_format(mesh);
}

void write_and_report(const Mesh& mesh, const fs::path& output, EditReport& report, const WriteOptions& options,
                      const Context& context) {
  const auto start = std::chrono::steady_clock::now();
  context.step("write");
  WriteResult written = write_mesh(mesh, output, options, context);
  for (const fs::path& file : written.files) report.outputs.push_back(file.string());
  report.notes.insert(report.notes.end(), written.notes.begin(), written.notes.end());
  report.seconds.write = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.seconds.total += report.seconds.write;
}

}  // namespace meshgraft::cli
