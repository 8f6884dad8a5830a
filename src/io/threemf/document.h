#pragma once

#include <string>
#include <vector>

#include "io/file_document.h"
#include "model.h"
#include "package.h"
#include "xml.h"

namespace meshgraft::io {

/// A 3MF file as it was read.
struct ThreemfDocument : FileDocument {
  /// Where an object's vertices are written.
  struct Source {
    std::size_t part = 0;
    std::size_t mesh = 0;  ///< of the part's
  };

  std::string package;
  std::vector<PackagePart> parts;                   ///< the model parts
  std::vector<ThreemfPart> scanned;                 ///< per part
  std::vector<Source> sources;                      ///< per object; empty where they could not be found
  std::vector<ThreemfModel::Placement> placements;  ///< of objects, in the order of the mesh's vertices
  std::string length_unit;
  std::size_t unplaced = 0;  ///< objects that the build does not use

  const ThreemfVertices& vertices(std::size_t object) const {
    return scanned[sources[object].part].meshes[sources[object].mesh];
  }
  std::vector<std::string> beside_the_mesh() const override;
  std::string unit() const override { return length_unit; }
};

/// Positions of an object in the world. The same expression for reading and writing: unchanged vertices are
/// told by their bits.
inline Eigen::RowVector3d placed(const Eigen::Affine3d& transform, const Eigen::RowVector3d& position) {
  return (transform.linear() * position.transpose() + transform.translation()).transpose();
}

}  // namespace meshgraft::io
