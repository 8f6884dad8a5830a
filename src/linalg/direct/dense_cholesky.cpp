#include "dense_cholesky.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/parallel.h"

// BLAS and LAPACK under their Fortran names. The lengths of their one-letter strings are not read.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" {
void dgemm_(const char* transa, const char* transb, const int* m, const int* n, const int* k,
            const double* alpha, const double* a, const int* lda, const double* b, const int* ldb,
            const double* beta, double* c, const int* ldc);
void dsyrk_(const char* uplo, const char* trans, const int* n, const int* k, const double* alpha,
            const double* a, const int* lda, const double* beta, double* c, const int* ldc);
void dtrsm_(const char* side, const char* uplo, const char* transa, const char* diag, const int* m,
            const int* n, const double* alpha, const double* a, const int* lda, double* b, const int* ldb);
void dpotrf_(const char* uplo, const int* n, double* a, const int* lda, int* info);
}
// NOLINTEND(readability-identifier-naming)

namespace meshgraft {

namespace {

constexpr double one = 1, minus_one = -1, zero = 0;

/// Runs `tile(t)` for all t, in parallel if there is enough work.
template <class Tile>
void for_each_tile(int count, const Context& context, const Tile& tile) {
  parallel_blocks(
      count,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) tile(static_cast<int>(t));
      },
      context, 1);
}

constexpr int panel_width = 192;  ///< columns factorised before the remaining ones are updated
constexpr int tile_size = 384;

int tiles_of(int length) { return (length + tile_size - 1) / tile_size; }

/// Computes C = beta C − A Bᵀ on the lower triangle of tiles. C is rows×columns with its diagonal at (0, 0).
void update_lower(const double* a, int lda, int rows, int columns, int depth, double beta, double* c, int ldc,
                  const Context& context) {
  struct Tile {
    int row, column;
  };
  std::vector<Tile> tiles;
  for (int j = 0; j < tiles_of(columns); ++j)
    for (int i = j; i < tiles_of(rows); ++i) tiles.push_back({i * tile_size, j * tile_size});
  for_each_tile(static_cast<int>(tiles.size()), context, [&](int t) {
    const auto [row, column] = tiles[t];
    const int n = std::min(tile_size, columns - column);
    int m = std::min(tile_size, rows - row), below = row;
    double* corner = c + row + static_cast<std::int64_t>(column) * ldc;
    if (row == column) {
      dsyrk_("L", "N", &n, &depth, &minus_one, a + row, &lda, &beta, corner, &ldc);
      m -= n;
      below += n;
      corner += n;
      if (m <= 0) return;
    }
    dgemm_("N", "T", &m, &n, &depth, &minus_one, a + below, &lda, a + column, &lda, &beta, corner, &ldc);
  });
}

}  // namespace

int factorise_panel(double* panel, int rows, int columns, const Context& context) {
  for (int begin = 0; begin < columns; begin += panel_width) {
    const int width = std::min(panel_width, columns - begin), below = rows - begin - width;
    double* diagonal = panel + begin + static_cast<std::int64_t>(begin) * rows;
    int info = 0;
    dpotrf_("L", &width, diagonal, &rows, &info);
    if (info != 0) return begin + info - 1;
    if (below == 0) break;
    for_each_tile(tiles_of(below), context, [&](int t) {
      const int first = t * tile_size, m = std::min(tile_size, below - first);
      dtrsm_("R", "L", "T", "N", &m, &width, &one, diagonal, &rows, diagonal + width + first, &rows);
    });
    if (const int right = columns - begin - width; right > 0)
      update_lower(diagonal + width, rows, below, right, width, one,
                   diagonal + width + static_cast<std::int64_t>(width) * rows, rows, context);
  }
  return columns;
}

void form_update(const double* panel, int rows, int columns, double* update, const Context& context) {
  const int below = rows - columns;
  if (below > 0) update_lower(panel + columns, rows, below, below, columns, zero, update, below, context);
}

