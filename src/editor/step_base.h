#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/selection.h>
#include <meshgraft/mesh/mesh.h>

#include "document.h"
#include "edit/run_steps.h"

namespace meshgraft::editor {

/// The meshes as the step that is worked on finds them, and what selecting and showing needs to know.
struct StepBase {
  std::map<std::string, Scene> scenes;
  std::string mesh_name;
  int id = 0;  ///< of its mesh, for the page
  Weld weld;
  Mesh welded;
  std::optional<SelectionContext> selections;  ///< on the mesh, or on the welded one
  Triangles triangles;                         ///< of the mesh
  Eigen::RowVector3d offset;                   ///< the middle of its box
  double diagonal = 0;                         ///< of it

  const Scene& scene() const { return scenes.at(mesh_name); }
  const Mesh& mesh() const { return scene().mesh; }
};

/// Runs the steps of documents, and keeps what was run last: a document that begins as another one did goes on
/// from there.
class StepBases {
 public:
  /// Throws what `run_edit` throws.
  std::shared_ptr<const StepBase> before(const Document& document, const Context& context);

  using Scenes = std::shared_ptr<const std::map<std::string, Scene>>;
  /// What the first `count` steps leave. Throws what `run_edit` throws.
  Scenes after(const Document& document, std::size_t count, const Context& context);
  /// That the steps of `document` leave this.
  void remember(const Document& document, Scenes scenes);

 private:
  const LoadedInputs& inputs_of(const Document& document, const Context& context);

  Scenes known_after(const Json& key) const;

  struct Known {
    Json key;  ///< of the steps before, and the mesh
    std::shared_ptr<const StepBase> base;
  };
  struct Finished {
    Json key;  ///< of the steps
    Scenes scenes;
  };
  std::deque<Known> known_;        ///< the newest last
  std::deque<Finished> finished_;  ///< the newest last
  Json inputs_key_;
  std::optional<LoadedInputs> inputs_;
  int last_id_ = 0;
};

/// The named selections that `json` may use, and those that they use.
Json selections_used(const Json& document, const Json& json);

}  // namespace meshgraft::editor
