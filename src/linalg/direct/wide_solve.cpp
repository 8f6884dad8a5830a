#include "wide_solve.h"

#include <cstdint>

#include "direction.h"
#include "linalg/lanes.h"

namespace meshgraft {

namespace {

using simd::Lanes;
using simd::load;
using simd::store;

constexpr int wide_strip =
    6;  ///< columns of the panel processed together: their part of x just fits the registers

/// Some right-hand sides of one unknown.
template <int lanes, int vectors>
struct Row {
  Lanes<lanes> part[vectors];

  MESHGRAFT_INLINE void read(const double* x) {
    for (int v = 0; v < vectors; ++v) load<lanes>(x + v * lanes, part[v]);
  }
  MESHGRAFT_INLINE void write(double* x) const {
    for (int v = 0; v < vectors; ++v) store<lanes>(part[v], x + v * lanes);
  }
  MESHGRAFT_INLINE void subtract(double factor, const Row& other) {
    for (int v = 0; v < vectors; ++v) part[v] -= factor * other.part[v];
  }
  MESHGRAFT_INLINE void scale(double factor) {
    for (int v = 0; v < vectors; ++v) part[v] *= factor;
  }
};

/// Columns first … first+columns−1 of a panel. `at(r, q)` is row r of the strip's column q.
struct Strip {
  const double* panel;
  int rows, first;

  MESHGRAFT_INLINE double at(int r, int q) const {
    return panel[r + static_cast<std::int64_t>(first + q) * rows];
  }
  MESHGRAFT_INLINE double* row_of(double* x, int r) const {
    return x + static_cast<std::int64_t>(r) * wide_columns;
  }
  /// Returns the strip that lies `by` columns further on. It may lie outside of the panel: it is only prefetched,
  /// because the runs are too short for the hardware prefetcher.
  MESHGRAFT_INLINE const double* strip_further(int by) const {
    return panel + static_cast<std::int64_t>(first + by) * rows;
  }
};

template <int lanes, int vectors, int columns>
MESHGRAFT_INLINE void solve_wide_strip(const Strip& l, double* x) {
  Row<lanes, vectors> y[columns];
  for (int q = 0; q < columns; ++q) {
    y[q].read(l.row_of(x, l.first + q));
    for (int before = 0; before < q; ++before) y[q].subtract(l.at(l.first + q, before), y[before]);
    y[q].scale(1 / l.at(l.first + q, q));
    y[q].write(l.row_of(x, l.first + q));
  }
  const double* const next = l.strip_further(columns);
  for (int r = l.first + columns; r < l.rows; ++r) {
    __builtin_prefetch(next + columns * (r - l.first));
    Row<lanes, vectors> row;
    row.read(l.row_of(x, r));
    for (int q = 0; q < columns; ++q) row.subtract(l.at(r, q), y[q]);
    row.write(l.row_of(x, r));
  }
}

template <int lanes, int vectors, int columns>
MESHGRAFT_INLINE void solve_wide_strip_transposed(const Strip& l, double* x) {
  Row<lanes, vectors> y[columns];
  for (int q = 0; q < columns; ++q) y[q].read(l.row_of(x, l.first + q));
  const double* const next = l.strip_further(-columns);
  for (int r = l.first + columns; r < l.rows; ++r) {
    __builtin_prefetch(next + columns * (r - l.first));
    Row<lanes, vectors> row;
    row.read(l.row_of(x, r));
    for (int q = 0; q < columns; ++q) y[q].subtract(l.at(r, q), row);
  }
  for (int q = columns - 1; q >= 0; --q) {
    for (int after = q + 1; after < columns; ++after) y[q].subtract(l.at(l.first + after, q), y[after]);
    y[q].scale(1 / l.at(l.first + q, q));
    y[q].write(l.row_of(x, l.first + q));
  }
}

/// Solves for the columns [first, end) of the panel: strips, then smaller strips.
template <int lanes, int vectors, int columns = wide_strip>
MESHGRAFT_INLINE void solve_wide_forward(const double* panel, int rows, int first, int end, double* x) {
  for (; first + columns <= end; first += columns)
    for (int side = 0; side < wide_columns; side += lanes * vectors)
      solve_wide_strip<lanes, vectors, columns>({panel, rows, first}, x + side);
  if constexpr (columns > 1) solve_wide_forward<lanes, vectors, columns / 2>(panel, rows, first, end, x);
}

/// Does the same in the reverse order.
template <int lanes, int vectors, int columns = wide_strip>
MESHGRAFT_INLINE void solve_wide_backward(const double* panel, int rows, int begin, int end, double* x) {
  const int whole = begin + (end - begin) / columns * columns;
  if constexpr (columns > 1) solve_wide_backward<lanes, vectors, columns / 2>(panel, rows, whole, end, x);
  for (int first = whole - columns; first >= begin; first -= columns)
    for (int side = 0; side < wide_columns; side += lanes * vectors)
      solve_wide_strip_transposed<lanes, vectors, columns>({panel, rows, first}, x + side);
}

template <int lanes, int vectors>
MESHGRAFT_INLINE void solve_wide(Direction direction, const double* panel, int rows, int columns, double* x) {
  if (direction == Direction::forward)
    solve_wide_forward<lanes, vectors>(panel, rows, 0, columns, x);
  else
    solve_wide_backward<lanes, vectors>(panel, rows, 0, columns, x);
}

void solve_wide_baseline(Direction direction, const double* panel, int rows, int columns, double* x) {
  solve_wide<2, 2>(direction, panel, rows, columns, x);
}

#if defined(__x86_64__) && defined(__GNUC__)
[[gnu::target("avx2,fma")]] void solve_wide_avx2(Direction direction, const double* panel, int rows,
                                                 int columns, double* x) {
  solve_wide<4, 2>(direction, panel, rows, columns, x);
}

[[gnu::target("avx512f,avx512vl,fma")]] void solve_wide_avx512(Direction direction, const double* panel,
                                                               int rows, int columns, double* x) {
  solve_wide<8, 4>(direction, panel, rows, columns, x);
}
#else
constexpr auto *solve_wide_avx2 = solve_wide_baseline, *solve_wide_avx512 = solve_wide_baseline;
#endif

void solve_wide_all(Direction direction, const double* panel, int rows, int columns, double* x,
                    platform::VectorInstructions instructions) {
  switch (instructions) {
    case platform::VectorInstructions::avx512: return solve_wide_avx512(direction, panel, rows, columns, x);
    case platform::VectorInstructions::avx2: return solve_wide_avx2(direction, panel, rows, columns, x);
    default: return solve_wide_baseline(direction, panel, rows, columns, x);
  }
}

}  // namespace

void solve_wide_panel(const double* panel, int rows, int columns, double* x,
                      platform::VectorInstructions instructions) {
  solve_wide_all(Direction::forward, panel, rows, columns, x, instructions);
}

void solve_wide_panel_transposed(const double* panel, int rows, int columns, double* x,
                                 platform::VectorInstructions instructions) {
  solve_wide_all(Direction::backward, panel, rows, columns, x, instructions);
}

}  // namespace meshgraft
