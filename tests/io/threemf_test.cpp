#include <cmath>
#include <map>
#include <memory>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <zip.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/samples/samples.h>

#include "io/expect_error.h"
#include "io/file.h"
#include "io/temporary_folder.h"
#include "mesh/join.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

using Parts = std::map<std::string, std::string>;

std::string pack(const Parts& parts) {
  zip_source_t* source = zip_source_buffer_create(nullptr, 0, 0, nullptr);
  zip_t* archive = zip_open_from_source(source, ZIP_TRUNCATE, nullptr);
  zip_source_keep(source);
  for (const auto& [name, content] : parts)
    zip_file_add(archive, name.c_str(), zip_source_buffer(archive, content.data(), content.size(), 0), 0);
  zip_close(archive);
  zip_stat_t status;
  zip_source_open(source);
  zip_source_stat(source, &status);
  std::string bytes(status.size, '\0');
  zip_source_read(source, bytes.data(), bytes.size());
  zip_source_close(source);
  zip_source_free(source);
  return bytes;
}

Parts unpack(const std::string& package) {
  zip_t* archive =
      zip_open_from_source(zip_source_buffer_create(package.data(), package.size(), 0, nullptr), 0, nullptr);
  Parts parts;
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive, 0); ++i) {
    zip_stat_t status;
    zip_stat_index(archive, static_cast<zip_uint64_t>(i), 0, &status);
    std::string content(status.size, '\0');
    zip_file_t* file = zip_fopen_index(archive, static_cast<zip_uint64_t>(i), 0);
    zip_fread(file, content.data(), content.size());
    zip_fclose(file);
    parts[status.name] = content;
  }
  zip_discard(archive);
  return parts;
}

constexpr std::string_view content_types =
    R"(<?xml version="1.0" encoding="UTF-8"?><Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">)"
    R"(<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>)"
    R"(<Default Extension="config" ContentType="text/plain"/><Default Extension="png" ContentType="image/png"/>)"
    R"(<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>)";

std::string relationships(const std::string& targets) {
  return R"(<?xml version="1.0" encoding="UTF-8"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">)" +
         targets + "</Relationships>";
}

std::string relationship(const std::string& target, int id) {
  return R"(<Relationship Target=")" + target + R"(" Id="rel)" + std::to_string(id) +
         R"(" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>)";
}

std::string model(const std::string& resources, const std::string& build,
                  const std::string& more = R"(unit="inch")") {
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<model xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02" xmlns:p="http://schemas.microsoft.com/3dmanufacturing/production/2015/06" xmlns:slic3rpe="http://schemas.slic3r.org/3mf/2017/06" )" +
         more + ">\n<metadata name=\"Title\">A thing</metadata>\n<resources>\n" + resources +
         "</resources>\n<build>\n" + build + "</build>\n</model>\n";
}

/// Returns a closed tetrahedron with unusual spellings of numbers, and with a slicer's own attribute of a
/// triangle.
std::string tetrahedron(const std::string& triangle_more = "") {
  return R"(<mesh><vertices>
 <vertex x="0" y="0.10" z="-0"/> <!-- <vertex x="9" y="9" z="9"/> -->
 <vertex x="1.0" z='0' y = "1e-1"  />
 <vertex x="0" y="1.123456789012345" z="0"></vertex>
 <vertex x="+0.25" y=".5" z="1"/>
</vertices><triangles>
<triangle v1="0" v2="2" v3="1")" +
         triangle_more + R"(/><triangle v1="0" v2="1" v3="3" slic3rpe:custom_supports="4"/>
<triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/>
</triangles></mesh>)";
}

Parts package_of(const std::string& text) {
  return {{"[Content_Types].xml", std::string(content_types)},
          {"_rels/.rels", relationships(relationship("/3D/3dmodel.model", 1))},
          {"3D/3dmodel.model", text},
          {"Metadata/slicer.config", "; speed = 60\n"},
          {"Metadata/plate.png", std::string("\x89PNG\0\1\2", 7)}};
}

std::string one_tetrahedron() {
  return model(R"(<object id="7" type="model" name="thing">)" + tetrahedron() + "</object>\n",
               R"(<item objectid="7"/>)");
}

