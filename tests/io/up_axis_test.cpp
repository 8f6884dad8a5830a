// Which way is up: what a file says, what its format says, and what is kept when a mesh is written.
#include "mesh/up_axis.h"

#include <string>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/cut.h>

#include "io/file.h"
#include "io/up_axis_comment.h"
#include "temporary_folder.h"

namespace meshgraft {
namespace {

using test::TemporaryFolder;

Mesh tetrahedron() {
  return make_mesh((Points(4, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1).finished(),
                   (Triangles(4, 3) << 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2).finished());
}

Mesh tetrahedron(UpAxis axis) {
  Mesh mesh = tetrahedron();
  mesh.source = std::make_shared<const FilelessSource>(axis);
  return mesh;
}

Mesh upper_part(const Mesh& mesh) { return cut_by_plane(mesh, {{0, 0, 0.4}, {0, 0, 1}}).mesh; }

TEST(UpAxis, CommentsAreReadInAnyCase) {
  for (const char* comment :
       {"Vertical axis: z", "Vertical Axis: Z", "  vertical axis:z", "Vertical axis: z (up)"})
    EXPECT_EQ(io::up_axis_in(comment), UpAxis::z) << comment;
  EXPECT_EQ(io::up_axis_in("VERTICAL AXIS: y"), UpAxis::y);
  for (const char* comment : {"", "Vertical axis:", "Vertical axis: x", "Vertical axis: zx",
                              "Vertical axis: 0 0 1", "The vertical axis: z", "Vertical axi"})
    EXPECT_EQ(io::up_axis_in(comment), std::nullopt) << comment;
}

TEST(UpAxis, IsThatOfTheFormatWhereNothingIsSaid) {
  const TemporaryFolder folder;
  EXPECT_EQ(told_up_axis(tetrahedron()), std::nullopt);
  EXPECT_EQ(up_axis_of(tetrahedron()), UpAxis::z);
  for (const char* name : {"a.ply", "a.obj", "a.off", "a.glb", "a.gltf", "a.stl"}) {
    write_mesh(tetrahedron(), folder / name);
    const bool is_stl = std::string_view(name) == "a.stl";
    EXPECT_EQ(told_up_axis(read_mesh(folder / name)), is_stl ? UpAxis::z : UpAxis::y) << name;
    EXPECT_EQ(read_file(folder / name).find("ertical axis"), std::string::npos) << name;
  }
}

// A model keeps the axis that is up in a file with comments, and through an edit of that file.
TEST(UpAxis, IsKeptInFilesWithComments) {
  const TemporaryFolder folder;
  for (const UpAxis axis : {UpAxis::y, UpAxis::z})
    for (const char* name : {"a.ply", "a.obj", "a.off"}) {
      write_mesh(tetrahedron(axis), folder / name);
      EXPECT_EQ(read_file(folder / name).find("Vertical axis: z") != std::string::npos, axis == UpAxis::z)
          << name;
      Mesh again = read_mesh(folder / name);
      EXPECT_EQ(up_axis_of(again), axis) << name;
      EXPECT_EQ(again.positions, tetrahedron().positions);
      EXPECT_EQ(again.faces, tetrahedron().faces);
      again.positions(3, 2) = 1.5;
      const Mesh cut = upper_part(again);
      EXPECT_EQ(up_axis_of(cut), axis) << name;
      for (const char* other : {"b.ply", "b.obj", "b.off"}) {
        write_mesh(again, folder / other);
        EXPECT_EQ(up_axis_of(read_mesh(folder / other)), axis) << name << ' ' << other;
        write_mesh(cut, folder / other);
        EXPECT_EQ(up_axis_of(read_mesh(folder / other)), axis) << name << ' ' << other;
      }
    }
}

TEST(UpAxis, FollowsAModelFromAFormatWithoutComments) {
  const TemporaryFolder folder;
  write_mesh(tetrahedron(), folder / "a.stl");
  write_mesh(read_mesh(folder / "a.stl"), folder / "a.ply");
  EXPECT_EQ(up_axis_of(read_mesh(folder / "a.ply")), UpAxis::z);
  write_mesh(tetrahedron(UpAxis::z), folder / "a.glb");
  EXPECT_EQ(up_axis_of(read_mesh(folder / "a.glb")), UpAxis::y) << "glTF has y up";
}

TEST(UpAxis, IsReadWhereverAHeaderHasItsComments) {
  const TemporaryFolder folder;
  const auto read_with = [&](const char* name, const std::string& text) {
    folder.file(name, text);
    return up_axis_of(read_mesh(folder / name));
  };
  const std::string body = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_EQ(read_with("a.obj", "\xEF\xBB\xBF# made\r\n\r\n  # Vertical axis: z\r\n" + body), UpAxis::z);
  EXPECT_EQ(read_with("a.obj", body + "# Vertical axis: z\n"), UpAxis::y) << "not before the first vertex";
  EXPECT_EQ(read_with("a.off", "OFF # Vertical axis: z\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), UpAxis::z);
  EXPECT_EQ(read_with("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n# Vertical axis: z\n"), UpAxis::y);
  EXPECT_EQ(read_with("a.ply",
                      "ply\nformat ascii 1.0\nelement vertex 1\ncomment Vertical Axis: Z\nproperty float x\n"
                      "property float y\nproperty float z\nend_header\n0 0 0\n"),
            UpAxis::z);
}

TEST(UpAxis, StaysWhereTheFileNoLongerFits) {
  const TemporaryFolder folder;
  folder.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  Mesh mesh = read_mesh(folder / "a.obj");
  forget_file(mesh);
  EXPECT_EQ(told_up_axis(mesh), UpAxis::y);
  Mesh of_arrays = tetrahedron();
  forget_file(of_arrays);
  EXPECT_EQ(of_arrays.source, nullptr);
}

}  // namespace
}  // namespace meshgraft
