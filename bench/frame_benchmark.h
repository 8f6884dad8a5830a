#pragma once

#include "bench_run.h"

namespace meshgraft::bench {

/// What a frame costs while a handle is dragged: linear frames by a handle basis, those of the default method
/// by reduced frames, and on a proxy; and what has to be set up for it.
void register_frames(Edits& edits);

}  // namespace meshgraft::bench