class Threemf : public ::testing::Test {
 protected:
  std::filesystem::path write(const Parts& parts, const std::string& name = "a.3mf") const {
    const auto path = folder_.path() / name;
    write_file_atomically(path, pack(parts));
    return path;
  }
  std::filesystem::path file(const std::string& name) const { return folder_.path() / name; }

  test::TemporaryFolder folder_;
};

TEST_F(Threemf, ReadsObjectsWithTheirDigits) {
  const Mesh mesh = read_mesh(write(package_of(one_tetrahedron())));
  ASSERT_EQ(mesh.vertex_count(), 4);
  EXPECT_EQ(mesh.face_count(), 4);
  EXPECT_EQ(mesh.positions.row(1), Eigen::RowVector3d(1, 0.1, 0));
  EXPECT_EQ(mesh.positions(2, 1), 1.123456789012345);
  EXPECT_EQ(mesh.positions.row(3), Eigen::RowVector3d(0.25, 0.5, 1));
  EXPECT_TRUE(mesh.attributes.empty());
}

TEST_F(Threemf, ComesBackByteForByteWithoutAnEdit) {
  const auto path = write(package_of(one_tetrahedron()));
  const WriteResult result = write_mesh(read_mesh(path), file("b.3mf"));
  EXPECT_EQ(read_file(file("b.3mf")), read_file(path));
  EXPECT_TRUE(result.notes.empty());
}

TEST_F(Threemf, AnEditChangesTheCoordinatesThatMovedAndNothingElse) {
  const Parts before = package_of(one_tetrahedron());
  Mesh mesh = read_mesh(write(before));
  mesh.positions(1, 0) = 1.0 / 3;
  mesh.positions(3, 2) = -2;
  EXPECT_TRUE(write_mesh(mesh, file("b.3mf")).notes.empty());
  Parts expected = before;
  std::string& text = expected["3D/3dmodel.model"];
  text.replace(text.find("x=\"1.0\""), 7, "x=\"0.3333333333333333\"");
  text.replace(text.find("y=\".5\" z=\"1\""), 12, "y=\".5\" z=\"-2\"");
  EXPECT_EQ(unpack(read_file(file("b.3mf"))), expected);
  EXPECT_EQ(read_mesh(file("b.3mf")).positions, mesh.positions);
}

TEST_F(Threemf, PlacesObjectsThroughComponentsAndItems) {
  const std::string resources = R"(<object id="1" type="model" name="thing">)" + tetrahedron() +
                                R"(</object><object id="2" type="model"><components>
      <component objectid="1" transform="0 1 0 -1 0 0 0 0 1 10 0 0"/></components></object>)";
  const Parts before =
      package_of(model(resources, R"(<item objectid="2" transform="2 0 0 0 2 0 0 0 2 0 0 5"/>)"));
  Mesh mesh = read_mesh(write(before));
  // (x, y, z) turns to (−y + 10, x, z), then doubles and rises by 5.
  EXPECT_LT((mesh.positions.row(1) - Eigen::RowVector3d(2 * (10 - 0.1), 2, 5)).norm(), 1e-12);
  mesh.positions.row(1) += Eigen::RowVector3d(0, 4, 0);
  write_mesh(mesh, file("b.3mf"));
  const Mesh again = read_mesh(file("b.3mf"));
  EXPECT_LT((again.positions - mesh.positions).cwiseAbs().maxCoeff(), 1e-12);
  for (const Eigen::Index v : {0, 2, 3}) EXPECT_EQ(again.positions.row(v), mesh.positions.row(v));
  const Parts after = unpack(read_file(file("b.3mf")));
  EXPECT_NE(after.at("3D/3dmodel.model").find("x=\"3\" z='0'"), std::string::npos)
      << after.at("3D/3dmodel.model");
  EXPECT_NE(after.at("3D/3dmodel.model").find(R"(transform="2 0 0 0 2 0 0 0 2 0 0 5")"), std::string::npos);
}

