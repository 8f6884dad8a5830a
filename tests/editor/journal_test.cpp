// Checks that a journal gives back every change whose line is whole, wherever its file is cut off.
#include "editor/journal.h"

#include <filesystem>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "editor/document_actions.h"
#include "io/file.h"
#include "io/temporary_folder.h"

namespace meshgraft::test {
namespace {

namespace fs = std::filesystem;
using editor::Document;
using editor::Journal;
using editor::Json;

Document first_document() { return editor::make_document(editor::new_edit("bar", {{"sample", "bar"}}), {}); }

Document with_handle(const Document& document, const std::string& name, int vertex) {
  Json json = document.json;
  editor::add_handle(
      json, {.name = name, .shape = "vertex", .select = {{"indices", {vertex}}}, .reach = 0.1 * vertex});
  return editor::make_document(json, {});
}

/// A journal's bytes, and the document after each of its lines.
struct Recorded {
  std::string text;
  std::vector<std::string> documents;
};

Recorded record() {
  const TemporaryFolder folder;
  Recorded recorded;
  Document one = first_document(), two = with_handle(one, "a", 1), three = with_handle(two, "b", 2);
  {
    Journal journal(folder / "bar.ply");
    journal.add("first", one.text, two.text);
    journal.add("second", two.text, three.text);
    journal.undo();
    journal.redo();
    journal.add("third", three.text, one.text);
    recorded.documents = {one.text, two.text, three.text, two.text, three.text, one.text};
    recorded.text = read_file(folder / "bar.ply.meshgraft-session");
  }
  return recorded;
}

TEST(Journal, TellsEveryWholeLineWhereverItIsCut) {
  const Recorded recorded = record();
  std::size_t lines = 0;
  for (std::size_t length = 0; length <= recorded.text.size(); ++length) {
    if (length > 0 && recorded.text[length - 1] == '\n') ++lines;
    const auto content = editor::read_journal(std::string_view(recorded.text).substr(0, length));
    ASSERT_EQ(content.has_value(), lines > 0) << length;
    if (lines > 0) {
      ASSERT_EQ(content->history.current(), recorded.documents[lines - 1]) << length;
      ASSERT_EQ(content->changes, lines - 1);
    }
  }
  EXPECT_EQ(lines, recorded.documents.size());
}

// Sessions of version 0.1 wrote the names of changes with blanks.
TEST(Journal, TellsChangesByTheirPresentNames) {
  const TemporaryFolder folder;
  const Document one = first_document(), two = with_handle(one, "a", 1);
  Journal journal(folder / "bar.ply");
  journal.add("paint handle", one.text, two.text);
  const auto content = editor::read_journal(read_file(folder / "bar.ply.meshgraft-session"));
  ASSERT_TRUE(content.has_value());
  EXPECT_EQ(content->history.label(), "paint_handle");
}

// Sessions of version 0.1 left documents and patches with a solver's former name.
TEST(Journal, TellsDocumentsThatNameASolverAsItWasCalledBefore) {
  Json settings = first_document().json;
  settings["steps"][0]["settings"]["backend"] = "cholmod";
  Json next = settings;
  next["steps"][0]["settings"]["backend"] = "eigen";
  const Json lines[] = {{{"format", "meshgraft-session"}, {"version", 1}, {"document", first_document().text}},
                        {{"label", "settings"}, {"patch", Json::diff(first_document().json, settings)}},
                        {{"label", "settings"}, {"patch", Json::diff(settings, next)}},
                        {{"label", "settings"}, {"document", settings.dump()}}};
  const char* backends[] = {"auto", "multifrontal", "eigen", "multifrontal"};
  std::string text;
  for (std::size_t line = 0; line < std::size(lines); ++line) {
    text += lines[line].dump() + '\n';
    const auto content = editor::read_journal(text);
    ASSERT_TRUE(content.has_value());
    EXPECT_EQ(content->changes, line);
    const Document document = editor::parse_document(content->history.current(), {});
    EXPECT_EQ(document.json["steps"][0]["settings"]["backend"], backends[line]);
  }
}

// Nesting without measure would end the program by its stack.
TEST(Journal, EndsWhereItIsNestedTooDeep) {
  const std::string first =
      Json{{"format", "meshgraft-session"}, {"version", 1}, {"document", first_document().text}}.dump() + '\n';
  const std::size_t depth = 100'000;
  const std::string nested = std::string(depth, '[') + std::string(depth, ']');
  const auto content = editor::read_journal(
      first + R"({"label": "a", "patch": [{"op": "add", "path": "/steps/-", "value": )" + nested + "}]}\n");
  ASSERT_TRUE(content.has_value());
  EXPECT_EQ(content->changes, 0u);
  EXPECT_EQ(content->valid_bytes, first.size());
  const std::string deep =
      Json{{"format", "meshgraft-session"}, {"version", 1}, {"document", nested}}.dump() + '\n';
  const auto of_document = editor::read_journal(deep + R"({"label": "a", "patch": []})" + '\n');
  ASSERT_TRUE(of_document.has_value());
  EXPECT_EQ(of_document->changes, 0u);
}

TEST(Journal, EndsWhereItIsDamaged) {
  const Recorded recorded = record();
  const std::size_t second = recorded.text.find('\n') + 1;
  for (std::size_t at = second; at < recorded.text.size(); at += 7) {
    std::string damaged = recorded.text;
    damaged[at] = '\x01';
    const auto content = editor::read_journal(damaged);
    ASSERT_TRUE(content);
    EXPECT_LT(content->changes, recorded.documents.size() - 1) << at;
  }
}

TEST(Journal, AppendsAfterATornLine) {
  const Recorded recorded = record();
  const TemporaryFolder folder;
  const fs::path file =
      folder.file("bar.ply.meshgraft-session", recorded.text.substr(0, recorded.text.size() - 5));
  const Document next = with_handle(first_document(), "c", 3);
  {
    Journal journal(folder / "bar.ply");
    ASSERT_TRUE(journal.found());
    EXPECT_EQ(journal.found()->changes, 4u);
    journal.take_up();
    journal.add("fourth", recorded.documents[4], next.text);
  }
  const auto content = editor::read_journal(read_file(file));
  EXPECT_EQ(content->history.current(), next.text);
  EXPECT_EQ(content->changes, 5u);
}

TEST(Journal, KeepsWhatIsPutAside) {
  const Recorded recorded = record();
  const TemporaryFolder folder;
  folder.file("bar.ply.meshgraft-session", recorded.text);
  Journal journal(folder / "bar.ply");
  const fs::path aside = journal.set_aside();
  EXPECT_EQ(read_file(aside), recorded.text);
  journal.add("first", recorded.documents[0], recorded.documents[1]);
  EXPECT_EQ(editor::read_journal(read_file(folder / "bar.ply.meshgraft-session"))->changes, 1u);
}

TEST(Journal, PutsAsideWhatItCannotRead) {
  const Recorded recorded = record();
  std::string later = recorded.text, damaged = recorded.text;
  later.replace(later.find("\"version\":1"), 11, "\"version\":2");
  damaged[0] = 'x';
  for (const std::string& text : {later, damaged, std::string("garbage"), std::string(3, '\0')}) {
    const TemporaryFolder folder;
    folder.file("bar.ply.meshgraft-session", text);
    Journal journal(folder / "bar.ply");
    EXPECT_FALSE(journal.found());
    journal.add("first", recorded.documents[0], recorded.documents[1]);
    ASSERT_EQ(journal.unreadable(), folder / "bar.ply.meshgraft-session.aside-1");
    EXPECT_EQ(read_file(journal.unreadable()), text);
    EXPECT_EQ(editor::read_journal(read_file(folder / "bar.ply.meshgraft-session"))->changes, 1u);
  }
}

TEST(Journal, TellsTheEditFileThatWasWrittenLast) {
  const Recorded recorded = record();
  const TemporaryFolder folder;
  const auto read = [&] {
    return *editor::read_journal(read_file(folder / "bar.ply.meshgraft-session"), folder.path());
  };
  Journal journal(folder / "bar.ply");
  journal.add("first", recorded.documents[0], recorded.documents[1]);
  EXPECT_FALSE(read().saved_edit);
  journal.mark_saved(folder / "edits" / "bar.json", "abc");
  journal.add("second", recorded.documents[1], recorded.documents[2]);
  ASSERT_TRUE(read().saved_edit);
  EXPECT_EQ(read().saved_edit->file, folder / "edits" / "bar.json");
  EXPECT_EQ(read().saved_edit->sha256, "abc");
  EXPECT_EQ(read().saved_edit->document, recorded.documents[1]);
  EXPECT_FALSE(read().saved);
}

TEST(Journal, IsRemovedWhenAllIsSaved) {
  const Recorded recorded = record();
  const TemporaryFolder folder;
  {
    Journal journal(folder / "bar.ply");
    journal.add("first", recorded.documents[0], recorded.documents[1]);
    journal.mark_saved();
  }
  EXPECT_EQ(folder.entry_count(), 0u);
}

/// The files are as a killed program leaves them: after all was saved, or beside another session's.
TEST(Journal, TakesAwayWhatWasSavedAndFindsTheSecondSessions) {
  const Recorded recorded = record();
  const TemporaryFolder folder;
  folder.file("bar.ply.meshgraft-session", recorded.text + "{\"saved\":true}\n");
  {
    const Journal journal(folder / "bar.ply");
    EXPECT_FALSE(journal.found());
  }
  EXPECT_EQ(folder.entry_count(), 0u);
  folder.file("bar.ply.meshgraft-session-2", recorded.text);
  Journal journal(folder / "bar.ply");
  ASSERT_TRUE(journal.found());
  EXPECT_EQ(journal.found()->changes, recorded.documents.size() - 1);
}

TEST(Journal, HasRoomBehindTheLongestName) {
  const Recorded recorded = record();
  const TemporaryFolder folder;
  const std::string name(251, 'x');
  Journal one(folder.path() / (name + ".ply")), other(folder.path() / (name + ".obj"));
  one.add("first", recorded.documents[0], recorded.documents[1]);
  other.add("first", recorded.documents[0], recorded.documents[1]);
  EXPECT_EQ(folder.entry_count(), 2u);
}

}  // namespace
}  // namespace meshgraft::test
