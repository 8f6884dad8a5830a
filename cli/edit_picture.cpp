#include "edit_picture.h"

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include <meshgraft/script/run_edit.h>

#include "render/viewpoint.h"

namespace meshgraft::cli {

render::Image picture_of_parts(const EditFile& edit, const Mesh& result, const View& view,
                               const Context& context) {
  std::vector<EditInput> inputs = edit.inputs;
  const auto merge = std::find_if(edit.steps.begin(), edit.steps.end(), [](const EditStep& step) {
    return std::holds_alternative<MergeStep>(step.action);
  });
  if (merge != edit.steps.end())
    std::stable_partition(inputs.begin(), inputs.end(),
                          [&](const EditInput& input) { return input.name == mesh_of(*merge); });
  std::vector<render::Image> images;
  std::vector<std::string> captions;
  render::RenderOptions options = quick_options_of(view, result);
  const auto add = [&](const Mesh& mesh, const std::string& caption) {
    const Mesh* one = &mesh;
    images.push_back(make_pictures({&one, 1}, options, context).front());
    captions.push_back(caption);
  };
  for (const EditInput& input : inputs) {
    const Mesh mesh = load_input(input, edit, context);
    const bool is_target = merge != edit.steps.end() && input.name == mesh_of(*merge);
    if (is_target && view.from.empty())
      options.camera.from_direction = render::direction_to_change(mesh, result, options.camera.up, context);
    add(mesh, input.name);
  }
  add(result, "result");
  return contact_sheet(images, captions, 4);
}

}  // namespace meshgraft::cli
