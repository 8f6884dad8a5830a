// Tests from where parts can be added, and which of their files a session keeps.
#include <filesystem>
#include <fstream>
#include <set>
#include <string>

#include <meshgraft/samples/samples.h>

#include "graft_editor.h"
#include "io/file.h"

namespace meshgraft::test {
namespace {

namespace fs = std::filesystem;

class PartFiles : public GraftEditor {
 protected:
  void SetUp() override {
    write_mesh(make_sample("bust", 20), folder_ / "bust.ply");
    fs::create_directory(folder_ / "library");
    write_mesh(make_sample("head", 18), folder_ / "library" / "head.ply");
  }
  Json add(const char* where, const std::string& name) {
    return page_.ask({{"do", "part"}, {"what", "add"}, {where, name}});
  }
  void open_bust_file() { page_.ask({{"do", "open"}, {"path", "bust.ply"}}); }
};

TEST_F(PartFiles, NamesAPartFromTheEditOn) {
  open_bust_file();
  EXPECT_EQ(add("path", "library/head.ply")["name"], "head");
  const Frame frame = shown(graft({{"source", "head"}}));
  fs::create_directory(folder_ / "edits");
  page_.ask({{"do", "save"}, {"edit", "edits/graft.json"}});
  const EditFile edit = read_edit_file(folder_ / "edits" / "graft.json");
  EXPECT_EQ(edit.inputs[1].file, "../library/head.ply");
  EXPECT_EQ(run_edit(edit).mesh.vertex_count(), frame.header["vertices"]);
  EXPECT_EQ(page_.refusal({{"do", "save"}, {"mesh", "library/head.ply"}, {"overwrite", true}})["code"], "usage")
      << "an input";
}

TEST_F(PartFiles, RefusesWaysOutOfItsFolders) {
  const TemporaryFolder outside;
  fs::copy_file(folder_ / "bust.ply", outside / "secret.ply");
  const std::string secret = (outside / "secret.ply").string();
  fs::create_symlink(secret, folder_ / "link.ply");
  folder_.file("refers.obj", "mtllib ../" + outside.path().filename().string() +
                                 "/secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  outside.file("secret.mtl", "newmtl a\n");
  open_bust_file();
  for (const std::string& path : {secret, std::string("link.ply"), std::string("../secret.ply"),
                                  std::string("refers.obj"), std::string("/etc/passwd")}) {
    EXPECT_EQ(page_.refusal({{"do", "part"}, {"what", "add"}, {"path", path}})["code"], "input") << path;
    EXPECT_EQ(page_.refusal({{"do", "thumbnail"}, {"path", path}})["code"], "input") << path;
  }
  EXPECT_EQ(page_.refusal({{"do", "part"}, {"what", "add"}, {"upload", "../../etc/passwd"}})["code"], "io");
  add("path", "library/head.ply");
  const Json elsewhere = {{"file", (outside / "indices.txt").string()}};
  for (const char* what : {"graft", "graft-drag"})
    EXPECT_EQ(page_.refusal({{"do", what}, {"pose", "keep"}, {"fixed", elsewhere}})["code"], "input");
}

TEST_F(PartFiles, KeepsAnUploadBesideTheEdit) {
  const std::string head = read_file(folder_ / "library" / "head.ply");
  const std::string upload = page_.upload("arm.ply", head);
  open_bust_file();
  EXPECT_EQ(add("upload", upload)["name"], "arm");
  const Frame frame = shown(graft(Json::object()));
  fs::create_directory(folder_ / "edits");
  (void)std::ofstream(folder_ / "edits" / upload.c_str()).write("another", 7);
  page_.ask({{"do", "save"}, {"edit", "edits/graft.json"}});
  const EditFile edit = read_edit_file(folder_ / "edits" / "graft.json");
  for (const EditInput& input : edit.inputs) {
    if (input.name == "bust") continue;
    EXPECT_EQ(read_file(folder_ / "edits" / input.file.c_str()), head) << input.file;
  }
  EXPECT_EQ(run_edit(edit).mesh.vertex_count(), frame.header["vertices"]);
  EXPECT_EQ(page_.ask({{"do", "list"}, {"folder", folder_.path().string()}})["folders"],
            (Json{"edits", "library"}))
      << "what the journal keeps is not listed";
}

TEST_F(PartFiles, RestoresPartsAndGraftsAfterACrash) {
  open_bust_file();
  add("path", "library/head.ply");
  page_.ask({{"do", "cut"},
             {"mesh", "head"},
             {"plane", {{"point", {0, 0, -0.3}}, {"normal", {0, 0, 1}}}},
             {"keep", "above"}});
  const std::string upload = page_.upload("other.ply", read_file(folder_ / "library" / "head.ply"));
  add("upload", upload);
  const std::vector<float> grafted = shown(graft({{"source", "head"}})).numbers.at("positions");
  const fs::path journal = folder_ / "bust.ply.meshgraft-session";
  // A copy of the folder stands for one that a stopped machine left; another program opens it.
  const TemporaryFolder later;
  fs::copy(folder_.path(), later.path(), fs::copy_options::recursive);
  const RunningEditor next({later.path()});
  Page page(next.url());
  page.ask({{"do", "open"}, {"path", "bust.ply"}});
  EXPECT_EQ(page.event("offer-restore")["changes"], 4);
  page.ask({{"do", "restore"}});
  const Json now = page.ask({{"do", "state"}});
  EXPECT_EQ(now["parts"].size(), 2u);
  EXPECT_EQ(now["graft"]["step"]["source"], "head");
  EXPECT_EQ(page.frame(6).numbers.at("positions"), grafted);
  page.ask({{"do", "accept"}});
  page.ask({{"do", "save"}, {"edit", "graft.json"}});
  page.ask({{"do", "open"}, {"sample", "bar"}, {"resolution", 8}});
  EXPECT_FALSE(fs::exists(later / "bust.ply.meshgraft-session")) << "all is saved";
  EXPECT_FALSE(fs::exists(later / "bust.ply.meshgraft-session.parts"));
  EXPECT_EQ(run_edit(read_edit_file(later / "graft.json")).report.steps.size(), 2u);
}

TEST_F(PartFiles, MakesThumbnails) {
  const int before_open = page_.send({{"do", "thumbnail"}, {"path", "library/head.ply"}, {"size", 48}});
  const Json reply = page_.reply_to(before_open);
  if (reply.contains("error")) {
    EXPECT_EQ(reply["error"]["code"], "usage");
    GTEST_SKIP() << "built without the renderer";
  }
  const Frame picture = page_.frame(8);
  EXPECT_EQ(picture.header["of"], before_open);
  const std::string& png = picture.bytes.at("png");
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png.substr(16, 8), std::string("\0\0\0\x30\0\0\0\x30", 8)) << "width and height";
  EXPECT_EQ(reply["result"]["bytes"], png.size());
  open_bust_file();
  EXPECT_GT(page_.ask({{"do", "thumbnail"}, {"mesh", "bust"}, {"size", 16}})["bytes"], 100);
  folder_.file("text.ply", "no mesh");
  folder_.file("points.obj", "v 0 0 0\n");
  for (const Json& request :
       {Json{{"do", "thumbnail"}}, Json{{"do", "thumbnail"}, {"path", "text.ply"}},
        Json{{"do", "thumbnail"}, {"path", "points.obj"}}, Json{{"do", "thumbnail"}, {"sample", "bar"}},
        Json{{"do", "thumbnail"}, {"mesh", "none"}},
        Json{{"do", "thumbnail"}, {"mesh", "bust"}, {"size", 9000}}})
    EXPECT_EQ(page_.refusal(request)["code"], "input") << request;
  std::vector<int> asked;
  for (int k = 0; k < 30; ++k)
    asked.push_back(page_.send({{"do", "thumbnail"}, {"path", "library/head.ply"}, {"size", 256}}));
  EXPECT_EQ(page_.ask({{"do", "state"}})["name"], "bust.ply");
  page_.ask({{"do", "cancel"}});
  int cancelled = 0;
  for (const int id : asked) cancelled += page_.reply_to(id).contains("error") ? 1 : 0;
  EXPECT_GT(cancelled, 15) << "the state did not wait for them";
}

TEST_F(PartFiles, TellsOfSizesThatCannotBeShown) {
  for (const std::string size : {"1e308", "1e20", "1e-30"}) {
    folder_.file("size.obj", "v 0 0 0\nv " + size + " 0 0\nv 0 " + size + " 0\nf 1 2 3\n");
    const Json notes = page_.ask({{"do", "open"}, {"path", "size.obj"}})["notes"];
    ASSERT_EQ(notes.size(), 1U) << size;
    EXPECT_EQ(notes[0]["id"], "editor.size_not_shown") << notes;
    EXPECT_EQ(notes[0]["fields"]["file"], "size.obj");
  }
}

TEST_F(PartFiles, TellsOfDefectsThatMatterForEditing) {
  const Json sound = page_.ask({{"do", "open"}, {"path", "bust.ply"}});
  EXPECT_EQ(sound["notes"], Json::array()) << "a boundary loop is no defect";
  EXPECT_EQ(add("path", "library/head.ply")["notes"], Json::array());
  folder_.file("torn it.obj", R"(v 0 0 0
v 1 0 0
v 0 1 0
v nan 0 0
v 5 5 5
v 0 0 1
v 0 0 -1
f 1 2 3
f 1 2 6
f 1 2 7
f 3 1 2
)");
  const Json opened = page_.ask({{"do", "open"}, {"path", "torn it.obj"}});
  std::set<std::string> found;
  ASSERT_EQ(opened["notes"].size(), 1U) << "one note on one file";
  for (const Json& note : opened["notes"][0]["details"]) found.insert(note["id"]);
  for (const char* id :
       {"mesh.non_finite", "mesh.non_manifold_edge", "mesh.isolated_vertex", "mesh.duplicate_face"})
    EXPECT_TRUE(found.contains(id)) << id << " in: " << opened["notes"];
  ASSERT_EQ(opened["notes"][0]["id"], "editor.defects");
  EXPECT_TRUE(opened["notes"][0]["fields"]["path"].get<std::string>().ends_with("torn it.obj"));
  EXPECT_EQ(opened["notes"][0]["fields"]["repaired"], "torn it_repaired.obj");
  page_.ask({{"do", "open"}, {"path", "bust.ply"}});
  const std::string upload = page_.upload("torn.obj", read_file(folder_ / "torn it.obj"));
  const Json added = add("upload", upload);
  ASSERT_EQ(added["notes"][0]["id"], "editor.defects");
  EXPECT_EQ(added["notes"][0]["fields"]["file"], "torn.obj");
  EXPECT_EQ(added["notes"][0]["fields"]["path"], "torn.obj");
  EXPECT_EQ(added["notes"][0]["fields"]["repaired"], "torn_repaired.obj");
}

TEST_F(PartFiles, TellsOfFilesOfAnotherFormatByTheirNames) {
  const std::string head = read_file(folder_ / "library" / "head.ply");
  folder_.file("scan.obj", head);
  const Json opened = page_.ask({{"do", "open"}, {"path", "scan.obj"}})["notes"];
  open_bust_file();
  const Json added = add("upload", page_.upload("scan.obj", head))["notes"];
  for (const Json& notes : {opened, added}) {
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_EQ(notes[0]["id"], "io.other_format");
    EXPECT_EQ(notes[0]["fields"], (Json{{"file", "scan.obj"}, {"format", "PLY"}, {"named", "OBJ"}}));
    EXPECT_FALSE(notes[0].contains("details"));
  }
}

TEST_F(PartFiles, UploadsKeepTheirNames) {
  const std::string head = read_file(folder_ / "library" / "head.ply");
  open_bust_file();
  const auto name_of = [&](const std::string& encoded) {
    return add("upload", page_.upload(encoded + ".ply", head))["name"].get<std::string>();
  };
  EXPECT_EQ(name_of("B%C3%A4r%20%E7%86%8A%20(2)"), "Bär 熊 (2)");
  EXPECT_EQ(name_of("a%2F..%2Fb%22%01c"), "b__c");
  std::string long_name;
  for (int i = 0; i < 200; ++i) long_name += "%C3%A4";
  EXPECT_EQ(name_of(long_name).size(), 120U);
  EXPECT_EQ(name_of("%FF%FE"), "model");
  const Json refused = page_.refusal({{"do", "save"}, {"mesh", std::string(300, 'x') + ".ply"}});
  EXPECT_EQ(refused["id"], "editor.name_too_long");
  EXPECT_EQ(refused["fields"]["bytes"], 304);
}

TEST_F(PartFiles, TellsWhichAxisStandsUp) {
  open_bust();
  EXPECT_EQ(state()["up"], "z") << "a sample";
  open_bust_file();
  EXPECT_EQ(state()["up"], "z") << "a sample's file says so";
  write_mesh(make_sample("bust", 20), folder_ / "bust.glb");
  page_.ask({{"do", "open"}, {"path", "bust.glb"}});
  EXPECT_EQ(state()["up"], "y") << "the format says so";
  folder_.file("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  page_.ask({{"do", "open"}, {"path", "plain.obj"}});
  EXPECT_EQ(state()["up"], "y") << "most programs write it so";
}

TEST_F(PartFiles, StandsAModelUprightAgainstTheConventionOfItsFormat) {
  Mesh bust = make_sample("bust", 20);
  bust.source.reset();
  write_mesh(bust, folder_ / "z_up.obj");
  page_.ask({{"do", "open"}, {"path", "z_up.obj"}});
  EXPECT_EQ(state()["up"], "z");
  EXPECT_EQ(state()["front"], "-y");
}

TEST_F(PartFiles, GuessesTheFrontFromTheShape) {
  open_bust();
  EXPECT_EQ(state()["front"], "-y") << "the usual one";
  Mesh turned = make_sample("bust", 20);
  for (auto point : turned.positions.rowwise())
    point = Eigen::RowVector3d(-point.y(), point.x(), point.z()).eval();
  write_mesh(turned, folder_ / "turned.ply");
  page_.ask({{"do", "open"}, {"path", "turned.ply"}});
  EXPECT_EQ(state()["up"], "z");
  EXPECT_TRUE(state()["front"] == "x" || state()["front"] == "-x") << "the shoulders lie along y";
}

TEST_F(PartFiles, APartChangesNoUnit) {
  write_mesh(make_sample("bust", 20), folder_ / "bust.glb");
  write_mesh(make_sample("head", 18), folder_ / "head.glb");
  const auto unit_with_part = [&](const Json& model, const Json& part) {
    Json open = model, more = part;
    open["do"] = "open";
    page_.ask(open);
    more.update({{"do", "part"}, {"what", "add"}});
    page_.ask(more);
    graft(Json::object());
    page_.ask({{"do", "accept"}});
    EXPECT_EQ(state()["steps"].size(), 2U) << "grafted";
    return state()["unit"].get<std::string>();
  };
  const Json sample_head = {{"sample", "head"}, {"resolution", 18}};
  EXPECT_EQ(unit_with_part({{"sample", "bust"}, {"resolution", 20}}, {{"path", "head.glb"}}), "");
  EXPECT_EQ(unit_with_part({{"path", "bust.ply"}}, {{"path", "head.glb"}}), "");
  EXPECT_EQ(unit_with_part({{"path", "bust.glb"}}, sample_head), "meter");
}

/// A session that is over leaves a journal only if there is work to restore.
TEST_F(PartFiles, JournalsGoWhereNothingIsLeftToRestore) {
  const auto journals = [&] {
    std::size_t count = 0;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      count += entry.path().filename().string().find(".meshgraft-session") != std::string::npos ? 1 : 0;
    return count;
  };
  const auto opened_elsewhere = [&] { page_.ask({{"do", "open"}, {"sample", "bar"}}); };
  open_bust_file();
  opened_elsewhere();
  EXPECT_EQ(journals(), 0U) << "nothing done";
  open_bust_file();
  add("path", "library/head.ply");
  EXPECT_EQ(journals(), 1U);
  page_.ask({{"do", "undo"}});
  opened_elsewhere();
  EXPECT_EQ(journals(), 0U) << "all taken back";
  open_bust_file();
  add("path", "library/head.ply");
  page_.ask({{"do", "save"}, {"edit", "bust.json"}});
  page_.ask({{"do", "undo"}});
  page_.ask({{"do", "redo"}});
  opened_elsewhere();
  EXPECT_EQ(journals(), 0U) << "back to what is saved";
  open_bust_file();
  add("path", "library/head.ply");
  opened_elsewhere();
  EXPECT_EQ(journals(), 1U) << "not saved";
  open_bust_file();
  EXPECT_EQ(page_.event("offer-restore")["changes"], 1);
  page_.ask({{"do", "restore"}});
  page_.ask({{"do", "save"}, {"edit", "bust2.json"}});
  opened_elsewhere();
  EXPECT_EQ(journals(), 0U);
}

}  // namespace
}  // namespace meshgraft::test
