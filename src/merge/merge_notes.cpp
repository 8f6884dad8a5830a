#include "merge_notes.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "merge/facts.h"
#include "start_candidates.h"

namespace meshgraft {

namespace {

// Each bound says whether it was measured or chosen. The tasks are the public merge tasks (docs/merging.md,
// "Shape").
// Chosen: four times the 6.2° that loops of the tasks have at most.
constexpr double ragged_deg = 25;
// Chosen, × the radius: about the most that loops of the tasks have (0.29), but for the CAD part's.
constexpr double unlike = 0.25;
// Chosen: the tasks' seams are bent by 35° at most.
constexpr double folded_deg = 60;
// Measured, × the radius: the farthest of the tasks is the feline kept in its pose, 3.96 away.
constexpr double far_off = 4;
// Chosen: below 0.35, the width of the worst graft that is accepted (docs/merging.md, "Worst spots").
constexpr double pinched = 0.3;

// Chosen: a source of half its size is not what was asked for.
constexpr double shrunk = 0.5;
// Chosen: pieces that differ by a fifth no longer fit one another.
constexpr double apart = 1.2;

/// Names the settings that differ from those of the first graft.
std::string settings_of(const MergeReport& report) {
  const RetryReport& retry = report.retry;
  std::vector<std::string> settings;
  if (retry.reach_doublings > 0)
    settings.push_back(fmt::format("{} × the influence radius", 1 << retry.reach_doublings));
  if (retry.normal_angle_deg != 0)
    settings.push_back(fmt::format("a normal angle of {:.3g}°", retry.normal_angle_deg));
  if (retry.size != 0) settings.push_back(fmt::format("size {:.6g}", retry.size));
  if (retry.start != 0 || retry.start_shift != 0) {
    const PairReport& pair = report.pairs.front();  // a retry is of one pair
    const Match& start = retry.start_shift == 0 && !pair.starts.empty()
                             ? pair.starts[static_cast<std::size_t>(retry.start)].start
                             : pair.start;
    settings.push_back(fmt::format("the start {}:{} (target:source)", start.target, start.source));
  }
  return fmt::format("{}", fmt::join(settings, ", "));
}

void add_faults(const MergeReport& report, std::vector<Note>& notes) {
  const RetryReport& retry = report.retry;
  if (retry.tries > 0 && retry.faults < retry.faults_before)
    notes.push_back(facts::merge::Retried{.faults_before = retry.faults_before,
                                          .faults = retry.faults,
                                          .tries = retry.tries,
                                          .settings = settings_of(report)});
  else if (retry.tries > 0)
    notes.push_back(facts::merge::RetriedInVain{.faults = retry.faults, .tries = retry.tries});
  const SeamFaults& faults = report.seam.faults;
  if (faults.folded_edges + faults.crossings > 0)
    notes.push_back(
        facts::merge::SeamFaulty{.folded_edges = faults.folded_edges, .crossings = faults.crossings});
  if (faults.far_crossings > 0) notes.push_back(facts::merge::SeamMeetsSurface{.pairs = faults.far_crossings});
}

}  // namespace

double relative_scale(const MergeReport& report, const MergeOptions& options) {
  if (options.pose == MergePose::keep || report.pairs.empty()) return 1;
  const double of_loops = std::ranges::min(report.pairs, {}, &PairReport::size_ratio).size_ratio;
  return report.shape.similarity.scale / options.size.value_or(of_loops);
}

std::vector<Note> merge_notes(const MergeReport& report, const MergeOptions& options) {
  std::vector<Note> notes;
  for (std::size_t p = 0; p < report.pairs.size(); ++p) {
    const PairReport& pair = report.pairs[p];
    if (pair.raggedness_deg > ragged_deg && !options.smooth_boundary)
      notes.push_back(facts::merge::BoundaryRagged{.pair = p, .turn_deg = pair.raggedness_deg});
    if (pair.starts.size() > 1 && is_unsure(pair.starts)) {
      const auto taken = static_cast<std::size_t>(report.retry.start);  // a retry is of one pair
      const StartCandidate& next = pair.starts[taken == 0 ? 1 : 0];
      notes.push_back(facts::merge::StartUnsure{.pair = p,
                                                .percent = 100 * pair.starts[taken].probability,
                                                .target = next.start.target,
                                                .source = next.start.source,
                                                .next_percent = 100 * next.probability});
    }
  }
  for (std::size_t p = 0; p < report.pairs.size(); ++p) {
    const double misfit = report.pairs[p].misfit_rel;
    if (options.pose == MergePose::keep && (misfit > far_off || (misfit > 1 && report.shape.inverted > 0)))
      notes.push_back(facts::merge::SourceStretched{.pair = p, .radii = misfit});
    else if (report.seam.dihedral_p99_deg > folded_deg && misfit > unlike)
      notes.push_back(facts::merge::LoopsDiffer{
          .pair = p, .difference_percent = 100 * misfit, .bend_deg = report.seam.dihedral_p99_deg});
  }
  if (const double scale = relative_scale(report, options); scale < shrunk)
    notes.push_back(facts::merge::SourceShrunk{.percent = 100 * scale});
  if (const auto& scales = report.shape.scales; !scales.empty()) {
    const auto [least, most] = std::ranges::minmax(scales);
    if (most > apart * least) notes.push_back(facts::merge::PiecesScaledApart{.least = least, .most = most});
  }
  if (report.shape.smallest_singular_p5 < pinched)
    notes.push_back(facts::merge::SourceSqueezed{.width_percent = 100 * report.shape.smallest_singular_p5});
  add_faults(report, notes);
  if (!report.seam.manifold) notes.push_back(facts::merge::ResultNotManifold{});
  if (report.evaluation.fell_back_to_linear) notes.push_back(facts::merge::FeaturesBlended{});
  if (report.shape.inverted > 0)
    notes.push_back(facts::merge::SourceInverted{.vertices = report.shape.inverted});
  return notes;
}

}  // namespace meshgraft
