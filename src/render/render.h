#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft::render {

/// One surface in a picture.
struct Shape {
  const Mesh* mesh = nullptr;
  /// Colour per vertex (n×3, linear 0…1), or empty for clay; see `vertex_colours`.
  Points colours;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

struct Camera {
  Eigen::Vector3d from_direction{0.5, -1.0, 0.35};  ///< towards the camera; fitted to the shapes
  Eigen::Vector3d up{0, 0, 1};                      ///< away from the ground
  double field_of_view_deg = 26.0;                  ///< vertical
  /// The box that the picture shows; if low > high, the bounding box of the shapes. Pictures for comparison
  /// share one.
  Eigen::Vector3d low{1, 1, 1}, high{0, 0, 0};
};

struct RenderOptions {
  int width = 1200, height = 900;
  Camera camera;
  int samples = 4;  ///< per pixel; rounded down to a square
  /// Ambient-occlusion rays from the surface in every second pixel in both directions, and from samples with
  /// none of these near them. At least one.
  int occlusion_rays = 16;
  /// Takes one sample in pixels that show the same smooth surface as the pixels around them, and traces only
  /// four occlusion rays and one ray to the light in every second pixel. `samples` and `occlusion_rays` then
  /// hold for what differs from its surroundings.
  bool sparse = false;
  bool smooth = true;  ///< interpolate vertex normals across edges flatter than `crease_angle_deg`
  double crease_angle_deg = 40.0;
  bool wireframe = false;
  bool ground = true;  ///< a soft contact shadow below, away from the camera's `up`
  /// Leaves out the background, and the ground with it: the picture is transparent around the shapes.
  bool transparent = false;
};

/// A picture, 8-bit sRGB, height×width×3.
struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;
  /// How much of each pixel is covered, of 255, height×width; empty if all are.
  std::vector<std::uint8_t> cover;
};

/// Returns the mesh's vertex attribute "colour" as linear n×3, or an empty array without one.
Points vertex_colours(const Mesh& mesh);

/// Renders the shapes as clay under a key and a fill light, with ambient occlusion. A visibility buffer tells
/// what each sample shows; the light there comes from rays. The same input gives the same bytes for any number
/// of threads. Throws Error(usage) for an empty picture or a camera without direction, Error(input) for shapes
/// without a face or with colours of another size, and Error(cancelled).
Image render(std::span<const Shape> shapes, const RenderOptions& options = {}, const Context& context = {});

/// Places images side by side with equal heights and optional captions below (printable ASCII). Gaps are
/// transparent if an image is.
/// Throws Error(usage) if the heights differ or there are captions, but not one per image.
Image side_by_side(std::span<const Image> images, std::span<const std::string> captions = {});

/// Places images below each other, each at the left edge. Throws Error(usage) without images.
Image stacked(std::span<const Image> images);

/// Returns the image as the bytes of a PNG file.
std::vector<std::uint8_t> png_bytes(const Image& image);

/// Writes a PNG file atomically: it appears whole or not at all. Throws Error(io).
void write_png(const Image& image, const std::filesystem::path& path);

}  // namespace meshgraft::render