TEST_F(Threemf, CopiesOfAnObjectStayOneWhileTheyAgree) {
  const std::string text =
      model(R"(<object id="1" name="thing">)" + tetrahedron() + "</object>",
            R"(<item objectid="1"/><item objectid="1" transform="1 0 0 0 1 0 0 0 1 5 0 0"/>)");
  Mesh mesh = read_mesh(write(package_of(text)));
  ASSERT_EQ(mesh.vertex_count(), 8);
  ASSERT_NE(mesh.find_attribute(Domain::face, "object"), nullptr);
  EXPECT_EQ(mesh.find_attribute(Domain::face, "object")->labels,
            (std::vector<std::string>{"thing", "thing_2"}));
  mesh.positions.row(2) += Eigen::RowVector3d(0, 1, 0);
  mesh.positions.row(6) += Eigen::RowVector3d(0, 1, 0);
  EXPECT_TRUE(write_mesh(mesh, file("same.3mf")).notes.empty());
  EXPECT_LT((read_mesh(file("same.3mf")).positions - mesh.positions).cwiseAbs().maxCoeff(), 1e-12);

  mesh.positions.row(6) += Eigen::RowVector3d(0, 1, 0);
  const WriteResult apart = write_mesh(mesh, file("apart.3mf"));
  ASSERT_FALSE(apart.notes.empty());
  EXPECT_EQ(apart.notes.back().id(), "threemf.copies_edited_apart");
  const Mesh again = read_mesh(file("apart.3mf"));
  EXPECT_EQ(again.positions, mesh.positions);
  EXPECT_EQ(again.faces, mesh.faces);
}

TEST_F(Threemf, ReadsObjectsOfOtherParts) {
  Parts parts = package_of(model(R"(<object id="1" type="model"><components>
      <component p:path="/3D/Objects/inner.model" objectid="4" transform="1 0 0 0 1 0 0 0 1 0 0 3"/></components></object>)",
                                 R"(<item objectid="1"/>)", R"(unit="millimeter" requiredextensions="p")"));
  parts["3D/Objects/inner.model"] = model(R"(<object id="4" type="model">)" + tetrahedron() + "</object>", "");
  parts["3D/_rels/3dmodel.model.rels"] = relationships(relationship("/3D/Objects/inner.model", 9));
  Mesh mesh = read_mesh(write(parts));
  ASSERT_EQ(mesh.vertex_count(), 4);
  EXPECT_EQ(mesh.positions(2, 1), 1.123456789012345);
  mesh.positions(2, 1) = 2;
  write_mesh(mesh, file("b.3mf"));
  Parts after = unpack(read_file(file("b.3mf")));
  std::string& inner = parts["3D/Objects/inner.model"];
  inner.replace(inner.find("1.123456789012345"), 17, "2");
  EXPECT_EQ(after, parts);
}

TEST_F(Threemf, ReadsMaterialsAndColours) {
  const std::string resources =
      R"(<basematerials id="3"><base name="red wax" displaycolor="#FF0000"/><base name="blue" displaycolor="#0000FF80"/></basematerials>)"
      R"(<m:colorgroup id="4"><m:color color="#102030FF"/><m:color color="#405060"/></m:colorgroup>)"
      R"(<object id="1" type="model" pid="3" pindex="1">)" +
      tetrahedron(R"( pid="3" p1="0")") + "</object>" + R"(<object id="2" type="model" pid="4" pindex="0">)" +
      tetrahedron(R"( pid="4" p1="0" p2="1" p3="0")") + "</object>";
  const Mesh mesh =
      read_mesh(write(package_of(model(resources, R"(<item objectid="1"/><item objectid="2"/>)"))));
  const Attribute* material = mesh.find_attribute(Domain::face, "material");
  ASSERT_NE(material, nullptr);
  EXPECT_EQ(material->labels, (std::vector<std::string>{"red wax", "blue"}));
  EXPECT_EQ(material->values[0], 0);
  EXPECT_EQ(material->values[1], 1);
  EXPECT_TRUE(std::isnan(material->values[4]));
  const Attribute* colour = mesh.find_attribute(Domain::corner, "colour");
  ASSERT_NE(colour, nullptr);
  const std::vector<double> corner(colour->values.begin() + 4 * 13, colour->values.begin() + 4 * 14);
  EXPECT_EQ(corner, (std::vector<double>{0x40, 0x50, 0x60, 255}));
  EXPECT_EQ(colour->values[0], 255);
}

