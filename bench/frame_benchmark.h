#pragma once

#include "bench_run.h"

namespace meshgraft::bench {

/// Times the frames of a dragged handle and their set-up: linear frames by a handle basis, frames of the
/// default method by reduced frames, and frames on a proxy.
void register_frames(Edits& edits);

}  // namespace meshgraft::bench
