#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/core/version.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/topology.h>

#include "choices.h"
#include "cli/facts.h"
#include "commands.h"
#include "io/file.h"
#include "loops.h"
#include "mesh/sound_mesh.h"
#include "outputs.h"
#include "picture.h"
#include "script/fact_json.h"
#include "script/pin_field.h"
#include "script/report_json.h"
#include "script/vector_json.h"
#include "values.h"
#include "wording.h"

namespace meshgraft::cli {

namespace {

using Json = nlohmann::ordered_json;

struct CutArguments {
  int threads = 0;
  std::uint64_t memory = 0;
  std::filesystem::path mesh, output, report, picture;
  std::string plane, loop;
  std::optional<CutKeep> keep;
  bool cap = false, pins = false;
  std::optional<Index> pin_count;
  std::optional<double> pin_diameter, pin_length, pin_clearance;
  std::optional<PinSide> pin_side;
  double snap = CutOptions{}.snap;
  bool json = false;
  bool force = false;
#ifdef MESHGRAFT_HAS_RENDER
  View view{.width = picture_width, .height = picture_height};
#endif

  const char* by() const { return loop.empty() ? "--plane" : "--loop"; }
};

void check_outputs(const CutArguments& arguments) {
  require_outputs({.mesh = arguments.output, .picture = arguments.picture, .report = arguments.report},
                  {arguments.mesh}, {}, arguments.force);
#ifdef MESHGRAFT_HAS_RENDER
  check_view(arguments.view);
#endif
}

std::string_view keep_name(CutKeep keep) {
  return keep == CutKeep::both ? "both" : keep == CutKeep::above ? "above" : "below";
}

std::string_view cap_name(CutCap cap) {
  return cap == CutCap::open ? "open" : cap == CutCap::flat ? "flat" : "pins";
}

std::string_view side_name(int side) { return side > 0 ? "above" : side < 0 ? "below" : "both sides"; }

// The cut that the command line asks for, parsed before the mesh is read.
struct CutAlong {
  std::optional<Plane> plane;
  std::vector<Index> loop;
};

CutAlong along(const CutArguments& arguments) {
  if (arguments.plane.empty() && arguments.loop.empty()) throw Error(facts::cli::NoCut{}, "cut");
  if (!arguments.loop.empty()) return {{}, numbers<Index>(arguments.loop, "--loop")};
  return {parse_plane(arguments.plane, "--plane"), {}};
}

// Returns the options of the cut. An option of the pins asks for pins.
CutOptions options_of(const CutArguments& arguments) {
  const bool has_pins = arguments.pins || arguments.pin_count || arguments.pin_diameter ||
                        arguments.pin_length || arguments.pin_clearance || arguments.pin_side;
  return {.keep = arguments.keep.value_or(CutKeep::both),
          .snap = arguments.snap,
          .cap = has_pins        ? CutCap::pins
                 : arguments.cap ? CutCap::flat
                                 : CutCap::open,
          .pin_count = arguments.pin_count,
          .pin_diameter = arguments.pin_diameter,
          .pin_length = arguments.pin_length,
          .pin_clearance = arguments.pin_clearance,
          .pin_side = arguments.pin_side.value_or(PinSide::below)};
}

// Returns where an error of the cut is on the command line: at an option of the pins, or else at the cut.
Location option_at(const Location& location, const CutArguments& arguments) {
  const auto field = pin_field(location);
  return field ? Location::field("--pin-" + *field) : Location(arguments.by()) / location;
}

CutResult cut(const SoundMesh& usable, const CutAlong& along, const CutArguments& arguments,
              const Context& context) {
  const CutOptions options = options_of(arguments);
  try {
    if (!along.plane) return cut_along_loop(usable.mesh(), along.loop, options, context);
    return cut_by_plane(usable.mesh(), *along.plane, options, context);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    throw usable.explained(error).at(option_at(error.location(), arguments));
  }
}

// The result's components and loops, for the summary and the JSON report.
struct CutFacts {
  struct Component {
    Index vertices = 0, faces = 0;
    int side = 0;
    std::vector<std::size_t> loops{};
  };
  struct Loop {
    LoopFacts facts;
    Index component = 0;
    bool made_by_cut = false;
  };
  std::vector<Component> components;
  std::vector<Loop> loops;
};

CutFacts gather(const CutResult& result) {
  CutFacts facts;
  Index count = 0;
  const std::vector<Index> component = connected_components(result.mesh, &count);
  facts.components.resize(count);
  for (const Index c : component)
    if (c >= 0) ++facts.components[c].vertices;
  for (Index f = 0; f < result.mesh.face_count(); ++f) {
    if (result.mesh.faces[f].empty() || component[result.mesh.faces[f][0]] < 0) continue;
    CutFacts::Component& owner = facts.components[component[result.mesh.faces[f][0]]];
    ++owner.faces;
    owner.side = result.face_side[f];
  }
  const auto loops = boundary_loops(result.mesh);
  const std::vector<LoopFacts> loop_list = loop_facts(result.mesh, loops);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const Index owner = component[loops[k].front()];
    const bool made = std::find(result.loops.begin(), result.loops.end(), loops[k]) != result.loops.end();
    facts.loops.push_back({loop_list[k], owner, made});
    facts.components[owner].loops.push_back(k);
  }
  return facts;
}

// The files that were written, and notes on the data that the mesh's format cannot hold.
struct WrittenCut {
  std::vector<std::string> files;
  std::vector<Note> notes;
};

void print_summary(const CutFacts& facts, const CutResult& result, const WrittenCut& written) {
  fmt::print("{} vertices, {} faces in {} component{}\n", result.mesh.vertex_count(), result.mesh.face_count(),
             facts.components.size(), facts.components.size() == 1 ? "" : "s");
  for (std::size_t k = 0; k < facts.components.size(); ++k) {
    const CutFacts::Component& one = facts.components[k];
    fmt::print("  component {}: {}, {} vertices, {} faces\n", k, side_name(one.side), one.vertices, one.faces);
    for (const std::size_t loop : one.loops)
      fmt::print("    loop {}{}: {}\n", loop, facts.loops[loop].made_by_cut ? ", made by the cut" : "",
                 loop_text(facts.loops[loop].facts));
  }
  for (const CutPin& pin : result.pins) {
    const auto at = [&](int k) { return coordinate_text(pin.centre[k], pin.diameter, 4); };
    fmt::print("  pin at {}, {}, {}: diameter {:.4g}, length {:.4g}, clearance {:.4g}\n", at(0), at(1), at(2),
               pin.diameter, pin.length, pin.clearance);
  }
  for (const Note& note : written.notes) fmt::print("  note: {}\n", sentence(note));
  for (const std::string& output : written.files) fmt::print("  wrote {}\n", output);
}

// Adds the requested cut in the terms of an edit file's cut step.
void add_cut_asked_for(const CutAlong& along, Json& json) {
  if (!along.plane) {
    json["loop"] = along.loop;
    return;
  }
  json["plane"] = {{"point", vector_json(along.plane->point)}, {"normal", vector_json(along.plane->normal)}};
}

Json report_json(const CutArguments& arguments, const CutAlong& along, const CutFacts& facts,
                 const CutResult& result, const WrittenCut& written) {
  Json json = {{"format", "meshgraft-cut"},
               {"version", 1},
               {"program", std::string("meshgraft ") + MESHGRAFT_VERSION},
               {"mesh", arguments.mesh.string()},
               {"outputs", written.files},
               {"notes", to_json(written.notes, text_of)}};
  add_cut_asked_for(along, json);
  json["keep"] = keep_name(arguments.keep.value_or(CutKeep::both));
  json["snap"] = arguments.snap;
  json["cap"] = cap_name(options_of(arguments).cap);
  json["pins"] = Json::array();
  for (const CutPin& pin : result.pins) json["pins"].push_back(pin_json(pin));
  json["counts"] = {{"vertices", result.mesh.vertex_count()}, {"faces", result.mesh.face_count()}};
  json["components"] = Json::array();
  for (std::size_t k = 0; k < facts.components.size(); ++k) {
    const CutFacts::Component& one = facts.components[k];
    json["components"].push_back({{"number", k},
                                  {"side", one.side == 0 ? Json(nullptr) : Json(side_name(one.side))},
                                  {"vertices", one.vertices},
                                  {"faces", one.faces},
                                  {"loops", one.loops}});
  }
  json["loops"] = Json::array();
  for (std::size_t k = 0; k < facts.loops.size(); ++k) {
    Json loop = loop_json(k, facts.loops[k].facts);
    loop["component"] = facts.loops[k].component;
    loop["made_by_cut"] = facts.loops[k].made_by_cut;
    json["loops"].push_back(loop);
  }
  return json;
}

std::string dump(const Json& json) { return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"; }

#ifdef MESHGRAFT_HAS_RENDER
// Moves the sides apart, so that the picture shows the cut.
Mesh pulled_apart(const CutResult& result) {
  Mesh mesh = result.mesh;
  Eigen::RowVector3d middle[2] = {Eigen::RowVector3d::Zero(), Eigen::RowVector3d::Zero()};
  std::vector<int> side(mesh.vertex_count(), 0);
  Index count[2] = {0, 0};
  for (Index f = 0; f < mesh.face_count(); ++f)
    for (const Index v : mesh.faces[f]) side[v] = result.face_side[f];
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (side[v] == 0) continue;
    middle[side[v] > 0] += mesh.positions.row(v);
    ++count[side[v] > 0];
  }
  if (count[0] == 0 || count[1] == 0) return mesh;
  const Eigen::RowVector3d apart = (middle[1] / count[1] - middle[0] / count[0]) / 5;
  for (Index v = 0; v < mesh.vertex_count(); ++v) mesh.positions.row(v) += side[v] * apart;
  return mesh;
}
#endif

// Computes everything before anything is written.
WrittenCut write_outputs(const CutArguments& arguments, const SoundMesh& usable, CutResult& result,
                         const Context& context) {
#ifdef MESHGRAFT_HAS_RENDER
  std::optional<render::Image> picture;
  if (!arguments.picture.empty()) {
    const Mesh after = pulled_apart(result);
    picture = make_comparison(usable.mesh(), after, arguments.view, context);
  }
#endif
  context.step("write");
  usable.put_back(result.vertex, result.mesh);
  const WriteResult written = write_mesh(result.mesh, arguments.output, {}, context);
  WrittenCut outputs;
  for (const std::filesystem::path& file : written.files) outputs.files.push_back(file.string());
  outputs.notes = notes_on_files(usable.mesh());
  outputs.notes.insert(outputs.notes.end(), written.notes.begin(), written.notes.end());
  if (const std::optional<Note> note = usable.note()) outputs.notes.push_back(*note);
  outputs.notes.insert(outputs.notes.end(), result.notes.begin(), result.notes.end());
#ifdef MESHGRAFT_HAS_RENDER
  if (picture) {
    render::write_png(*picture, arguments.picture);
    outputs.files.push_back(arguments.picture.string());
  }
#endif
  return outputs;
}

void run_cut(const CutArguments& arguments, Context context) {
  context.threads = arguments.threads;
  context.memory = arguments.memory;
  const CutAlong asked = along(arguments);
  check_outputs(arguments);
  context.step("read");
  const Mesh mesh = read_mesh(arguments.mesh, context);
  const Diagnostics findings = check_mesh(mesh, context);
  const SoundMesh usable(mesh, findings, arguments.mesh.string());
  usable.require_beyond(asked.loop);
  CutResult result = cut(usable, asked, arguments, context);
  usable.require_beyond(vertices_at_cut(result));
  const CutFacts facts = gather(result);
  WrittenCut written = write_outputs(arguments, usable, result, context);
  if (!arguments.report.empty()) {
    written.files.push_back(arguments.report.string());
    write_file_atomically(arguments.report, dump(report_json(arguments, asked, facts, result, written)),
                          context);
  }
  if (arguments.json)
    fmt::print("{}", dump(report_json(arguments, asked, facts, result, written)));
  else
    print_summary(facts, result, written);
}

void add_pin_options(CLI::App& command, CutArguments& arguments) {
  command.add_option("--pin-count", arguments.pin_count, "Pins on each cap, 1 to 32 (default 2)")
      ->type_name("N")
      ->check(whole_number_from(1, 32));
  command
      .add_option("--pin-diameter", arguments.pin_diameter,
                  "Their diameter (default: from the size of the cap)")
      ->type_name("LENGTH");
  command.add_option("--pin-length", arguments.pin_length, "Their length (default 1.5 × the diameter)")
      ->type_name("LENGTH");
  command
      .add_option("--pin-clearance", arguments.pin_clearance,
                  "By how much the holes are wider all round, and deeper (default 0.05 × the diameter)")
      ->type_name("LENGTH");
  add_choice<PinSide>(command, "--pin-side", arguments.pin_side,
                      {{"above", PinSide::above}, {"below", PinSide::below}},
                      "The half that carries the pins (default below)");
}

}  // namespace

