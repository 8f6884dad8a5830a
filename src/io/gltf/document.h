#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/mesh/mesh.h>

#include "accessor.h"
#include "container.h"
#include "io/file_document.h"
#include "json.h"

namespace meshgraft::io {

/// A vertex attribute of glTF: its name in a mesh, and its kind, which decides how a node's transform acts on
/// it.
struct GltfChannel {
  enum class Kind { position, normal, tangent, uv, plain };
  Kind kind = Kind::plain;
  std::string semantic;   ///< "TEXCOORD_0"
  std::string attribute;  ///< "uv"; empty for positions
};

/// Returns nothing for attributes that only the file keeps: joints, weights, and names that glTF does not
/// define.
std::optional<GltfChannel> channel_of(const std::string& semantic);

/// The world transform of a node. It converts values between the file and the mesh.
class GltfPlacement {
 public:
  GltfPlacement() = default;
  explicit GltfPlacement(const Eigen::Affine3d& world);

  bool mirrors() const { return mirrors_; }
  bool flattens() const { return flattens_; }

  /// Convert a value from the file to the mesh and back. The way back needs a placement that does not
  /// flatten. UVs count from the bottom in a mesh, as in OBJ and PLY, and from the top in glTF.
  GltfValue to_mesh(GltfChannel::Kind kind, const GltfValue& value) const;
  GltfValue to_file(GltfChannel::Kind kind, const GltfValue& value) const;

 private:
  Eigen::Affine3d world_ = Eigen::Affine3d::Identity();
  Eigen::Affine3d inverse_ = Eigen::Affine3d::Identity();
  bool is_identity_ = true;
  bool mirrors_ = false;
  bool flattens_ = false;
};

/// Maps each element of a position accessor to its mesh vertex, or to -1 if no triangle uses it.
struct GltfElementMap {
  std::size_t accessor = 0;
  std::vector<Index> vertex;
};

/// A primitive of triangles as one node shows it.
struct GltfPart {
  std::size_t primitive = 0;  ///< index in the mesh of the file
  std::size_t map = 0;        ///< index in `GltfInstance::maps`
  Index first_corner = 0;
  Index corner_count = 0;
};

/// A mesh of the file as one node shows it.
struct GltfInstance {
  std::optional<std::size_t> node;  ///< empty in a file without nodes
  std::size_t mesh = 0;
  GltfPlacement placement;
  std::vector<GltfElementMap> maps;
  std::vector<GltfPart> parts;
};

/// Returns distinct names for numbered objects. An unnamed one is called e.g. "material_3", and a second
/// "skin" is called "skin_2".
std::vector<std::string> gltf_labels(const JsonView& root, const char* array, const std::string& kind);

/// Returns the nodes of the default scene that have a mesh, with their placements, in the order of the
/// hierarchy. A file without scenes shows all its nodes, and one without nodes shows all its meshes. Throws
/// Error(input) if the hierarchy is not a tree.
std::vector<GltfInstance> instances_of(const JsonView& root);

/// Returns whether a primitive consists of triangles (a list, a strip or a fan).
bool has_triangles(const Json& primitive);

constexpr std::uint32_t no_element = std::numeric_limits<std::uint32_t>::max();

/// A glTF file as it was read. It keeps the file's bytes. A writer copies them and replaces the values that
/// differ.
struct GltfDocument : FileDocument {
  std::string content;  ///< of the .gltf or .glb
  bool is_glb = false;
  GlbLayout layout;
  Json json;
  std::vector<GltfBuffer> buffers;
  std::vector<GltfInstance> instances;
  std::vector<std::uint32_t> corner_elements;  ///< per corner: its element in the accessors, or no_element

  std::string_view json_text() const;
  std::string_view binary_rest() const;
  GltfBytes bytes() const;
  std::string name() const { return path.string(); }

  std::string_view format() const override { return "glTF"; }
  std::optional<UpAxis> stated_up_axis() const override { return UpAxis::y; }
  UpAxis usual_up_axis() const override { return UpAxis::y; }
  std::vector<Note> beside_the_mesh() const override;
};

}  // namespace meshgraft::io
