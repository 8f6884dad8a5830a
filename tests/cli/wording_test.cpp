#include <cstdint>
#include <fstream>
#include <regex>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>

#include "cli/facts.h"
#include "cli/wording.h"
#include "merge/facts.h"
#include "mesh/facts.h"
#include "support/paths.h"

namespace meshgraft::cli {

/// Returns the types of facts in the tables that this program compiles: the command line's and the editor's.
std::span<const FactType* const> fact_types();

namespace {

using nlohmann::json;

std::vector<const FactType*> all_types() {
  std::vector<const FactType*> types(meshgraft::fact_types().begin(), meshgraft::fact_types().end());
  types.insert(types.end(), cli::fact_types().begin(), cli::fact_types().end());
  return types;
}

FieldValue sample(const FieldType& field, std::int64_t count) {
  switch (field.kind) {
    case FieldKind::integer: return count;
    case FieldKind::number: return 0.5;
    case FieldKind::text: return "text";
    case FieldKind::integers: return std::vector<std::int64_t>{1, 2};
    case FieldKind::numbers: return std::vector<double>{0.5, 1.5};
    case FieldKind::texts: return std::vector<std::string>{"a", "b"};
    case FieldKind::word: return std::string(field.words.front().name);
  }
  return {};
}

// Returns a fact of a class whose integer fields are `count`.
Fact sample(const FactType& type, std::int64_t count) {
  std::vector<FieldValue> values;
  for (const FieldType& field : type.fields) values.push_back(sample(field, count));
  return {type, std::move(values)};
}

TEST(Wording, EveryFactHasASentence) {
  const std::regex unfilled(R"(\{[a-z0-9_]*[:}])"), of_the_library(R"(::|\b[a-z_]+\(\))");
  for (const FactType* type : all_types())
    for (const std::int64_t count : {1, 3}) {
      const Fact fact = sample(*type, count);
      const std::string text = type->code ? sentence(Error(fact, "here")) : sentence(fact);
      EXPECT_GT(text.size(), 8U) << type->id;
      EXPECT_EQ(text.starts_with("here: "), type->code.has_value()) << type->id << ": " << text;
      EXPECT_FALSE(std::regex_search(text, unfilled)) << type->id << ": " << text;
      EXPECT_FALSE(std::regex_search(text, of_the_library)) << type->id << ": " << text;
    }
}

TEST(Wording, IdsAreToldApart) {
  std::set<std::string_view> ids;
  for (const FactType* type : all_types()) EXPECT_TRUE(ids.insert(type->id).second) << type->id;
}

TEST(Wording, OwnTextsAreOfFactsThatExistAndSayAnotherThing) {
  std::set<std::string> unknown;
  const json own = json::parse(std::ifstream(test::source_path("cli/texts.json")));
  for (const auto& [id, text] : own.items()) unknown.insert(id);
  for (const FactType* type : all_types()) {
    if (unknown.erase(std::string(type->id)) == 0) continue;
    const Fact fact = sample(*type, 3);
    EXPECT_NE(sentence(fact), error_sentence({}, fact.text(), fact.remedy())) << type->id;
  }
  EXPECT_TRUE(unknown.empty()) << *unknown.begin();
}

TEST(Wording, SentencesNameFlagsAndEndWithNotes) {
  EXPECT_EQ(sentence(Error(facts::cli::NotABox{.count = 5}, "--fix")), "--fix: a box has 6 numbers, not 5");
  EXPECT_EQ(sentence(Error(facts::cli::NoOutputOfRepair{}, "repair")),
            "repair: where to? -o FILE is missing. Or look first, with --dry-run.");
  const Error found(facts::merge::FixedWhilePoseFound{}, "--fix");
  EXPECT_EQ(
      sentence(found.with(facts::mesh::FacesLeftOut{.mesh = "a.ply", .count = 2})),
      "--fix: the pose is found, so nothing stays in place. Keep the pose (--pose keep), or mark the vertices "
      "as a feature. a.ply: 2 faces that are refused were left out ('meshgraft check' names what is "
      "refused)");
  EXPECT_EQ(sentence(facts::mesh::ZeroAreaFace{.count = 1}),
            "1 face has no area. Weights and normals leave them out; the file keeps them.");
}

}  // namespace
}  // namespace meshgraft::cli