TEST_F(Threemf, ComposesMeshesOfAnySource) {
  for (const test::TestMesh& family : test::mesh_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    if (mesh.positions.cwiseAbs().maxCoeff() >= 1e9) {
      test::expect_error([&] { write_mesh(mesh, file("a.3mf")); }, "threemf.coordinate_too_large",
                         {"a.3mf", "vertex 0", "1e9"});
      continue;
    }
    write_mesh(mesh, file("a.3mf"));
    const Mesh again = read_mesh(file("a.3mf"));
    ASSERT_EQ(again.face_count(), mesh.face_count());
    for (Index f = 0; f < again.face_count(); ++f)
      for (int c = 0; c < 3; ++c)
        EXPECT_EQ(again.positions.row(again.faces[f][static_cast<std::size_t>(c)]),
                  mesh.positions.row(mesh.faces[f][static_cast<std::size_t>(c)]));
  }
}

TEST_F(Threemf, ComposesTheSameBytesEachTime) {
  const Mesh mesh = make_sample("bar");
  write_mesh(mesh, file("a.3mf"));
  write_mesh(mesh, file("b.3mf"));
  EXPECT_EQ(read_file(file("a.3mf")), read_file(file("b.3mf")));
}

TEST_F(Threemf, KeepsTinyModels) {
  Mesh mesh = read_mesh(write(package_of(one_tetrahedron())));
  mesh.source.reset();
  mesh.positions *= 1e-9;
  write_mesh(mesh, file("tiny.3mf"));
  EXPECT_EQ(read_mesh(file("tiny.3mf")).positions, mesh.positions);
}

TEST_F(Threemf, KeepsTheUnitWhereTheFacesAreNew) {
  Mesh mesh = read_mesh(write(package_of(one_tetrahedron())));
  mesh.faces.push_back(std::vector<Index>{0, 1, 2});
  write_mesh(mesh, file("b.3mf"));
  EXPECT_NE(unpack(read_file(file("b.3mf"))).at("3D/3dmodel.model").find("unit=\"inch\""), std::string::npos);
  EXPECT_EQ(unit_of(read_mesh(file("b.3mf"))), "inch");
}

TEST_F(Threemf, KeepsTheUnitOfTheMeshThatAnotherIsJoinedTo) {
  const Mesh inches = read_mesh(write(package_of(one_tetrahedron())));
  Mesh unknown = inches;
  unknown.source.reset();
  write_mesh(unknown, file("millimetres.3mf"));
  const Mesh millimetres = read_mesh(file("millimetres.3mf"));
  const auto unit_of_joined = [&](const Mesh& first, const Mesh& second) {
    write_mesh(join(join(first, second).mesh, second).mesh, file("joined.3mf"));
    return unit_of(read_mesh(file("joined.3mf")));
  };
  EXPECT_EQ(unit_of_joined(inches, millimetres), "inch");
  EXPECT_EQ(unit_of_joined(millimetres, inches), "millimeter");
  EXPECT_EQ(unit_of_joined(unknown, inches), "millimeter") << "the default";
  EXPECT_EQ(unit_of_joined(inches, unknown), "inch");
}

TEST_F(Threemf, CarriesObjectsMaterialsAndColours) {
  Mesh mesh = make_sample("bar");
  const auto faces = static_cast<std::size_t>(mesh.face_count());
  Attribute object{.name = "object",
                   .domain = Domain::face,
                   .interpolation = Interpolation::nearest,
                   .type = ScalarType::int32,
                   .labels = {"lower", "upper"}};
  Attribute material{.name = "material",
                     .domain = Domain::face,
                     .interpolation = Interpolation::nearest,
                     .type = ScalarType::int32,
                     .labels = {"skin"}};
  for (std::size_t f = 0; f < faces; ++f) {
    object.values.push_back(f % 2 ? 1 : 0);
    material.values.push_back(f % 3 ? 0 : std::nan(""));
  }
  mesh.attributes = {object, material};
  write_mesh(mesh, file("a.3mf"));
  const Mesh again = read_mesh(file("a.3mf"));
  EXPECT_EQ(again.find_attribute(Domain::face, "object")->labels, object.labels);
  EXPECT_EQ(again.find_attribute(Domain::face, "material")->labels, material.labels);

  Attribute colour{.name = "colour", .domain = Domain::vertex, .type = ScalarType::uint8, .components = 3};
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    colour.values.insert(colour.values.end(), {double(v % 256), 7, 255});
  mesh.attributes = {colour};
  write_mesh(mesh, file("c.3mf"));
  const Mesh coloured = read_mesh(file("c.3mf"));
  const Attribute* corners = coloured.find_attribute(Domain::corner, "colour");
  ASSERT_NE(corners, nullptr);
  const Triangles triangles = triangulate(mesh).triangles;
  for (Eigen::Index c = 0; c < triangles.size(); ++c)
    EXPECT_EQ(corners->values[4 * static_cast<std::size_t>(c)], triangles.data()[c] % 256);
}

