#pragma once

#include <span>
#include <string_view>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

struct SampleInfo {
  std::string_view name;         ///< "octopus", "head", …
  std::string_view description;  ///< one line, for lists
  int default_resolution = 0;    ///< about the square root of the number of vertices
};

/// Returns the built-in models.
std::span<const SampleInfo> sample_list();

/// Makes a built-in model of about resolution² vertices (0: its default). The sculpted models are never
/// coarser than at resolution 24. The same name and resolution always give the same mesh on a machine, byte
/// for byte.
///
/// The z axis points up, and figures look towards −y (the dinosaur towards −x). Locations do not depend on
/// the resolution (docs/samples.md has more):
/// - octopus: closed; mantle z > 1.3. Arm k = 0 … 7 leaves at the azimuth 22.5° + 45°·k from +x towards +y.
///   It lies on the ground about 1.2 off the axis, and curls up about 1.8 off the axis;
/// - head: one loop in the plane z = −0.40 around the neck's axis (0, 0.12); cranium z > 0.65;
/// - bust: one loop in the plane z = −0.28 around the same axis; shoulders |x| > 0.55; flat base z = −1.34;
/// - dinosaur: closed; head x < −1.7 and z > 3, tail x > 1.2, soles at z = 0;
/// - cactus: closed; trunk within 0.40 of the z axis, arms x > 0.45, x < −0.45 and y < −0.45;
/// - bracket: genus 5, a flange about the z axis with a bore and four bolt holes; four loops in the plane
///   z = −1, of radius 0.18, 1.1 from the axis at the azimuths 0°, 90°, 180°, 270°;
/// - posts: four components, each with a loop in the plane z = 1.2: at (1.35, 0.15) of radius 0.15,
///   (−0.1, 1.25) 0.26, (−1.2, −0.1) 0.20, (0.1, −1.45) 0.12; feet at z = 0;
/// - bumpy_plane: [−0.5, 0.5]², one loop; bar: [−0.5, 0.5]² × [0, 4], closed; cylinder: radius 0.5, 0 ≤ z ≤ 4,
///   two loops; torus: radii 1 and 0.4 about the z axis; knot: a trefoil tube of radius 0.42.
///
/// The sculpted models carry the vertex attribute "colour" (red, green, blue; uint8, sRGB).
/// Throws Error(input) with the id samples.no_such_sample, listing the names, for an unknown name, and with
/// core.out_of_range for a resolution out of [4, 4096].
Mesh make_sample(std::string_view name, int resolution = 0, const Context& context = {});

}  // namespace meshgraft
