#include <meshgraft/core/error.h>

#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "core/facts.h"
#include "support/sample_fact.h"

namespace meshgraft {
namespace {

TEST(Error, JoinsThePartsThatAreGiven) {
  EXPECT_EQ(error_sentence("", "no faces", ""), "no faces");
  EXPECT_EQ(error_sentence("arm.ply", "no faces", ""), "arm.ply: no faces");
  EXPECT_EQ(error_sentence("arm.ply", "no faces", "Give a mesh."), "arm.ply: no faces. Give a mesh.");
  EXPECT_EQ(error_sentence("", "no faces", "Give a mesh."), "no faces. Give a mesh.");
}

TEST(Error, IsAFactAndALocation) {
  const Error error(facts::core::NoSuchVertex{.vertex = 9, .count = 3}, "arm.ply");
  EXPECT_EQ(error.id(), "core.no_such_vertex");
  EXPECT_EQ(error.code(), ErrorCode::input);
  EXPECT_EQ(error.fact().get<std::int64_t>("vertex"), 9);
  EXPECT_STREQ(error.what(), "arm.ply: vertex 9 does not exist; the mesh has 3. Vertices are numbered from 0.");
  EXPECT_THROW((void)error.fact().value("face"), std::out_of_range);
}

TEST(Location, IsWrittenFromTheOutsideIn) {
  const Location edit = Location::file("edit.json"), step = (edit / "steps")[2];
  EXPECT_EQ(Location().text(), "");
  EXPECT_EQ((step / "handles")[0] / "pose", (((edit / "steps")[2] / "handles")[0] / "pose"));
  EXPECT_EQ(((step / "handles")[0] / "pose").text(), "edit.json: steps[2].handles[0].pose");
  EXPECT_EQ((step / Location::handle("it's") / "axis").text(), "edit.json: steps[2]: handle 'it's'.axis");
  EXPECT_EQ((step / Location::pair(1)).text(), "edit.json: steps[2]: pair 1");
  EXPECT_EQ((step / "select" / std::filesystem::path("a.sel") / Location::place("line 3")).text(),
            "edit.json: steps[2].select: a.sel, line 3");
}

TEST(Location, IsWithinWhatItStartsWith) {
  const Location edit = Location::file("edit.json"), field = (edit / "steps")[2] / "pose";
  EXPECT_TRUE(field.starts_with(edit / "steps"));
  EXPECT_TRUE(field.starts_with(field));
  EXPECT_FALSE(edit.starts_with(field));
  EXPECT_FALSE(field.starts_with("steps"));
  EXPECT_EQ(field.from(3), "pose");
  EXPECT_TRUE(field.from(9).empty());
}

TEST(Error, WithinPutsTheOuterLocationFirst) {
  const Error inner(facts::core::NoFaces{}, Location::place("component 2"));
  const Error outer = inner.within(Location::file("edit.json")).within(Location::file("batch"));
  EXPECT_EQ(outer.fact(), inner.fact());
  EXPECT_EQ(outer.location().text(), "batch: edit.json, component 2");
  EXPECT_EQ(Error(facts::core::NoFaces{}).within(Location::file("a.ply")).location().text(), "a.ply");
  EXPECT_EQ(inner.at(Location::file("a.ply")).location().text(), "a.ply");
}

TEST(Error, EndsWithItsNotes) {
  const Error error = Error(facts::core::NoFaces{}, Location::file("arm.ply"))
                          .with(facts::core::NotFinite{.what = facts::core::Quantity::point});
  EXPECT_EQ(error.notes().size(), 1u);
  EXPECT_STREQ(error.within(Location::file("edit.json")).what(),
               "edit.json: arm.ply: the mesh has no faces. Export it with its faces. The point is not finite");
}

TEST(Error, IsCopiedWithoutThrowing) { EXPECT_TRUE(std::is_nothrow_copy_constructible_v<Error>); }

TEST(Error, EveryCodeHasItsOwnName) {
  const ErrorCode codes[] = {ErrorCode::usage,  ErrorCode::input,     ErrorCode::unsolvable, ErrorCode::io,
                             ErrorCode::memory, ErrorCode::cancelled, ErrorCode::internal};
  for (const ErrorCode a : codes)
    for (const ErrorCode b : codes) EXPECT_EQ(to_string(a) == to_string(b), a == b);
}

TEST(Fact, FillsInNumbersCountsAndLists) {
  constexpr FieldType fields[] = {{"n", FieldKind::integer},
                                  {"x", FieldKind::number},
                                  {"name", FieldKind::text},
                                  {"list", FieldKind::texts}};
  const FactType type{"test.fact", {}, fields, "", ""};
  const auto filled = [&](std::int64_t n, std::string_view text) {
    return fill_in(text, Fact(type, {n, 0.25, "arm", std::vector<std::string>{"a", "b"}}));
  };
  EXPECT_EQ(filled(1, "{n:face has|faces have} no area"), "1 face has no area");
  EXPECT_EQ(filled(3, "{n:face has|faces have} no area"), "3 faces have no area");
  EXPECT_EQ(filled(7, "{n:03d} of {x:.1e}, '{name}': {list}"), "007 of 2.5e-01, 'arm': a, b");
}

TEST(Fact, WordsAreIdentifiersAndTheLibraryHasATextForEach) {
  const Fact fact = facts::core::SizeMismatch{.what = facts::core::Rows::rest_normals, .given = 3, .needed = 4};
  EXPECT_EQ(fact.get<std::string>("what"), "rest_normals");
  EXPECT_EQ(fact.text(), "there are 3 normals at rest; 4 are needed");
  for (const FactType* type : fact_types())
    for (const FieldType& field : type->fields) {
      EXPECT_EQ(field.words.empty(), field.kind != FieldKind::word) << type->id;
      std::set<std::string_view> names;
      for (const FieldWord& word : field.words) {
        EXPECT_TRUE(names.insert(word.name).second) << type->id << ": " << word.name;
        EXPECT_EQ(word.name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), word.name.npos)
            << type->id;
        EXPECT_FALSE(word.text.empty()) << type->id << ": " << word.name;
      }
    }
}

// The library's texts are complete sentences about their fields, in the library's terms.
TEST(Fact, EveryIdHasATextWithoutFlagsOrCommands) {
  ASSERT_GT(fact_types().size(), 100u);
  for (const FactType* type : fact_types()) {
    const Fact fact = test::sample_fact(*type);
    EXPECT_FALSE(fact.text().empty()) << type->id;
    for (const std::string& text : {fact.text(), fact.remedy()}) {
      for (const FieldType& field : type->fields)
        EXPECT_EQ(text.find("{" + std::string(field.name)), std::string::npos) << type->id << ": " << text;
      EXPECT_EQ(text.find("--"), std::string::npos) << type->id << ": " << text;
      EXPECT_EQ(text.find("'meshgraft "), std::string::npos) << type->id << ": " << text;
    }
    if (const std::string remedy = fact.remedy(); !remedy.empty()) {
      EXPECT_TRUE(remedy.ends_with('.') || remedy.ends_with('?')) << type->id;
    }
  }
}

TEST(Fact, IdsAreDistinctAndSorted) {
  std::string_view before;
  for (const FactType* type : fact_types()) {
    EXPECT_NE(type->id, before);
    before = type->id;
  }
}

}  // namespace
}  // namespace meshgraft
