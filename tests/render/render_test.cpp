#include "render/render.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/samples/samples.h>

#include "mesh/shapes.h"

namespace meshgraft::render {
namespace {

RenderOptions small_picture() {
  RenderOptions options;
  options.width = 96;
  options.height = 72;
  return options;
}

std::vector<int> pixel(const Image& image, int x, int y) {
  const auto* p = image.pixels.data() + 3 * (y * image.width + x);
  return {p[0], p[1], p[2]};
}

TEST(Render, IsTheSameForAnyNumberOfThreads) {
  const Mesh mesh = make_sample("torus", 24);
  const Shape shape{&mesh, {}};
  Context one;
  one.threads = 1;
  EXPECT_EQ(render({&shape, 1}, small_picture(), one).pixels, render({&shape, 1}, small_picture()).pixels);
}

TEST(Render, FitsTheShapeIntoThePictureWhereverItIs) {
  Mesh mesh = make_sample("bar", 8);
  const Shape near{&mesh, {}};
  const Image here = render({&near, 1}, small_picture());
  const Shape far{&mesh, {}, {1e6, -1e6, 1e6}};
  const Image there = render({&far, 1}, small_picture());
  // The corner is light background and the middle is clay. A mesh far from the origin looks the same.
  EXPECT_GT(pixel(here, 1, 1)[0], 215);
  EXPECT_LT(pixel(here, 48, 36)[2], 200);
  EXPECT_GT(pixel(here, 48, 36)[0], pixel(here, 48, 36)[2]);
  EXPECT_NEAR(pixel(here, 48, 36)[0], pixel(there, 48, 36)[0], 12);
}

TEST(Render, LightAndShadowFollowTheDirectionThatIsUp) {
  // The model and the camera are turned as one, so the picture stays, but for the random rays.
  Mesh mesh = make_sample("octopus", 24);
  const Shape shape{&mesh, {}};
  RenderOptions options = small_picture();
  options.occlusion_rays = 64;
  const Image before = render({&shape, 1}, options);
  const Points rest = mesh.positions;
  for (const Eigen::Matrix3d& turn :
       {Eigen::AngleAxisd(-1.5707963267948966, Eigen::Vector3d::UnitX()).toRotationMatrix(),
        Eigen::AngleAxisd(2, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix()}) {
    mesh.positions = rest * turn.transpose();
    RenderOptions turned = options;
    turned.camera.from_direction = turn * options.camera.from_direction;
    turned.camera.up = turn * options.camera.up;
    const Image after = render({&shape, 1}, turned);
    double sum = 0;
    for (std::size_t k = 0; k < before.pixels.size(); ++k)
      sum += std::abs(int{before.pixels[k]} - int{after.pixels[k]});
    EXPECT_LT(sum / static_cast<double>(before.pixels.size()), 1.0);
  }
}

TEST(Render, IsNearlyTheSameWithSparseRays) {
  for (const char* const sample : {"octopus", "bumpy_plane", "torus"}) {
    SCOPED_TRACE(sample);
    const Mesh mesh = make_sample(sample, 40);
    const Shape shape{&mesh, {}};
    RenderOptions options = small_picture();
    options.width *= 4;
    options.height *= 4;
    const Image full = render({&shape, 1}, options);
    options.sparse = true;
    const Image sparse = render({&shape, 1}, options);
    double sum = 0;
    for (std::size_t k = 0; k < full.pixels.size(); ++k)
      sum += std::abs(int{full.pixels[k]} - int{sparse.pixels[k]});
    EXPECT_LT(sum / static_cast<double>(full.pixels.size()), 1.0);
    Context one;
    one.threads = 1;
    EXPECT_EQ(render({&shape, 1}, options, one).pixels, sparse.pixels);
  }
}

TEST(Render, IsNearlyTheSameForSmallAndTinyTriangles) {
  // Light on the finer one comes from a coarser surface.
  const Mesh small = make_sample("torus", 120), tiny = make_sample("torus", 600);
  ASSERT_GT(tiny.face_count(), 500'000);
  RenderOptions options = small_picture();
  options.width *= 4;
  options.height *= 4;
  const Shape of_small{&small, {}}, of_tiny{&tiny, {}};
  const Image expected = render({&of_small, 1}, options), image = render({&of_tiny, 1}, options);
  double sum = 0;
  for (std::size_t k = 0; k < image.pixels.size(); ++k)
    sum += std::abs(int{expected.pixels[k]} - int{image.pixels[k]});
  EXPECT_LT(sum / static_cast<double>(image.pixels.size()), 0.5);
}

TEST(Render, ThinPartsOfLargeMeshesCastShadowsInSmallPictures) {
  const auto thin_hoop = [](int columns, int rows) {
    return shapes::sheet({.columns = columns, .rows = rows, .close_columns = true}, [](double u, double v) {
      const double around = 2 * std::numbers::pi * u, across = 2 * std::numbers::pi * v;
      const double radius = 1 + 0.04 * std::cos(across);
      return Eigen::Vector3d(radius * std::cos(around), radius * std::sin(around), 0.04 * std::sin(across));
    });
  };
  const Mesh small = thin_hoop(300, 30), tiny = thin_hoop(3000, 100);
  ASSERT_GT(2 * tiny.face_count(), 500'000) << "of two triangles each";
  const Shape of_small{&small, {}}, of_tiny{&tiny, {}};
  const Image expected = render({&of_small, 1}, small_picture()),
              image = render({&of_tiny, 1}, small_picture());
  double brighter = 0;
  for (std::size_t k = 0; k < image.pixels.size(); ++k)
    brighter += int{image.pixels[k]} - int{expected.pixels[k]};
  EXPECT_NEAR(brighter / static_cast<double>(image.pixels.size()), 0.0, 0.1);
}

TEST(Render, IsFacetedWithoutSmoothNormals) {
  const Mesh mesh = make_sample("torus", 12);
  const Shape shape{&mesh, {}};
  RenderOptions options = small_picture();
  const auto colours = [&] {
    const Image image = render({&shape, 1}, options);
    std::set<int> reds;
    for (int x = 0; x < image.width; ++x) reds.insert(pixel(image, x, 45)[0]);
    return reds.size();
  };
  options.occlusion_rays = 64;
  options.crease_angle_deg = 180;
  const std::size_t smooth = colours();
  options.crease_angle_deg = 0;
  const std::size_t creased = colours();
  options.smooth = false;
  EXPECT_LT(colours(), 0.8 * static_cast<double>(smooth));
  EXPECT_EQ(colours(), creased);
}

TEST(Render, ShowsColours) {
  const Mesh mesh = make_sample("bar", 8);
  Shape shape{&mesh, Points::Zero(mesh.vertex_count(), 3)};
  shape.colours.col(1).setOnes();
  const auto middle = pixel(render({&shape, 1}, small_picture()), 48, 36);
  EXPECT_GT(middle[1], 2 * middle[0]);
  shape.colours.resize(3, 3);
  EXPECT_THROW(render({&shape, 1}, small_picture()), Error);
}

TEST(Render, ReadsTheColourAttributeAsLinear) {
  Mesh mesh = make_sample("bar", 4);
  EXPECT_EQ(vertex_colours(mesh).rows(), 0);
  Attribute colour;
  colour.name = "colour";
  colour.type = ScalarType::uint8;
  colour.components = 3;
  colour.values.assign(3 * static_cast<std::size_t>(mesh.vertex_count()), 255.0);
  colour.values[0] = 188.0;
  mesh.attributes.push_back(colour);
  const Points linear = vertex_colours(mesh);
  ASSERT_EQ(linear.rows(), mesh.vertex_count());
  EXPECT_NEAR(linear(0, 0), 0.5, 0.01);
  EXPECT_DOUBLE_EQ(linear(1, 1), 1.0);
}

TEST(Render, IsTransparentAroundTheShapes) {
  const Mesh mesh = make_sample("torus", 24);
  const Shape shape{&mesh, {}};
  RenderOptions options = small_picture();
  options.ground = false;
  const Image opaque = render({&shape, 1}, options);
  EXPECT_TRUE(opaque.cover.empty());
  options.transparent = true;
  const Image image = render({&shape, 1}, options);
  ASSERT_EQ(image.cover.size(), 96u * 72u);
  std::size_t inside = 0, outside = 0;
  for (std::size_t i = 0; i < image.cover.size(); ++i) {
    inside += image.cover[i] == 255 ? 1 : 0;
    outside += image.cover[i] == 0 ? 1 : 0;
    if (image.cover[i] == 255) {
      EXPECT_NEAR(image.pixels[3 * i], opaque.pixels[3 * i], 2) << "pixel " << i;
    }
    if (image.cover[i] > 75) {
      EXPECT_GT(image.pixels[3 * i], 40) << "pixel " << i << ": no dark rim";
    }
  }
  EXPECT_GT(inside, 1000u);
  EXPECT_GT(outside, 1000u);
  EXPECT_EQ(png_bytes(image)[25], 6) << "RGB and alpha";
  EXPECT_EQ(png_bytes(opaque)[25], 2) << "RGB";

  const std::vector<Image> pair{image, opaque};
  const Image both = side_by_side(pair, std::vector<std::string>{"a", "b"});
  const auto cover = [&](int x, int y) { return both.cover[static_cast<std::size_t>(y * both.width + x)]; };
  EXPECT_EQ(cover(0, 0), 0);
  EXPECT_EQ(cover(97, 0), 0) << "the gap";
  EXPECT_EQ(cover(both.width - 1, 0), 255);
  EXPECT_EQ(cover(0, both.height - 1), 255) << "the captions";
}

TEST(Render, LeavesOutFacesWithoutAPosition) {
  // A vertex that is not finite costs the faces around it, and not the picture.
  const Mesh whole = make_sample("torus", 24);
  for (const double value : {std::nan(""), HUGE_VAL}) {
    Mesh mesh = whole;
    mesh.positions(7, 1) = value;
    const Shape shape{&mesh, {}}, beside{&whole, {}};
    const RenderOptions options = small_picture();
    const Image image = render({&shape, 1}, options), expected = render({&beside, 1}, options);
    int different = 0;
    for (int y = 0; y < options.height; ++y)
      for (int x = 0; x < options.width; ++x)
        if (std::abs(pixel(image, x, y)[0] - pixel(expected, x, y)[0]) > 40) ++different;
    EXPECT_LT(different, options.width * options.height / 50);
  }
  Mesh none = whole;
  none.positions.setConstant(std::nan(""));
  const Shape shape{&none, {}};
  EXPECT_THROW(render({&shape, 1}, small_picture()), Error);
}

TEST(Render, RefusesAnEmptyScene) {
  EXPECT_THROW(render({}, small_picture()), Error);
  const Mesh mesh;
  const Shape shape{&mesh, {}};
  EXPECT_THROW(render({&shape, 1}, small_picture()), Error);
}

TEST(SideBySide, KeepsThePicturesAndDrawsCaptions) {
  Image red{40, 30, std::vector<std::uint8_t>(3 * 40 * 30, 0)};
  for (std::size_t i = 0; i < red.pixels.size(); i += 3) red.pixels[i] = 255;
  const std::vector<Image> two{red, red};
  const Image plain = side_by_side(two);
  EXPECT_EQ(plain.height, 30);
  EXPECT_GE(plain.width, 80);
  EXPECT_EQ(pixel(plain, 0, 0), pixel(red, 0, 0));
  EXPECT_EQ(pixel(plain, plain.width - 1, 29), pixel(red, 39, 29));
  const std::vector<std::string> blank{"", ""}, words{"before", "after"}, one{"before"};
  const Image without = side_by_side(two, blank), with = side_by_side(two, words);
  EXPECT_GT(with.height, 30);
  EXPECT_EQ(with.height, without.height);
  EXPECT_NE(with.pixels, without.pixels);
  EXPECT_THROW(side_by_side(two, one), Error);
}

TEST(Stacked, PlacesPicturesBelowEachOtherAtTheLeft) {
  const Image wide{40, 30, std::vector<std::uint8_t>(3 * 40 * 30, 10)};
  const Image narrow{20, 5, std::vector<std::uint8_t>(3 * 20 * 5, 90)};
  const std::vector<Image> two{wide, narrow};
  const Image both = stacked(two);
  ASSERT_EQ(both.width, 40);
  ASSERT_EQ(both.height, 35);
  EXPECT_EQ(pixel(both, 39, 29), pixel(wide, 0, 0));
  EXPECT_EQ(pixel(both, 0, 30), pixel(narrow, 0, 0));
  EXPECT_EQ(pixel(both, 19, 34), pixel(narrow, 0, 0));
  EXPECT_NE(pixel(both, 20, 34), pixel(narrow, 0, 0));
  EXPECT_THROW(stacked({}), Error);
}

TEST(WritePng, WritesAWholeFileOrNone) {
  const std::filesystem::path folder = testing::TempDir();
  const Image image{2, 2, std::vector<std::uint8_t>(12, 128)};
  write_png(image, folder / "picture.png");
  std::ifstream file(folder / "picture.png", std::ios::binary);
  std::string head(8, ' ');
  file.read(head.data(), 8);
  EXPECT_EQ(head, std::string("\x89PNG\r\n\x1a\n", 8));
  EXPECT_FALSE(std::filesystem::exists(folder / "picture.png.partial"));
  try {
    write_png(image, folder / "no such folder" / "picture.png");
    FAIL() << "no exception";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_EQ(error.id(), "render.file_not_made");
  }
}

}  // namespace
}  // namespace meshgraft::render
