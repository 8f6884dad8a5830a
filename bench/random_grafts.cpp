// Random grafts of the built-in models on one another: whether their results are valid, why some are refused,
// and how good the others are; prints markdown tables.
//
//   meshgraft_random_grafts [--count 500] [--seed 1] [--verbose]

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "../cli/blas_kernels.h"
#include "support/random_grafts.h"

namespace meshgraft::bench {
namespace {

struct Arguments {
  std::uint64_t first_seed = 1;
  int count = 500;
  bool verbose = false;
};

struct Outcome {
  std::uint64_t seed = 0;
  std::string text;
  std::vector<std::string> faults;
  std::string refusal;  ///< empty where it was not refused
  double seconds = 0;
  MergeReport report;
};

// A message without its numbers, so that refusals for one reason count as one.
std::string reason_of(const Error& error) {
  std::string reason = fmt::format("{}: ", to_string(error.code()));
  bool in_number = false;
  for (const char c : error.problem()) {
    const bool digit = (c >= '0' && c <= '9') || (in_number && (c == '.' || c == ','));
    if (!digit) reason += c;
    if (digit && !in_number) reason += '#';
    in_number = digit;
  }
  return reason;
}

Outcome run_one(std::uint64_t seed) {
  Outcome outcome{seed, {}, {}, {}, 0, {}};
  const test::RandomGraft graft = test::make_random_graft(seed);
  outcome.text = graft.text;
  const auto start = std::chrono::steady_clock::now();
  try {
    const MergeResult result = merge_meshes(graft.target, graft.source, graft.pairs, graft.options);
    outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    outcome.report = result.report;
    outcome.faults = test::faults_of(graft, result);
  } catch (const Error& error) {
    outcome.refusal = reason_of(error);
    if (error.code() == ErrorCode::internal) outcome.faults = {outcome.refusal};
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
    if (outcome.faults.empty() && outcome.refusal.empty()) add("valid");
    if (outcome.faults.empty() && !outcome.refusal.empty()) add("refused: " + outcome.refusal);
    for (const std::string& fault : outcome.faults) add("INVALID: " + fault);
  }
  fmt::print("| outcome | grafts | for instance, number |\n|---|---:|---|\n");
  for (const auto& [what, count] : counts)
    fmt::print("| {} | {} | {} |\n", what, count.runs, fmt::join(count.seeds, ", "));
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
      {"smallest singular value p5", [](const Outcome& o) { return o.report.shape.smallest_singular_p5; },
       true},
      {"inverted vertices", [](const Outcome& o) { return static_cast<double>(o.report.shape.inverted); },
       false},
      {"band displacement", [](const Outcome& o) { return o.report.seam.band_displacement_rel; }, false},
      {"seconds", [](const Outcome& o) { return o.seconds; }, false},
  };
  fmt::print("\n| measure | median | worst tenth | worst | of number |\n|---|---:|---:|---:|---:|\n");
  for (const Measure& measure : measures) {
    std::vector<std::pair<double, std::uint64_t>> values;  // the worst last
    for (const Outcome& outcome : outcomes)
      if (outcome.refusal.empty() && outcome.faults.empty())
        values.emplace_back(measure.value(outcome), outcome.seed);
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
    outcomes.push_back(run_one(arguments.first_seed + static_cast<std::uint64_t>(k)));
    const Outcome& last = outcomes.back();
    if (!arguments.verbose && last.faults.empty()) continue;
    fmt::print(stderr, "{}: {}: {} {:.2f} s\n", last.seed, last.text,
               !last.faults.empty()   ? fmt::format("INVALID {}", fmt::join(last.faults, "; "))
               : last.refusal.empty() ? "valid"
                                      : last.refusal,
               last.seconds);
  }
  print_counts(outcomes);
  print_measures(outcomes);
  const bool all_valid =
      std::all_of(outcomes.begin(), outcomes.end(), [](const Outcome& o) { return o.faults.empty(); });
  return all_valid ? 0 : 1;
}

std::optional<Arguments> parse(int argc, char** argv) {
  Arguments arguments;
  for (int k = 1; k < argc; ++k) {
    const std::string_view name = argv[k];
    if (name == "--verbose") {
      arguments.verbose = true;
      continue;
    }
    if (k + 1 == argc) return std::nullopt;
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
    fmt::print(stderr, "usage: meshgraft_random_grafts [--count 500] [--seed 1] [--verbose]\n");
    return 2;
  }
  return meshgraft::bench::run(*arguments);
}
