// The engine opens, saves and replaces files of its folders, and no others.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/script/run_edit.h>

#include "bar_editing.h"
#include "io/file.h"
#include "io/temporary_folder.h"
#include "page_client.h"

namespace meshgraft::test {
namespace {

namespace fs = std::filesystem;

TEST(Editor, WritesTheModelAsItIsWhereNothingIsDone) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  const fs::path model = bar_file(folder);
  page.ask({{"do", "open"}, {"path", model.string()}});
  page.ask({{"do", "export"}, {"path", (folder / "untouched.ply").string()}});
  EXPECT_EQ(read_file(folder / "untouched.ply"), read_file(model));
  paint_top(page);
  pose_top(page);
  page.ask({{"do", "undo"}});
  page.ask({{"do", "undo"}});
  page.ask({{"do", "export"}, {"path", (folder / "undone.ply").string()}});
  EXPECT_EQ(read_file(folder / "undone.ply"), read_file(model));
}

TEST(Editor, OpensAModelWithOthersBeside) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  const std::string file = bar_file(folder).string();
  page.ask({{"do", "open"}, {"path", file}, {"parts", {file, file}}});
  const Json state = page.ask({{"do", "state"}});
  ASSERT_EQ(state["parts"].size(), 2U);
  EXPECT_EQ(state["parts"][0]["name"], "bar 2");
  EXPECT_EQ(state["undo"], nullptr);
  EXPECT_EQ(state["dirty"], false);
  EXPECT_EQ(page.refusal({{"do", "open"}, {"path", file}, {"parts", {"/etc/passwd"}}})["code"], "input");
}

TEST(Editor, UsesAFolderThatAPageAdds) {
  const TemporaryFolder folder, added;
  const std::string file = bar_file(added).string();
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  EXPECT_EQ(page.refusal({{"do", "open"}, {"path", file}})["code"], "input");
  const auto refused = [&](const std::string& path) {
    return page.refusal({{"do", "add-folder"}, {"path", path}})["id"].get<std::string>();
  };
  EXPECT_EQ(refused("models"), "editor.path_not_full");
  EXPECT_EQ(refused(file), "editor.no_such_folder");
  EXPECT_EQ(refused((added / "none").string()), "editor.no_such_folder");
  EXPECT_EQ(refused(std::string("/tmp\0", 5)), "editor.zero_byte");

  const Json reply = page.ask({{"do", "add-folder"}, {"path", (added / ".").string()}});
  EXPECT_EQ(reply["folder"], fs::canonical(added.path()).string());
  EXPECT_EQ(reply["folders"].size(), 2U);
  EXPECT_EQ(page.ask({{"do", "add-folder"}, {"path", added.path().string()}})["folders"].size(), 2U) << "once";
  page.ask({{"do", "open"}, {"path", file}});
  Page other(editor.url());
  EXPECT_EQ(other.ask({{"do", "list"}})["folders"].size(), 2U) << "for all pages";
}

TEST(Editor, KeepsTheFoldersThatTwoPagesAddAtOnce) {
  const TemporaryFolder folder, added;
  const RunningEditor editor({folder.path()});
  Page first(editor.url()), second(editor.url());
  std::vector<int> asked_first, asked_second;
  const auto add = [&](Page& page, int k) {
    const fs::path path = added.path() / ("models " + std::to_string(k));
    fs::create_directory(path);
    return page.send({{"do", "add-folder"}, {"path", path.string()}});
  };
  for (int k = 0; k < 20; k += 2) {
    asked_first.push_back(add(first, k));
    asked_second.push_back(add(second, k + 1));
  }
  for (const int id : asked_first) EXPECT_FALSE(first.reply_to(id).contains("error"));
  for (const int id : asked_second) EXPECT_FALSE(second.reply_to(id).contains("error"));
  for (Page* page : {&first, &second}) EXPECT_EQ(page->ask({{"do", "list"}})["folders"].size(), 21U);
}

TEST(Editor, OpensAnEditFileAndWhatBelongsToIt) {
  const TemporaryFolder folder;
  bar_file(folder);
  fs::create_directory(folder / "edits");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", "bar.ply"}});
  const auto model = [&] { return page.ask({{"do", "list"}, {"folder", folder.path().string()}})["files"][0]; };
  EXPECT_FALSE(model()["unsaved"]);
  paint_top(page);
  EXPECT_TRUE(model()["unsaved"]);
  const std::vector<float> shown = page.exact(pose_top(page)["pose"]);
  page.ask({{"do", "save"}, {"edit", "edits/bar.json"}});
  EXPECT_FALSE(page.ask({{"do", "state"}})["dirty"]);
  const Json listed = page.ask({{"do", "list"}, {"folder", "edits"}});
  EXPECT_EQ(listed["files"][0]["kind"], "edit");
  EXPECT_EQ(page.ask({{"do", "list"}})["folders"].size(), 1u);

  Page other(editor.url());
  other.ask({{"do", "open"}, {"path", "edits/bar.json"}});
  const Json state = other.event("state");
  EXPECT_EQ(state["handles"][0]["name"], "top");
  EXPECT_EQ(other.exact(1), shown);
}

