#include "narrow_solve.h"

#include <algorithm>
#include <cstdint>

#include "direction.h"
#include "linalg/lanes.h"

namespace meshgraft {

namespace {

using simd::Lanes;
using simd::load;
using simd::store;

constexpr int strip = 4;   ///< columns of the panel processed together
constexpr int widest = 6;  ///< right-hand sides processed together
constexpr int line = 8;    ///< values in a cache line

/// Prefetches a cache line of each column of the strip that lies `by` columns further on. The runs are too
/// short for the hardware prefetcher. Addresses may lie outside of the panel: a prefetch reads nothing.
template <int columns, class Number>
MESHGRAFT_INLINE void fetch_strip(const Number* panel, int rows, int row, int by) {
  for (int q = 0; q < columns; ++q) __builtin_prefetch(panel + row + static_cast<std::int64_t>(by + q) * rows);
}

/// Computes x_r −= Σ_q L_rq y_q for the rows from `r` on.
template <int lanes, int width, int columns, class Number>
MESHGRAFT_INLINE void subtract_product(const Number* panel, int rows, int r, const double (&y)[strip][width],
                                       double* x) {
  for (; r + lanes <= rows; r += lanes) {
    if (lanes >= line || r % line < lanes) fetch_strip<columns>(panel, rows, r, columns);
    Lanes<lanes> l[columns];
    for (int q = 0; q < columns; ++q) load<lanes>(panel + r + static_cast<std::int64_t>(q) * rows, l[q]);
    for (int c = 0; c < width; ++c) {
      double* const out = x + r + static_cast<std::int64_t>(c) * rows;
      Lanes<lanes> value;
      load<lanes>(out, value);
      for (int q = 0; q < columns; ++q) value -= l[q] * y[q][c];
      store<lanes>(value, out);
    }
  }
  if constexpr (lanes > 1) subtract_product<lanes / 2, width, columns>(panel, rows, r, y, x);
}

/// Computes y_q −= Σ_r L_rq x_r over the rows from `r` on.
template <int lanes, int width, int columns, class Number>
MESHGRAFT_INLINE void subtract_dot_products(const Number* panel, int rows, int r, const double* x,
                                            double (&y)[strip][width]) {
  if (r + lanes <= rows) {
    Lanes<lanes> sums[columns][width] = {};
    for (; r + lanes <= rows; r += lanes) {
      if (lanes >= line || r % line < lanes) fetch_strip<columns>(panel, rows, r, -columns);
      Lanes<lanes> value[width];
      for (int c = 0; c < width; ++c) load<lanes>(x + r + static_cast<std::int64_t>(c) * rows, value[c]);
      for (int q = 0; q < columns; ++q) {
        Lanes<lanes> l;
        load<lanes>(panel + r + static_cast<std::int64_t>(q) * rows, l);
        for (int c = 0; c < width; ++c) sums[q][c] += l * value[c];
      }
    }
    for (int q = 0; q < columns; ++q)
      for (int c = 0; c < width; ++c) {
        double parts[lanes];
        store<lanes>(sums[q][c], parts);
        for (int half = lanes / 2; half > 0; half /= 2)
          for (int k = 0; k < half; ++k) parts[k] += parts[k + half];
        y[q][c] -= parts[0];
      }
  }
  if constexpr (lanes > 1) subtract_dot_products<lanes / 2, width, columns>(panel, rows, r, x, y);
}

template <int lanes, int width, int columns, class Number>
MESHGRAFT_INLINE void solve_strip(const Number* panel, int rows, int first, double* x) {
  double y[strip][width];
  for (int q = 0; q < columns; ++q)
    for (int c = 0; c < width; ++c) {
      double value = x[first + q + static_cast<std::int64_t>(c) * rows];
      for (int before = 0; before < q; ++before)
        value -= panel[first + q + static_cast<std::int64_t>(before) * rows] * y[before][c];
      y[q][c] = value / panel[first + q + static_cast<std::int64_t>(q) * rows];
      x[first + q + static_cast<std::int64_t>(c) * rows] = y[q][c];
    }
  subtract_product<lanes, width, columns>(panel, rows, first + columns, y, x);
}

template <int lanes, int width, int columns, class Number>
MESHGRAFT_INLINE void solve_strip_transposed(const Number* panel, int rows, int first, double* x) {
  double y[strip][width];
  for (int q = 0; q < columns; ++q)
    for (int c = 0; c < width; ++c) y[q][c] = x[first + q + static_cast<std::int64_t>(c) * rows];
  subtract_dot_products<lanes, width, columns>(panel, rows, first + columns, x, y);
  for (int q = columns - 1; q >= 0; --q)
    for (int c = 0; c < width; ++c) {
      double value = y[q][c];
      for (int after = q + 1; after < columns; ++after)
        value -= panel[first + after + static_cast<std::int64_t>(q) * rows] * y[after][c];
      y[q][c] = value / panel[first + q + static_cast<std::int64_t>(q) * rows];
      x[first + q + static_cast<std::int64_t>(c) * rows] = y[q][c];
    }
}

template <int lanes, int width, class Number>
MESHGRAFT_INLINE void solve_forward(const Number* panel, int rows, int columns, double* x) {
  int first = 0;
  for (; first + strip <= columns; first += strip)
    solve_strip<lanes, width, strip>(panel + static_cast<std::int64_t>(first) * rows, rows, first, x);
  for (; first < columns; ++first)
    solve_strip<lanes, width, 1>(panel + static_cast<std::int64_t>(first) * rows, rows, first, x);
}

template <int lanes, int width, class Number>
MESHGRAFT_INLINE void solve_backward(const Number* panel, int rows, int columns, double* x) {
  int first = columns;
  for (; first % strip != 0; --first)
    solve_strip_transposed<lanes, width, 1>(panel + static_cast<std::int64_t>(first - 1) * rows, rows,
                                            first - 1, x);
  for (; first > 0; first -= strip)
    solve_strip_transposed<lanes, width, strip>(panel + static_cast<std::int64_t>(first - strip) * rows, rows,
                                                first - strip, x);
}

template <int lanes, int width, class Number>
MESHGRAFT_INLINE void solve_columns(Direction direction, const Number* panel, int rows, int columns,
                                    double* x) {
  if (direction == Direction::forward)
    solve_forward<lanes, width>(panel, rows, columns, x);
  else
    solve_backward<lanes, width>(panel, rows, columns, x);
}

template <int lanes, class Number>
MESHGRAFT_INLINE void solve(Direction direction, const Number* panel, int rows, int columns, double* x,
                            int width) {
  switch (width) {
    case 1: return solve_columns<lanes, 1>(direction, panel, rows, columns, x);
    case 2: return solve_columns<lanes, 2>(direction, panel, rows, columns, x);
    case 3: return solve_columns<lanes, 3>(direction, panel, rows, columns, x);
    case 4: return solve_columns<lanes, 4>(direction, panel, rows, columns, x);
    case 5: return solve_columns<lanes, 5>(direction, panel, rows, columns, x);
    default: return solve_columns<lanes, widest>(direction, panel, rows, columns, x);
  }
}

template <class Number>
void solve_baseline(Direction direction, const Number* panel, int rows, int columns, double* x, int width) {
  solve<2>(direction, panel, rows, columns, x, width);
}

#if defined(__x86_64__) && defined(__GNUC__)
template <class Number>
[[gnu::target("avx2,fma")]] void solve_avx2(Direction direction, const Number* panel, int rows, int columns,
                                            double* x, int width) {
  solve<4>(direction, panel, rows, columns, x, width);
}

template <class Number>
[[gnu::target("avx512f,avx512vl,fma")]] void solve_avx512(Direction direction, const Number* panel, int rows,
                                                          int columns, double* x, int width) {
  solve<8>(direction, panel, rows, columns, x, width);
}
#else
template <class Number>
constexpr auto* solve_avx2 = solve_baseline<Number>;
template <class Number>
constexpr auto* solve_avx512 = solve_baseline<Number>;
#endif

template <class Number>
void solve_all(Direction direction, const Number* panel, int rows, int columns, double* x, int width,
               platform::VectorInstructions instructions) {
  const auto kernel = [&] {
    switch (instructions) {
      case platform::VectorInstructions::avx512: return solve_avx512<Number>;
      case platform::VectorInstructions::avx2: return solve_avx2<Number>;
      default: return solve_baseline<Number>;
    }
  }();
  for (int c = 0; c < width; c += widest)
    kernel(direction, panel, rows, columns, x + static_cast<std::int64_t>(c) * rows,
           std::min(widest, width - c));
}

}  // namespace

void solve_narrow_panel(const double* panel, int rows, int columns, double* x, int width,
                        platform::VectorInstructions instructions) {
  solve_all(Direction::forward, panel, rows, columns, x, width, instructions);
}

void solve_narrow_panel_transposed(const double* panel, int rows, int columns, double* x, int width,
                                   platform::VectorInstructions instructions) {
  solve_all(Direction::backward, panel, rows, columns, x, width, instructions);
}

void solve_narrow_panel(const float* panel, int rows, int columns, double* x, int width,
                        platform::VectorInstructions instructions) {
  solve_all(Direction::forward, panel, rows, columns, x, width, instructions);
}

void solve_narrow_panel_transposed(const float* panel, int rows, int columns, double* x, int width,
                                   platform::VectorInstructions instructions) {
  solve_all(Direction::backward, panel, rows, columns, x, width, instructions);
}

}  // namespace meshgraft
