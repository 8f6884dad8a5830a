#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft::test {

/// A call that can be cancelled. Returns what the call returns.
using CancellableCall = std::function<std::shared_ptr<void>(const Context&)>;

/// A kind of operation on meshes of any size.
struct CancelCase {
  std::string name;
  /// Makes the inputs, of about that many vertices, and returns the call.
  std::function<CancellableCall(Index vertices)> prepare;
  /// The largest mesh that the operation is for, in vertices.
  Index most_vertices = 1'000'000;
};

/// Returns one case for each operation that takes a Context and may take long. Files are written to and read
/// from the system's temporary folder.
std::vector<CancelCase> cancel_cases();

}  // namespace meshgraft::test
