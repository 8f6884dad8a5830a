#pragma once

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

/// Runs the steps before the one that is worked on, and keeps what was run last.
class StepBases {
 public:
  /// Throws what `run_edit` throws.
  std::shared_ptr<const StepBase> before(const Document& document, const Context& context);

 private:
  const LoadedInputs& inputs_of(const Document& document, const Context& context);

  struct Known {
    Json key;
    std::shared_ptr<const StepBase> base;
  };
  std::deque<Known> known_;  ///< the newest last
  Json inputs_key_;
  std::optional<LoadedInputs> inputs_;
  int last_id_ = 0;
};

/// The named selections that `json` may use, and those that they use.
Json selections_used(const Json& document, const Json& json);

}  // namespace meshgraft::editor
