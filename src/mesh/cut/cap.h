#pragma once

#include <array>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/cut.h>

#include "cap_region.h"
#include "pin_fit.h"

namespace meshgraft {

inline constexpr Index pin_sides = 32;
/// Height and depth of the chamfer at the end of a pin, relative to its diameter.
inline constexpr double pin_chamfer_rel = 0.1;

/// Throws Error(input) for sizes that are not positive, and a count out of range.
void check_pins(const CutOptions& options);

/// Fits pins to the caps of a cut with both halves, one fit for each cap in the order of `nest_outlines`.
/// Throws Error(input) if no cap takes a pin.
std::vector<PinFit> fit_pins(const CutResult& both, const PlaneFrame& frame, const CutOptions& options,
                             const Context& context = {});

/// Closes the halves of a cut by the plane of `frame` with caps. `fits` has the pins of each cap, or is empty.
/// Throws Error(input) where an outline has no inside.
void close_cut(CutResult& cut, const PlaneFrame& frame, const std::vector<PinFit>& fits,
               const CutOptions& options, const Context& context = {});

}  // namespace meshgraft
