#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tiny_obj_loader.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "damage.h"
#include "io/file.h"
#include "obj_files.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

TEST(Obj, AllLineEndsReadAlikeAndComeBackByteForByte) {
  const TemporaryFolder folder;
  for (const char* line_end : {"\n", "\r\n", "\r"}) {
    for (const char* mark : {"", "\xEF\xBB\xBF"}) {
      for (const bool last_line_end : {true, false}) {
        std::string file = rich_obj;
        if (!last_line_end) file.pop_back();
        file = mark + with_line_ends(file, line_end);
        const Mesh mesh = folder.mesh("in.obj", file);
        expect_rich_obj(mesh);
        EXPECT_EQ(folder.written(mesh, "out.obj"), file);
      }
    }
  }
}

TEST(Obj, FacesMayComeBeforeTheirVertices) {
  const TemporaryFolder folder;
  const std::string file = "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const Mesh mesh = folder.mesh("in.obj", file);
  EXPECT_EQ(mesh.faces.corners(), (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(folder.written(mesh, "out.obj"), file);
}

TEST(Obj, SpecialNumbersAreReadAsSuch) {
  const TemporaryFolder folder;
  const std::string file = "v nan -inf 1.#QNAN\n";
  const Mesh mesh = folder.mesh("in.obj", file);
  EXPECT_TRUE(std::isnan(mesh.positions(0, 0)));
  EXPECT_EQ(mesh.positions(0, 1), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(mesh.positions(0, 2)));
  EXPECT_EQ(folder.written(mesh, "out.obj"), file);
}

TEST(Obj, FacesBeforeTheFirstGroupHaveNone) {
  const TemporaryFolder folder;
  const std::string file = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ng late\nf 3 2 1\n";
  const Mesh mesh = folder.mesh("in.obj", file);
  const Mesh ply = folder.mesh("middle.ply", folder.written(mesh, "out.ply"));
  for (const Mesh* each : {&mesh, &ply}) {
    const Attribute* group = each->find_attribute(Domain::face, "group");
    ASSERT_NE(group, nullptr);
    EXPECT_TRUE(std::isnan(group->values[0]));
    EXPECT_EQ(group->values[1], 0);
    EXPECT_EQ(group->labels, std::vector<std::string>{"late"});
  }
  EXPECT_EQ(folder.written(ply, "again.ply"), read_file(folder / "middle.ply"));
}

TEST(Obj, AgreesWithTinyobjloader) {
  const TemporaryFolder folder;
  const std::string file =
      "v 0 0 0\nv 1.5 0 0\nv 1 1e-3 0\nv 0 1 0\nvt 0 0\nvt .5 0\nvt 0 .25\nvn 0 0 1\n"
      "f 1/1/1 2/2/1 3/3/1 4/1/1\nv 3 3 3\nf -1/-1/-1 -2/-2/-1 -3/-3/-1\n";
  const Mesh mesh = folder.mesh("in.obj", file);
  tinyobj::ObjReaderConfig config;
  config.triangulate = false;
  tinyobj::ObjReader reader;
  ASSERT_TRUE(reader.ParseFromString(file, "", config)) << reader.Error();
  const tinyobj::attrib_t& other = reader.GetAttrib();
  ASSERT_EQ(other.vertices.size(), static_cast<std::size_t>(3 * mesh.vertex_count()));
  for (std::size_t k = 0; k < other.vertices.size(); ++k) {
    EXPECT_NEAR(mesh.positions.data()[k], other.vertices[k], 1e-6);
  }
  const tinyobj::mesh_t& shape = reader.GetShapes().at(0).mesh;
  ASSERT_EQ(shape.indices.size(), static_cast<std::size_t>(mesh.faces.corner_count()));
  const Attribute* uv = mesh.find_attribute(Domain::corner, "uv");
  ASSERT_NE(uv, nullptr);
  for (std::size_t c = 0; c < shape.indices.size(); ++c) {
    EXPECT_EQ(mesh.faces.corners()[c], shape.indices[c].vertex_index);
    EXPECT_NEAR(uv->values[2 * c], other.texcoords[2 * shape.indices[c].texcoord_index], 1e-6);
    EXPECT_NEAR(uv->values[2 * c + 1], other.texcoords[2 * shape.indices[c].texcoord_index + 1], 1e-6);
  }
}

TEST(Obj, ContinuedLinesAreOneWhateverTheyHold) {
  const TemporaryFolder folder;
  for (const std::string name :
       {"o on\\\nv 9 9 9", "usemtl a#b\\\nv 9 9 9", "g a \\\n b\\\r\nc", "q 1#2\\\n3"}) {
    SCOPED_TRACE(name);
    const std::string content = name + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\n# C:\\\nf 1 2 3\n";
    Mesh mesh = folder.mesh("in.obj", content);
    EXPECT_EQ(mesh.vertex_count(), 3);
    EXPECT_EQ(folder.written(mesh, "same.obj"), content);
    mesh.positions.array() += 1;
    const Mesh again = folder.mesh("again.obj", folder.written(mesh, "moved.obj"));
    EXPECT_EQ(again.positions, mesh.positions);
  }
}

TEST(Obj, ABackslashMayBeTheLastCharacter) {
  const TemporaryFolder folder;
  const std::string content = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 \\";
  const Mesh mesh = folder.mesh("in.obj", content);
  EXPECT_EQ(mesh.face_count(), 1);
  EXPECT_EQ(folder.written(mesh, "same.obj"), content);
}

}  // namespace
}  // namespace meshgraft::test
