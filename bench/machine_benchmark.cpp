#include "machine_benchmark.h"

#include <cstddef>
#include <memory>
#include <thread>
#include <vector>

#include "bench_run.h"

extern "C" void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k,
                       const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
                       const double* beta, double* c, const int* ldc);

extern "C" [[gnu::weak]] void openblas_set_num_threads(int count);  // null unless BLAS is OpenBLAS

namespace meshgraft::bench {

namespace {

void on_threads(int threads, const std::function<void(int)>& work) {
  std::vector<std::jthread> others;
  for (int thread = 1; thread < threads; ++thread) others.emplace_back([&work, thread] { work(thread); });
  work(0);
}

/// Returns the operations per second of dense matrix products; each thread multiplies its own matrices.
double dgemm_flops(int threads) {
  if (openblas_set_num_threads != nullptr) openblas_set_num_threads(1);
  constexpr int n = 2000;
  std::vector<std::vector<double>> a(threads), b(threads), c(threads);
  for (int thread = 0; thread < threads; ++thread)
    for (auto* matrix : {&a[thread], &b[thread], &c[thread]}) matrix->assign(std::size_t{n} * n, 1.0);
  const double time = median_seconds(5, [&] {
    on_threads(threads, [&](int thread) {
      const double one = 1, zero = 0;
      dgemm_("N", "T", &n, &n, &n, &one, a[thread].data(), &n, b[thread].data(), &n, &zero, c[thread].data(),
             &n);
    });
  });
  return threads * 2.0 * n * n * n / time;
}

constexpr std::size_t stream_length = std::size_t{1} << 25;

double triad_bytes(int threads) {
  std::vector<double> a(stream_length, 1), b(stream_length, 2), c(stream_length, 3);
  const double time = median_seconds(5, [&] {
    on_threads(threads, [&](int thread) {
      const std::size_t share = stream_length / static_cast<std::size_t>(threads);
      const std::size_t first = share * static_cast<std::size_t>(thread);
      for (std::size_t i = first; i < first + share; ++i) a[i] = b[i] + 3 * c[i];
    });
    benchmark::DoNotOptimize(a.data());
    benchmark::ClobberMemory();
  });
  return 3.0 * sizeof(double) * stream_length / time;
}

void run(benchmark::State& state, double (*rate)(int)) {
  const auto cores = static_cast<int>(std::thread::hardware_concurrency());
  double one = 0, all = 0;
  for ([[maybe_unused]] auto iteration : state) {
    const double time = seconds([&] {
      one = rate(1);
      all = rate(cores);
    });
    state.SetIterationTime(time);
  }
  state.counters["one_core"] = one;
  state.counters["all_cores"] = all;
}

}  // namespace

void register_machine() {
  add("machine/dgemm/double/2000", [](benchmark::State& state) { run(state, dgemm_flops); });
  add("machine/triad/double/33554432", [](benchmark::State& state) { run(state, triad_bytes); });
}

}  // namespace meshgraft::bench
