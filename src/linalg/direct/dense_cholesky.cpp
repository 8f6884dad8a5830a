#include "dense_cholesky.h"

#include <algorithm>
#include <cstdint>
#include <vector>

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
void dtrmm_(const char* side, const char* uplo, const char* transa, const char* diag, const int* m,
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

/// Computes C = beta C + alpha A Aᵀ on the lower triangle of tiles. C is rows×columns with its diagonal at
/// (0, 0).
void update_lower(double alpha, const double* a, int lda, int rows, int columns, int depth, double beta,
                  double* c, int ldc, const Context& context) {
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
      dsyrk_("L", "N", &n, &depth, &alpha, a + row, &lda, &beta, corner, &ldc);
      m -= n;
      below += n;
      corner += n;
      if (m <= 0) return;
    }
    dgemm_("N", "T", &m, &n, &depth, &alpha, a + below, &lda, a + column, &lda, &beta, corner, &ldc);
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
      update_lower(minus_one, diagonal + width, rows, below, right, width, one,
                   diagonal + width + static_cast<std::int64_t>(width) * rows, rows, context);
  }
  return columns;
}

void form_update(const double* panel, int rows, int columns, double* update, const Context& context) {
  const int below = rows - columns;
  if (below > 0)
    update_lower(minus_one, panel + columns, rows, below, below, columns, zero, update, below, context);
}

void take_back_update(const double* panel, int rows, int columns, double* update, const Context& context) {
  const int below = rows - columns;
  if (below > 0) update_lower(one, panel + columns, rows, below, below, columns, one, update, below, context);
}

// Rows of L times L₁₁ᵀ. Those of A₁₁ are needed up to the diagonal only.
void restore_panel(const double* panel, int rows, int columns, double* restored, const Context& context) {
  for_each_tile(tiles_of(rows), context, [&](int t) {
    const int first = t * tile_size, m = std::min(tile_size, rows - first), n = std::min(columns, first + m);
    for (int c = 0; c < columns; ++c) {
      const std::int64_t at = first + static_cast<std::int64_t>(c) * rows;
      const int zeros = std::clamp(c - first, 0, m);
      std::fill_n(restored + at, zeros, 0.0);
      std::copy_n(panel + at + zeros, m - zeros, restored + at + zeros);
    }
    dtrmm_("R", "L", "T", "N", &m, &n, &one, panel, &rows, restored + first, &rows);
    for (int c = first + 1; c < n; ++c)
      std::fill_n(restored + first + static_cast<std::int64_t>(c) * rows, c - first, 0.0);
  });
}

}  // namespace meshgraft
