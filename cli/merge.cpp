#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/edit/edit_file.h>
#include <meshgraft/edit/run_edit.h>
#include <meshgraft/io/mesh_io.h>

#include "choices.h"
#include "commands.h"
#include "outputs.h"
#include "selection_text.h"
#include "summary.h"
#include "values.h"
#ifdef MESHGRAFT_HAS_RENDER
#include "picture.h"
#endif

namespace meshgraft::cli {

namespace {

struct MergeArguments {
  std::filesystem::path target, source, output, report, picture, save_edit;  // `target`: or the edit file
  // Of the plain case.
  std::vector<std::string> pairs, starts, matches, align;
  std::optional<MergePose> pose;
  std::string fix, reach, mirror, at;
  std::optional<double> size, spin_deg;
  std::optional<Index> source_loop;
  double normal_angle_deg = 0;
  bool fix_winding = false, smooth_boundary = false;
  std::optional<int> band;
  std::optional<StripMethod> strip;
  std::vector<const CLI::Option*> plain_options;
  // Of both.
  RunOptions run;
  int threads = 0;
  bool json = false;
  bool force = false;

  bool plain() const { return !source.empty(); }
};

// "5rings" or a length.
Reach reach_from(const std::string& text) {
  Reach reach;
  std::size_t count = 0;
  if (const std::size_t rings = text.find("ring"); rings != std::string::npos) {
    const auto given = numbers<int>(text.substr(0, rings), "--reach");
    count = given.size();
    reach.rings = given.front();
  } else {
    const auto given = numbers<double>(text, "--reach");
    count = given.size();
    reach.length = given.front();
  }
  if (count != 1)
    throw Error(ErrorCode::usage, fmt::format("'{}' is neither a number of rings nor a length", text),
                "--reach", "Write it as 5rings, or as a length like 0.3");
  return reach;
}

// A vertex, or a point as x,y,z that stands for the nearest one.
VertexSpec vertex_from(const std::string& text, const std::string& option) {
  if (text.find(',') == std::string::npos) {
    const auto vertex = numbers<Index>(text, option);
    if (vertex.size() == 1 && vertex.front() >= 0) return vertex.front();
  } else {
    const auto values = numbers<double>(text, option);
    if (values.size() == 3) return Eigen::Vector3d(values[0], values[1], values[2]);
  }
  throw Error(ErrorCode::usage, fmt::format("'{}' is neither a vertex nor a point x,y,z", text), option);
}

// Where to drop the part, and by which of its loops.
DropSpec drop_from(const std::string& text, double spin_deg, std::optional<Index> source_loop) {
  std::optional<SelectionSpec> loop;
  if (source_loop) loop = SelectionSpec{Selection::Loop{*source_loop}};
  return {vertex_from(text, "--at"), spin_deg, loop};
}

std::vector<MatchSpec> matches_from(const std::vector<std::string>& texts, const std::string& option) {
  std::vector<MatchSpec> matches;
  for (const std::string& text : texts) {
    const std::size_t colon = text.find(':');
    if (colon == std::string::npos)
      throw Error(ErrorCode::usage, fmt::format("'{}' is not TARGET:SOURCE", text), option,
                  "Give a vertex of each, as a number or as x,y,z");
    matches.push_back(
        {vertex_from(text.substr(colon + 1), option), vertex_from(text.substr(0, colon), option)});
  }
  return matches;
}

// The source's loops as far as the command line names them.
std::vector<Index> source_loops(const MergeStep& step) {
  std::vector<Index> loops;
  for (const MergePairSpec& pair : step.pairs)
    loops.push_back(std::get<Selection::Loop>(pair.source_loop.kind).number);
  return loops.empty() ? std::vector<Index>{0} : loops;
}

MergeStep plain_step(const MergeArguments& arguments) {
  MergeStep step;
  step.target = "target";
  step.source = "source";
  for (const std::string& text : arguments.pairs) {
    const auto [target, source] = index_pair(text, "--pair");
    step.pairs.push_back({{Selection::Loop{source}}, {Selection::Loop{target}}, {}});
  }
  step.matches = matches_from(arguments.starts, "--start");
  const std::vector<MatchSpec> more = matches_from(arguments.matches, "--match");
  step.matches.insert(step.matches.end(), more.begin(), more.end());
  step.align = matches_from(arguments.align, "--align");
  step.pose = arguments.pose.value_or(step.pose);
  step.shape = arguments.run.overrides.shape.value_or(step.shape);
  if (!arguments.fix.empty()) step.fixed = selection_from(arguments.fix, source_loops(step), "--fix");
  if (!arguments.reach.empty()) step.reach = reach_from(arguments.reach);
  if (!arguments.mirror.empty()) {
    const PlaneText plane = parse_plane(arguments.mirror, "--mirror");
    step.mirror = MirrorPlane{plane.point, plane.normal};
  }
  if (!arguments.at.empty())
    step.at = drop_from(arguments.at, arguments.spin_deg.value_or(0), arguments.source_loop);
  step.size = arguments.size;
  step.normal_angle_deg = arguments.normal_angle_deg;
  step.fix_winding = arguments.fix_winding;
  step.smooth_boundary = arguments.smooth_boundary;
  step.settings.seam.target_rings = arguments.band.value_or(step.settings.seam.target_rings);
  step.settings.seam.strip = arguments.strip.value_or(step.settings.seam.strip);
  return step;
}

// The edit that the command line describes, its paths relative to the folder of the file it may be saved in.
EditFile plain_edit(const MergeArguments& arguments) {
  const std::filesystem::path folder = arguments.save_edit.parent_path();
  const auto from_there = [&](const std::filesystem::path& path) {
    return folder.empty() ? path.generic_string() : std::filesystem::proximate(path, folder).generic_string();
  };
  MergeStep step = plain_step(arguments);
  if (step.fixed)
    if (auto* file = std::get_if<SelectionSpec::IndexFile>(&step.fixed->kind))
      file->file = from_there(file->file);
  EditFile edit;
  edit.inputs.push_back({.name = "source", .file = from_there(arguments.source)});
  edit.inputs.push_back({.name = "target", .file = from_there(arguments.target)});
  edit.steps.push_back({{}, {}, std::move(step)});
  // Through the parser, for its checks.
  return parse_edit(write_edit(edit), "command line", folder);
}

EditFile edit_from(const MergeArguments& arguments) {
  if (arguments.plain()) {
    if (arguments.spin_deg && arguments.at.empty()) throw Error(ErrorCode::usage, "--spin goes with --at");
    if (arguments.source_loop && arguments.at.empty())
      throw Error(ErrorCode::usage, "--source-loop goes with --at", "",
                  "Without it, name --pair TARGET:SOURCE.");
    return plain_edit(arguments);
  }
  if (arguments.target.extension() != ".json")
    throw Error(ErrorCode::usage, "the source is missing", arguments.target.string(),
                "Give TARGET and SOURCE, or an edit file (.json).");
  for (const CLI::Option* option : arguments.plain_options)
    if (option->count() > 0)
      throw Error(ErrorCode::usage, fmt::format("{} goes with TARGET and SOURCE", option->get_name()), "",
                  "An edit file says this in its steps.");
  return read_edit_file(arguments.target);
}

void check_outputs(const MergeArguments& arguments, const EditFile& edit) {
  require_outputs({arguments.output, arguments.report, arguments.picture, arguments.save_edit},
                  referenced_files(edit), arguments.plain() ? std::filesystem::path() : arguments.target,
                  arguments.force);
  if (!arguments.picture.empty()) require_png(arguments.picture);
}

#ifdef MESHGRAFT_HAS_RENDER
// Each mesh in a frame of its own, for parts come in any size: the target, the other inputs, the result.
void draw(const MergeArguments& arguments, const EditFile& edit, const Mesh& result, const Context& context) {
  std::vector<EditInput> inputs = edit.inputs;
  const auto merge = std::find_if(edit.steps.begin(), edit.steps.end(), [](const EditStep& step) {
    return std::holds_alternative<MergeStep>(step.action);
  });
  if (merge != edit.steps.end())
    std::stable_partition(inputs.begin(), inputs.end(),
                          [&](const EditInput& input) { return input.name == mesh_of(*merge); });
  std::vector<render::Image> images;
  std::vector<std::string> captions;
  const auto add = [&](const Mesh& mesh, const std::string& caption) {
    const Mesh* one = &mesh;
    images.push_back(make_pictures({&one, 1}, options_of({.width = 800, .height = 800}), context).front());
    captions.push_back(caption);
  };
  for (const EditInput& input : inputs) add(load_input(input, edit, context), input.name);
  add(result, "result");
  render::write_png(contact_sheet(images, captions, 4), arguments.picture);
}
#endif

void write_outputs(const MergeArguments& arguments, const EditFile& edit, EditResult& result,
                   const Context& context) {
  const auto start = std::chrono::steady_clock::now();
  context.step("write");
  EditReport& report = result.report;
  write_mesh(result.mesh, arguments.output, {}, context);
  report.outputs.push_back(arguments.output.string());
  report.seconds.write = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  report.seconds.total += report.seconds.write;
#ifdef MESHGRAFT_HAS_RENDER
  if (!arguments.picture.empty()) {
    draw(arguments, edit, result.mesh, context);
    report.outputs.push_back(arguments.picture.string());
  }
#endif
  if (!arguments.save_edit.empty()) {
    report.outputs.push_back(arguments.save_edit.string());
    write_file_atomically(arguments.save_edit, write_edit(edit));
  }
  if (!arguments.report.empty()) {
    report.outputs.push_back(arguments.report.string());
    write_file_atomically(arguments.report, write_report(report));
  }
}

void run_merge(const MergeArguments& arguments, Context context) {
  context.threads = arguments.threads;
  const EditFile edit = edit_from(arguments);
  check_outputs(arguments, edit);
  EditResult result = run_edit(edit, arguments.run, context);
  write_outputs(arguments, edit, result, context);
  if (arguments.json)
    fmt::print("{}", write_report(result.report));
  else
    print_summary(result.report, result.rest);
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
  list("--match", arguments.matches, "More vertices that meet; repeatable, by arc length between them");
  list("--align", arguments.align, "Pose the source first by three or more such pairs; repeatable");
  plain(command.add_flag("--fix-winding", arguments.fix_winding,
                         "Turn the source inside out where loops need it"));
  plain(command.add_flag("--smooth-boundary", arguments.smooth_boundary, "Smooth ragged loops first"));
}

void add_part_options(CLI::App& command, MergeArguments& arguments) {
  const auto plain = [&](CLI::Option* option) {
    arguments.plain_options.push_back(option);
    return option;
  };
  plain(add_choice<MergePose>(command, "--pose", arguments.pose,
                              {{"find", MergePose::find}, {"keep", MergePose::keep}},
                              "Whether the part's place, turn and size are found (default) or kept"));
  plain(command
            .add_option("--fix", arguments.fix,
                        fmt::format("With --pose keep: what stays of the source: {}", selection_forms))
            ->type_name("SELECTION"));
  plain(command
            .add_option("--reach", arguments.reach,
                        "How far from its loops the part may deform: 5rings, or a length")
            ->type_name("N"
                        "rings|LENGTH"));
  plain(command.add_option("--mirror", arguments.mirror, "Mirror the source first: x=0, or px,py,pz,nx,ny,nz")
            ->type_name("PLANE"));
  plain(command.add_option("--size", arguments.size, "Scale of the part, where it is not to be found")
            ->type_name("S")
            ->check([](const std::string& text) {
              const double size = std::strtod(text.c_str(), nullptr);
              return size > 0 && size < 1e100 ? std::string() : text + " is not a positive number";
            }));
  plain(command
            .add_option("--normal-angle", arguments.normal_angle_deg,
                        "Turn the target's normals about the tangents of its loops")
            ->type_name("DEG")
            ->check(CLI::Range(-180.0, 180.0)));
  plain(
      command.add_option("--at", arguments.at, "Drop the part on a surface without a hole: a vertex, or x,y,z")
          ->type_name("PLACE"));
  plain(command.add_option("--spin", arguments.spin_deg, "With --at: turn the part about the normal")
            ->type_name("DEG"));
  plain(command
            .add_option("--source-loop", arguments.source_loop, "With --at: the loop of the part that meets it")
            ->type_name("LOOP")
            ->check(CLI::NonNegativeNumber));
}

void add_seam_options(CLI::App& command, MergeArguments& arguments) {
  const auto plain = [&](CLI::Option* option) {
    arguments.plain_options.push_back(option);
    return option;
  };
  plain(
      command.add_option("--band", arguments.band, "Rings of the target that smoothing may move; 0 moves none")
          ->type_name("N")
          ->check(CLI::Range(0, 100)));
  plain(add_choice<StripMethod>(command, "--strip", arguments.strip,
                                {{"greedy", StripMethod::greedy}, {"optimal", StripMethod::optimal}},
                                "How the gap between loops is filled"));
  plain(command.add_option("--save-edit", arguments.save_edit, "Write the edit file that repeats this command")
            ->type_name("FILE"));
}

void add_common_options(CLI::App& command, MergeArguments& arguments) {
  add_choice<MergeShape>(command, "--shape", arguments.run.overrides.shape,
                         {{"similar", MergeShape::similar}, {"ft05", MergeShape::ft05}},
                         "What becomes of the part: it keeps its shape beyond a reach, or as in the paper");
  command.add_flag("--strict", arguments.run.strict, "Fail where the result intersects itself");
  command.add_option("--report", arguments.report, "Write what was done, with index maps, as JSON")
      ->type_name("FILE");
#ifdef MESHGRAFT_HAS_RENDER
  command.add_option("--picture", arguments.picture, "Write a PNG of target, source and result")
      ->type_name("FILE");
#endif
  add_threads(command, arguments.threads);
  command.add_flag("--force,--in-place", arguments.force, "Allow the output to replace an input mesh");
  command.add_flag("--json", arguments.json, "Print the report instead of a summary");
}

}  // namespace

void add_merge(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<MergeArguments>();
  CLI::App* command = program.add_subcommand("merge", "Graft a part onto another mesh along boundary loops");
  command->add_option("target", arguments->target, "The mesh that stays, or an edit file")
      ->required()
      ->type_name("TARGET");
  command->add_option("source", arguments->source, "The part; none after an edit file")->type_name("SOURCE");
  command->add_option("-o,--output", arguments->output, "The mesh file to write; its extension is the format")
      ->required()
      ->type_name("FILE");
  add_loop_options(*command, *arguments);
  add_part_options(*command, *arguments);
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
