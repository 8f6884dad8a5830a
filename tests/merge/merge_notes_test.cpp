#include "merge/merge_notes.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace meshgraft {
namespace {

/// Returns a report that gives no reason for a note.
MergeReport clean_report(std::size_t pairs) {
  MergeReport report;
  report.pairs.resize(pairs);
  for (std::size_t p = 0; p < pairs; ++p)
    report.pairs[p].start = {static_cast<Index>(10 + p), static_cast<Index>(20 + p)};
  report.seam.manifold = true;
  return report;
}

std::vector<std::string> note_ids(const MergeReport& report, const MergeOptions& options = {}) {
  std::vector<std::string> ids;
  for (const Note& note : merge_notes(report, options)) ids.emplace_back(note.id());
  return ids;
}

using Ids = std::vector<std::string>;
using Change = std::function<void(MergeReport&)>;

/// Two changes of a clean report: one that just keeps a bound, and one that just exceeds it.
struct NotedBound {
  std::string id;
  Change keeps, exceeds;
  MergeOptions options{};
};

std::vector<NotedBound> noted_bounds() {
  const auto raggedness = [](double value) {
    return [value](MergeReport& report) { report.pairs[1].raggedness_deg = value; };
  };
  const auto confidence = [](double value) {
    return [value](MergeReport& report) { report.pairs[1].starts = {{{7, 8}, value}, {{3, 4}, 1 - value}}; };
  };
  const auto differing = [](double misfit, double bend_deg) {
    return [misfit, bend_deg](MergeReport& report) {
      report.pairs[1].misfit_rel = misfit;
      report.seam.dihedral_p99_deg = bend_deg;
    };
  };
  const auto width = [](double value) {
    return [value](MergeReport& report) { report.shape.smallest_singular_p5 = value; };
  };
  const auto scale = [](double value) {
    return [value](MergeReport& report) { report.shape.similarity.scale = value; };
  };
  const auto scales = [](double larger) {
    return [larger](MergeReport& report) { report.shape.scales = {1, larger}; };
  };
  const auto manifold = [](bool value) {
    return [value](MergeReport& report) { report.seam.manifold = value; };
  };
  const auto blended = [](bool value) {
    return [value](MergeReport& report) { report.evaluation.fell_back_to_linear = value; };
  };
  const auto inverted = [](Index value) {
    return [value](MergeReport& report) { report.shape.inverted = value; };
  };
  const MergeOptions kept{.pose = MergePose::keep};
  return {{"merge.boundary_ragged", raggedness(25), raggedness(25.001)},
          {"merge.start_unsure", confidence(0.6), confidence(0.599)},
          {"merge.loops_differ", differing(0.25, 61), differing(0.251, 61)},
          {"merge.loops_differ", differing(0.3, 60), differing(0.3, 60.001)},
          {"merge.loops_differ", differing(0.3, 60), differing(0.3, 60.001), kept},
          {"merge.source_stretched", differing(4, 0), differing(4.001, 0), kept},
          {"merge.source_squeezed", width(0.3), width(0.299)},
          {"merge.source_shrunk", scale(0.5), scale(0.499)},
          {"merge.source_shrunk", scale(1.5), scale(1.499), {.size = 3}},
          {"merge.pieces_scaled_apart", scales(1.2), scales(1.201)},
          {"merge.result_not_manifold", manifold(true), manifold(false)},
          {"merge.features_blended", blended(false), blended(true)},
          {"merge.source_inverted", inverted(0), inverted(1)}};
}

TEST(MergeNotes, ACleanReportHasNone) {
  for (const std::size_t pairs : {0U, 1U, 4U})
    for (const MergePose pose : {MergePose::find, MergePose::keep})
      EXPECT_EQ(note_ids(clean_report(pairs), {.pose = pose}), Ids());
}

TEST(MergeNotes, EachAppearsAloneWhereItsBoundIsExceeded) {
  for (const NotedBound& bound : noted_bounds()) {
    MergeReport report = clean_report(3);
    bound.keeps(report);
    EXPECT_EQ(note_ids(report, bound.options), Ids()) << bound.id;
    bound.exceeds(report);
    EXPECT_EQ(note_ids(report, bound.options), Ids{bound.id});
  }
}

TEST(MergeNotes, DoNotSuppressEachOther) {
  for (const NotedBound& first : noted_bounds())
    for (const NotedBound& second : noted_bounds()) {
      const auto is_of_found_poses = [](const NotedBound& bound) {
        return bound.id == "merge.loops_differ" || bound.id == "merge.source_shrunk";
      };
      if (first.id >= second.id || is_of_found_poses(first) || is_of_found_poses(second)) continue;
      MergeReport report = clean_report(3);
      first.exceeds(report);
      second.exceeds(report);
      const Ids ids = note_ids(report, {.pose = MergePose::keep});
      EXPECT_EQ(ids.size(), 2U) << first.id << ", " << second.id;
      for (const std::string& id : {first.id, second.id}) EXPECT_TRUE(std::ranges::count(ids, id)) << id;
    }
}

TEST(MergeNotes, NameTheirPairAndItsValues) {
  for (std::size_t p = 0; p < 3; ++p) {
    MergeReport report = clean_report(3);
    PairReport& pair = report.pairs[p];
    pair.raggedness_deg = 40;
    pair.starts = {{{7, 8}, 0.5}, {{3, 4}, 0.25}};
    pair.misfit_rel = 0.5;
    report.seam.dihedral_p99_deg = 80;
    const std::vector<Note> notes = merge_notes(report, {});
    ASSERT_EQ(notes.size(), 3U);
    for (const Note& note : notes)
      EXPECT_EQ(note.get<std::int64_t>("pair"), static_cast<std::int64_t>(p)) << note.id();
    EXPECT_EQ(notes[0].get<double>("turn_deg"), 40);
    EXPECT_EQ(notes[1].get<double>("percent"), 50);
    EXPECT_EQ(notes[1].get<double>("next_percent"), 25);
    EXPECT_EQ(notes[1].get<std::int64_t>("source"), 3);
    EXPECT_EQ(notes[1].get<std::int64_t>("target"), 4);
    EXPECT_EQ(notes[2].get<double>("difference_percent"), 50);
    EXPECT_EQ(notes[2].get<double>("bend_deg"), 80);
  }
}

TEST(MergeNotes, TakeTheLeastLoopForTheSourcesSize) {
  MergeReport report = clean_report(3);
  report.pairs[0].size_ratio = 8;
  report.pairs[1].size_ratio = 4;
  report.pairs[2].size_ratio = 5;
  report.shape.similarity.scale = 1;
  const std::vector<Note> notes = merge_notes(report, {});
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].get<double>("percent"), 25);
  EXPECT_EQ(note_ids(report, {.pose = MergePose::keep}), Ids());
}

