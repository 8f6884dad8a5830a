#include <algorithm>
#include <filesystem>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "choices.h"
#include "commands.h"
#include "outputs.h"
#include "picture.h"
#include "render/facts.h"

namespace meshgraft::cli {

namespace {

struct RenderArguments {
  std::vector<std::filesystem::path> meshes;
  std::filesystem::path output;
  View view;
  bool wireframe = false, flat = false, no_ground = false, transparent = false;
  int threads = 0;
  std::uint64_t memory = 0;
};

render::RenderOptions render_options_of(const RenderArguments& arguments, const Mesh& mesh) {
  render::RenderOptions options = options_of(arguments.view, mesh);
  options.wireframe = arguments.wireframe;
  options.smooth = !arguments.flat;
  options.ground = !arguments.no_ground;
  options.transparent = arguments.transparent;
  return options;
}

// Throws Error(input) at the file unless a face of the mesh can be shown.
void require_face(const Mesh& mesh, const std::filesystem::path& file) {
  const auto is_finite = [&](Index vertex) { return mesh.positions.row(vertex).allFinite(); };
  for (Index face = 0; face < mesh.face_count(); ++face)
    if (std::ranges::all_of(mesh.faces[face], is_finite)) return;
  throw Error(facts::render::NoFace{}, file);
}

void run_render(const RenderArguments& arguments, Context context) {
  context.threads = arguments.threads;
  context.memory = arguments.memory;
  require_png(arguments.output);
  require_writable(arguments.output);
  check_view(arguments.view);
  require_not_an_input(arguments.output, arguments.meshes);
  std::vector<Mesh> meshes;
  std::vector<std::string> captions;
  for (const std::filesystem::path& path : arguments.meshes) {
    meshes.push_back(read_mesh(path, context));
    require_face(meshes.back(), path);
    captions.push_back(path.stem().string());
  }
  std::vector<const Mesh*> shown;
  for (const Mesh& mesh : meshes) shown.push_back(&mesh);
  const render::RenderOptions options = render_options_of(arguments, meshes.front());
  render::write_png(make_picture(shown, captions, options, context), arguments.output);
  fmt::print("{}\n", arguments.output.string());
}

}  // namespace

void add_render(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<RenderArguments>();
  CLI::App* command = program.add_subcommand(
      "render", "Make a picture of one mesh, or of several side by side, each at its place in space");
  command->add_option("mesh", arguments->meshes, "The mesh files")
      ->required()
      ->type_name("MESH")
      ->expected(1, 8);
  command->add_option("-o,--output", arguments->output, "The PNG file to write")->required()->type_name("FILE");
  add_view(*command, arguments->view, "0.5 -1 0.35, where up is 0 0 1");
  command->add_flag("--wireframe", arguments->wireframe, "Draw the edges");
  command->add_flag("--flat", arguments->flat, "Shade every face by its own normal");
  command->add_flag("--no-ground", arguments->no_ground, "Leave the shadow on the ground out");
  command->add_flag("--transparent", arguments->transparent,
                    "Leave the background out, and the ground with it");
  add_threads(*command, arguments->threads);
  add_memory(*command, arguments->memory);
  command->footer("Example:\n  meshgraft render before.ply after.ply -o picture.png");
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_render(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
