#include "run_step.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

#include <meshgraft/mesh/normals.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/report.h>

#include "convert_mesh.h"
#include "core/stopwatch.h"
#include "distributed/facts.h"
#include "io/file.h"
#include "local_mesh.h"
#include "mesh_file.h"
#include "resolve_step.h"
#include "script/json_text.h"
#include "script/run_steps.h"
#include "shared_quality.h"

namespace meshgraft::distributed {

namespace {

EditFile read_edit(const Communicator& comm, const std::filesystem::path& path) {
  std::string text;
  comm.together([&] {
    if (comm.rank() == 0) text = read_file(path);
  });
  text = comm.broadcast(std::move(text));
  return parse_edit(text, path.string(), path.parent_path());
}

/// Returns the edit's only step. Throws Error(input) for edits that are not one deform step on a mesh of a
/// file.
const DeformStep& only_step(const EditFile& edit) {
  const Location location = Location::file(edit.location);
  const auto* step = edit.steps.size() == 1 ? std::get_if<DeformStep>(&edit.steps[0].action) : nullptr;
  if (step == nullptr) throw Error(facts::distributed::OneDeformStep{}, location / "steps");
  return *step;
}

const EditInput& input_of(const EditFile& edit, const DeformStep& step) {
  const auto input = std::ranges::find(edit.inputs, step.mesh, &EditInput::name);
  const Location location = Location::file(edit.location) / "inputs" / Location::field(step.mesh);
  if (input == edit.inputs.end() || !input->sample.empty())
    throw Error(facts::distributed::NeedsFile{}, location);
  return *input;
}

/// Throws unless the output can be written, in the format of the input.
void require_edit_output(const RunRequest& request, const std::filesystem::path& input) {
  require_output(request.output, input, request.force);
  if (names_chunks(request.output) != names_chunks(input))
    throw Error(facts::distributed::OtherFormat{}, request.output);
}

/// Throws Error(input) if there are more vertices than an edit numbers.
void require_numbers(const MeshFile& file, const std::filesystem::path& path) {
  constexpr Number most = std::numeric_limits<Index>::max();
  if (file.vertex_count() > most)
    throw Error(facts::distributed::TooManyVertices{.count = file.vertex_count(), .most = most}, path);
}

/// The mesh of an edit while it is run: the own vertices and their normals, before and after.
struct RunState {
  Points rest, edited;
  Points normals, turned;  ///< empty if the file has no normals
  std::vector<NumberedTriangle> triangles;
};

/// Returns the positions of all local vertices.
Points with_halo(const LocalMesh& mesh, const Points& own) {
  Points all(mesh.vertices.size(), 3);
  all.topRows(mesh.vertices.own()) = own;
  mesh.vertices.update(all);
  return all;
}

/// Turns the normals of the own vertices as the faces around them turn.
Points turn_normals(const Communicator& comm, const MeshFile& file, const RunState& state) {
  const LocalMesh mesh = make_local_mesh(comm, file.vertex_starts(), state.triangles, 0);
  const Points before = with_halo(mesh, state.rest), normals = with_halo(mesh, state.normals);
  Points turned;
  const Points after = with_halo(mesh, state.edited);
  comm.together([&] {
    Mesh local = make_mesh(after, mesh.triangles);
    Attribute attribute{.name = "normal", .interpolation = Interpolation::direction, .components = 3};
    attribute.values.assign(normals.data(), normals.data() + normals.size());
    local.attributes.push_back(std::move(attribute));
    update_normals(local, before);
    turned = Eigen::Map<const Points>(local.attributes[0].values.data(), mesh.vertices.own(), 3);
  });
  return turned;
}

using Json = nlohmann::ordered_json;

/// Returns the report as text, with what this run does not measure as null, and figures of its own.
std::string report_text(const EditReport& report, const DistributedSummary& summary,
                        const DistributedWork& work, const Communicator& comm, const RunRequest& request,
                        const Wording& wording) {
  Json json = Json::parse(write_report(report, wording));
  json["solver"] = nullptr;
  for (Json& input : json["inputs"]) {
    input["findings"] = nullptr;
    input["faces"] = summary.faces;
  }
  Json& step = json["steps"][0];
  step["solver"] = nullptr;
  json["counts"]["faces"] = step["counts"]["faces"] = summary.faces;  // may need 64 bits
  for (Json* quality : {&json["quality"], &step["quality"]})
    for (const char* field : {"width_min", "narrowest_vertex", "new_self_intersections"})
      (*quality)[field] = nullptr;
  json["distributed"] = {{"ranks", comm.size()},
                         {"preconditioner", to_string(request.preconditioner)},
                         {"tolerance", request.tolerance},
                         {"iterations", report.evaluation ? report.evaluation->solver_iterations : 0},
                         {"patch_vertices", summary.patch_vertices},
                         {"unknowns", summary.unknowns},
                         {"coarse_unknowns", summary.coarse_unknowns},
                         {"matrix_nonzeros", summary.matrix_nonzeros},
                         {"largest_part", summary.largest_part},
                         {"largest_halo", summary.largest_halo},
                         {"most_neighbours", summary.most_neighbours},
                         {"partition_seconds", summary.partition_seconds},
                         {"work",
                          {{"iterations", work.iterations},
                           {"coarse_iterations", work.coarse_iterations},
                           {"messages", work.messages},
                           {"bytes", work.bytes},
                           {"reductions", work.reductions}}}};
  return json::to_text(json);
}

}  // namespace

void run_distributed(MPI_Comm mpi, const RunRequest& request, const Wording& wording) {
  const Communicator comm(mpi);
  Stopwatch watch;
  const EditFile edit = read_edit(comm, request.edit);
  const DeformStep& step = only_step(edit);
  const EditInput& input = input_of(edit, step);
  const std::filesystem::path input_path = edit.base_folder / input.file;
  comm.together([&] { require_mesh_name(request.output); });
  if (request.check_outputs) request.check_outputs(input_path);
  comm.together([&] {
    if (comm.rank() == 0) require_edit_output(request, input_path);
  });
  const Location location = (Location::file(edit.location) / "steps")[0];

  StepReport done;
  done.name = edit.steps[0].name;
  done.mesh = step.mesh;
  done.result = step.result.empty() ? step.mesh : step.result;
  done.settings = effective_settings(step.settings, request.overrides);
  done.settings.deformer.backend = SolverBackend::iterative;
  done.method = done.settings.deformer.method;

  const MeshFile file(comm, input_path);
  require_numbers(file, input_path);
  RunState state;
  state.rest = file.read_positions();
  state.triangles = file.read_triangles();
  if (file.has_normals()) state.normals = file.read_normals();
  EditReport report;
  report.seconds.read = watch.lap();

  ResolvedStep resolved;
  {
    const LocalMesh mesh = make_local_mesh(comm, file.vertex_starts(), state.triangles, 0);
    DeformStep effective = step;
    effective.settings = done.settings;
    resolved =
        resolve_step(comm, edit, effective, mesh, with_halo(mesh, state.rest), file.face_count(), location);
  }
  resolved.problem.rest = state.rest;
  resolved.problem.triangles.resize(static_cast<Eigen::Index>(state.triangles.size()), 3);
  for (std::size_t t = 0; t < state.triangles.size(); ++t)
    for (std::size_t c = 0; c < 3; ++c)
      resolved.problem.triangles(static_cast<Eigen::Index>(t), static_cast<Eigen::Index>(c)) =
          state.triangles[t].corners[c];
  const bool measures = !request.report.empty();
  if (!file.has_normals() && !measures) std::vector<NumberedTriangle>().swap(state.triangles);
  Flags is_free = resolved.problem.movable;
  for (const VertexConstraint& constraint : resolved.problem.constraints)
    if (constraint.position) is_free[constraint.vertex] = 0;
  done.seconds.select = watch.lap();

  const std::vector<VertexConstraint> constraints = resolved.problem.constraints;
  DistributedSummary summary;
  DistributedWork work;
  EvaluationReport& evaluation = done.evaluation.emplace();
  try {
    const DistributedDeformer deformer(mpi, resolved.problem,
                                       {.deformer = done.settings.deformer,
                                        .preconditioner = request.preconditioner,
                                        .tolerance = request.tolerance});
    resolved.problem = {};
    summary = deformer.summary();
    done.seconds.assemble = summary.partition_seconds + summary.assemble_seconds;
    done.seconds.factorise = summary.factorise_seconds;
    watch.lap();
    state.edited = deformer.evaluate(constraints, &evaluation);
    done.seconds.solve = watch.lap();
    work = deformer.work();
  } catch (const Error& error) {
    throw error.within(location);
  }
  if (file.has_normals()) state.turned = turn_normals(comm, file, state);

  done.handles = resolved.handles;
  done.counts = {.vertices = static_cast<Index>(file.vertex_count()),
                 .faces = static_cast<Index>(file.face_count()),
                 .free = static_cast<Index>(summary.free_vertices),
                 .fixed = static_cast<Index>(resolved.fixed),
                 .handle = static_cast<Index>(resolved.held),
                 .degenerate = static_cast<Index>(summary.degenerate_vertices)};
  done.max_displacement = comm.largest(largest_displacement(state.rest, state.edited));
  summary.faces = file.face_count();  // with those that have a corner twice
  if (measures)
    done.quality = measure_shared_quality(comm, file.vertex_starts(), state.triangles,
                                          {.rest = state.rest, .edited = state.edited, .is_free = is_free});
  done.seconds.measure = watch.lap();

  file.write(request.output, {state.rest, state.edited, state.normals, state.turned});
  report.seconds.write = watch.lap();
  comm.together([&] {
    if (comm.rank() != 0 || request.report.empty()) return;
    report.edit = edit.location;
    report.outputs = {request.output.string()};
    report.notes = edit.notes;
    if (input.sha256) report.notes.push_back(facts::distributed::HashNotChecked{});
    report.inputs.push_back({input.name, input.file, done.counts.vertices, done.counts.faces, {}});
    report.counts = done.counts;
    report.evaluation = done.evaluation;
    report.deformed = true;
    report.max_displacement = done.max_displacement;
    report.quality = done.quality;
    for (auto field : {&StageSeconds::select, &StageSeconds::assemble, &StageSeconds::factorise,
                       &StageSeconds::solve, &StageSeconds::measure})
      report.seconds.*field = done.seconds.*field;
    done.seconds.total = watch.seconds() - report.seconds.read - report.seconds.write;
    report.seconds.total = watch.seconds();
    report.steps.push_back(done);
    write_file_atomically(request.report, report_text(report, summary, work, comm, request, wording));
  });
}

}  // namespace meshgraft::distributed
