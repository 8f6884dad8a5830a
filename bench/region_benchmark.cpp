#include "region_benchmark.h"

#include <chrono>
#include <string>
#include <string_view>
#include <utility>

namespace meshgraft::bench {

namespace {

/// Returns the edit's region with a second disc as a handle, beside the first.
Region with_second_disc(const BenchEdit& edit) {
  Region region = region_of(edit);
  Handle disc{"second disc"};
  const Eigen::RowVector2d centre(0.75, 0.5);
  for (Index v = 0; v < static_cast<Index>(edit.positions.rows()); ++v)
    if ((edit.positions.row(v).head<2>() - centre).norm() < 0.05) disc.vertices.push_back(v);
  region.handles.push_back(std::move(disc));
  return region;
}

/// Seconds of a set-up: before the matrix, for the matrix, and for its analysis and factorisation.
struct SetUp {
  double prepare = 0, normal = 0, analyse = 0, factorise = 0;
};

/// Times a set-up. `make` takes a context, whose progress tells when the matrix begins.
template <class Make>
SetUp time_set_up(const Make& make) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto since_start = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  SetUp set_up;
  Context context;
  context.progress = [&](const Progress& progress) {
    if (progress.stage == "assemble") set_up.prepare = since_start();
  };
  const Deformer deformer = make(context);
  set_up.analyse = deformer.summary().analyse_seconds;
  set_up.factorise = deformer.summary().factorise_seconds;
  set_up.normal = since_start() - set_up.prepare - set_up.analyse - set_up.factorise;
  return set_up;
}

void run_added_handle(benchmark::State& state, const BenchEdit& edit, DeformMethod method) {
  const DeformerOptions options{.method = method};
  const Region more = with_second_disc(edit);
  for ([[maybe_unused]] auto iteration : state) {
    const SetUp fresh = time_set_up([&](const Context& context) {
      return Deformer(edit.positions, edit.triangles, more, options, context);
    });
    const Deformer first(edit.positions, edit.triangles, region_of(edit), options);
    const SetUp shared = time_set_up([&](const Context& context) { return first.with_region(more, context); });
    report(state, {{"prepare", shared.prepare},
                   {"normal", shared.normal},
                   {"analyse", shared.analyse},
                   {"factorise", shared.factorise}});
    state.counters["fresh_prepare"] += fresh.prepare;
    state.counters["fresh_normal"] += fresh.normal;
    state.counters["fresh_analyse"] += fresh.analyse;
    state.counters["fresh_factorise"] += fresh.factorise;
  }
  average(state);
  state.counters["vertices"] = static_cast<double>(edit.positions.rows());
}

}  // namespace

void register_regions(Edits& edits) {
  for (const auto method : {DeformMethod::ft05, DeformMethod::corotational})
    for (const Index size : {50'000, 250'000})
      add("region/" + std::string(to_string(method)) + "/added-handle/" + std::to_string(size),
          [&edits, size, method](benchmark::State& state) { run_added_handle(state, edits[size], method); });
}

}  // namespace meshgraft::bench
