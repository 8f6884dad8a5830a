#pragma once

#include <algorithm>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/select/selection.h>

#include "document.h"
#include "numbers.h"
#include "running_steps.h"
#include "script/run_steps.h"

namespace meshgraft::editor {

/// A mesh of a document in the state before the current step, with the data for selecting and showing it.
struct Object {
  std::string name;  ///< unique within the document
  std::shared_ptr<const MeshState> shared_state;
  int id = 0;  ///< identifies the mesh to the page
  Weld weld;
  Mesh welded;
  std::optional<SelectionMesh> selections;  ///< of the mesh, or of the welded one
  std::vector<std::vector<Index>> loops;    ///< of the mesh, numbered as in merge steps
  Triangles triangles;                      ///< of the mesh
  std::vector<Index> triangle_faces;        ///< per triangle: the face that contains it
  Eigen::RowVector3d offset;                ///< centre of the bounding box
  double diagonal = 0;                      ///< of the bounding box

  const MeshState& state() const { return *shared_state; }
  const Mesh& mesh() const { return state().mesh; }
};

/// The meshes before the current step.
struct StepInputs {
  std::shared_ptr<const Object> model;  ///< the mesh that is deformed, or grafted onto
  std::vector<std::shared_ptr<const Object>> parts;
  /// Per step before the one in work: for a graft, its `size` and the starts of its pairs (`starts`); for a
  /// repair, notes on its `changes`, and on the defects that remain; else null.
  std::vector<Json> found;

  /// Returns the object of that name. Throws Error(input).
  const std::shared_ptr<const Object>& named(const std::string& name) const;
};

/// The result of a step, as `run_step` left it, and its element of `StepInputs::found`.
struct StepOutcome {
  std::shared_ptr<const MeshState> state;
  Json found = nullptr;
};

/// A cache of values by the hash of their inputs; it drops the least recently used ones.
template <class Value>
class Recent {
 public:
  std::shared_ptr<const Value> find(const std::string& key) {
    const auto found =
        std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) { return entry.first == key; });
    if (found == entries_.end()) return nullptr;
    std::rotate(found, found + 1, entries_.end());
    return entries_.back().second;
  }
  void put(const std::string& key, std::shared_ptr<const Value> value) {
    entries_.emplace_back(key, std::move(value));
  }
  void keep(std::size_t count) {
    while (entries_.size() > count) entries_.pop_front();
  }

 private:
  std::deque<std::pair<std::string, std::shared_ptr<const Value>>> entries_;
};

/// Reads a document's inputs and runs its steps. Each runs once as long as its inputs stay the same.
class Objects {
 public:
  /// Marks each step in `running` while it runs.
  Objects(const Numbers& numbers, RunningSteps& running) : numbers_(numbers), running_(running) {}

  /// Runs the steps before the one in work. Throws what `run_edit` throws.
  StepInputs before(const Document& document, const Context& context);

  /// Returns a mesh in the state after the first `count` steps. Throws what `run_edit` throws.
  std::shared_ptr<const MeshState> after(const Document& document, std::size_t count, const std::string& name,
                                         const Context& context);

  /// Stores the result of the last step, so that accepting or saving it does not run it again.
  void learn(const Document& document, StepOutcome outcome);

  /// Returns a key of each step, which changes with everything that its result depends on.
  static std::vector<std::string> step_keys(const Document& document);

 private:
  /// The cache keys of each step and each input.
  struct Keys;

  std::shared_ptr<const MeshState> input(const Document& document, const std::string& name, const Keys& keys,
                                         const Context& context);
  /// Returns a mesh in the state after the first `count` steps.
  std::shared_ptr<const MeshState> state(const Document& document, const std::string& name, std::size_t count,
                                         const Keys& keys, const Context& context);
  std::shared_ptr<const Object> object(const std::string& name, const std::string& key,
                                       std::shared_ptr<const MeshState> state);

  const Numbers& numbers_;
  RunningSteps& running_;
  Recent<MeshState> inputs_, states_;
  Recent<Object> objects_;
  Recent<Json> found_;
};

/// Returns the named selections that `json` may use, including those that they use themselves.
Json selections_used(const Json& document, const Json& json);

}  // namespace meshgraft::editor
