// OBJ files keep their material libraries when they are edited, refined and joined.
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>

#include "io/file.h"
#include "mesh/join.h"
#include "mesh/refine.h"
#include "obj_files.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

TEST(Obj, AChangedTopologyKeepsTheMaterialLibrary) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.obj", rich_obj);
  Faces faces;
  faces.push_back(std::array<Index, 3>{0, 1, 2});
  mesh.faces = faces;
  mesh.attributes.clear();
  const std::string written = folder.written(mesh, "out.obj");
  EXPECT_EQ(written.find("mtllib skin and bones.mtl\n"), 0u);
  EXPECT_TRUE(folder.mesh("again.obj", written).faces == faces);
}

TEST(Obj, ARefinedMeshKeepsTheMaterialLibrary) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("in.obj", rich_obj);
  const RefineResult refined = split_edges_at(mesh, std::vector<Index>{0});
  ASSERT_GT(refined.mesh.face_count(), mesh.face_count());
  const std::string written = folder.written(refined.mesh, "out.obj");
  EXPECT_EQ(written.find("mtllib skin and bones.mtl\n"), 0u);
}

// Two triangles, of two materials.
std::string with_materials(const std::string& library) {
  return "mtllib " + library +
         "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl skin\nf 1 2 3\nusemtl hair\nf 3 2 4\n";
}

TEST(Obj, AJoinedMeshDefinesTheMaterialsOfBoth) {
  const TemporaryFolder folder;
  for (const char* sub : {"a", "b", "out"}) std::filesystem::create_directory(folder / sub);
  folder.file("a/one.mtl",
              "# of one\nnewmtl skin\nKd 1 0 0\nmap_Kd -s 1 1 1 -o 0.5 -bm 2 tex/the skin.png\n"
              "newmtl hair\nKd 0 0 1\nmap_Bump C:\\abs.png\nnewmtl unused\nKd 9 9 9\n");
  folder.file("b/my two.mtl",
              "newmtl skin\r\nKd 0 1 0\r\nmap_Kd ..\\b\\tex.png\r\nnewmtl hair\r\nbump /abs/b.png\r\n");
  const Mesh one = folder.mesh("a/one.obj", with_materials("one.mtl"));
  const Mesh two = folder.mesh("b/two.obj", with_materials("my two.mtl"));
  const WriteResult result = write_mesh(join(one, two).mesh, folder / "out/whole.obj");
  ASSERT_EQ(result.files,
            (std::vector<std::filesystem::path>{folder / "out/whole.obj", folder / "out/whole.mtl"}));
  EXPECT_TRUE(result.notes.empty());
  EXPECT_EQ(read_file(folder / "out/whole.mtl"),
            "# Materials, put together by meshgraft for whole.obj\n"
            "\nnewmtl skin\nKd 1 0 0\nmap_Kd -s 1 1 1 -o 0.5 -bm 2 ../a/tex/the skin.png\n"
            "\nnewmtl hair\nKd 0 0 1\nmap_Bump C:\\abs.png\n"
            "\nnewmtl skin_2\nKd 0 1 0\nmap_Kd ../b/tex.png\n"
            "\nnewmtl hair_2\nbump /abs/b.png\n");
  const std::string written = read_file(folder / "out/whole.obj");
  EXPECT_NE(written.find("\nmtllib whole.mtl\n"), std::string::npos) << written;
  EXPECT_EQ(written.find("mtllib", written.find("mtllib") + 1), std::string::npos);
  EXPECT_NE(written.find("\nusemtl hair_2\n"), std::string::npos) << written;

  // Joins once more, onto that result.
  const WriteResult again =
      write_mesh(join(read_mesh(folder / "out/whole.obj"), one).mesh, folder / "out/whole.obj");
  EXPECT_EQ(again.files.back(), folder / "out/whole_2.mtl") << "an input's library stays";
  const std::string third = read_file(folder / "out/whole_2.mtl");
  for (const char* name : {"skin\n", "hair_2\n", "skin_3\n", "hair_3\n"})
    EXPECT_NE(third.find(std::string("newmtl ") + name), std::string::npos) << third;
  EXPECT_NE(third.find("map_Kd ../b/tex.png"), std::string::npos) << third;
}

TEST(Obj, AMaterialLibraryReplacesOnlyOneOfItsKind) {
  const TemporaryFolder folder;
  folder.file("one.mtl", "newmtl skin\nKd 1 0 0\nnewmtl hair\n");
  folder.file("two.mtl", "newmtl skin\nKd 0 1 0\nnewmtl hair\n");
  folder.file("whole.mtl", "somebody's\n");
  const Mesh both =
      join(folder.mesh("one.obj", with_materials("one.mtl")), folder.mesh("two.obj", with_materials("two.mtl")))
          .mesh;
  EXPECT_EQ(write_mesh(both, folder / "whole.obj").files.back(), folder / "whole_2.mtl");
  EXPECT_EQ(write_mesh(both, folder / "whole.obj").files.back(), folder / "whole_2.mtl") << "its own";
  EXPECT_EQ(write_mesh(both, folder / "two.obj").files.back(), folder / "two_2.mtl");
  EXPECT_EQ(read_file(folder / "whole.mtl"), "somebody's\n");
  EXPECT_EQ(read_file(folder / "two.mtl"), "newmtl skin\nKd 0 1 0\nnewmtl hair\n");
}

