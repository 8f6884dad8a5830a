#pragma once

#include <array>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/deform/deform_problem.h>

#include "support/mesh_families.h"

namespace meshgraft::test {

/// Edits of a row mesh: the first tenth of its length is held, the last tenth is moved.
enum class RowEdit {
  stretch,  ///< along its length, by 0.3 of it
  bend,     ///< about an axis across its middle
  twist,    ///< about its length
};

/// Angles of bend and twist. The defaults are small enough for a linear method.
struct RowTurns {
  double bend_deg = 20, twist_deg = 20;
};

const char* to_string(RowEdit edit);

std::vector<VertexConstraint> row_constraints(const RowMesh& rows, RowEdit edit, const RowTurns& turns = {});

/// Returns the effect of an edit on each row. For a stretch or a bend this is the mean displacement along or
/// across the length, relative to the length. For a twist it is the turn about the length, radians.
std::vector<double> row_profile(const RowMesh& rows, RowEdit edit, const Points& edited);

/// The diagonals of the cells of a row mesh. `shifted` turns every second row by half a cell, so that the
/// triangles are isosceles, and obtuse in cells that are long around the tube.
enum class Diagonals { alternate, rising, falling, shifted };

const char* to_string(Diagonals diagonals);

/// Returns a tube of length 3 and girth 2.4 with `around` cells in every row. The halves of its length have
/// `halves[0]` and `halves[1]` rows of cells.
RowMesh tube_of_long_cells(int around, const std::array<int, 2>& halves, Diagonals diagonals);

/// Triangles of the second half of a sheet. `fans` have up to ten triangles of one cell's width at a vertex of
/// every second row, `slivers` angles down to 6°.
enum class OddCells { none, fans, slivers };

/// Returns a flat sheet of 3 × 2.4 with 30 rows of 24 cells, those of the second half by `odd`.
RowMesh sheet_of_odd_cells(OddCells odd);

/// Returns a profile's value at half the length, as a fraction of the whole change.
double fraction_at_half(const RowMesh& rows, const std::vector<double>& profile);

/// Solves for the positions of a mesh under several sets of constraints on the same vertices.
using SolveRows =
    std::function<std::vector<Points>(const TestMesh&, const std::vector<std::vector<VertexConstraint>>&)>;

/// The largest difference between the profiles of a mesh with halves of different resolution (1 : ratio) and of
/// an even mesh of the same shape. Profiles are compared at the same positions along the length, relative to
/// the profile's amplitude. `cells_along` is that of the coarser half.
struct DensityDeviation {
  RowShape shape = RowShape::bar;
  RowEdit edit = RowEdit::stretch;
  int cells_along = 0;
  int ratio = 0;
  double deviation = 0;
};

inline constexpr RowShape all_row_shapes[] = {RowShape::bar, RowShape::tube, RowShape::plane};

/// Returns the deviations of every edit of the shapes: halves 1:2 and 1:4, then even meshes of other
/// resolutions. The reference is an even mesh of 40 cells along the length.
std::vector<DensityDeviation> density_deviations(const SolveRows& solve,
                                                 std::span<const RowShape> shapes = all_row_shapes,
                                                 const RowTurns& turns = {});

/// Returns the deviations of every edit of a sheet with odd triangles from the sheet without.
std::vector<DensityDeviation> odd_cell_deviations(const SolveRows& solve, OddCells odd,
                                                  const RowTurns& turns = {});

}  // namespace meshgraft::test
