// The engine sends meshes, pictures, weights and frames of a drag as binary messages.
#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/samples/samples.h>

#include "bar_editing.h"
#include "io/temporary_folder.h"
#include "page_client.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft::test {
namespace {

namespace fs = std::filesystem;

TEST(Editor, SendsTheExactFrameAloneWhereThePageShowsTheOthers) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  page.ask({{"do", "settings"}, {"settings", {{"method", "ft05"}}}});
  page.frame(3);
  const Json moved = {{"top", {{"translate", {0.3, 0, 0}}}}};
  const Json pose = page.ask({{"do", "drag"}, {"poses", moved}, {"frames", "exact"}})["pose"];
  const Frame first = page.frame(2, [&](const Frame& frame) { return frame.header["pose"] == pose; });
  EXPECT_EQ(first.header["accuracy"], "exact");
  EXPECT_EQ(page.refusal({{"do", "drag"}, {"poses", moved}, {"frames", "few"}})["code"], "input");
}

TEST(Editor, SendsALargeMeshInParts) {
  const TemporaryFolder folder;
  const TestMesh sheet = grid(400, 400);
  write_mesh(make_mesh(sheet.positions, sheet.triangles), folder / "large.ply");
  const Mesh mesh = read_mesh(folder / "large.ply");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", (folder / "large.ply").string()}});
  Frame frame = page.frame(1);
  EXPECT_GE(page.parts_seen(), 2u);
  EXPECT_EQ(frame.numbers["positions"], as_shown(mesh.positions, page.offset()));
  ASSERT_EQ(frame.indices["triangles"].size(), 3 * static_cast<std::size_t>(mesh.face_count()));
  EXPECT_TRUE(
      std::equal(mesh.faces.corners().begin(), mesh.faces.corners().end(), frame.indices["triangles"].begin()));
}

TEST(Editor, SendsThePicturesOfItsFoldersAlone) {
  const TemporaryFolder folder, other;
  const auto put = [](const fs::path& file, const std::string& content) { std::ofstream(file) << content; };
  put(folder / "skin.png", "picture");
  put(other / "secret.png", "secret");
  put(folder / "looks.mtl", "newmtl a\nmap_Kd skin.png\nnewmtl c\nmap_Kd skin.png\n");
  put(folder / "model.obj",
      "mtllib looks.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
      "usemtl a\nf 1/1 2/2 3/3 4/4\nusemtl b\nf 1/2 3/3 2/1\nusemtl c\nf 1/1 2/2 4/4\n");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", (folder / "model.obj").string()}});
  Frame frame = page.frame(1);
  EXPECT_EQ(frame.pictures, (std::map<int, std::string>{{1, "picture"}}));
  EXPECT_EQ(frame.indices["pictures"], (std::vector<std::int32_t>{1, 1, 0, 1}))
      << "one picture for both materials";
  const std::vector<float>& uv = frame.numbers["corner_uv"];
  ASSERT_EQ(uv.size(), 24u);
  for (std::size_t c = 0; c < 6; ++c) {  // the model's UVs equal its x and y
    const auto v = static_cast<std::size_t>(frame.indices["triangles"][c]);
    EXPECT_EQ(uv[2 * c], frame.numbers["positions"][3 * v] + 0.5F);
    EXPECT_EQ(uv[2 * c + 1], frame.numbers["positions"][3 * v + 1] + 0.5F);
  }
  put(folder / "away.mtl", "newmtl a\nmap_Kd " + (other / "secret.png").string() + "\n");
  put(folder / "away.obj", "mtllib away.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1 2 3\n");
  EXPECT_EQ(page.refusal({{"do", "open"}, {"path", (folder / "away.obj").string()}})["code"], "input");
}

TEST(Editor, SendsTheWeightsOfTheLinearMethod) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  page.ask({{"do", "settings"}, {"settings", {{"method", "ft05"}}}});
  Frame weights = page.frame(3);
  EXPECT_EQ(weights.header["width"], 16);
  EXPECT_EQ(weights.numbers["blocks"].size(), 16 * weights.indices["vertices"].size());
}

TEST(Editor, SendsTheWeightsOfTheMeshsVerticesAlone) {
  const RunningEditor editor({});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"sample", "bumpy_plane"}, {"resolution", 25}});
  page.ask({{"do", "settings"}, {"settings", {{"method", "ft05"}}}});
  const Json painted = page.ask({{"do", "paint-handle"}, {"vertices", {312}}, {"name", "tip"}, {"reach", 0.3}});
  Frame weights = page.frame(3);  // of a solve with more vertices, around the handle
  const std::vector<std::int32_t>& vertices = weights.indices["vertices"];
  const Json counts = page.ask({{"do", "state"}})["counts"];
  EXPECT_EQ(vertices.size(), counts["free"].get<std::size_t>() + 1) << painted;
  EXPECT_LT(*std::max_element(vertices.begin(), vertices.end()), 25 * 25);
  EXPECT_EQ(weights.numbers["blocks"].size(), 16 * vertices.size());
  EXPECT_EQ(weights.numbers["positions"].size(), 3 * vertices.size());
  EXPECT_EQ(weights.numbers["normals"].size(), 3 * vertices.size());
}

TEST(Editor, SendsWeightsToAllCopiesOfWeldedVertices) {
  const TemporaryFolder folder;
  write_mesh(as_soup(make_sample("bar", 12)), folder / "soup.ply");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", (folder / "soup.ply").string()}});
  paint_top(page);
  page.ask({{"do", "settings"}, {"settings", {{"method", "ft05"}}}});
  const Frame mesh = page.frame(1);
  const Frame weights = page.frame(3);
  const auto& vertices = weights.indices.at("vertices");
  const auto& rows = weights.indices.at("rows");
  ASSERT_EQ(rows.size(), vertices.size());
  const auto place = [&](std::size_t v) {
    const auto& p = mesh.numbers.at("positions");
    return std::array<float, 3>{p[3 * v], p[3 * v + 1], p[3 * v + 2]};
  };
  std::map<std::array<float, 3>, std::int32_t> row_at;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    ASSERT_LT(3 * static_cast<std::size_t>(rows[i]), weights.numbers.at("positions").size());
    EXPECT_EQ(row_at.try_emplace(place(static_cast<std::size_t>(vertices[i])), rows[i]).first->second, rows[i]);
  }
  EXPECT_EQ(3 * row_at.size(), weights.numbers.at("positions").size());
  const std::set<std::int32_t> moving(vertices.begin(), vertices.end());
  for (std::size_t v = 0; 3 * v < mesh.numbers.at("positions").size(); ++v)
    EXPECT_EQ(moving.count(static_cast<std::int32_t>(v)), row_at.count(place(v))) << v;
}

}  // namespace
}  // namespace meshgraft::test
