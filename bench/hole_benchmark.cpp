// Compares hole triangulation with CGAL's. Prints a Markdown table by family and size for docs/repair.md.

#include <chrono>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "mesh/repair/hole_triangulation.h"
#include "support/cgal_holes.h"
#include "support/hole_families.h"

namespace {

using namespace meshgraft;
using Triangles = std::vector<HoleTriangle>;

struct Run {
  Triangles triangles;
  double seconds = 0;
};

template <class Work>
Run timed(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  Run run{work()};
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return run;
}

const char* verdict(const test::HoleCost& ours, const test::HoleCost& theirs) {
  if (ours.angle < theirs.angle - 1e-9) return "smaller angle";
  if (ours.angle > theirs.angle + 1e-9) return "**larger angle**";
  if (ours.area < theirs.area * (1 - 1e-9)) return "smaller area";
  if (ours.area > theirs.area * (1 + 1e-9)) return "**larger area**";
  return "equal";
}

}  // namespace

// meshgraft_hole_bench [MOST_EDGES [FAMILY]]
int main(int count, char** arguments) {
  const Index most = count > 1 ? std::atoi(arguments[1]) : 5000;
  const std::string family = count > 2 ? arguments[2] : "";
  constexpr double degrees = 180 / M_PI;
  fmt::print(
      "| hole | edges | faces around | largest angle, degrees | CGAL's | area | CGAL's | seconds | CGAL's | "
      "|\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|---|\n");
  int holes = 0, worse = 0;
  for (const test::HoleCase& hole : test::hole_cases(most)) {
    if (!family.empty() && hole.family != family) continue;
    const Run ours = timed([&] { return triangulate_hole({hole.points, hole.beyond}); });
    const Run theirs = timed([&] { return test::cgal_hole_triangles(hole); });
    const std::string faults = test::hole_faults(hole.size(), ours.triangles);
    const bool answered = !theirs.triangles.empty();
    const test::HoleCost our_cost = hole_cost(hole, ours.triangles),
                         their_cost = hole_cost(hole, theirs.triangles);
    const std::string what = !faults.empty() ? "**" + faults + "**"
                             : answered      ? verdict(our_cost, their_cost)
                                             : "CGAL has none";
    ++holes;
    worse += what.starts_with("**");
    fmt::print("| {} | {} | {} | {:.4f} | {:.4f} | {:.6g} | {:.6g} | {:.4f} | {:.4f} | {} |\n", hole.family,
               hole.size(), hole.beyond.rows() > 0 ? "yes" : "no", our_cost.angle * degrees,
               their_cost.angle * degrees, our_cost.area, their_cost.area, ours.seconds, theirs.seconds, what);
    std::fflush(stdout);
  }
  fmt::print("\n{} holes, {} worse than CGAL's\n", holes, worse);
}