TEST(Obj, NamesMaterialsThatAreNotDefined) {
  const TemporaryFolder folder;
  folder.file("one.mtl", "newmtl skin\n");
  const Mesh one = folder.mesh("one.obj", with_materials("one.mtl"));
  const Mesh two = folder.mesh("two.obj", with_materials("gone.mtl"));
  const WriteResult result = write_mesh(join(one, two).mesh, folder / "whole.obj");
  ASSERT_EQ(result.notes.size(), 1u);
  EXPECT_EQ(result.notes[0].id(), "io.library_not_read");
  EXPECT_EQ(result.notes[0].get<std::string>("library"), folder / "gone.mtl");
  EXPECT_EQ(result.notes[0].get<std::string>("reason"), "No such file or directory");
  const std::string written = read_file(folder / "whole.obj");
  EXPECT_NE(written.find("mtllib gone.mtl\nmtllib whole.mtl\n"), std::string::npos) << written;

  const Mesh three = folder.mesh("three.obj", with_materials("one.mtl"));
  const WriteResult undefined = write_mesh(join(one, three).mesh, folder / "three_times.obj");
  ASSERT_EQ(undefined.notes.size(), 2u);
  EXPECT_EQ(undefined.notes[0].id(), "io.material_undefined");
  EXPECT_EQ(undefined.notes[0].get<std::string>("material"), "hair");

  std::filesystem::create_directory(folder / "folder.mtl");
  const Mesh four = folder.mesh("four.obj", with_materials("folder.mtl"));
  const WriteResult no_file = write_mesh(join(one, four).mesh, folder / "whole.obj");
  ASSERT_EQ(no_file.notes.size(), 1u);
  EXPECT_EQ(no_file.notes[0].get<std::string>("reason"), "Is a directory");
}

TEST(Obj, FacesWithoutAMaterialGetANameOfTheirOwn) {
  const TemporaryFolder folder;
  const Mesh bare = folder.mesh("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.file("part.mtl", "newmtl default\n");
  const Mesh part =
      folder.mesh("part.obj", "mtllib part.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl default\nf 1 2 3\n");
  const std::string written = folder.written(join(part, bare).mesh, "whole.obj");
  EXPECT_NE(written.find("usemtl default\nf 1 2 3\nusemtl default_2\nf 4 5 6\n"), std::string::npos) << written;
}

TEST(Obj, TellsWhatItCannotCarry) {
  const TemporaryFolder folder;
  const Mesh ply =
      folder.mesh("in.ply",
                  "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 3\nproperty float x\n"
                  "property float y\nproperty float z\nproperty float heat\nelement face 1\n"
                  "property list uchar int vertex_indices\nelement edge 2\nproperty int a\nend_header\n"
                  "0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n1\n2\n");
  const WriteResult result = write_mesh(ply, folder / "out.obj");
  ASSERT_EQ(result.notes.size(), 3u);
  EXPECT_EQ(result.notes[0].id(), "io.left_out");
  EXPECT_EQ(result.notes[0].get<std::string>("file"), "in.ply");
  EXPECT_NE(result.notes[0].text().find("edge (2)"), std::string::npos) << result.notes[0].text();
  EXPECT_EQ(result.notes[1].get<std::string>("content"), "TextureFile a.png");
  EXPECT_EQ(result.notes[2].get<std::vector<std::string>>("attributes"), std::vector<std::string>{"heat"});

  folder.file("one.mtl", "newmtl skin\n");
  const Mesh obj = folder.mesh("one.obj", with_materials("one.mtl") + "l 1 2\nl 2 3\n");
  const WriteResult as_ply = write_mesh(obj, folder / "out.ply");
  ASSERT_EQ(as_ply.notes.size(), 2u);
  EXPECT_NE(as_ply.notes[0].text().find("l (2)"), std::string::npos) << as_ply.notes[0].text();
  EXPECT_EQ(as_ply.notes[1].id(), "io.materials_named_only");
  EXPECT_EQ(as_ply.notes[1].get<std::string>("library"), "one.mtl");

  std::filesystem::create_directory(folder / "far");
  const WriteResult moved = write_mesh(obj, folder / "far/one.obj");
  ASSERT_EQ(moved.notes.size(), 1u);
  EXPECT_EQ(moved.notes[0].id(), "io.library_to_copy");
  EXPECT_TRUE(write_mesh(obj, folder / "other.obj").notes.empty());
}

TEST(Obj, KnowsTheFilesBehindIt) {
  const TemporaryFolder folder;
  folder.file("one.mtl", "newmtl skin\nmap_Kd -clamp on skin.png\nmap_d gone.png\n");
  folder.file("skin.png", "png");
  folder.mesh("one.obj", with_materials("one.mtl"));
  EXPECT_EQ(files_behind(folder / "one.obj"),
            (std::vector<std::filesystem::path>{folder / "one.obj", folder / "one.mtl", folder / "skin.png"}));
  EXPECT_EQ(files_behind(folder / "gone.obj").size(), 1u);
}

}  // namespace
}  // namespace meshgraft::test
