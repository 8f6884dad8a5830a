#include "summary.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <variant>

#include <fmt/format.h>
#include <Eigen/LU>

#include "script/percent.h"
#include "wording.h"

namespace meshgraft::cli {

namespace {

// Returns whether a handle holds its vertices where they are.
bool is_still(const HandleSpec& handle) {
  const auto* motion = std::get_if<HandleMotion>(&handle.pose.kind);
  if (motion != nullptr)
    return motion->translate.isZero(0) && motion->angle_deg == 0 && motion->scale == Eigen::Vector3d::Ones();
  const auto* matrix = std::get_if<Eigen::Matrix4d>(&handle.pose.kind);
  return matrix != nullptr && *matrix == Eigen::Matrix4d::Identity();
}

bool holds_nothing(const EditStep& asked, const StepReport& step) {
  if (step.counts.fixed > 0 || step.counts.free + step.counts.handle < step.counts.vertices) return false;
  const auto* deform = std::get_if<DeformStep>(&asked.action);
  return deform != nullptr && deform->anchors.empty() && deform->targets.empty() &&
         std::ranges::none_of(deform->handles, is_still);
}

bool moves_nothing(const EditStep& asked) {
  const auto* deform = std::get_if<DeformStep>(&asked.action);
  return deform != nullptr && deform->handles.empty() && deform->anchors.empty() && deform->targets.empty();
}

// The quality of one step alone is that of the edit, which has a line of its own.
void print_deform(const EditStep& asked, const StepReport& step, const std::string& name,
                  bool is_one_of_several) {
  fmt::print("  {}{} free vertices followed {} held by handles, {} stayed fixed; the farthest moved {:.4g}\n",
             name, step.counts.free, step.counts.handle, step.counts.fixed, step.max_displacement);
  if (step.refined_vertices > 0)
    fmt::print("  {}edges near handles were halved for the solve, which had {} more vertices\n", name,
               step.refined_vertices);
  const std::int64_t crossings = step.quality.new_self_intersections.value_or(0);
  if (is_one_of_several && (crossings > 0 || step.quality.flipped_faces > 0))
    fmt::print("  {}new self-intersections: {}, flipped faces: {}\n", name, crossings,
               step.quality.flipped_faces);
  if (moves_nothing(asked))
    fmt::print("  {}nothing moves it; 'handles', with poses, would\n", name);
  else if (holds_nothing(asked, step))
    fmt::print("  {}nothing is held in place; a 'fixed' selection, or a smaller region, would hold the rest\n",
               name);
}

// Returns where the loops' correspondence starts, if that was found. A start that was ranked can be given as it
// is printed; others lie between vertices.
std::string start_text(const PairReport& pair, const RetryReport& retry) {
  if (!pair.starts.empty()) {
    const auto taken = std::min(static_cast<std::size_t>(retry.start), pair.starts.size() - 1);
    const StartCandidate& start = pair.starts[taken];
    const std::string shifted =
        retry.start_shift == 0 ? "" : fmt::format(", shifted by {:.2g} % of the loop", 100 * retry.start_shift);
    return fmt::format(", start {}:{}{} (found, {:.0f} % probable)", start.start.target, start.start.source,
                       shifted, 100 * start.probability);
  }
  return pair.confidence < 1 ? fmt::format(", start near {}:{} (found, confidence {:.2f})", pair.start.target,
                                           pair.start.source, pair.confidence)
                             : "";
}

void print_pairs(const MergeReport& report, const std::string& name) {
  for (const PairReport& pair : report.pairs)
    fmt::print("  {}matched {} vertices of the target with {} of the source{}\n", name, pair.target_vertices,
               pair.source_vertices, start_text(pair, report.retry));
}

// Pieces of the source that are not connected have a scale each.
std::string shape_text(const ShapeReport& shape) {
  const double kept = 100 * shape.distance_rel;
  if (shape.scales.size() < 2)
    return fmt::format("the source was scaled by {:.4g} and keeps its shape to {:.2g} % of its size",
                       shape.similarity.scale, kept);
  std::vector<std::string> scales;
  for (const double scale : shape.scales) scales.push_back(fmt::format("{:.4g}", scale));
  return fmt::format("the source's pieces were scaled by {} and keep their shapes to {:.2g} % of their sizes",
                     fmt::join(scales, ", "), kept);
}

void print_merge(const StepReport& step, const std::string& name) {
  const MergeReport& report = step.merge->report;
  print_pairs(report, name);
  fmt::print("  {}{}\n", name, shape_text(report.shape));
  const SeamReport& seam = report.seam;
  fmt::print(
      "  {}seam: {} new faces, {}{}smallest angles {:.0f}° (p1), bends by {:.0f}° (p99; beside it {:.0f}° "
      "and {:.0f}°), the target moved by {:.2g} % of the size\n",
      name, seam.new_faces, seam.manifold && seam.oriented ? "" : "not a manifold, ",
      seam.closed ? "closed, " : "", seam.angle_p1_deg, seam.dihedral_p99_deg, seam.target_dihedral_p99_deg,
      seam.source_dihedral_p99_deg, 100 * seam.band_displacement_rel);
  const StageSeconds& seconds = step.seconds;
  const std::string retries =
      report.retry.tries == 0 ? std::string()
                              : fmt::format(", {} further grafts {:.2f} s", report.retry.tries, seconds.retry);
  fmt::print(
      "  {}{} vertices, {} faces in {:.2f} s (match {:.2f} s, set-up {:.2f} s, solve {:.2f} s, seam {:.2f} "
      "s{})\n",
      name, step.counts.vertices, step.counts.faces, seconds.total, seconds.match,
      seconds.assemble + seconds.factorise, seconds.solve, seconds.seam, retries);
}

std::string counted(std::int64_t count, const char* one, const char* several) {
  return fmt::format("{} {}", count, count == 1 ? one : several);
}

void print_cut(const StepReport& step, const std::string& name) {
  const CutOutcome& cut = *step.cut;
  std::vector<std::string> sizes;
  for (const auto& loop : cut.loops) sizes.push_back(std::to_string(loop.size()));
  const std::string along =
      sizes.size() == 1 ? fmt::format("a loop of {}", counted(cut.loops[0].size(), "vertex", "vertices"))
                        : fmt::format("loops of {} vertices", fmt::join(sizes, ", "));
  fmt::print("  {}cut along {}; {}, {} are left\n", name, along,
             counted(step.counts.vertices, "vertex", "vertices"), counted(step.counts.faces, "face", "faces"));
}

void print_repair(const StepReport& step, const std::string& name) {
  for (const RepairChange& change : step.repair->changes) fmt::print("  {}{}\n", name, sentence(change.note));
  if (step.repair->changes.empty()) fmt::print("  {}nothing to repair\n", name);
  fmt::print("  {}repair: {} vertices, {} faces are left\n", name, step.counts.vertices, step.counts.faces);
}

void print_sculpt(const StepReport& step, const std::string& name) {
  fmt::print("  {}{}: {}; the farthest moved {:.4g}\n", name, to_string(step.sculpt->action),
             counted(step.sculpt->region, "vertex", "vertices"), step.sculpt->max_displacement);
  if (step.sculpt->max_displacement == 0)
    fmt::print("  {}nothing moved; a larger 'region' or 'strength' may\n", name);
  if (step.sculpt->new_self_intersections > 0)
    fmt::print("  {}new self-intersections: {}\n", name, step.sculpt->new_self_intersections);
}

void print_transform(const StepReport& step, const std::string& name) {
  const Eigen::Matrix3d& linear = step.transform->linear();
  if (step.transform->matrix().isIdentity(0)) {
    fmt::print("  {}transform: nothing was moved, because the pose is that of rest\n", name);
    return;
  }
  fmt::print("  {}transform: the whole mesh was moved, and its volume changed by a factor of {:.4g}\n", name,
             std::abs(linear.determinant()));
}

void print_quality(const EditReport& report, const Points& rest) {
  const double size = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
  const Quality& quality = report.quality;
  const std::string volume =
      quality.volume_ratio ? fmt::format(", volume {}", percent_change(*quality.volume_ratio)) : std::string();
  const std::string intersections =
      quality.new_self_intersections
          ? ", " + counted(*quality.new_self_intersections, "new self-intersection", "new self-intersections")
          : std::string();
  const std::string width = quality.narrowest_vertex < 0
                                ? std::string()
                                : fmt::format(", narrowest {:.0f} % of its width", 100 * quality.width_min);
  fmt::print("  quality: edges changed by {} (RMS), area {}{}, bending p99 {:.1f}°{}, {}{}\n",
             percent(quality.edge_rms), percent_change(quality.area_ratio), volume, quality.dihedral_p99_deg,
             width, counted(quality.flipped_faces, "flipped face", "flipped faces"), intersections);
  if (report.condition_estimate) fmt::print("  condition number at least {:.2g}\n", *report.condition_estimate);
  fmt::print("  moved at most {:.3g} % of the model's size, in {:.2f} s (factor {:.2f} s, solve {:.2f} s)\n",
             size > 0 ? 100 * report.max_displacement / size : 0.0, report.seconds.total,
             report.seconds.analyse + report.seconds.factorise, report.seconds.solve);
}

}  // namespace

void print_summary(const EditFile& edit, const EditReport& report, const Points& rest) {
  for (const EditReport::Input& input : report.inputs)
    fmt::print("{}: {} vertices, {} faces\n", input.source, input.vertices, input.faces);
  for (std::size_t i = 0; i < report.steps.size(); ++i) {
    const StepReport& step = report.steps[i];
    const std::string name = step.name.empty() ? "" : step.name + ": ";
    if (step.merge)
      print_merge(step, name);
    else if (step.cut)
      print_cut(step, name);
    else if (step.repair)
      print_repair(step, name);
    else if (step.sculpt)
      print_sculpt(step, name);
    else if (step.transform)
      print_transform(step, name);
    else
      print_deform(edit.steps[i], step, name, report.steps.size() > 1);
    for (const Note& note : step.notes) fmt::print("  {}note: {}\n", name, sentence(note));
  }
  for (const Note& note : report.notes) fmt::print("  note: {}\n", sentence(note));
  if (report.deformed) print_quality(report, rest);
  for (const std::string& output : report.outputs) fmt::print("  wrote {}\n", output);
}

}  // namespace meshgraft::cli
