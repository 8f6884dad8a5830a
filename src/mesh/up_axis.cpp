#include "up_axis.h"

#include "join.h"

namespace meshgraft {

std::optional<UpAxis> told_up_axis(const Mesh& mesh) {
  const SourceDocument* source = mesh.source.get();
  if (const auto* joined = dynamic_cast<const JoinedSources*>(source)) source = joined->origin.get();
  const auto* upright = dynamic_cast<const UprightSource*>(source);
  return upright == nullptr ? std::nullopt : std::optional(upright->up_axis());
}

UpAxis up_axis_of(const Mesh& mesh) { return told_up_axis(mesh).value_or(UpAxis::z); }

void forget_file(Mesh& mesh) {
  const std::optional<UpAxis> axis = told_up_axis(mesh);
  mesh.source = axis ? std::make_shared<const FilelessSource>(*axis) : nullptr;
}

}  // namespace meshgraft
