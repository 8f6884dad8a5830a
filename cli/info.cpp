#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/script/report.h>

#include "choices.h"
#include "commands.h"
#include "findings.h"
#include "loops.h"
#include "script/fact_json.h"
#include "values.h"
#include "wording.h"

namespace meshgraft::cli {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t shown_loops = 12;

struct InfoArguments {
  std::uint64_t memory = 0;
  std::filesystem::path mesh;
  bool json = false;
};

struct MeshFacts {
  Mesh mesh;
  TopologySummary topology;
  std::vector<std::vector<Index>> loops;
  std::vector<LoopFacts> loop_facts;
  std::map<Index, Index> faces_by_corners;
  Eigen::RowVector3d low, high;  // bounding box of the finite positions
  Diagnostics diagnostics;
};

MeshFacts gather(const std::filesystem::path& path, const Context& context) {
  MeshFacts facts;
  context.step("read");
  facts.mesh = read_mesh(path, context);
  facts.diagnostics = check_mesh(facts.mesh, context);
  facts.topology = summarise_topology(facts.mesh);
  facts.loops = boundary_loops(facts.mesh);
  facts.loop_facts = loop_facts(facts.mesh, facts.loops);
  for (Index f = 0; f < facts.mesh.face_count(); ++f)
    ++facts.faces_by_corners[static_cast<Index>(facts.mesh.faces[f].size())];
  facts.low.setConstant(std::numeric_limits<double>::infinity());
  facts.high.setConstant(-std::numeric_limits<double>::infinity());
  for (const auto& position : facts.mesh.positions.rowwise()) {
    if (!position.allFinite()) continue;
    facts.low = facts.low.cwiseMin(position);
    facts.high = facts.high.cwiseMax(position);
  }
  return facts;
}

bool has_box(const MeshFacts& facts) { return (facts.low.array() <= facts.high.array()).all(); }

std::string_view scalar_type(ScalarType type) {
  switch (type) {
    case ScalarType::int8: return "int8";
    case ScalarType::uint8: return "uint8";
    case ScalarType::int16: return "int16";
    case ScalarType::uint16: return "uint16";
    case ScalarType::int32: return "int32";
    case ScalarType::uint32: return "uint32";
    case ScalarType::float32: return "float32";
    case ScalarType::float64: return "float64";
  }
  return "";
}

std::string face_kind(Index corners, Index count) {
  const std::string plural = count == 1 ? "" : "s";
  if (corners == 3) return fmt::format("{} triangle{}", count, plural);
  if (corners == 4) return fmt::format("{} quad{}", count, plural);
  return fmt::format("{} face{} of {} corners", count, plural, corners);
}

template <class Range>
std::string first_values(const Range& values, std::size_t limit) {
  std::string text = fmt::format(
      "{}", fmt::join(values.begin(),
                      values.begin() + static_cast<std::ptrdiff_t>(std::min(limit, values.size())), ", "));
  return values.size() > limit ? text + ", …" : text;
}

void line(std::string_view label, const std::string& text) { fmt::print("  {:<12}{}\n", label, text); }

// Returns the defects that keep a loop from being merged. The findings give the details.
std::string defects_along(const MeshFacts& facts, const std::vector<Index>& loop) {
  std::string text;
  for (const FindingKind kind :
       {FindingKind::non_finite, FindingKind::outlying_vertex, FindingKind::non_manifold_edge,
        FindingKind::non_manifold_vertex, FindingKind::inconsistent_winding}) {
    const Finding* finding = facts.diagnostics.find(kind);
    if (!finding) continue;
    const auto here = std::find_if(loop.begin(), loop.end(), [&](Index v) {
      return std::binary_search(finding->indices.begin(), finding->indices.end(), v);
    });
    if (here != loop.end()) text += fmt::format("; {} at vertex {}", name_of(kind), *here);
  }
  return text;
}

void print_surface(const MeshFacts& facts) {
  const TopologySummary& topology = facts.topology;
  std::vector<std::string> kinds;
  for (const auto& [corners, count] : facts.faces_by_corners) kinds.push_back(face_kind(corners, count));
  line("vertices",
       topology.isolated_vertices == 0
           ? fmt::format("{}", facts.mesh.vertex_count())
           : fmt::format("{}, {} of them in no face", facts.mesh.vertex_count(), topology.isolated_vertices));
  line("faces", kinds.empty() ? "none" : fmt::format("{}", fmt::join(kinds, ", ")));
  line("edges", fmt::format("{}", topology.edges));
  line("components", fmt::format("{}", topology.components));
  std::vector<std::size_t> sizes;
  for (const auto& loop : facts.loops) sizes.push_back(loop.size());
  std::string boundary = fmt::format("{} loop{} of {} vertices", sizes.size(), sizes.size() == 1 ? "" : "s",
                                     first_values(sizes, shown_loops));
  if (sizes.empty())
    boundary = topology.faces == 0 ? "none, there are no faces"
               : topology.closed   ? "none, the surface is closed"
                                   : "no closed loop: it ends at edges of three faces or more";
  line("boundary", boundary);
  for (std::size_t k = 0; k < std::min(facts.loops.size(), shown_loops); ++k)
    line("", fmt::format("  loop {}: {}{}", k, loop_text(facts.loop_facts[k]),
                         defects_along(facts, facts.loops[k])));
  if (facts.loops.size() > shown_loops)
    line("", fmt::format("  and {} more", facts.loops.size() - shown_loops));
  line("genus", topology.faces == 0 ? "unknown, there are no faces"
                : topology.genus    ? fmt::format("{}", *topology.genus)
                                    : "unknown, the surface is not an oriented manifold");
}

void print_box(const MeshFacts& facts) {
  if (!has_box(facts)) return;
  const Eigen::RowVector3d size = facts.high - facts.low;
  const auto side = [&](int k) {
    return fmt::format("{} to {}", coordinate_text(facts.low(k), size(k)),
                       coordinate_text(facts.high(k), size(k)));
  };
  line("box", fmt::format("x {}, y {}, z {}", side(0), side(1), side(2)));
  line("size",
       fmt::format("{:.6g} × {:.6g} × {:.6g}, diagonal {:.6g}", size(0), size(1), size(2), size.norm()));
  if (const std::string unit = unit_of(facts.mesh); !unit.empty()) line("unit", unit);
}

void print_attributes(const Mesh& mesh) {
  std::string label = "attributes";
  if (mesh.attributes.empty()) line(label, "none");
  for (const Attribute& attribute : mesh.attributes) {
    line(label, fmt::format("{} '{}', {} × {}", domain_name(attribute.domain), attribute.name,
                            attribute.components, scalar_type(attribute.type)));
    label.clear();
  }
}

Json point_json(const Eigen::RowVector3d& point) { return {point(0), point(1), point(2)}; }

Json facts_json(const std::filesystem::path& path, const MeshFacts& facts) {
  const TopologySummary& topology = facts.topology;
  Json faces = Json::object();
  for (const auto& [corners, count] : facts.faces_by_corners) faces[std::to_string(corners)] = count;
  Json loop_sizes = Json::array(), loops = Json::array();
  for (std::size_t k = 0; k < facts.loops.size(); ++k) {
    loop_sizes.push_back(facts.loops[k].size());
    loops.push_back(loop_json(k, facts.loop_facts[k]));
  }
  Json attributes = Json::array();
  for (const Attribute& attribute : facts.mesh.attributes)
    attributes.push_back({{"name", attribute.name},
                          {"domain", domain_name(attribute.domain)},
                          {"type", scalar_type(attribute.type)},
                          {"components", attribute.components}});
  Json json = {{"format", "meshgraft-info"}, {"version", 1}, {"mesh", path.string()}};
  json["counts"] = {{"vertices", facts.mesh.vertex_count()},
                    {"isolated_vertices", topology.isolated_vertices},
                    {"faces", facts.mesh.face_count()},
                    {"faces_by_corners", faces},
                    {"edges", topology.edges}};
  json["components"] = topology.components;
  json["boundary_loops"] = loop_sizes;
  json["loops"] = loops;
  json["euler_characteristic"] = topology.euler_characteristic;
  json["genus"] = topology.genus ? Json(*topology.genus) : Json(nullptr);
  json["closed"] = topology.closed;
  json["manifold"] = topology.manifold;
  json["oriented"] = topology.oriented;
  json["box"] =
      has_box(facts) ? Json{{"min", point_json(facts.low)}, {"max", point_json(facts.high)}} : Json(nullptr);
  json["unit"] = unit_of(facts.mesh).empty() ? Json(nullptr) : Json(unit_of(facts.mesh));
  json["attributes"] = attributes;
  json["notes"] = to_json(notes_on_files(facts.mesh), text_of);
  json["findings"] = Json::parse(write_diagnostics(facts.diagnostics, text_of));
  return json;
}

void run_info(const InfoArguments& arguments, Context context) {
  context.memory = arguments.memory;
  const MeshFacts facts = gather(arguments.mesh, context);
  if (arguments.json) {
    fmt::print("{}\n", facts_json(arguments.mesh, facts).dump(2, ' ', false, Json::error_handler_t::replace));
    return;
  }
  fmt::print("{}\n", arguments.mesh.string());
  print_surface(facts);
  print_box(facts);
  print_attributes(facts.mesh);
  print_findings(facts.diagnostics, "findings");
  for (const Note& note : notes_on_files(facts.mesh)) line("note", sentence(note));
}

}  // namespace

void add_info(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<InfoArguments>();
  CLI::App* command = program.add_subcommand(
      "info",
      "Tell what a mesh file holds: counts, components, boundary loops, genus, bounding box, attributes, "
      "and what is wrong with it");
  command->add_option("mesh", arguments->mesh, "The mesh file")->required()->type_name("MESH");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->footer("Example:\n  meshgraft info horse.ply");
  add_memory(*command, arguments->memory);
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_info(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