// libzip writes by another algorithm where the entries before a changed one make up most of the archive.
TEST_F(Threemf, SurvivesLargeEntriesBeforeTheModel) {
  std::mt19937 random(7);
  for (const std::size_t size : {std::size_t{1500}, std::size_t{60000}}) {
    Parts parts = package_of(one_tetrahedron());
    std::string& thumbnail = parts["0.png"];
    for (std::size_t k = 0; k < size; ++k) thumbnail += static_cast<char>(random());
    Mesh mesh = read_mesh(write(parts));
    mesh.positions(0, 0) = 4;
    write_mesh(mesh, file("b.3mf"));
    EXPECT_EQ(unpack(read_file(file("b.3mf"))).at("0.png"), thumbnail);
    EXPECT_EQ(read_mesh(file("b.3mf")).positions, mesh.positions);
  }
}

// lib3mf reads referenced parts before the part with the build, in whatever order the archive has them.
TEST_F(Threemf, TellsEqualMeshesOfTwoPartsApart) {
  const std::string object = R"(<object id="4" type="model">)" + tetrahedron() + "</object>";
  for (const char* inner : {"3D/Objects/inner.model", "2D/inner.model"}) {
    SCOPED_TRACE(inner);
    const std::string path = std::string("/") + inner;
    const std::string resources =
        object + R"(<object id="5" type="model"><components><component p:path=")" + path +
        R"(" objectid="4" transform="1 0 0 0 1 0 0 0 1 0 3 0"/></components></object>)";
    Parts parts = package_of(model(resources, R"(<item objectid="4"/><item objectid="5"/>)",
                                   R"(unit="millimeter" requiredextensions="p")"));
    parts[inner] = model(object, "");
    parts["3D/_rels/3dmodel.model.rels"] = relationships(relationship(path, 9));
    Mesh mesh = read_mesh(write(parts));
    ASSERT_EQ(mesh.vertex_count(), 8);
    mesh.positions(2, 1) += 0.5;
    write_mesh(mesh, file("b.3mf"));
    const Mesh again = read_mesh(file("b.3mf"));
    EXPECT_LT((again.positions - mesh.positions).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_EQ(unpack(read_file(file("b.3mf"))).at(inner), parts.at(inner));
  }
}

