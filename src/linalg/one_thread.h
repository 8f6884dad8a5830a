#pragma once

#include <functional>

namespace meshgraft {

/// Runs `work`, which must not throw, with OpenMP held to one thread for as long. CHOLMOD's supernodal kernels
/// open a region of four threads around loops of microseconds: on two cores that makes factorising two to three
/// times as long, most of it spent on waking threads.
void with_one_openmp_thread(const std::function<void()>& work);

}  // namespace meshgraft