TEST(MergeNotes, AppearForEachPair) {
  MergeReport report = clean_report(3);
  for (PairReport& pair : report.pairs) pair.raggedness_deg = 40;
  EXPECT_EQ(note_ids(report), Ids(3, "merge.boundary_ragged"));
}

TEST(MergeNotes, SmoothedBoundariesAreNotCalledRagged) {
  MergeReport report = clean_report(2);
  report.pairs[0].raggedness_deg = 90;
  EXPECT_EQ(note_ids(report, {.smooth_boundary = true}), Ids());
}

TEST(MergeNotes, OnlyAKeptPoseDrawsTheSourceOut) {
  for (const double misfit : {0.5, 1.0, 1.001, 3.0, 4.0, 4.001, 100.0})
    for (const Index inverted : {0, 7}) {
      MergeReport report = clean_report(1);
      report.pairs[0].misfit_rel = misfit;
      report.shape.inverted = inverted;
      const Ids turned = inverted > 0 ? Ids{"merge.source_inverted"} : Ids();
      EXPECT_EQ(note_ids(report), turned) << misfit;
      Ids kept = turned;
      if (misfit > (inverted > 0 ? 1 : 4)) kept.insert(kept.begin(), "merge.source_stretched");
      EXPECT_EQ(note_ids(report, {.pose = MergePose::keep}), kept) << misfit;
      // Loops that are far apart need not differ.
      report.seam.dihedral_p99_deg = 90;
      if (kept.size() > turned.size()) {
        EXPECT_EQ(note_ids(report, {.pose = MergePose::keep}), kept) << misfit;
      }
    }
}

}  // namespace
}  // namespace meshgraft
