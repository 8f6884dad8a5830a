#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/run_edit.h>

#include "choices.h"
#include "cli/facts.h"
#include "commands.h"
#include "edit_picture.h"
#include "io/file.h"
#include "merge/merge_conflict.h"
#include "outputs.h"
#include "picture.h"
#include "selection_text.h"
#include "summary.h"
#include "values.h"
#include "wording.h"

namespace meshgraft::cli {

namespace {

// The name of the edit that options make, in the locations of its errors.
constexpr const char* plain_edit_name = "command line";

struct MergeArguments {
  std::filesystem::path target, source, output, report, picture, save_edit;  // `target` may be the edit file
  // The following options are for TARGET and SOURCE, without an edit file.
  std::vector<std::string> pairs, starts, matches, align;
  std::optional<MergePose> pose;
  std::string fix, reach, mirror, at, upright;
  std::vector<std::string> features;
  std::optional<double> size, spin_deg, base_height;
  std::string base_tilt;
  std::optional<Index> source_loop;
  double normal_angle_deg = 0;
  bool fix_winding = false, smooth_boundary = false, no_retry = false;
  std::optional<int> band;
  std::optional<double> blend_colours;
  std::optional<StripMethod> strip;
  std::vector<const CLI::Option*> plain_options;
  // The following options are for both cases.
  RunOptions run;
#ifdef MESHGRAFT_HAS_RENDER
  View view{.width = 640, .height = 640};
#endif
  int threads = 0;
  std::uint64_t memory = 0;
  bool json = false;
  bool force = false;

