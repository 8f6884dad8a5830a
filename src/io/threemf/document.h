#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/file_document.h"
#include "model.h"
#include "package.h"
#include "xml.h"

namespace meshgraft::io {

/// A 3MF file as it was read.
struct ThreemfDocument : FileDocument {
  /// The location of an object's vertices in the package.
  struct Source {
    std::size_t part = 0;
    std::size_t mesh = 0;  ///< index in the part
  };

  std::string package;
  std::vector<PackagePart> parts;                   ///< the model parts
  std::vector<ThreemfPart> scanned;                 ///< per part
  std::vector<Source> sources;                      ///< per object; empty if they could not be found
  std::vector<ThreemfModel::Placement> placements;  ///< of objects, in the order of the mesh's vertices
  std::string length_unit;
  std::size_t unplaced = 0;  ///< objects that the build does not use

  const ThreemfVertices& vertices(std::size_t object) const {
    return scanned[sources[object].part].meshes[sources[object].mesh];
  }
  std::string_view format() const override { return "3MF"; }
  std::optional<UpAxis> stated_up_axis() const override { return UpAxis::z; }
  UpAxis usual_up_axis() const override { return UpAxis::z; }
  std::vector<Note> beside_the_mesh() const override;
  std::string unit() const override { return length_unit; }
};

/// Returns a position of an object in world coordinates. Reading and writing must use the same expression,
/// because unchanged vertices are recognised by their bits.
inline Eigen::RowVector3d placed(const Eigen::Affine3d& transform, const Eigen::RowVector3d& position) {
  return (transform.linear() * position.transpose() + transform.translation()).transpose();
}

}  // namespace meshgraft::io
