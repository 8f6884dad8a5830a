#pragma once

#include <span>

#include <Eigen/Core>

#include <meshgraft/core/context.h>

#include "deform/solve/limb_twist.h"
#include "linalg/sparse.h"

namespace meshgraft {

/// Returns functions at vertices of which the strain of twists is nearly a sum (vertices × functions, `count`
/// for each handle): the principal components of the strains that a handle causes by turns of 15° to 720° about
/// the axes of limbs and discs. `influence` (vertices × handles) are the weights by which the handles'
/// logarithms are blended, and `slopes` their rates along `LimbPoint::direction`. `points` are vertices that
/// stand for equal parts of the limbs and discs. The mean square of a handle's first function over them is 1,
/// and that of each later one is its share in the strains.
Columns twist_modes(const LimbTwist& limbs, const Columns& influence, const Columns& slopes,
                    std::span<const Index> points, std::span<const Index> handles, Eigen::Index count,
                    const Context& context);

}  // namespace meshgraft
