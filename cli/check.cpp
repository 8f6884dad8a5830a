#include <algorithm>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/report.h>
#include <meshgraft/script/run_edit.h>

#include "choices.h"
#include "commands.h"
#include "exit_status.h"
#include "findings.h"
#include "merge/loops.h"
#include "outputs.h"
#include "script/fact_json.h"
#include "wording.h"

namespace meshgraft::cli {

namespace {

using Json = nlohmann::ordered_json;

struct CheckArguments {
  int threads = 0;
  std::uint64_t memory = 0;
  std::filesystem::path file;
  bool json = false;
  bool intersections = false;
};

// A search for self-intersections takes seconds above this size.
constexpr Index most_triangles_searched = 1'000'000;

// The operations that a mesh allows as it is.
struct Uses {
  std::size_t components = 0;      // connected components
  bool deform = false;             // deformable everywhere
  bool deform_beyond = false;      // deformable where no refused finding is within reach
  std::vector<std::size_t> loops;  // numbers of the boundary loops that a merge can use
  std::size_t all_loops = 0;
};

// Returns the numbers of the boundary loops that a merge can use. A merge takes away the ring of faces at a
// target's loop, so these must be sound, too.
std::vector<std::size_t> mergeable_loops(const Mesh& mesh, const Diagnostics& diagnostics,
                                         const std::vector<std::vector<Index>>& loops) {
  const auto none = loops.size();
  std::vector<std::size_t> loop_at(static_cast<std::size_t>(mesh.vertex_count()), none);
  for (std::size_t k = 0; k < loops.size(); ++k)
    for (const Index v : loops[k]) loop_at[v] = k;
  Flags unsound(mesh.vertex_count(), false);
  for (const FindingKind kind :
       {FindingKind::non_manifold_edge, FindingKind::non_manifold_vertex, FindingKind::inconsistent_winding})
    if (const Finding* finding = diagnostics.find(kind))
      for (const Index v : finding->indices) unsound[v] = true;
  Flags refused(static_cast<Index>(loops.size()), false);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    if (std::ranges::any_of(face, [&](Index v) { return v >= 0 && v < mesh.vertex_count() && unsound[v]; }))
      for (const Index v : face)
        if (v >= 0 && v < mesh.vertex_count() && loop_at[v] != none) refused[loop_at[v]] = true;
  }
  std::vector<std::size_t> numbers = usable_loops(mesh);
  std::erase_if(numbers, [&](std::size_t k) { return refused[k]; });
  return numbers;
}

Uses uses_of(const Mesh& mesh, const Diagnostics& diagnostics) {
  Uses uses;
  const bool refused =
      std::any_of(diagnostics.findings.begin(), diagnostics.findings.end(),
                  [](const Finding& finding) { return finding.severity == Severity::refused; });
  const bool has_faces = mesh.face_count() > 0;
  uses.deform = has_faces && !refused;
  uses.deform_beyond = has_faces && refused;
  uses.components = static_cast<std::size_t>(summarise_topology(mesh).components);
  const auto loops = boundary_loops(mesh);
  uses.all_loops = loops.size();
  uses.loops = mergeable_loops(mesh, diagnostics, loops);
  return uses;
}

std::string uses_text(const Uses& uses) {
  const std::string deform = uses.deform && uses.components > 1
                                 ? fmt::format(
                                       "deform: yes, where something holds each of the {} components that it "
                                       "moves",
                                       uses.components)
                             : uses.deform ? "deform: yes"
                             : uses.deform_beyond
                                 ? "deform, cut and merge: where nothing that is refused is within reach"
                                 : "deform: no, there are no faces";
  const std::string merge =
      !uses.deform && !uses.deform_beyond ? "merge: no"
      : uses.all_loops == 0               ? "merge: cut it open first, or drop a source on it with --at"
      : uses.loops.empty()                ? "merge: no loop is sound"
      : uses.loops.size() == uses.all_loops
          ? fmt::format("merge: along {}", uses.all_loops == 1 ? "its loop" : "all its loops")
          : fmt::format("merge: along {} of {} loops", uses.loops.size(), uses.all_loops);
  return deform + "; " + merge;
}

// Returns a word as a POSIX shell reads it, in quotation marks where it needs them.
std::string shell_word(const std::string& word) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+./,:@%";
  if (!word.empty() && word.front() != '-' && word.find_first_not_of(plain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word)
    if (c == '\'')
      quoted += "'\\''";
    else
      quoted += c;
  return quoted + "'";
}

// Returns the command that mends a mesh file. Its output is a PLY file where the input's name has no known
// extension.
std::string repair_command(const std::filesystem::path& mesh) {
  const std::filesystem::path input = mesh.native().starts_with('-') ? "." / mesh : mesh;
  const std::string extension = names_a_mesh(mesh) ? mesh.extension().string() : ".ply";
  std::filesystem::path output = input.filename().stem();
  output += "_repaired" + extension;
  if (output.native().starts_with('-')) output = "." / output;
  return fmt::format("meshgraft repair {} -o {}", shell_word(input.string()), shell_word(output.string()));
}

// Openings may be meant. Closing them is a choice and mends nothing.
bool is_choice(const RepairChange& change) { return change.kind == RepairChangeKind::filled_hole; }

// The changes that a repair would make; `leaves_faces` tells whether a face would remain.
struct RepairTrial {
  std::vector<RepairChange> changes;
  bool leaves_faces = false;
};

RepairTrial try_repair(const Mesh& mesh, const Context& context) {
  if (mesh.face_count() == 0) return {};
  RepairResult result = repair(mesh, {}, context);
  return {std::move(result.changes), result.mesh.face_count() > 0};
}

// Returns the number of pairs of triangles that intersect; nothing for a mesh with too many triangles.
std::optional<std::int64_t> self_intersections_of(const Mesh& mesh, bool whatever_the_size,
                                                  const Context& context) {
  const Triangulation pieces = triangulate(mesh, {.skip_out_of_range = true});
  if (pieces.triangles.rows() > most_triangles_searched && !whatever_the_size) return std::nullopt;
  std::vector<Index> all(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(all.begin(), all.end(), Index{0});
  return count_self_intersections(mesh.positions, pieces.triangles, all, context);
}

Json changes_json(const std::vector<RepairChange>& changes) {
  Json list = Json::array();
  constexpr std::size_t most = 10;
  for (const RepairChange& change : changes) {
    const auto end =
        change.indices.begin() + static_cast<std::ptrdiff_t>(std::min(most, change.indices.size()));
    list.push_back(change_json(change));
    list.back()["first"] = std::vector<Index>(change.indices.begin(), end);
    list.back()["choice"] = is_choice(change);
  }
  return list;
}

// All that a check finds out about one mesh.
struct CheckedMesh {
  Mesh mesh;
  Diagnostics diagnostics;
  RepairTrial repair;
  std::optional<std::int64_t> intersections;
  Uses uses;

  // Whether a repair mends something. It cannot where coordinates are too large, or the surface has one side.
  bool repairable() const {
    return mesh.face_count() > 0 && !diagnostics.find(FindingKind::coordinate_too_large) &&
           !std::ranges::all_of(repair.changes, is_choice);
  }
  bool clean() const { return mesh.face_count() > 0 && sound(); }

 private:
  bool sound() const { return !diagnostics.has_defects() && std::ranges::all_of(repair.changes, is_choice); }
};

CheckedMesh check(Mesh mesh, bool intersections, const Context& context) {
  CheckedMesh checked{.mesh = std::move(mesh)};
  checked.diagnostics = check_mesh(checked.mesh, context);
  checked.repair = try_repair(checked.mesh, context);
  checked.intersections = self_intersections_of(checked.mesh, intersections, context);
  checked.uses = uses_of(checked.mesh, checked.diagnostics);
  return checked;
}

// Adds what was found out about a mesh to `json`.
void add_to(Json& json, const CheckedMesh& checked) {
  const auto& [mesh, diagnostics, repair, intersections, uses] = checked;
  json["clean"] = checked.clean();
  json["counts"] = {{"vertices", mesh.vertex_count()}, {"faces", mesh.face_count()}};
  json["findings"] = Json::parse(write_diagnostics(diagnostics, text_of));
  json["repair"] = changes_json(repair.changes);
  json["self_intersections"] = intersections ? Json(*intersections) : Json(nullptr);
  json["components"] = uses.components;
  json["deform"] = uses.deform ? "everywhere" : uses.deform_beyond ? "partly" : "no";
  json["notes"] = to_json(notes_on_files(mesh), text_of);
  json["loops"] = uses.all_loops;
  json["mergeable_loops"] = uses.loops;
}

void print_line(std::string_view label, const std::string& text) { fmt::print("  {:<12}{}\n", label, text); }

// Prints what a repair would change, besides what the findings say.
void print_changes(const std::vector<RepairChange>& changes) {
  std::string_view label = "a repair";
  for (const RepairChange& change : changes) {
    print_line(label, fmt::format("{}: {}{}", name_of(change.kind), text_of(change.note).statement,
                                  is_choice(change) ? " (a choice: openings may be meant)" : ""));
    label = "";
  }
}

// Prints what was found out about the mesh `name`. `file` is where it was read; empty for a sample.
void print(const std::string& name, const std::filesystem::path& file, const CheckedMesh& checked) {
  const auto& [mesh, diagnostics, repair, intersections, uses] = checked;
  fmt::print("{}: {} vertices, {} faces\n", name, mesh.vertex_count(), mesh.face_count());
  if (mesh.face_count() == 0)
    print_line("findings", "no faces: there is no surface to edit");
  else
    print_findings(diagnostics, "findings");
  print_changes(repair.changes);
  if (!intersections)
    print_line("intersects", "not searched among so many triangles: --intersections does it");
  else if (*intersections > 0)
    print_line("intersects", fmt::format("{} pairs of triangles of the surface intersect", *intersections));
  if (checked.repairable() && !file.empty())
    print_line("to mend",
               repair.leaves_faces ? repair_command(file) : "make it anew: a repair would leave no face");
  print_line("as it is", uses_text(uses));
  for (const Note& note : notes_on_files(mesh)) print_line("note", sentence(note));
}

void check_mesh_file(const CheckArguments& arguments, const Context& context) {
  const CheckedMesh checked = check(read_mesh(arguments.file, context), arguments.intersections, context);
  if (arguments.json) {
    Json json = {{"format", "meshgraft-check"}, {"version", 1}, {"mesh", arguments.file.string()}};
    add_to(json, checked);
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  } else {
    print(arguments.file.string(), arguments.file, checked);
  }
  if (!checked.clean()) throw Answer{exit_status(ErrorCode::input)};
}

// Runs the steps of an edit and returns the error that ends them, if there is one.
std::optional<Error> failure_of(const EditFile& edit, const Context& context) {
  try {
    run_edit(edit, {}, context);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    return error;
  }
  return std::nullopt;
}

// Checks the inputs of an edit, and then runs its steps. Some defects keep a mesh from one edit and not from
// another, e.g. a component that no handle of the edit holds.
void check_edit_file(const CheckArguments& arguments, const Context& context) {
  const EditFile edit = read_edit_file(arguments.file);
  Json inputs = Json::array();
  bool clean = true;
  for (const EditInput& input : edit.inputs) {
    const CheckedMesh checked = check(load_input(input, edit, context), arguments.intersections, context);
    clean = clean && checked.clean();
    if (arguments.json) {
      inputs.push_back({{"name", input.name}, {"mesh", input.file.empty() ? input.sample : input.file}});
      add_to(inputs.back(), checked);
    } else {
      const std::string from = input.file.empty() ? "sample " + input.sample : input.file;
      print(fmt::format("{} ({})", input.name, from),
            input.file.empty() ? std::filesystem::path() : edit.base_folder / input.file, checked);
    }
  }
  const std::optional<Error> failure = failure_of(edit, context);
  if (arguments.json) {
    Json json = {{"format", "meshgraft-check"}, {"version", 1}, {"edit", arguments.file.string()}};
    json["clean"] = clean;
    json["inputs"] = inputs;
    json["runs"] = !failure;
    json["notes"] = to_json(edit.notes, text_of);
    json["error"] = failure ? Json{{"id", failure->id()}, {"text", sentence(*failure)}} : Json(nullptr);
    fmt::print("{}\n", json.dump(2, ' ', false, Json::error_handler_t::replace));
  } else {
    fmt::print("{}: {} {}\n", arguments.file.string(), edit.steps.size(),
               edit.steps.size() == 1 ? "step" : "steps");
    print_line("as it is", failure ? "fails: " + sentence(*failure) : "runs");
    for (const Note& note : edit.notes) print_line("note", sentence(note));
  }
  if (failure) throw Answer{exit_status(failure->code())};
  if (!clean) throw Answer{exit_status(ErrorCode::input)};
}

void run_check(const CheckArguments& arguments, Context context) {
  context.threads = arguments.threads;
  context.memory = arguments.memory;
  context.step("read");
  if (arguments.file.extension() == ".json")
    check_edit_file(arguments, context);
  else
    check_mesh_file(arguments, context);
}

}  // namespace

void add_check(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = program.add_subcommand("check",
                                             "Name what is wrong with a mesh, or with an edit and its meshes, "
                                             "and what to do about it; exit status 0 if "
                                             "nothing is");
  command->add_option("file", arguments->file, "The mesh file, or an edit file")->required()->type_name("FILE");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->add_flag("--intersections", arguments->intersections,
                    "Look for self-intersections also among more than a million triangles");
  command->footer("Example:\n  meshgraft check scan.ply && meshgraft check edit.json");
  add_threads(*command, arguments->threads);
  add_memory(*command, arguments->memory);
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_check(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
