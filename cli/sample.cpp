#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/samples/samples.h>

#include "choices.h"
#include "cli/facts.h"
#include "commands.h"
#include "outputs.h"

namespace meshgraft::cli {

namespace {

using Json = nlohmann::ordered_json;

struct SampleArguments {
  std::string name;
  std::filesystem::path output;
  int resolution = 0;
  int threads = 0;
  bool list = false;
  bool json = false;
};

void print_list(bool json) {
  Json list = Json::array();
  for (const SampleInfo& sample : sample_list()) {
    if (json)
      list.push_back({{"name", sample.name},
                      {"description", sample.description},
                      {"default_resolution", sample.default_resolution}});
    else
      fmt::print("{:<14}{} (resolution {})\n", sample.name, sample.description, sample.default_resolution);
  }
  if (json) fmt::print("{}\n", list.dump(2));
}

void make(const SampleArguments& arguments, Context context) {
  context.threads = arguments.threads;
  require_mesh_format(arguments.output);
  require_writable(arguments.output);
  const Mesh mesh = make_sample(arguments.name, arguments.resolution, context);
  context.step("write");
  write_mesh(mesh, arguments.output, {}, context);
  if (arguments.json) {
    const Json json = {{"sample", arguments.name},
                       {"output", arguments.output.string()},
                       {"vertices", mesh.vertex_count()},
                       {"faces", mesh.face_count()}};
    fmt::print("{}\n", json.dump(2));
  } else {
    fmt::print("{}: {} vertices, {} faces\n", arguments.output.string(), mesh.vertex_count(),
               mesh.face_count());
  }
}

void run_sample(const SampleArguments& arguments, const Context& context) {
  if (arguments.list) return print_list(arguments.json);
  if (arguments.name.empty()) throw Error(facts::cli::NoSample{}, "sample");
  if (arguments.output.empty()) throw Error(facts::cli::NoOutput{}, "sample");
  make(arguments, context);
}

}  // namespace

void add_sample(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<SampleArguments>();
  CLI::App* command = program.add_subcommand("sample", "Make one of the built-in models, or list them");
  command->add_option("name", arguments->name, "The sample's name")->type_name("NAME");
  command->add_option("-o,--output", arguments->output, "The mesh file to write; its extension is the format")
      ->type_name("FILE");
  command->add_option("--resolution", arguments->resolution, "How fine, 4 to 4096 (default: the sample's own)")
      ->type_name("N")
      ->check(whole_number_from(4, 4096));
  add_threads(*command, arguments->threads);
  command->add_flag("--list", arguments->list, "List the samples");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->footer(
      "Examples:\n  meshgraft sample --list\n  meshgraft sample octopus --resolution 96 -o octopus.ply");
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_sample(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
