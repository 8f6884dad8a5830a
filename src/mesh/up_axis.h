#pragma once

#include <optional>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The axis of a mesh's coordinates that points away from the ground.
enum class UpAxis { y, z };

/// A source that tells which way is up.
struct UprightSource : SourceDocument {
  /// Returns what the source says by itself; nothing if only the convention of its format tells.
  virtual std::optional<UpAxis> stated_up_axis() const = 0;
  virtual UpAxis usual_up_axis() const = 0;
  UpAxis up_axis() const { return stated_up_axis().value_or(usual_up_axis()); }
};

/// The source of a mesh that comes from no file, or whose file no longer fits it.
struct FilelessSource : UprightSource {
  explicit FilelessSource(UpAxis axis) : FilelessSource(axis, axis) {}
  FilelessSource(std::optional<UpAxis> stated, UpAxis usual) : stated_(stated), usual_(usual) {}
  std::optional<UpAxis> stated_up_axis() const override { return stated_; }
  UpAxis usual_up_axis() const override { return usual_; }

 private:
  std::optional<UpAxis> stated_;
  UpAxis usual_;
};

/// Returns the source of a mesh that tells which way is up; for a graft, that of the target. Returns null for a
/// mesh that was made of arrays.
const UprightSource* upright_source(const Mesh& mesh);

/// Returns the axis that points up, as the source of a mesh tells; nothing without such a source.
std::optional<UpAxis> told_up_axis(const Mesh& mesh);

/// Returns the axis that points up, and z for a mesh whose source does not tell.
UpAxis up_axis_of(const Mesh& mesh);

/// Removes the file behind a mesh, and keeps which way is up.
void forget_file(Mesh& mesh);

}  // namespace meshgraft
