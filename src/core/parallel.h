#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>

namespace meshgraft {

/// Returns the largest number of threads that a loop uses: `context.threads`, but at most one per core.
int worker_threads(const Context& context);

/// Runs `body(begin, end)` over disjoint blocks that cover [0, count), on at most `context.threads` threads.
/// Each index must write only its own results and reduce nothing across indices; the outcome then does not
/// depend on the number of threads. Checks for cancellation between blocks; exceptions propagate. Throws
/// Error(memory) if no threads can be started.
void parallel_blocks(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body,
                     const Context& context = {}, std::size_t grain = 512);

/// Divides [0, count) into as many equal ranges as there are threads, and runs `body(begin, end)` once for
/// each. It serves work in which every range must read all of the input. The outcome must not depend on the
/// number of ranges.
void share_out(int count, const std::function<void(int, int)>& body, const Context& context = {});

/// Runs `work`, which cannot be interrupted and must own everything that it uses. Throws Error(cancelled) when
/// a stop is requested; a thread of its own then finishes the work and frees it. While two works that were
/// left behind still run, a call waits for one of them before it starts another.
void run_abandonable(std::function<void()> work, const Context& context = {});

/// A forest of nodes in postorder whose work is divided among threads. In postorder every subtree is a range
/// of nodes that ends with its root.
class TaskForest {
 public:
  /// `parent` is the parent of each node, or -1 for roots. `work` is the work at each node, in any unit.
  TaskForest(std::span<const int> parent, std::span<const double> work);

  /// Visits all nodes: `visit_up` children before their parent, `visit_down` parents before their children.
  /// Two nodes may be visited at the same time if neither is an ancestor of the other. `visit` may call
  /// `parallel_blocks`. Data that a visit writes may be read only by visits of its ancestors (in `visit_up`)
  /// or descendants (in `visit_down`). Checks for cancellation before each visit; exceptions propagate.
  void visit_up(const std::function<void(int)>& visit, const Context& context = {}) const;
  void visit_down(const std::function<void(int)>& visit, const Context& context = {}) const;

 private:
  /// The nodes that one thread visits in a row: a small subtree, or a path of nodes with much work below
  /// them. The subtrees beside such a path are tasks of their own. Tasks are nested no deeper than the paths
  /// branch.
  struct Task {
    std::vector<int> nodes;  ///< parents before children
    std::vector<int> below;  ///< tasks, by index
  };
  int size_ = 0;
  std::vector<Task> tasks_;
  std::vector<int> roots_;  ///< tasks, by index
};

}  // namespace meshgraft
