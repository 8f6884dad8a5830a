#pragma once

#include "bench_run.h"

namespace meshgraft::bench {

/// Times a second handle on the edit's sheet: a set-up from scratch beside `Deformer::with_region`.
void register_regions(Edits& edits);

}  // namespace meshgraft::bench
