#pragma once

namespace meshgraft::bench {

/// Measures the machine, as a scale for the other figures: products of dense matrices (dgemm) on one core and
/// on all, and the speed of memory (triad a = b + s c, and reading alone).
void register_machine();

}  // namespace meshgraft::bench
