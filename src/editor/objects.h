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
#include <meshgraft/deform/selection.h>
#include <meshgraft/mesh/mesh.h>

#include "document.h"
#include "numbers.h"
#include "script/run_steps.h"

namespace meshgraft::editor {

/// A mesh of a document as the step in work finds it, and what selecting and showing needs to know.
struct Object {
  std::string name;  ///< in the document
  std::shared_ptr<const Scene> shared_scene;
  int id = 0;  ///< of its mesh, for the page
  Weld weld;
  Mesh welded;
  std::optional<SelectionContext> selections;  ///< on the mesh, or on the welded one
  std::vector<std::vector<Index>> loops;       ///< of the mesh, as merge steps number them
  Triangles triangles;                         ///< of the mesh
  std::vector<Index> triangle_faces;           ///< the face that each is a part of
  Eigen::RowVector3d offset;                   ///< the middle of its box
  double diagonal = 0;                         ///< of it

  const Scene& scene() const { return *shared_scene; }
  const Mesh& mesh() const { return scene().mesh; }
};

/// What the step in work finds.
struct Stage {
  std::shared_ptr<const Object> model;  ///< what is deformed, or grafted onto
  std::vector<std::shared_ptr<const Object>> parts;
  /// Of each step before it that is a graft: its `size`, and where its pairs start to meet (`starts`); else
  /// null.
  std::vector<Json> found;

  /// The object of that name. Throws Error(input).
  const std::shared_ptr<const Object>& named(const std::string& name) const;
};

/// What a step made, as `run_step` left it, and what of it `Stage::found` tells.
struct StepOutcome {
  std::shared_ptr<const Scene> scene;
  Json found = nullptr;
};

/// Values by what they were made from; those that were not used for longest go.
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

/// Reads a document's inputs and runs its steps, each once as long as what it is made from stays the same.
class Objects {
 public:
  explicit Objects(const Numbers& numbers) : numbers_(numbers) {}

  /// Runs the steps before the one in work. Throws what `run_edit` throws.
  Stage before(const Document& document, const Context& context);

  /// A mesh as the first `count` steps leave it. Throws what `run_edit` throws.
  std::shared_ptr<const Scene> after(const Document& document, std::size_t count, const std::string& name,
                                     const Context& context);

  /// What the last step made: no need to run it again when it is accepted or saved.
  void learn(const Document& document, StepOutcome outcome);

 private:
  /// What each step was made from, and each input.
  struct Keys;

  std::shared_ptr<const Scene> input(const Document& document, const std::string& name, const Keys& keys,
                                     const Context& context);
  /// As the first `count` steps leave it.
  std::shared_ptr<const Scene> scene(const Document& document, const std::string& name, std::size_t count,
                                     const Keys& keys, const Context& context);
  std::shared_ptr<const Object> object(const std::string& name, const std::string& key,
                                       std::shared_ptr<const Scene> scene);

  const Numbers& numbers_;
  Recent<Scene> inputs_, scenes_;
  Recent<Object> objects_;
  Recent<Json> found_;
};

/// The named selections that `json` may use, and those that they use.
Json selections_used(const Json& document, const Json& json);

}  // namespace meshgraft::editor
