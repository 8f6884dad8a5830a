#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/mesh.h>

/// PLY files for tests, in text and in binary.
namespace meshgraft::test {

/// Bytes of a binary body.
class Bytes {
 public:
  explicit Bytes(bool big_endian) : swap_(big_endian == (std::endian::native == std::endian::little)) {}

  template <class T>
  Bytes& put(T value) {
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (swap_) std::reverse(bytes.begin(), bytes.end());
    text_.append(bytes.data(), bytes.size());
    return *this;
  }
  template <class T>
  Bytes& put(std::initializer_list<T> values) {
    for (const T value : values) put(value);
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  bool swap_;
  std::string text_;
};

/// A file with everything: comments, foreign properties and elements, lists of several kinds.
inline std::string rich_header(const char* format) {
  return std::string("ply\nformat ") + format +
         " 1.0\n"
         "comment made by hand\n"
         "obj_info num_cols 512\n"
         "comment TextureFile skin.png\n"
         "element camera 1\n"
         "property float view_px\n"
         "property list uchar short lens\n"
         "element vertex 4\n"
         "property uchar red\n"
         "property uchar green\n"
         "property uchar blue\n"
         "property float x\n"
         "property double quality\n"
         "property float y\n"
         "property float z\n"
         "property float nx\n"
         "property float ny\n"
         "property float nz\n"
         "property short flags\n"
         "element tristrips 1\n"
         "property list int int vertex_indices\n"
         "element face 2\n"
         "property int group\n"
         "property list uchar int vertex_indices\n"
         "property list uchar float texcoord\n"
         "property list uchar uchar marks\n"
         "element edge 1\n"
         "property int vertex1\n"
         "property int vertex2\n"
         "end_header\n";
}

inline std::string rich_binary(bool big_endian) {
  Bytes bytes(big_endian);
  bytes.put(1.5f).put<std::uint8_t>(2).put<std::int16_t>({-7, 300});
  for (int v = 0; v < 4; ++v) {
    bytes.put<std::uint8_t>({static_cast<std::uint8_t>(10 * v), 20, 255});
    bytes.put(static_cast<float>(v % 2) + 0.1f).put(0.1 * v).put(static_cast<float>(v / 2)).put(0.f);
    bytes.put({0.f, 0.f, 1.f}).put<std::int16_t>(static_cast<std::int16_t>(-v));
  }
  bytes.put<std::int32_t>({5, 0, 1, 2, 3, -1});
  bytes.put<std::int32_t>(7).put<std::uint8_t>(3).put<std::int32_t>({0, 1, 3});
  bytes.put<std::uint8_t>(6).put({0.f, 0.f, 1.f, 0.f, 1.f, 1.f}).put<std::uint8_t>({2, 8, 9});
  bytes.put<std::int32_t>(9).put<std::uint8_t>(3).put<std::int32_t>({0, 3, 2});
  bytes.put<std::uint8_t>(6).put({.5f, 0.f, 1.f, 1.f, 0.f, 1.f}).put<std::uint8_t>(0);
  bytes.put<std::int32_t>({0, 3});
  return rich_header(big_endian ? "binary_big_endian" : "binary_little_endian") + bytes.text();
}

inline std::string rich_ascii() {
  return rich_header("ascii") +
         "1.50 2 -7 300\n"
         "0 20 255  0.1 0.0 0 0  0 0 1 0\n"
         "10 20 255  1.1 0.1 0 0  0 0 1 -1 \n"
         "20 20 255  0.10 0.2 1 0  0 0 1 -2\n"
         "30 20 255\t1.1 0.30000000000000004 1 0  0 0 1 -3\n"
         "5 0 1 2 3 -1\n"
         "7 3 0 1 3 6 0 0 1 0 1 1 2 8 9\n"
         "9 3 0 3 2 6 .5 0 1 1 0 1 0\n"
         "0 3\n";
}

inline void expect_rich_ply(const Mesh& mesh) {
  ASSERT_EQ(mesh.vertex_count(), 4);
  ASSERT_EQ(mesh.face_count(), 2);
  EXPECT_EQ(mesh.positions(3, 0), double{1.1f});
  EXPECT_EQ(mesh.positions(3, 1), 1.0);
  EXPECT_EQ(mesh.faces.corners(), (std::vector<Index>{0, 1, 3, 0, 3, 2}));

  const Attribute* colour = mesh.find_attribute(Domain::vertex, "colour");
  ASSERT_NE(colour, nullptr);
  EXPECT_EQ(colour->components, 3);
  EXPECT_EQ(colour->type, ScalarType::uint8);
  EXPECT_EQ(colour->values[3 * 2], 20);
  EXPECT_EQ(colour->source_names, (std::vector<std::string>{"red", "green", "blue"}));
  const Attribute* normal = mesh.find_attribute(Domain::vertex, "normal");
  ASSERT_NE(normal, nullptr);
  EXPECT_EQ(normal->interpolation, Interpolation::direction);
  EXPECT_EQ(normal->values[2], 1);
  const Attribute* quality = mesh.find_attribute(Domain::vertex, "quality");
  ASSERT_NE(quality, nullptr);
  EXPECT_EQ(quality->interpolation, Interpolation::linear);
  EXPECT_EQ(quality->values[3], 0.1 * 3);
  const Attribute* flags = mesh.find_attribute(Domain::vertex, "flags");
  ASSERT_NE(flags, nullptr);
  EXPECT_EQ(flags->interpolation, Interpolation::nearest);
  EXPECT_EQ(flags->values[3], -3);
  const Attribute* group = mesh.find_attribute(Domain::face, "group");
  ASSERT_NE(group, nullptr);
  EXPECT_EQ(group->values, (std::vector<double>{7, 9}));
  const Attribute* uv = mesh.find_attribute(Domain::corner, "uv");
  ASSERT_NE(uv, nullptr);
  EXPECT_EQ(uv->components, 2);
  EXPECT_EQ(uv->values[6], 0.5);  // vertex 0 has another uv in face 1: a seam
  EXPECT_EQ(mesh.find_attribute(Domain::corner, "marks"), nullptr);
}

inline std::string ascii_vertices(const std::string& rows, int count = 1) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + rows;
}

/// Faces of three, four and two corners between scalars.
template <class Count, class Corner>
std::string binary_polygons(const char* count_type, const char* corner_type, bool big_endian) {
  Bytes bytes(big_endian);
  for (int k = 0; k < 12; ++k) bytes.put(static_cast<double>(k));
  for (const std::vector<int>& face : {std::vector{0, 1, 2}, std::vector{0, 1, 2, 3}, std::vector{1, 3}}) {
    bytes.put<std::int16_t>(static_cast<std::int16_t>(100 * face[1])).put(static_cast<Count>(face.size()));
    for (const int corner : face) bytes.put(static_cast<Corner>(corner));
    bytes.put(static_cast<float>(face.size()) / 4);
  }
  return std::string("ply\nformat ") + (big_endian ? "binary_big_endian" : "binary_little_endian") +
         " 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
         "element face 3\nproperty short before\nproperty list " +
         count_type + " " + corner_type + " vertex_indices\nproperty float behind\nend_header\n" + bytes.text();
}

inline std::vector<std::string> binary_polygon_files() {
  std::vector<std::string> files;
  for (const bool big_endian : {false, true}) {
    files.push_back(binary_polygons<std::uint8_t, std::int32_t>("uchar", "int", big_endian));
    files.push_back(binary_polygons<std::int8_t, std::uint32_t>("char", "uint", big_endian));
    files.push_back(binary_polygons<std::uint32_t, std::int16_t>("uint", "short", big_endian));
    files.push_back(binary_polygons<std::uint16_t, std::uint8_t>("ushort", "uchar", big_endian));
  }
  return files;
}

}  // namespace meshgraft::test
