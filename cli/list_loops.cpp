#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/topology.h>

#include "choices.h"
#include "cli/facts.h"
#include "commands.h"
#include "loops.h"
#include "values.h"

namespace meshgraft::cli {

namespace {

using Json = nlohmann::ordered_json;

struct LoopsArguments {
  std::filesystem::path mesh, source;
  bool starts = false, fix_winding = false, json = false;
  std::vector<std::string> pairs;
  std::string upright;
  std::uint64_t memory = 0;
};

// A mesh with its boundary loops.
struct LoopsOfMesh {
  Mesh mesh;
  std::vector<std::vector<Index>> loops;
};

LoopsOfMesh read_loops(const std::filesystem::path& path, const Context& context) {
  LoopsOfMesh found{read_mesh(path, context), {}};
  found.loops = boundary_loops(found.mesh);
  return found;
}

void list_loops(const LoopsOfMesh& mesh, const LoopsArguments& arguments) {
  const std::vector<LoopFacts> facts = loop_facts(mesh.mesh, mesh.loops);
  if (arguments.json) {
    Json loops = Json::array();
    for (std::size_t k = 0; k < facts.size(); ++k) loops.push_back(loop_json(k, facts[k]));
    fmt::print("{}\n", Json::object({{"loops", loops}}).dump(2));
    return;
  }
  if (facts.empty()) fmt::print("{} is closed: it has no boundary loop\n", arguments.mesh.string());
  for (std::size_t k = 0; k < facts.size(); ++k) fmt::print("loop {}: {}\n", k, loop_text(facts[k]));
}

// Numbers of loops that meet, target first.
using NumberedPair = std::array<Index, 2>;

std::vector<NumberedPair> numbered_pairs(const LoopsOfMesh& target, const LoopsOfMesh& source,
                                         const LoopsArguments& arguments) {
  std::vector<NumberedPair> pairs;
  for (const std::string& text : arguments.pairs) pairs.push_back(index_pair(text, "--pair"));
  if (pairs.empty() && target.loops.size() == 1 && source.loops.size() == 1) pairs.push_back({0, 0});
  for (const auto& [mesh, path] : {std::pair(&target, &arguments.mesh), {&source, &arguments.source}})
    if (mesh->loops.empty()) throw Error(facts::cli::ClosedMesh{}, *path);
  if (pairs.empty())
    throw Error(facts::cli::LoopsToPair{.target = target.loops.size(), .source = source.loops.size()},
                "--pair");
  for (const auto& [there, here] : pairs) {
    if (static_cast<std::size_t>(there) >= target.loops.size())
      throw Error(facts::cli::NoSuchLoop{.loop = there, .count = target.loops.size()}, arguments.mesh);
    if (static_cast<std::size_t>(here) >= source.loops.size())
      throw Error(facts::cli::NoSuchLoop{.loop = here, .count = source.loops.size()}, arguments.source);
  }
  return pairs;
}

Json starts_json(const NumberedPair& pair, const std::vector<StartCandidate>& starts) {
  Json list = Json::array();
  for (const auto& [start, probability, turn_deg] : starts)
    list.push_back({{"target", start.target},
                    {"source", start.source},
                    {"probability", probability},
                    {"turn_deg", turn_deg}});
  return {{"target_loop", pair[0]}, {"source_loop", pair[1]}, {"starts", list}};
}

void print_starts(const NumberedPair& pair, const std::vector<StartCandidate>& starts) {
  fmt::print("target loop {} and source loop {}:\n", pair[0], pair[1]);
  if (starts.empty()) fmt::print("  the other pairs determine the start\n");
  for (const auto& [start, probability, turn_deg] : starts)
    fmt::print(
        "  {:3.0f} %  --start {}:{}{}\n", 100 * probability, start.target, start.source,
        &start == &starts.front().start ? "" : fmt::format("  (turned by {:.0f}° from the first)", turn_deg));
}

void list_starts(const LoopsOfMesh& target, const LoopsOfMesh& source, const LoopsArguments& arguments) {
  const std::vector<NumberedPair> numbers = numbered_pairs(target, source, arguments);
  std::vector<MergePair> pairs;
  for (const auto& [there, here] : numbers) pairs.push_back({{source.loops[here], target.loops[there]}, {}});
  MergeOptions options;
  options.fix_winding = arguments.fix_winding;
  if (!arguments.upright.empty()) {
    const UprightModels known = parse_upright(arguments.upright, "--upright");
    options.target_orientations = {{known.target}};
    options.source_orientations = {{known.source}};
  }
  const std::vector<std::vector<StartCandidate>> starts = find_starts(target.mesh, source.mesh, pairs, options);
  if (arguments.json) {
    Json list = Json::array();
    for (std::size_t p = 0; p < numbers.size(); ++p) list.push_back(starts_json(numbers[p], starts[p]));
    fmt::print("{}\n", Json::object({{"pairs", list}}).dump(2));
    return;
  }
  for (std::size_t p = 0; p < numbers.size(); ++p) print_starts(numbers[p], starts[p]);
}

void run_loops(const LoopsArguments& arguments, Context context) {
  context.memory = arguments.memory;
  for (const auto& [given, option] : {std::pair(!arguments.pairs.empty(), "--pair"),
                                      {!arguments.upright.empty(), "--upright"},
                                      {arguments.fix_winding, "--fix-winding"}})
    if (given && !arguments.starts) throw Error(facts::cli::OptionNeeds{.option = option, .other = "--starts"});
  if (arguments.starts == arguments.source.empty()) throw Error(facts::cli::StartsNeedSource{}, "--starts");
  const LoopsOfMesh mesh = read_loops(arguments.mesh, context);
  if (arguments.source.empty())
    list_loops(mesh, arguments);
  else
    list_starts(mesh, read_loops(arguments.source, context), arguments);
}

}  // namespace

void add_loops(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<LoopsArguments>();
  CLI::App* command = program.add_subcommand(
      "loops", "List the boundary loops of a mesh, or the starts from which those of two meshes may meet");
  command->add_option("mesh", arguments->mesh, "The mesh; with a source, the target")
      ->required()
      ->type_name("MESH");
  command->add_option("source", arguments->source, "With --starts: the mesh to graft")->type_name("SOURCE");
  command->add_flag("--starts", arguments->starts,
                    "List the starts that a person may mean, with their probabilities; merge takes the first");
  command->add_option("--pair", arguments->pairs, "With --starts: loops that meet; repeatable")
      ->type_name("TARGET:SOURCE")
      ->expected(1)
      ->take_all();
  add_upright(*command, arguments->upright);
  command->add_flag("--fix-winding", arguments->fix_winding, "Turn the source inside out where loops need it");
  add_memory(*command, arguments->memory);
  command->add_flag("--json", arguments->json, "Print JSON");
  command->footer("Example:\n  meshgraft loops bust.ply head.ply --starts");
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_loops(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
