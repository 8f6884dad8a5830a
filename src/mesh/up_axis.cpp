#include "up_axis.h"

#include "join.h"

namespace meshgraft {

const UprightSource* upright_source(const Mesh& mesh) {
  const SourceDocument* source = mesh.source.get();
  if (const auto* joined = dynamic_cast<const JoinedSources*>(source)) source = joined->origin.get();
  return dynamic_cast<const UprightSource*>(source);
}

std::optional<UpAxis> told_up_axis(const Mesh& mesh) {
  const UprightSource* upright = upright_source(mesh);
  return upright == nullptr ? std::nullopt : std::optional(upright->up_axis());
}

UpAxis up_axis_of(const Mesh& mesh) { return told_up_axis(mesh).value_or(UpAxis::z); }

void forget_file(Mesh& mesh) {
  const UprightSource* upright = upright_source(mesh);
  mesh.source = upright == nullptr ? nullptr
                                   : std::make_shared<const FilelessSource>(upright->stated_up_axis(),
                                                                            upright->usual_up_axis());
}

}  // namespace meshgraft