TEST_F(Threemf, MirroredCopiesFaceOutward) {
  const std::string text = model(R"(<object id="1" name="thing">)" + tetrahedron() + "</object>",
                                 R"(<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>)");
  Mesh mesh = read_mesh(write(package_of(text)));
  EXPECT_TRUE(check_mesh(mesh).clean());
  mesh.positions(1, 0) -= 1;
  write_mesh(mesh, file("b.3mf"));
  EXPECT_LT((read_mesh(file("b.3mf")).positions - mesh.positions).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_F(Threemf, RefusesToWriteWhatItCouldNotRead) {
  Mesh mesh = read_mesh(write(package_of(one_tetrahedron())));
  mesh.positions(2, 0) = 1e10;
  test::expect_error([&] { write_mesh(mesh, file("b.3mf")); }, "threemf.coordinate_too_large",
                     {"vertex 2", "1e9"});
  EXPECT_FALSE(std::filesystem::exists(file("b.3mf")));
}

TEST_F(Threemf, NamesWhatItLeavesOut) {
  Mesh mesh = make_mesh(Points::Random(4, 3), (Triangles(1, 3) << 0, 1, 2).finished());
  mesh.attributes = {{.name = "material",
                      .domain = Domain::face,
                      .interpolation = Interpolation::nearest,
                      .type = ScalarType::int32,
                      .values = {0},
                      .labels = {"skin"}},
                     {.name = "colour", .components = 3, .values = std::vector<double>(12, 0.5)}};
  const WriteResult result = write_mesh(mesh, file("a.3mf"));
  ASSERT_EQ(result.notes.size(), 2U);
  EXPECT_EQ(result.notes[0].id(), "threemf.colours_lost");
  EXPECT_EQ(result.notes[1].id(), "io.vertices_left_out");
  EXPECT_EQ(result.notes[1].get<std::int64_t>("count"), 1);
  EXPECT_NE(read_mesh(file("a.3mf")).find_attribute(Domain::face, "material"), nullptr);
}

TEST_F(Threemf, NamesWhatIsWrong) {
  const auto refused = [&](const Parts& parts, const std::string& id, const std::string& words) {
    const auto path = write(parts);
    test::expect_error([&] { read_mesh(path); }, id, {words});
  };
  Parts parts = package_of(one_tetrahedron());
  const std::string good = parts["3D/3dmodel.model"];
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    parts["3D/3dmodel.model"] = text;
    return parts;
  };
  refused(with("x=\"1.0\"", "x=\"1,0\""), "io.decimal_comma", "3D/3dmodel.model, line 7: x of vertex");
  refused(with("x=\"1.0\"", "x=\"1e999\""), "io.number_out_of_range", "line 7: x of vertex");
  refused(with("x=\"1.0\"", ""), "threemf.coordinate_missing", "line 7: a vertex has no 'x'");
  refused(with("</vertices>", ""), "threemf.not_xml", "3D/3dmodel.model, line");
  refused(with("<model ", "<!DOCTYPE a [<!ENTITY b \"c\">]><model "), "threemf.has_document_type", "line 2");
  refused(with("v3=\"1\"", "v3=\"44\""), "threemf.model_refused", "a.3mf");
  refused(with("objectid=\"7\"", "objectid=\"8\""), "threemf.model_refused", "a.3mf");
  parts.erase("3D/3dmodel.model");
  refused(parts, "threemf.no_model", "a.3mf");

  const std::string whole = pack(package_of(one_tetrahedron()));
  write_file_atomically(file("cut.3mf"), whole.substr(0, whole.size() / 2));
  test::expect_error([&] { read_mesh(file("cut.3mf")); }, "threemf.not_zip", {"cut.3mf"});
}

TEST_F(Threemf, RefusesWhatUnpacksWithoutMeasure) {
  Parts parts = package_of(one_tetrahedron());
  parts["Metadata/slicer.config"] = std::string(std::size_t{100} << 20, ' ');
  const auto path = write(parts);
  test::expect_error([&] { read_mesh(path); }, "threemf.part_too_large",
                     {"more than 200 times", "Metadata/slicer.config"});

  // None of these parts is suspicious by itself.
  Parts many = package_of(one_tetrahedron());
  for (int part = 0; part < 10; ++part)
    many["3D/part" + std::to_string(part) + ".model"] = std::string(std::size_t{1} << 20, ' ');
  const auto sum = write(many);
  Context context;
  context.memory = std::uint64_t{20} << 20;
  test::expect_error([&] { read_mesh(sum, context); }, "core.over_budget", {"a.3mf", "20 MB are allowed"});

  std::string resources = R"(<object id="1" type="model">)" + tetrahedron() + "</object>";
  for (int level = 2; level < 12; ++level) {
    resources += "<object id=\"" + std::to_string(level) + "\" type=\"model\"><components>";
    for (int k = 0; k < 10; ++k) resources += "<component objectid=\"" + std::to_string(level - 1) + "\"/>";
    resources += "</components></object>";
  }
  const auto laughs = write(package_of(model(resources, R"(<item objectid="11"/>)")));
  test::expect_error([&] { read_mesh(laughs); }, "threemf.build_too_large", {"copies", "a.3mf"});
}

// Damage anywhere gives a mesh or an Error.
TEST_F(Threemf, SurvivesDamage) {
  const std::string good = pack(package_of(one_tetrahedron()));
  std::mt19937 random(1);
  int refused = 0;
  for (int round = 0; round < 400; ++round) {
    std::string bytes = good;
    if (round % 4 == 0) bytes.resize(random() % bytes.size());
    for (int k = 0; k < 1 + round % 5 && !bytes.empty(); ++k)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    write_file_atomically(file("a.3mf"), bytes);
    try {
      read_mesh(file("a.3mf"));
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace meshgraft