void add_cut(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<CutArguments>();
  CLI::App* command =
      program.add_subcommand("cut", "Cut a mesh in two by a plane or along a loop, or keep one side of it");
  command->add_option("mesh", arguments->mesh, "The mesh file")->required()->type_name("MESH");
  CLI::Option* plane =
      command
          ->add_option("--plane", arguments->plane,
                       "Cut by this plane: x=0.5 (or y=, z=), or a point and a normal as px,py,pz,nx,ny,nz")
          ->type_name("PLANE");
  command
      ->add_option(
          "--loop", arguments->loop,
          "Cut along the closed curve that joins these vertices, in order, by straight ways on the surface")
      ->type_name("V1,V2,…")
      ->excludes(plane);
  add_choice<CutKeep>(
      *command, "--keep", arguments->keep,
      {{"above", CutKeep::above}, {"below", CutKeep::below}, {"both", CutKeep::both}},
      "The side to keep: above is where the normal points, or the left hand of the loop seen from outside "
      "(default both)");
  command
      ->add_option(
          "--snap", arguments->snap,
          fmt::format("Move a vertex onto the cut where an edge is cut within this fraction of its length, "
                      "0 to 0.5 (default {})",
                      arguments->snap))
      ->type_name("X")
      ->check(number_from(0, 0.5));
  command->add_flag("--cap", arguments->cap, "Close the halves of a cut by a plane with flat caps");
  command->add_flag("--pins", arguments->pins,
                    "Close them with caps that have pins on one half and holes in the other, for gluing");
  add_pin_options(*command, *arguments);
  command->add_option("-o,--output", arguments->output, "The mesh file to write; its extension is the format")
      ->required()
      ->type_name("FILE");
  command->add_option("--report", arguments->report, "Write components and loops as JSON")->type_name("FILE");
#ifdef MESHGRAFT_HAS_RENDER
  add_picture(*command, arguments->picture, arguments->view, "Write a PNG of the mesh before and after");
#endif
  command->add_flag("--force,--in-place", arguments->force, "Allow the output to replace the input mesh");
  command->add_flag("--json", arguments->json, "Print the report instead of a summary");
  command->footer(
      "Examples:\n  meshgraft cut horse.ply --plane y=0.4 --keep above -o head.ply\n"
      "  meshgraft cut horse.ply --plane y=0.4 --keep above --pins -o head.stl\n"
      "  meshgraft cut horse.ply --loop 100,250,371 -o parts.ply --report parts.json");
  add_threads(*command, arguments->threads);
  add_memory(*command, arguments->memory);
  command->callback(
      [arguments, &action] { action = [arguments](const Context& context) { run_cut(*arguments, context); }; });
}

}  // namespace meshgraft::cli
