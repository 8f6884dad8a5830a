#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>

namespace meshgraft {

/// How many threads a loop has at most.
int worker_threads(const Context& context);

/// Runs `body(begin, end)` over disjoint blocks that cover [0, count), on at most `context.threads` threads.
/// Each index must write only its own results and reduce nothing across indices: then the outcome does not
/// depend on the number of threads. Checks for cancellation between blocks; exceptions propagate.
void parallel_blocks(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body,
                     const Context& context = {}, std::size_t grain = 512);

/// Runs `body(begin, end)` once for each of as many even shares of [0, count) as there are threads: for work in
/// which each share has to look at everything. What comes of it must not depend on how many there are.
void share_out(int count, const std::function<void(int, int)>& body, const Context& context = {});

/// Runs `work`, which cannot be interrupted, and stops waiting for it when a stop is requested: throws
/// Error(cancelled), and the work is finished by a thread of its own. It must own whatever it uses.
void run_abandonable(std::function<void()> work, const Context& context = {});

/// A forest in postorder (every subtree is a range of nodes that ends with its root), shared out between
/// threads.
class TaskForest {
 public:
  /// `parent` of each node, -1 at roots; `work` of each, in any unit.
  TaskForest(std::span<const int> parent, std::span<const double> work);

  /// Visits all nodes, children before their parent, or parents before their children. Nodes neither of which
  /// lies below the other may be visited at the same time; `visit` may call `parallel_blocks`. What a visit
  /// writes, only visits above (below) it may read. Checks for cancellation before each; exceptions propagate.
  void visit_up(const std::function<void(int)>& visit, const Context& context = {}) const;
  void visit_down(const std::function<void(int)>& visit, const Context& context = {}) const;

 private:
  /// Nodes that one thread visits in a row: a small subtree, or a path of nodes with much work below them, and
  /// what hangs beside it as tasks of their own. Tasks are nested no deeper than the work branches.
  struct Task {
    std::vector<int> nodes;  ///< parents before children
    std::vector<int> below;
  };
  int size_ = 0;
  std::vector<Task> tasks_;
  std::vector<int> roots_;  ///< tasks
};

}  // namespace meshgraft