namespace {

// For few right-hand sides reading the panel takes the time, so it is read once. BLAS would pack it first.

constexpr int strip = 4;  ///< columns of the panel processed together

constexpr int line = 8;  ///< values in a cache line

/// Prefetches a cache line of each column of the strip that lies `by` columns further on. The runs are too
/// short for the hardware prefetcher.
template <int columns>
void fetch_strip(const double* panel, int rows, int row, int by) {
  for (int q = 0; q < columns; ++q) __builtin_prefetch(panel + row + static_cast<std::int64_t>(by + q) * rows);
}

/// Computes x_r −= Σ_q L_rq y_q for the rows from `first` on.
template <int width, int columns>
void subtract_product(const double* panel, int rows, int first, const double (&y)[strip][width], double* x) {
  const double* __restrict l = panel;
  double* __restrict out = x;
  for (int begin = first; begin < rows; begin += line) {
    fetch_strip<columns>(panel, rows, begin, columns);
    const int end = std::min(begin + line, rows);
    for (int r = begin; r < end; ++r) {
      for (int c = 0; c < width; ++c) {
        double sum = 0;
        for (int q = 0; q < columns; ++q) sum += l[r + static_cast<std::int64_t>(q) * rows] * y[q][c];
        out[r + static_cast<std::int64_t>(c) * rows] -= sum;
      }
    }
  }
}

/// Computes y_q −= Σ_r L_rq x_r over the rows from `first` on.
template <int width, int columns>
void subtract_dot_products(const double* panel, int rows, int first, const double* x,
                           double (&y)[strip][width]) {
  using Pair = Eigen::Array2d;
  Pair sums[columns][width];
  for (auto& of_column : sums)
    for (Pair& sum : of_column) sum.setZero();
  int r = first;
  for (; r + 1 < rows; r += 2) {
    if ((r - first) % line == 0) fetch_strip<columns>(panel, rows, r, -columns);
    for (int c = 0; c < width; ++c) {
      const Pair value = Eigen::Map<const Pair>(x + r + static_cast<std::int64_t>(c) * rows);
      for (int q = 0; q < columns; ++q)
        sums[q][c] += Eigen::Map<const Pair>(panel + r + static_cast<std::int64_t>(q) * rows) * value;
    }
  }
  for (int q = 0; q < columns; ++q)
    for (int c = 0; c < width; ++c) {
      double sum = sums[q][c].sum();
      if (r < rows)
        sum += panel[r + static_cast<std::int64_t>(q) * rows] * x[r + static_cast<std::int64_t>(c) * rows];
      y[q][c] -= sum;
    }
}

template <int width, int columns>
void solve_strip(const double* panel, int rows, int first, double* x) {
  double y[strip][width];
  for (int q = 0; q < columns; ++q)
    for (int c = 0; c < width; ++c) {
      double value = x[first + q + static_cast<std::int64_t>(c) * rows];
      for (int before = 0; before < q; ++before)
        value -= panel[first + q + static_cast<std::int64_t>(before) * rows] * y[before][c];
      y[q][c] = value / panel[first + q + static_cast<std::int64_t>(q) * rows];
      x[first + q + static_cast<std::int64_t>(c) * rows] = y[q][c];
    }
  subtract_product<width, columns>(panel, rows, first + columns, y, x);
}

template <int width, int columns>
void solve_strip_transposed(const double* panel, int rows, int first, double* x) {
  double y[strip][width];
  for (int q = 0; q < columns; ++q)
    for (int c = 0; c < width; ++c) y[q][c] = x[first + q + static_cast<std::int64_t>(c) * rows];
  subtract_dot_products<width, columns>(panel, rows, first + columns, x, y);
  for (int q = columns - 1; q >= 0; --q)
    for (int c = 0; c < width; ++c) {
      double value = y[q][c];
      for (int after = q + 1; after < columns; ++after)
        value -= panel[first + after + static_cast<std::int64_t>(q) * rows] * y[after][c];
      y[q][c] = value / panel[first + q + static_cast<std::int64_t>(q) * rows];
      x[first + q + static_cast<std::int64_t>(c) * rows] = y[q][c];
    }
}

template <int width>
void solve_narrow(const double* panel, int rows, int columns, double* x) {
  int first = 0;
  for (; first + strip <= columns; first += strip)
    solve_strip<width, strip>(panel + static_cast<std::int64_t>(first) * rows, rows, first, x);
  for (; first < columns; ++first)
    solve_strip<width, 1>(panel + static_cast<std::int64_t>(first) * rows, rows, first, x);
}

template <int width>
void solve_narrow_transposed(const double* panel, int rows, int columns, double* x) {
  int first = columns;
  for (; first % strip != 0; --first)
    solve_strip_transposed<width, 1>(panel + static_cast<std::int64_t>(first - 1) * rows, rows, first - 1, x);
  for (; first > 0; first -= strip)
    solve_strip_transposed<width, strip>(panel + static_cast<std::int64_t>(first - strip) * rows, rows,
                                         first - strip, x);
}

}  // namespace

void solve_panel(const double* panel, int rows, int columns, double* x, int width) {
  switch (width) {
    case 1: return solve_narrow<1>(panel, rows, columns, x);
    case 2: return solve_narrow<2>(panel, rows, columns, x);
    case 3: return solve_narrow<3>(panel, rows, columns, x);
    default: break;
  }
  const int below = rows - columns;
  dtrsm_("L", "L", "N", "N", &columns, &width, &one, panel, &rows, x, &rows);
  if (below > 0)
    dgemm_("N", "N", &below, &width, &columns, &minus_one, panel + columns, &rows, x, &rows, &one, x + columns,
           &rows);
}

void solve_panel_transposed(const double* panel, int rows, int columns, double* x, int width) {
  switch (width) {
    case 1: return solve_narrow_transposed<1>(panel, rows, columns, x);
    case 2: return solve_narrow_transposed<2>(panel, rows, columns, x);
    case 3: return solve_narrow_transposed<3>(panel, rows, columns, x);
    default: break;
  }
  const int below = rows - columns;
  if (below > 0)
    dgemm_("T", "N", &columns, &width, &below, &minus_one, panel + columns, &rows, x + columns, &rows, &one, x,
           &rows);
  dtrsm_("L", "L", "T", "N", &columns, &width, &one, panel, &rows, x, &rows);
}

}  // namespace meshgraft