TEST(Editor, ListsTheFilesOfFoldersWithinTheNearestFirst) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "lamps" / "old");
  fs::create_directories(folder / ".hidden");
  for (const char* name : {"b.ply", "lamps/a.ply", "lamps/old/c.ply", ".hidden/d.ply"}) bar_file(folder, name);
  fs::create_directory_symlink(folder.path(), folder / "lamps" / "round");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  const auto names_of = [](const Json& listed) {
    std::vector<std::string> names;
    for (const Json& file : listed["files"]) names.push_back(file["name"]);
    return names;
  };
  const Json flat = page.ask({{"do", "list"}, {"folder", folder.path().string()}});
  EXPECT_EQ(names_of(flat), std::vector<std::string>{"b.ply"});
  const Json deep = page.ask({{"do", "list"}, {"folder", folder.path().string()}, {"deep", true}});
  EXPECT_EQ(names_of(deep), (std::vector<std::string>{"b.ply", "lamps/a.ply", "lamps/old/c.ply"}));
  EXPECT_EQ(deep["folders"], Json({"lamps"}));
  EXPECT_EQ(deep["whole"], true);

  fs::create_directory(folder / "lamps" / "many");
  for (int i = 0; i < 10'000; ++i) std::ofstream(folder / "lamps" / "many" / std::to_string(i));
  const Json cut = page.ask({{"do", "list"}, {"folder", folder.path().string()}, {"deep", true}});
  EXPECT_EQ(names_of(cut), (std::vector<std::string>{"b.ply", "lamps/a.ply"}));
  EXPECT_EQ(cut["whole"], false);
}

TEST(Editor, SavesWhichMethodsMadeAnEditAndTellsOfOthers) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  Json edit = Json::parse(saved(page, folder / "bar.json"));
  EXPECT_EQ(edit["made_with"]["methods"], current_methods);
  const auto notes = [&] {
    Page other(editor.url());
    return other.ask({{"do", "open"}, {"path", "bar.json"}})["notes"];
  };
  EXPECT_EQ(notes(), Json::array());
  edit["made_with"]["methods"] = current_methods + 1;
  folder.file("bar.json", edit.dump());
  ASSERT_EQ(notes().size(), 1U);
  EXPECT_EQ(notes()[0]["id"], "script.other_methods");
  edit["steps"][0]["settings"] = {{"preset", "as-published"}};
  folder.file("bar.json", edit.dump());
  EXPECT_EQ(notes(), Json::array());
}

TEST(Editor, KeepsAnUploadBesideTheEditThatNeedsIt) {
  const TemporaryFolder folder;
  const std::string model = read_file(bar_file(folder));
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  const std::string name = page.upload("from_afar.ply", model);
  page.ask({{"do", "open"}, {"upload", name}});
  paint_top(page);
  const std::vector<float> shown = page.exact(pose_top(page)["pose"]);
  fs::create_directory(folder / "edits");
  page.ask({{"do", "save"}, {"edit", "edits/afar.json"}});
  EXPECT_EQ(read_file(folder.path() / "edits" / name), model);
  const EditFile edit = read_edit_file(folder.path() / "edits" / "afar.json");
  EXPECT_EQ(edit.inputs[0].file, name);
  EXPECT_EQ(shown, as_shown(run_edit(edit).mesh.positions, page.offset()));
}

TEST(Editor, AsksBeforeItReplacesAnEditThatSomethingElseWrote) {
  const TemporaryFolder folder;
  const RunningEditor editor({folder.path()});
  const fs::path file = folder / "bar.json";
  Page page(editor.url()), other(editor.url());
  for (Page* one : {&page, &other}) {
    one->ask(open_bar);
    paint_top(*one);
  }
  saved(page, file);
  const Json exists = other.refusal({{"do", "save"}, {"edit", file.string()}});
  EXPECT_EQ(exists["id"], "io.file_exists");
  EXPECT_EQ(exists["fields"]["file"], file.string());
  pose_top(other);
  saved(other, file);
  const Json changed = page.refusal({{"do", "save"}});
  EXPECT_EQ(changed["id"], "editor.file_changed");
  EXPECT_EQ(changed["fields"]["file"], file.string());
  page.ask({{"do", "save"}, {"edit", file.string()}, {"overwrite", true}});
  pose_top(page);
  page.ask({{"do", "save"}});
}

TEST(Editor, ReplacesNothingUnasked) {
  const TemporaryFolder folder;
  bar_file(folder);
  folder.file("there.ply", "x");
  folder.file("there.json", "x");
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  page.ask({{"do", "open"}, {"path", "bar.ply"}});
  paint_top(page);
  EXPECT_EQ(page.refusal({{"do", "save"}, {"mesh", "there.ply"}})["code"], "io");
  EXPECT_EQ(page.refusal({{"do", "save"}, {"edit", "there.json"}})["code"], "io");
  EXPECT_EQ(page.refusal({{"do", "save"}, {"mesh", "bar.ply"}, {"overwrite", true}})["code"], "usage");
  EXPECT_EQ(page.refusal({{"do", "save"}})["code"], "input");
}