  bool plain() const { return !source.empty(); }
};

// Parses "5rings" or a length.
Reach reach_from(const std::string& text) {
  Reach reach;
  std::size_t count = 0;
  if (const std::size_t unit = text.find("ring"); text.ends_with("ring") || text.ends_with("rings")) {
    const auto given = numbers<int>(text.substr(0, unit), "--reach");
    count = given.size();
    reach.rings = given.front();
  } else {
    const auto given = numbers<double>(text, "--reach");
    count = given.size();
    reach.length = given.front();
  }
  constexpr int most_rings = 1'000'000;
  if (count != 1 || (reach.rings && (*reach.rings < 1 || *reach.rings > most_rings)) ||
      (reach.length && !(*reach.length > 0)))
    throw Error(facts::cli::NotAReach{.text = text, .most = most_rings}, "--reach");
  return reach;
}

// Parses a vertex index, or a point x,y,z that stands for the nearest vertex.
VertexSpec vertex_from(const std::string& text, const std::string& option) {
  if (text.find(',') == std::string::npos) {
    const auto vertex = numbers<Index>(text, option);
    if (vertex.size() == 1 && vertex.front() >= 0) return vertex.front();
  } else {
    const auto values = numbers<double>(text, option);
    if (values.size() == 3) return Eigen::Vector3d(values[0], values[1], values[2]);
  }
  throw Error(facts::cli::NotAVertex{.text = text}, Location::place(option));
}

// Parses a tilt of the base: degrees, and after a comma the axis x, y or z.
void read_tilt(const std::string& text, DropBase& base) {
  const std::size_t comma = text.find(',');
  const auto fail = [&] { throw Error(facts::cli::NotATilt{.text = text}, "--base-tilt"); };
  const auto tilt = numbers<double>(text.substr(0, comma), "--base-tilt");
  if (tilt.size() != 1) fail();
  base.tilt_deg = tilt.front();
  if (comma == std::string::npos) return;
  const std::string axis = text.substr(comma + 1);
  const std::size_t number = std::string_view("xyz").find(axis);
  if (axis.size() != 1 || number == std::string_view::npos) fail();
  base.tilt_axis = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(number));
}

// Returns the vertex or point to drop the source on, and the source loop or the base to use.
DropSpec drop_from(const MergeArguments& arguments) {
  DropSpec drop{vertex_from(arguments.at, "--at"), arguments.spin_deg.value_or(0)};
  if (arguments.source_loop) drop.source_loop = EditSelection{Selection::Loop{*arguments.source_loop}};
  if (!arguments.base_height && arguments.base_tilt.empty()) return drop;
  DropBase& base = drop.base.emplace();
  base.height = arguments.base_height;
  if (!arguments.base_tilt.empty()) read_tilt(arguments.base_tilt, base);
  return drop;
}

std::vector<MatchSpec> matches_from(const std::vector<std::string>& texts, const std::string& option) {
  std::vector<MatchSpec> matches;
  for (const std::string& text : texts) {
    const std::size_t colon = text.find(':');
    if (colon == std::string::npos) throw Error(facts::cli::NotAMatch{.text = text}, Location::place(option));
    matches.push_back(
        {vertex_from(text.substr(colon + 1), option), vertex_from(text.substr(0, colon), option)});
  }
  return matches;
}

// Returns the source loops that the command line names, or loop 0 if it names none.
std::vector<Index> source_loops(const MergeStep& step) {
  std::vector<Index> loops;
  for (const MergePairSpec& pair : step.pairs)
    loops.push_back(std::get<Selection::Loop>(pair.source_loop.kind).number);
  return loops.empty() ? std::vector<Index>{0} : loops;
}

// Returns the numbers of a file's boundary loops in words.
std::string loop_numbers(const std::filesystem::path& file) {
  const std::size_t count = boundary_loops(read_mesh(file, {})).size();
  if (count < 2) return count == 0 ? "no loop" : "only loop 0";
  return fmt::format("loops 0 to {}", count - 1);
}

// Throws Error(input) where two values of `--pair` name the same loop.
void require_loops_once(const MergeArguments& arguments) {
  std::map<std::pair<std::string, Index>, std::size_t> owner;
  for (std::size_t k = 0; k < arguments.pairs.size(); ++k) {
    const std::string& text = arguments.pairs[k];
    const auto [target, source] = index_pair(text, "--pair");
    for (const auto& [side, loop] : {std::pair<std::string, Index>{"target", target}, {"source", source}}) {
      const auto [before, is_new] = owner.emplace(std::pair{side, loop}, k);
      if (is_new) continue;
      const std::string target_loops = loop_numbers(arguments.target),
                        source_loops = loop_numbers(arguments.source);
      if (arguments.pairs[before->second] == text)
        throw Error(facts::cli::PairGivenTwice{.target_loops = target_loops, .source_loops = source_loops},
                    Location::field("--pair " + text));
      throw Error(facts::cli::LoopInTwoPairs{.side = side,
                                             .loop = loop,
                                             .other = arguments.pairs[before->second],
                                             .target_loops = target_loops,
                                             .source_loops = source_loops},
                  Location::field("--pair " + text));
    }
  }
}

MergeStep plain_step(const MergeArguments& arguments) {
  MergeStep step;
  step.target = "target";
  step.source = "source";
  require_loops_once(arguments);
  for (const std::string& text : arguments.pairs) {
    const auto [target, source] = index_pair(text, "--pair");
    step.pairs.push_back({{Selection::Loop{source}}, {Selection::Loop{target}}, {}});
  }
  step.matches = matches_from(arguments.starts, "--start");
  const std::vector<MatchSpec> more = matches_from(arguments.matches, "--match");
  step.matches.insert(step.matches.end(), more.begin(), more.end());
  step.align = matches_from(arguments.align, "--align");
  step.pose = arguments.pose.value_or(step.pose);
  if (arguments.run.overrides.preset) {
    const MergeOptions published = MergeOptions::as_published();
    step.shape = published.shape;
    step.settings = {arguments.run.overrides.preset, published.deformer, published.seam};
  }
  step.shape = arguments.run.overrides.shape.value_or(step.shape);
  if (!arguments.fix.empty()) step.fixed = selection_from(arguments.fix, source_loops(step), "--fix");
  for (const std::string& text : arguments.features)
    step.features.push_back({selection_from(text, source_loops(step), "--feature")});
  if (!arguments.reach.empty()) step.reach = reach_from(arguments.reach);
  if (!arguments.mirror.empty()) step.mirror = parse_plane(arguments.mirror, "--mirror");
  if (!arguments.at.empty()) step.at = drop_from(arguments);
  step.size = arguments.size;
  step.normal_angle_deg = arguments.normal_angle_deg;
  step.fix_winding = arguments.fix_winding;
  step.smooth_boundary = arguments.smooth_boundary;
  step.retry = !arguments.no_retry;
  step.settings.seam.blend_colours = arguments.blend_colours.value_or(step.settings.seam.blend_colours);
  step.settings.seam.target_rings = arguments.band.value_or(step.settings.seam.target_rings);
  step.settings.seam.strip = arguments.strip.value_or(step.settings.seam.strip);
  return step;
}

// Returns the edit that the command line describes. Its paths are relative to the folder of the file it may
// be saved in.
EditFile plain_edit(const MergeArguments& arguments) {
  const std::filesystem::path folder = arguments.save_edit.parent_path();
  const auto from_there = [&](const std::filesystem::path& path) {
    return folder.empty() ? path.generic_string() : std::filesystem::proximate(path, folder).generic_string();
  };
  MergeStep step = plain_step(arguments);
  const auto move_file = [&](EditSelection& selection) {
    if (auto* file = std::get_if<EditSelection::IndexFile>(&selection.kind))
      file->file = from_there(file->file);
  };
  if (step.fixed) move_file(*step.fixed);
  for (FeatureSpec& feature : step.features) move_file(feature.select);
  EditFile edit;
  edit.inputs.push_back({.name = "source", .file = from_there(arguments.source)});
  edit.inputs.push_back({.name = "target", .file = from_there(arguments.target)});
  if (!arguments.upright.empty()) {
    const UprightModels known = parse_upright(arguments.upright, "--upright");
    edit.inputs[0].orientation = known.source;
    edit.inputs[1].orientation = known.target;
  }
  edit.steps.push_back({{}, {}, std::move(step)});
  edit.made_with = this_library();
  // The parser checks the edit.
  return parse_edit(write_edit(edit), plain_edit_name, folder);
}

// Refuses options that contradict each other.
void require_sense(const MergeArguments& arguments) {
  using enum MergeConflict;
  const bool at = !arguments.at.empty();
  if (arguments.spin_deg && !at) throw Error(facts::cli::OptionNeeds{.option = "--spin", .other = "--at"});
  if (arguments.source_loop && !at) throw Error(facts::cli::SourceLoopWithoutAt{});
  if (arguments.base_height && !at)
    throw Error(facts::cli::OptionNeeds{.option = "--base-height", .other = "--at"});
  if (!arguments.base_tilt.empty() && !at)
    throw Error(facts::cli::OptionNeeds{.option = "--base-tilt", .other = "--at"});
  MergeRequest request{.pose = arguments.pose.value_or(MergePose::find),
                       .dropped = at,
                       .pairs_given = !arguments.pairs.empty(),
                       .matches_given = !arguments.starts.empty() || !arguments.matches.empty(),
                       .fixed_given = !arguments.fix.empty(),
                       .size_given = arguments.size.has_value()};
  if (!arguments.align.empty()) request.aligned_pairs = arguments.align.size();
  const auto conflict = find_conflict(request);
  if (!conflict) return;
  switch (*conflict) {
    case dropped_with_pairs: throw Error(facts::cli::AtWithLoops{.option = "--pair"});
    case dropped_with_matches:
      throw Error(facts::cli::AtWithLoops{.option = arguments.starts.empty() ? "--match" : "--start"});
    case dropped_pose_kept: throw Error(facts::cli::AtWithKeptPose{});
    case too_few_aligned: throw Error(facts::cli::CountOfAlignments{.count = arguments.align.size()});
    case fixed_pose_found: throw Error(facts::cli::FixWithFoundPose{});
    case size_pose_kept: throw Error(facts::cli::SizeWithKeptPose{});
    case posed_twice:
    case reach_given_twice: return;  // there is no option for a transform, and one for the reach
  }
}

// Returns the option with its `number`-th value, or without a value if it has no such value.
std::string repeated(const std::string& option, const std::vector<std::string>& values, std::size_t number) {
  return number < values.size() ? option + " " + values[number] : option;
}

// Returns the option behind a field of the plain step, e.g. "--match 3:7" for `matches[0]`. `parts` begin in
// the step.
std::string option_behind(const MergeArguments& arguments, std::span<const LocationPart> parts) {
  const std::string& word = parts.front().name;
  const std::size_t number = parts.size() > 1 ? parts[1].index : 0;
  if (word == "pairs") return arguments.pairs.empty() ? "" : repeated("--pair", arguments.pairs, number);
  if (word == "matches" && number < arguments.starts.size())
    return repeated("--start", arguments.starts, number);
  if (word == "matches") return repeated("--match", arguments.matches, number - arguments.starts.size());
  if (word == "features") return repeated("--feature", arguments.features, number);
  if (word == "align") return repeated("--align", arguments.align, number);
  if (word == "at" && parts.size() > 1 && parts[1].name == "source_loop")
    return arguments.source_loop ? "--source-loop" : "--at";
  if (word == "at" && parts.size() > 1 && parts[1].name == "base") {
    const std::string field = parts.size() > 2 ? parts[2].name : "";
    if (!arguments.base_tilt.empty() && field != "height") return "--base-tilt";
    return arguments.base_height ? "--base-height" : "--at";
  }
  for (const auto& [name, option] : {std::pair{"at", "--at"},
                                     {"size", "--size"},
                                     {"reach", "--reach"},
                                     {"mirror", "--mirror"},
                                     {"fixed", "--fix"},
                                     {"normal_angle_deg", "--normal-angle"},
                                     {"source_transform", "--align"}})
    if (word == name) return option;
  return word;
}

// Returns the error with the option or file that caused it as its location. The user never wrote the fields
// of the plain edit.
Error in_words_of_options(const Error& error, const MergeArguments& arguments) {
  const Location& location = error.location();
  const Location edit = Location::file(plain_edit_name), inputs = edit / "inputs", step = (edit / "steps")[0];
  const std::span<const LocationPart> parts = location.parts();
  if (location.starts_with(inputs) && parts.size() > 2) {
    if (parts.size() > 3) return error.at(location.from(3));
    return error.at(parts[2].name == "source" ? arguments.source : arguments.target);
  }
  if (!location.starts_with(step)) return error;
  const bool has_field = parts.size() > 3 && (parts[3].kind == LocationPart::Kind::field);
  return error.at(at_option(location, 3, has_field ? option_behind(arguments, parts.subspan(3)) : ""));
}

EditFile edit_from(const MergeArguments& arguments) {
  const bool is_edit = arguments.target.extension() == ".json";
  if (arguments.plain()) {
    if (is_edit) throw Error(facts::cli::SourceWithEdit{}, arguments.target);
    require_sense(arguments);
    return plain_edit(arguments);
  }
  if (!is_edit) throw Error(facts::cli::NoSource{}, arguments.target);
  for (const CLI::Option* option : arguments.plain_options)
    if (option->count() > 0) throw Error(facts::cli::OptionOfPlainMerge{.option = option->get_name()});
  return read_edit_file(arguments.target);
}

void check_outputs(const MergeArguments& arguments, const EditFile& edit) {
  require_outputs({.mesh = arguments.output,
                   .picture = arguments.picture,
                   .report = arguments.report,
                   .edit = arguments.save_edit},
                  referenced_files(edit), arguments.plain() ? std::filesystem::path() : arguments.target,
                  arguments.force);
#ifdef MESHGRAFT_HAS_RENDER
  check_view(arguments.view);
#endif
}

// Computes everything before anything is written.
void write_outputs(const MergeArguments& arguments, const EditFile& edit, EditResult& result,
                   const Context& context) {
  EditReport& report = result.report;
#ifdef MESHGRAFT_HAS_RENDER
  std::optional<render::Image> picture;
  if (!arguments.picture.empty()) picture = picture_of_parts(edit, result.mesh, arguments.view, context);
#endif
  write_and_report(result.mesh, arguments.output, report, {}, context);
#ifdef MESHGRAFT_HAS_RENDER
  if (picture) {
    render::write_png(*picture, arguments.picture);
    report.outputs.push_back(arguments.picture.string());
  }
#endif
  if (!arguments.save_edit.empty()) {
    report.outputs.push_back(arguments.save_edit.string());
    write_file_atomically(arguments.save_edit, write_edit(edit), context);
  }
  if (!arguments.report.empty()) {
    report.outputs.push_back(arguments.report.string());
    write_file_atomically(arguments.report, write_report(report, text_of), context);
  }
}

void run_merge(const MergeArguments& arguments, Context context) {
  context.threads = arguments.threads;
  context.memory = arguments.memory;
  EditFile edit;
  EditResult result;
  try {
    edit = edit_from(arguments);
    check_outputs(arguments, edit);
    RunOptions options = arguments.run;
    if (arguments.plain()) options.overrides.preset.reset();  // the step has it, with `--band` and `--strip`
    result = run_edit(edit, options, context);
  } catch (const Error& error) {
    if (!arguments.plain()) throw;
    throw in_words_of_options(error, arguments);
  }
  write_outputs(arguments, edit, result, context);
  if (arguments.json)
    fmt::print("{}", write_report(result.report, text_of));
  else
    print_summary(edit, result.report, result.rest);
}

void add_loop_options(CLI::App& command, MergeArguments& arguments) {
  const auto plain = [&](CLI::Option* option) {
    arguments.plain_options.push_back(option);
    return option;
  };
  const auto list = [&](const char* name, std::vector<std::string>& values, const char* description) {
    plain(command.add_option(name, values, description)->type_name("TARGET:SOURCE")->expected(1)->take_all());
  };
  list("--pair", arguments.pairs, "Loops that meet, as 'info' numbers them; repeatable");
  list("--start", arguments.starts, "Vertices that meet, one on each loop");
  plain(add_upright(command, arguments.upright));
  list("--match", arguments.matches, "More vertices that meet; repeatable, by arc length between them");
  list("--align", arguments.align, "Pose the source first by three or more such pairs; repeatable");
  plain(command.add_flag("--fix-winding", arguments.fix_winding,
                         "Turn the source inside out where loops need it"));
  plain(command.add_flag("--smooth-boundary", arguments.smooth_boundary, "Smooth ragged loops first"));
  plain(command.add_flag("--no-retry", arguments.no_retry,
                         "Keep the first graft, also with folds or intersections at its seam"));
}

void add_source_options(CLI::App& command, MergeArguments& arguments) {
  const auto plain = [&](CLI::Option* option) {
    arguments.plain_options.push_back(option);
    return option;
  };
  plain(add_choice<MergePose>(command, "--pose", arguments.pose,
                              {{"find", MergePose::find}, {"keep", MergePose::keep}},
                              "Whether the source's position, rotation and scale are found (default) or kept"));
  plain(
      command
          .add_option("--fix", arguments.fix,
                      fmt::format("With --pose keep: what stays of the source: {}, or JSON as in an edit file",
                                  fmt::join(selection_forms, ", ")))
          ->type_name("SELECTION"));
  plain(command
            .add_option("--feature", arguments.features,
                        "What keeps its shape up to one similarity, in the forms of --fix; repeatable")
            ->type_name("SELECTION"));
  plain(command
            .add_option("--reach", arguments.reach,
                        "Influence radius, how far from its loops the source may deform: 5rings, or a length")
            ->type_name("N"
                        "rings|LENGTH"));
  plain(command.add_option("--mirror", arguments.mirror, "Mirror the source first: x=0, or px,py,pz,nx,ny,nz")
            ->type_name("PLANE"));
  plain(command.add_option("--size", arguments.size, "Scale of the source, instead of finding it")
            ->type_name("S")
            ->check(positive_number()));
  plain(command
            .add_option("--normal-angle", arguments.normal_angle_deg,
                        "Turn the target's normals about the tangents of its loops")
            ->type_name("DEG")
            ->check(number_from(-180, 180)));
  plain(command
            .add_option("--at", arguments.at, "Drop the source on a surface without a hole: a vertex, or x,y,z")
            ->type_name("PLACE"));
  plain(command.add_option("--spin", arguments.spin_deg, "With --at: turn the source about the normal")
            ->type_name("DEG")
            ->check(finite_number()));
  plain(
      command
          .add_option("--source-loop", arguments.source_loop, "With --at: the loop of the source that meets it")
          ->type_name("LOOP")
          ->check(whole_number_from(0, std::numeric_limits<Index>::max())));
}

void add_base_options(CLI::App& command, MergeArguments& arguments) {
  arguments.plain_options.push_back(
      command
          .add_option("--base-height", arguments.base_height,
                      "With --at and a closed source: where to cut it open, above its lowest point")
          ->type_name("LENGTH")
          ->check(positive_number()));
  arguments.plain_options.push_back(
      command
          .add_option("--base-tilt", arguments.base_tilt,
                      "With --at and a closed source: turn of the plane that cuts it open, about x, y or z")
          ->type_name("DEG[,AXIS]"));
}

void add_seam_options(CLI::App& command, MergeArguments& arguments) {
  const auto plain = [&](CLI::Option* option) {
    arguments.plain_options.push_back(option);
    return option;
  };
  plain(command.add_option("--band", arguments.band, "Rings of the target that fairing may move; 0 moves none")
            ->type_name("N")
            ->check(whole_number_from(0, 100)));
  plain(command
            .add_option("--blend-colours", arguments.blend_colours,
                        "Mix the vertex colours of both meshes within this length from the seam")
            ->type_name("LENGTH")
            ->check(positive_number()));
  plain(add_choice<StripMethod>(command, "--strip", arguments.strip,
                                {{"greedy", StripMethod::greedy}, {"optimal", StripMethod::optimal}},
                                "How the gap between loops is filled"));
  plain(command.add_option("--save-edit", arguments.save_edit, "Write the edit file that repeats this command")
            ->type_name("FILE"));
}

void add_common_options(CLI::App& command, MergeArguments& arguments) {
  add_as_published(command, arguments.run.overrides.preset);
  add_choice<MergeShape>(command, "--shape", arguments.run.overrides.shape,
                         {{"similar", MergeShape::similar}, {"ft05", MergeShape::ft05}},
                         "How the source deforms: only within the reach (similar), or as in the paper (ft05)");
  command.add_flag("--strict", arguments.run.strict, "Fail where the result intersects itself");
  command.add_option("--report", arguments.report, "Write what was done, with index maps, as JSON")
      ->type_name("FILE");
#ifdef MESHGRAFT_HAS_RENDER
  add_picture(command, arguments.picture, arguments.view, "Write a PNG of target, source and result");
#endif
  add_threads(command, arguments.threads);
  add_memory(command, arguments.memory);
  command.add_flag("--force,--in-place", arguments.force, "Allow the output to replace an input mesh");
  command.add_flag("--json", arguments.json, "Print the report instead of a summary");
}

}  // namespace

void add_merge(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<MergeArguments>();
  CLI::App* command =
      program.add_subcommand("merge", "Graft a source mesh onto a target mesh along boundary loops");
  command->add_option("target", arguments->target, "The mesh that stays, or an edit file")
      ->required()
      ->type_name("TARGET");
  command->add_option("source", arguments->source, "The mesh to graft; none after an edit file")
      ->type_name("SOURCE");
  command->add_option("-o,--output", arguments->output, "The mesh file to write; its extension is the format")
      ->required()
      ->type_name("FILE");
  add_loop_options(*command, *arguments);
  add_source_options(*command, *arguments);
  add_base_options(*command, *arguments);
  add_seam_options(*command, *arguments);
  add_common_options(*command, *arguments);
  command->footer(
      "Pairs of loops and of vertices are written TARGET:SOURCE, numbers from 0 on.\n\n"
      "Examples:\n  meshgraft merge torso.ply head.ply -o whole.ply --start 702:3356\n"
      "  meshgraft merge edit.json -o whole.ply");
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_merge(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
