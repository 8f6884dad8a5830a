// Makes random grafts of the built-in models on one another. Prints Markdown tables of how many results are
// valid, and how good the results are.
//
//   meshgraft_random_grafts [--count 500] [--seed 1] [--found] [--no-retry] [--verbose] [--save FOLDER]
//
// --found: only with the shape `similar`, and with pose and start found; --no-retry: the first graft of each

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "../cli/blas_kernels.h"
#include "support/graft_faults.h"
#include "support/random_grafts.h"

namespace meshgraft::bench {
namespace {

struct Arguments {
  std::uint64_t first_seed = 1;
  int count = 500;
  bool verbose = false, retry = true;
  test::GraftKind kind = test::GraftKind::any;
  std::filesystem::path folder;  ///< where the meshes of each graft are saved; not if empty
};

struct Outcome {
  std::uint64_t seed = 0;
  std::string text;
  std::string refusal;  ///< id of the error; empty where it was merged
  std::vector<std::string> faults;
  double seconds = 0;
  MergeReport report;
  test::Intersections intersections;

  bool is_valid() const { return refusal.empty() && faults.empty(); }
};

void save(const test::RandomGraft& graft, const MergeResult& result, const std::filesystem::path& folder,
          std::uint64_t seed) {
  std::filesystem::create_directories(folder);
  write_mesh(graft.target, folder / fmt::format("{}_target.ply", seed));
  write_mesh(graft.source, folder / fmt::format("{}_source.ply", seed));
  write_mesh(result.mesh, folder / fmt::format("{}_result.ply", seed));
}

Outcome run_one(std::uint64_t seed, const Arguments& arguments) {
  Outcome outcome;
  outcome.seed = seed;
  test::RandomGraft graft = test::make_random_graft(seed, arguments.kind);
  graft.options.retry = arguments.retry;
  outcome.text = graft.text;
  try {
    const auto start = std::chrono::steady_clock::now();
    const test::Attempt made = test::attempt(graft);
    outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (made.refusal) {
      outcome.refusal = fmt::format("{}: {}", made.refusal->id(), made.refusal->what());
      if (made.refusal->code() == ErrorCode::internal) outcome.faults = {outcome.refusal};
    } else {
      outcome.report = made.result->report;
      outcome.faults = test::faults_of(graft, *made.result);
      outcome.intersections = test::intersections_of(graft, *made.result);
      if (!arguments.folder.empty()) save(graft, *made.result, arguments.folder, seed);
    }
  } catch (const std::exception& error) {
    outcome.faults = {fmt::format("an exception: {}", error.what())};
  }
  return outcome;
}

void print_counts(const std::vector<Outcome>& outcomes) {
  struct Count {
    int runs = 0;
    std::vector<std::uint64_t> seeds;
  };
  std::map<std::string, Count> counts;
  for (const Outcome& outcome : outcomes) {
    const auto add = [&](const std::string& what) {
      Count& count = counts[what];
      ++count.runs;
      if (count.seeds.size() < 5) count.seeds.push_back(outcome.seed);
    };
    if (outcome.is_valid())
      add("valid");
    else if (outcome.faults.empty())
      add("refused: " + outcome.refusal);
    for (const std::string& fault : outcome.faults) add("INVALID: " + fault);
  }
  fmt::print("| outcome | grafts | for instance, number |\n|---|---:|---|\n");
  for (const auto& [what, count] : counts)
    fmt::print("| {} | {} | {} |\n", what, count.runs, fmt::join(count.seeds, ", "));
}

// Returns by how many degrees the seam's dihedral angles (p99) exceed those of the surfaces that it joins.
double bend_beyond_surfaces(const SeamReport& seam) {
  return seam.dihedral_p99_deg - std::max(seam.target_dihedral_p99_deg, seam.source_dihedral_p99_deg);
}

void print_shares(const std::vector<Outcome>& outcomes) {
  struct Share {
    std::string name;
    std::function<bool(const Outcome&)> holds;
  };
  const std::vector<Share> shares{
      {"smallest angles p1 below 10°", [](const Outcome& o) { return o.report.seam.angle_p1_deg < 10; }},
      {"bends p99 more than 5° beyond both surfaces'",
       [](const Outcome& o) { return bend_beyond_surfaces(o.report.seam) > 5; }},
      {"bends p99 above 90°", [](const Outcome& o) { return o.report.seam.dihedral_p99_deg > 90; }},
      {"bends p99 above 150° (folded)", [](const Outcome& o) { return o.report.seam.dihedral_p99_deg > 150; }},
      {"new self-intersections", [](const Outcome& o) { return o.intersections.new_ones > 0; }},
      {"self-intersections of the seam", [](const Outcome& o) { return o.intersections.of_seam > 0; }},
      {"inverted local maps", [](const Outcome& o) { return o.report.shape.inverted > 0; }},
      {"folded edges within three rings of a strip",
       [](const Outcome& o) { return o.report.seam.faults.folded_edges > 0; }},
      {"intersections among faces there", [](const Outcome& o) { return o.report.seam.faults.crossings > 0; }},
      {"intersections of faces there with other faces",
       [](const Outcome& o) { return o.report.seam.faults.far_crossings > 0; }},
      {"any of these four faults",
       [](const Outcome& o) { return o.report.shape.inverted + o.report.seam.faults.total() > 0; }},
      {"grafted again", [](const Outcome& o) { return o.report.retry.tries > 0; }},
  };
  fmt::print("\n| of the valid ones | grafts | for instance, number |\n|---|---:|---|\n");
  for (const Share& share : shares) {
    int count = 0, all = 0;
    std::vector<std::uint64_t> seeds;
    for (const Outcome& outcome : outcomes) {
      if (!outcome.is_valid()) continue;
      ++all;
      if (!share.holds(outcome)) continue;
      ++count;
      if (seeds.size() < 12) seeds.push_back(outcome.seed);
    }
    fmt::print("| {} | {} of {} | {} |\n", share.name, count, all, fmt::join(seeds, ", "));
  }
}

void print_measures(const std::vector<Outcome>& outcomes) {
  struct Measure {
    std::string name;
    std::function<double(const Outcome&)> value;
    bool small_is_bad;
  };
  const std::vector<Measure> measures{
      {"smallest angle p1 (°)", [](const Outcome& o) { return o.report.seam.angle_p1_deg; }, true},
      {"dihedral p99 (°)", [](const Outcome& o) { return o.report.seam.dihedral_p99_deg; }, false},
      {"the same beyond both surfaces' (°)",
       [](const Outcome& o) { return bend_beyond_surfaces(o.report.seam); }, false},
      {"smallest singular value p5", [](const Outcome& o) { return o.report.shape.smallest_singular_p5; },
       true},
      {"inverted vertices", [](const Outcome& o) { return static_cast<double>(o.report.shape.inverted); },
       false},
      {"new self-intersections", [](const Outcome& o) { return static_cast<double>(o.intersections.new_ones); },
       false},
      {"self-intersections of the seam",
       [](const Outcome& o) { return static_cast<double>(o.intersections.of_seam); }, false},
      {"misfit of the loops",
       [](const Outcome& o) {
         double worst = 0;
         for (const PairReport& pair : o.report.pairs) worst = std::max(worst, pair.misfit_rel);
         return worst;
       },
       false},
      {"band displacement", [](const Outcome& o) { return o.report.seam.band_displacement_rel; }, false},
      {"seconds", [](const Outcome& o) { return o.seconds; }, false},
  };
  fmt::print("\n| measure | median | worst tenth | worst | of number |\n|---|---:|---:|---:|---:|\n");
  for (const Measure& measure : measures) {
    std::vector<std::pair<double, std::uint64_t>> values;  // measure and seed, the worst last
    for (const Outcome& outcome : outcomes)
      if (outcome.is_valid()) values.emplace_back(measure.value(outcome), outcome.seed);
    if (values.empty()) return;
    std::sort(values.begin(), values.end());
    if (measure.small_is_bad) std::reverse(values.begin(), values.end());
    fmt::print("| {} | {:.3g} | {:.3g} | {:.3g} | {} |\n", measure.name, values[values.size() / 2].first,
               values[values.size() * 9 / 10].first, values.back().first, values.back().second);
  }
}

int run(const Arguments& arguments) {
  std::vector<Outcome> outcomes;
  for (int k = 0; k < arguments.count; ++k) {
    outcomes.push_back(run_one(arguments.first_seed + static_cast<std::uint64_t>(k), arguments));
    const Outcome& last = outcomes.back();
    if (!arguments.verbose && last.faults.empty()) continue;
    const SeamReport& seam = last.report.seam;
    fmt::print(stderr,
               "{}: {}: {}{} {:.2f} s; angle {:.1f}, bend {:.0f} ({:.0f}, {:.0f}), intersections {} ({}), "
               "inverted {}\n",
               last.seed, last.text, last.refusal.empty() ? "" : "refused, ",
               !last.faults.empty() ? fmt::format("INVALID {}", fmt::join(last.faults, "; "))
               : last.is_valid()    ? "valid"
                                    : "no result",
               last.seconds, seam.angle_p1_deg, seam.dihedral_p99_deg, seam.target_dihedral_p99_deg,
               seam.source_dihedral_p99_deg, last.intersections.new_ones, last.intersections.of_seam,
               last.report.shape.inverted);
  }
  print_counts(outcomes);
  print_shares(outcomes);
  print_measures(outcomes);
  const bool all_valid =
      std::all_of(outcomes.begin(), outcomes.end(), [](const Outcome& o) { return o.faults.empty(); });
  return all_valid ? 0 : 1;
}

std::optional<Arguments> parse(int argc, char** argv) {
  Arguments arguments;
  for (int k = 1; k < argc; ++k) {
    const std::string_view name = argv[k];
    if (name == "--verbose" || name == "--found" || name == "--no-retry") {
      arguments.verbose |= name == "--verbose";
      if (name == "--found") arguments.kind = test::GraftKind::found;
      if (name == "--no-retry") arguments.retry = false;
      continue;
    }
    if (k + 1 == argc) return std::nullopt;
    if (name == "--save") {
      arguments.folder = argv[++k];
      continue;
    }
    const std::uint64_t value = std::strtoull(argv[++k], nullptr, 10);
    if (name == "--count") {
      arguments.count = static_cast<int>(value);
    } else if (name == "--seed") {
      arguments.first_seed = value;
    } else {
      return std::nullopt;
    }
  }
  return arguments;
}

}  // namespace
}  // namespace meshgraft::bench

int main(int argc, char** argv) {
  meshgraft::cli::restart_with_better_blas_kernels(argv);
  const auto arguments = meshgraft::bench::parse(argc, argv);
  if (!arguments) {
    fmt::print(stderr,
               "usage: meshgraft_random_grafts [--count 500] [--seed 1] [--found] [--no-retry] [--verbose] "
               "[--save FOLDER]\n");
    return 2;
  }
  return meshgraft::bench::run(*arguments);
}