TEST(Editor, WritesNothingWhereItWouldBeLost) {
  const RunningEditor editor(std::vector<fs::path>{});
  Page page(editor.url());
  page.ask(open_bar);
  paint_top(page);
  EXPECT_EQ(page.refusal({{"do", "save"}, {"edit", "bar.json"}})["code"], "usage");
  EXPECT_EQ(page.refusal({{"do", "export"}, {"path", "bar.ply"}})["code"], "usage");
}

TEST(Editor, RefusesWaysOutOfItsFolders) {
  const TemporaryFolder outside, folder;
  const std::string secret = outside.file("secret.ply", read_file(bar_file(outside))).string();
  bar_file(folder);
  fs::create_symlink(secret, folder / "link.ply");
  fs::create_directory_symlink(outside.path(), folder / "folder");
  fs::create_symlink(outside / "new.ply", folder / "dangling.ply");
  fs::create_symlink(outside / "new.mtl", folder / "out.mtl");
  const std::string name = outside.path().filename().string();
  folder.file("refers.obj", "mtllib ../" + name + "/secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  outside.file("secret.mtl", "newmtl a\n");
  const std::string buffer = R"("buffers":[{"byteLength":36,"uri":"../)" + name + R"(/secret.bin"}])";
  outside.file("secret.bin", std::string(36, 'x'));
  folder.file("refers.gltf", R"({"asset":{"version":"2.0"},)" + buffer + "}");
  folder.file("other_name.ply", std::string("glTF") + std::string(40, '\0'));
  folder.file("indices.txt", "0 1 2");
  const auto edit_of = [&](const std::string& file, const std::string& region) {
    return R"({"format":"meshgraft-edit","version":2,"inputs":{"m":{"file":")" + file +
           R"("}},"steps":[{"kind":"deform","mesh":"m","region":)" + region + "}]}";
  };
  folder.file("input.json", edit_of("../" + name + "/secret.ply", "\"all\""));
  folder.file("selection.json",
              edit_of("bar.ply", R"({"file":")" + (outside / "indices.txt").string() + "\"}"));
  const RunningEditor editor({folder.path()});
  Page page(editor.url());
  for (const std::string& path :
       {secret, "../" + name + "/secret.ply", std::string("link.ply"), std::string("folder/secret.ply"),
        std::string("/etc/passwd"), std::string("refers.obj"), std::string("refers.gltf"),
        std::string("other_name.ply"), std::string("input.json"), std::string("selection.json")})
    EXPECT_EQ(page.refusal({{"do", "open"}, {"path", path}})["code"], "input") << path;
  EXPECT_EQ(page.refusal({{"do", "open"}, {"upload", "../../etc/passwd"}})["code"], "io");
  for (const char* path : {"..", "folder", "/", "/etc"})
    EXPECT_EQ(page.refusal({{"do", "list"}, {"folder", path}})["code"], "input") << path;

  page.ask(open_bar);
  paint_top(page);
  for (const std::string& path : {secret, std::string("../new.ply"), std::string("dangling.ply"),
                                  std::string("folder/new.ply"), std::string("out.obj")}) {
    EXPECT_EQ(page.refusal({{"do", "save"}, {"mesh", path}, {"overwrite", true}})["code"], "input") << path;
    EXPECT_EQ(page.refusal({{"do", "export"}, {"path", path}, {"overwrite", true}})["code"], "input") << path;
  }
  for (const char* path : {"../new.json", "folder/new.json"})
    EXPECT_EQ(page.refusal({{"do", "save"}, {"edit", path}})["code"], "input") << path;
  EXPECT_EQ(page.refusal({{"do", "save"}, {"edit", "bar.sh"}})["code"], "input");
  const Json elsewhere = {{"file", (outside / "indices.txt").string()}};
  EXPECT_EQ(page.refusal({{"do", "region"}, {"select", elsewhere}})["code"], "input");
  EXPECT_EQ(page.refusal({{"do", "select"}, {"how", "set"}, {"what", elsewhere}})["code"], "input");
  const Json def = {{"top", {{"def", (outside / "pose.def").string()}}}};
  EXPECT_EQ(page.refusal({{"do", "pose"}, {"poses", def}})["code"], "input");
  EXPECT_EQ(page.refusal({{"do", "drag"}, {"poses", def}})["code"], "input");
  page.ask({{"do", "select"}, {"how", "set"}, {"what", {{"file", "indices.txt"}}}});
  EXPECT_EQ(outside.entry_count(), 4u) << "nothing was written";
}

}  // namespace
}  // namespace meshgraft::test
