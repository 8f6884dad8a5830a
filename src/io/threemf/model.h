#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/core/context.h>

namespace meshgraft::io {

/// What a 3MF package says about its meshes, by lib3mf, which one source file sees.
struct ThreemfModel {
  static constexpr std::int32_t none = -1;

  /// A mesh object. Properties that no triangle has are empty lists.
  struct Object {
    std::string name;
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::int32_t> materials;                ///< per triangle, index into `material_names` or `none`
    std::vector<std::array<std::uint8_t, 12>> colours;  ///< per triangle, RGBA of its corners
  };
  /// A mesh object in the build, through all components and items.
  struct Placement {
    std::size_t object = 0;
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
  };

  std::string unit = "millimeter";  ///< as 3MF spells it
  std::vector<std::string> material_names;
  std::vector<std::array<std::uint8_t, 4>> material_colours;
  std::vector<Object> objects;        ///< in the order in which they are read
  std::vector<Placement> placements;  ///< of the build; of all objects if the build is empty
};

/// `name` is the file's, for messages. The build must have been found sensible: lib3mf walks through all of its
/// copies. Throws Error(input) for what lib3mf refuses.
ThreemfModel read_threemf_model(std::string_view package, const std::string& name, const Context& context);

/// A package with the objects, each placed once. Coordinates have six decimals: lib3mf writes no more. The same
/// model gives the same bytes.
std::string write_threemf_model(const ThreemfModel& model, const Context& context);

}  // namespace meshgraft::io
