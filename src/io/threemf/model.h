#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/core/context.h>

namespace meshgraft::io {

/// The meshes of a 3MF package as lib3mf reads them. Only one source file includes lib3mf.
struct ThreemfModel {
  static constexpr std::int32_t none = -1;

  /// A mesh object. The list of a property is empty if no triangle has it.
  struct Object {
    std::string name;
    std::vector<std::array<float, 3>> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<std::int32_t> materials;                ///< per triangle, index into `material_names` or `none`
    std::vector<std::array<std::uint8_t, 12>> colours;  ///< per triangle, RGBA of its corners
  };
  /// A mesh object placed by the build, with the transforms of all components and items combined.
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

/// Reads a model. `name` is the file's, for messages. The build must have been checked before, because lib3mf
/// walks through all copies in it. Throws Error(input) with the id threemf.model_refused if lib3mf refuses the
/// package.
ThreemfModel read_threemf_model(std::string_view package, const std::string& name, const Context& context);

/// Composes a package with the objects, each placed once. Coordinates have six decimals, because lib3mf
/// writes no more. The same model gives the same bytes.
std::string write_threemf_model(const ThreemfModel& model, const Context& context);

}  // namespace meshgraft::io
