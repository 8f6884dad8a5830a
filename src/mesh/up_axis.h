#pragma once

#include <optional>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The axis of a mesh's coordinates that points away from the ground.
enum class UpAxis { y, z };

/// A source that tells which way is up.
struct UprightSource : SourceDocument {
  virtual UpAxis up_axis() const = 0;
};

/// The source of a mesh that comes from no file, or whose file no longer fits it.
struct FilelessSource : UprightSource {
  explicit FilelessSource(UpAxis axis) : axis_(axis) {}
  UpAxis up_axis() const override { return axis_; }

 private:
  UpAxis axis_;
};

/// Returns the axis that points up, as the source of a mesh tells; for a graft, that of the target. Returns
/// nothing for a mesh that was made of arrays.
std::optional<UpAxis> told_up_axis(const Mesh& mesh);

/// Returns the axis that points up, and z for a mesh whose source does not tell.
UpAxis up_axis_of(const Mesh& mesh);

/// Removes the file behind a mesh, and keeps which way is up.
void forget_file(Mesh& mesh);

}  // namespace meshgraft
