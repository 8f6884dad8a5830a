#pragma once

namespace meshgraft::bench {

/// What the machine can do: products of dense matrices (dgemm) on one core and on all, and the memory's streams
/// (triad a = b + s c, and reading alone). Other figures are read beside these.
void register_machine();

}  // namespace meshgraft::bench
