// Tests grafts through the engine's socket, as a page sees them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "editor/twist.h"
#include "graft_editor.h"

namespace meshgraft::test {
namespace {

Eigen::Vector3d applied(const Json& map, const Eigen::Vector3d& x) {
  Eigen::Vector3d y;
  for (int i = 0; i < 3; ++i) {
    y(i) = map[i][3].get<double>();
    for (int k = 0; k < 3; ++k) y(i) += map[i][k].get<double>() * x(k);
  }
  return y;
}

TEST_F(GraftEditor, PairsByItselfAndTellsHowSure) {
  open_bust_and_head();
  const Json event = graft({{"source", "head"}});
  ASSERT_FALSE(event.contains("error")) << event;
  EXPECT_FALSE(event["dragged"]);
  EXPECT_TRUE(event["seam"]["manifold"]);
  EXPECT_TRUE(event["seam"]["closed"]);
  EXPECT_GT(event["pairs"][0]["confidence"], 0);
  const Frame frame = shown(event);
  const Json now = state();
  EXPECT_EQ(frame.header["mesh"], now["model"]["mesh"]);
  EXPECT_EQ(frame.header["source"], now["parts"][0]["mesh"]);
  EXPECT_EQ(now["graft"]["step"]["source"], "head");
  EXPECT_EQ(now["graft"]["graft"], event["graft"]);
  const std::string& origin = frame.bytes.at("origin");
  EXPECT_EQ(3 * origin.size(), frame.indices.at("triangles").size());
  EXPECT_EQ(std::count(origin.begin(), origin.end(), '\2'), event["seam"]["new_faces"].get<int>());
  EXPECT_GT(std::count(origin.begin(), origin.end(), '\0'), 100);
  EXPECT_GT(std::count(origin.begin(), origin.end(), '\1'), 100);
  EXPECT_EQ(frame.indices.at("line_sources"), boundary_loops(make_sample("head", 18))[0]);
  EXPECT_EQ(frame.numbers.at("line_places").size(), 3 * frame.indices.at("line_sources").size());
  expect_replayed(frame);
}

TEST_F(GraftEditor, ShowsTheShapeBeforeTheDeformation) {
  open_bust_and_head();
  const Json event = graft({{"source", "head"}});
  ASSERT_FALSE(event.contains("error")) << event;
  const Frame frame = shown(event);
  const Points head = make_sample("head", 18).positions;
  const std::vector<float>& rest = frame.numbers.at("rest");
  ASSERT_EQ(rest.size(), frame.numbers.at("positions").size());
  const auto distance_to_rest = [&](const Eigen::Vector3d& point) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < rest.size(); k += 3) {
      const Eigen::Vector3d at(rest[k], rest[k + 1], rest[k + 2]);
      const Eigen::Vector3d offset(frame.header["offset"][0], frame.header["offset"][1],
                                   frame.header["offset"][2]);
      least = std::min(least, (at + offset - point).norm());
    }
    return least;
  };
  for (const auto& point : head.rowwise())
    ASSERT_LT(distance_to_rest(applied(event["transform"], point.transpose())), 1e-5);
}

TEST_F(GraftEditor, TellsTheStartsThatOneMayMean) {
  page_.ask({{"do", "open"}, {"sample", "cylinder"}, {"resolution", 20}});
  page_.ask({{"do", "part"}, {"what", "add"}, {"sample", "cylinder"}, {"resolution", 20}, {"name", "tube"}});
  const Json pair = {{"source_loop", loop_0}, {"target_loop", {{"loop", 1}}}};
  const Json event = graft({{"source", "tube"}, {"pairs", {pair}}});
  ASSERT_FALSE(event.contains("error")) << event;
  const Json& found = event["pairs"][0];
  ASSERT_GT(found["starts"].size(), 1U) << "circles fit from any start";
  EXPECT_EQ(found["starts"][0]["probability"], found["confidence"]);
  Json given = pair;
  given["start"] = found["starts"][1]["start"];
  const Json other = graft({{"pairs", {given}}});
  EXPECT_EQ(other["pairs"][0]["confidence"], 1);
  EXPECT_TRUE(other["pairs"][0]["starts"].empty());
}

TEST_F(GraftEditor, PairsByHand) {
  page_.ask({{"do", "open"}, {"sample", "posts"}, {"resolution", 24}});
  page_.ask({{"do", "part"}, {"what", "add"}, {"sample", "bracket"}, {"resolution", 28}});
  const Json unclear = graft(Json::object());
  EXPECT_EQ(unclear["error"]["code"], "input") << "which loops meet is not clear";
  EXPECT_FALSE(unclear["error"]["remedy"].empty());
  EXPECT_EQ(page_.refusal({{"do", "accept"}})["code"], "input");

  // Pairs loops by their length, wide ones with wide ones.
  const Json posts = page_.ask({{"do", "loops"}})["loops"];
  const Json bracket = page_.ask({{"do", "loops"}, {"mesh", "bracket"}})["loops"];
  const auto by_length = [](const Json& loops) {
    std::vector<std::size_t> order{0, 1, 2, 3};
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return loops[a]["length"] < loops[b]["length"]; });
    return order;
  };
  Json pairs = Json::array();
  for (std::size_t k = 0; k < 4; ++k)
    pairs.push_back(
        {{"source_loop", {{"loop", by_length(bracket)[k]}}}, {"target_loop", {{"loop", by_length(posts)[k]}}}});
  const Json event = graft({{"pairs", pairs}});
  ASSERT_FALSE(event.contains("error")) << event;
  EXPECT_EQ(event["pairs"].size(), posts.size());
  const Frame frame = shown(event);
  EXPECT_EQ(frame.indices.at("line_pairs").back(), static_cast<int>(posts.size()) - 1);
  expect_replayed(frame);
}

TEST_F(GraftEditor, FollowsTheStartAndTheMatches) {
  open_bust_and_head();
  const Json found = graft({{"source", "head"}});
  const auto sources = boundary_loops(make_sample("head", 18))[0],
             targets = boundary_loops(make_sample("bust", 20))[0];
  const auto start_place = [&](const Json& event) {
    const Frame frame = shown(event);
    const auto& lines = frame.indices.at("line_sources");
    const auto at = std::find(lines.begin(), lines.end(), sources[0]) - lines.begin();
    Eigen::Vector3d place;
    for (int k = 0; k < 3; ++k)
      place(k) = frame.numbers.at("line_places")[static_cast<std::size_t>(3 * at + k)] +
                 frame.header["offset"][k].get<double>();
    return place;
  };
  const Points points = make_sample("bust", 20).positions;
  for (const std::size_t t : {std::size_t{0}, targets.size() / 3}) {
    const Json pairs =
        Json::array({{{"source_loop", loop_0}, {"target_loop", loop_0}, {"start", {sources[0], targets[t]}}}});
    const Json event = graft({{"pairs", pairs}});
    ASSERT_FALSE(event.contains("error")) << event;
    EXPECT_EQ(event["pairs"][0]["confidence"], 1) << "it was given";
    EXPECT_LT((start_place(event) - points.row(targets[t]).transpose()).norm(), 1e-5);
  }
  const Json crossed = graft(
      {{"pairs",
        {{{"source_loop", loop_0},
          {"target_loop", loop_0},
          {"matches", {{sources[0], targets[0]}, {sources[5], targets[4]}, {sources[9], targets[8]}}}}}}});
  EXPECT_EQ(crossed["error"]["code"], "input") << crossed;
  const Json again = graft({{"pairs", nullptr}});
  EXPECT_EQ(again["pairs"], found["pairs"]) << "automatic when left alone";
  for (const Json& fields :
       {Json{{"pairs", 3}}, Json{{"size", -1}}, Json{{"normal_angle_deg", 500}}, Json{{"shape", "round"}},
        Json{{"source", 4}}, Json{{"source", "none"}}, Json{{"source", "bust"}}, Json{{"target", nullptr}},
        Json{{"nose", 1}}, Json{{"pose", "keep"}, {"size", 2}}, Json{{"what", "fly"}},
        Json{{"what", "swap"}, {"size", 2}}, Json{{"settings", {{"nose", 1}}}}}) {
    Json request = fields;
    for (const char* what : {"graft", "graft-drag"}) {
      request["do"] = what;
      EXPECT_EQ(page_.refusal(request)["code"], "input") << request;
    }
  }
  EXPECT_EQ(page_.refusal({{"do", "graft"}, {"fixed", true}})["code"], "usage") << "nothing is selected";
}

TEST_F(GraftEditor, SlidersChangeWhatIsShown) {
  open_bust_and_head();
  std::vector<std::vector<float>> outcomes{shown(graft({{"source", "head"}})).numbers.at("positions")};
  const auto take = [&](const Json& fields) {
    const Json event = graft(fields);
    ASSERT_FALSE(event.contains("error")) << fields << event;
    outcomes.push_back(shown(event).numbers.at("positions"));
  };
  take({{"normal_angle_deg", 25}});
  take({{"shape", "ft05"}});
  take({{"normal_angle_deg", nullptr},
        {"shape", nullptr},
        {"mirror", {{"point", {0, 0, 0}}, {"normal", {1, 0, 0}}}}});
  take({{"mirror", nullptr}, {"size", 0.8}});
  take({{"size", nullptr}, {"settings", {{"fairings", 0}}}});
  for (std::size_t a = 0; a < outcomes.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) EXPECT_NE(outcomes[a], outcomes[b]) << a << " " << b;
  take({{"settings", {{"fairings", 2}}}});
  EXPECT_EQ(outcomes.back(), outcomes.front());
  EXPECT_EQ(state()["graft"]["step"]["settings"]["fairings"], 2);
}

TEST_F(GraftEditor, KeepsAPoseAndWhatIsFixed) {
  open_bust_and_head();
  page_.ask({{"do", "select"},
             {"mesh", "head"},
             {"how", "set"},
             {"what", {{"half_space", {{"point", {0, 0, 0.3}}, {"normal", {0, 0, 1}}}}}}});
  const Json posed = {{1, 0, 0, 0.1}, {0, 1, 0, 0}, {0, 0, 1, 0.3}, {0, 0, 0, 1}};
  const Json event =
      graft({{"source", "head"}, {"pose", "keep"}, {"source_transform", posed}, {"fixed", true}});
  ASSERT_FALSE(event.contains("error")) << event;
  const Frame frame = shown(event);
  const Mesh head = make_sample("head", 18), merged = expect_replayed(frame);
  const Index behind = merged.vertex_count() - head.vertex_count();
  int moved = 0;
  for (Index v = 0; v < head.vertex_count(); ++v) {
    if (head.positions(v, 2) < 0.31) continue;
    const Eigen::RowVector3d there = head.positions.row(v) + Eigen::RowVector3d(0.1, 0, 0.3);
    double nearest = 1e9;
    for (Index w = std::max(Index{0}, behind - 400); w < merged.vertex_count(); ++w)
      nearest = std::min(nearest, (merged.positions.row(w) - there).norm());
    moved += nearest > 1e-12 ? 1 : 0;
  }
  EXPECT_EQ(moved, 0) << "what was painted stays where it was posed";
  page_.ask({{"do", "select"}, {"how", "set"}, {"what", {{"indices", {1}}}}});
  EXPECT_EQ(page_.refusal({{"do", "graft"}, {"fixed", true}})["code"], "usage") << "on the other object";
}

TEST_F(GraftEditor, DropsAPartOnTheSurface) {
  page_.ask({{"do", "open"}, {"sample", "bar"}, {"resolution", 20}});
  add_head();
  const Json reply =
      page_.ask({{"do", "graft-drag"}, {"source", "head"}, {"at", {{"point", {0.5, 0, 2}}}}, {"size", 0.8}});
  const Mesh head = make_sample("head", 18);
  const auto loop = boundary_loops(head)[0];
  const Eigen::Vector3d stands = applied(reply["transform"], head.positions(loop, Eigen::all).colwise().mean());
  EXPECT_LT((stands - Eigen::Vector3d(0.5, 0, 2)).norm(), 0.05) << stands;
  const Json dragged = told(reply["graft"]);
  ASSERT_FALSE(dragged.contains("error")) << dragged;
  EXPECT_TRUE(dragged["dragged"]);
  EXPECT_EQ(state()["graft"], nullptr) << "a drag is no part of the document";
  const std::vector<float> there = shown(dragged).numbers.at("positions");

  const Json spun = page_.ask({{"do", "graft-drag"},
                               {"source", "head"},
                               {"at", {{"point", {0.5, 0, 2}}, {"spin_deg", 90}}},
                               {"size", 0.4}});
  EXPECT_NE(spun["transform"], reply["transform"]);
  const Json event = graft({{"source", "head"}, {"at", {{"point", {0.5, 0, 2}}}}, {"size", 0.8}});
  const Frame frame = shown(event);
  EXPECT_EQ(frame.numbers.at("positions"), there);
  EXPECT_NEAR(event["size"].get<double>(), 0.8, 0.05);
  expect_replayed(frame);

  const Json off = page_.ask({{"do", "graft-drag"}, {"at", {{"point", {9, 9, 9}}}}});
  EXPECT_FALSE(off.contains("transform"));
  EXPECT_EQ(told(off["graft"])["error"]["code"], "input");
  const Json back = told(page_.ask({{"do", "graft-drag"}})["graft"]);
  EXPECT_FALSE(back["dragged"]);
  EXPECT_EQ(shown(back).numbers.at("positions"), there) << "as the document has it";
  page_.ask({{"do", "graft"}, {"what", "cancel"}});
  EXPECT_EQ(page_.ask({{"do", "graft-drag"}})["graft"], 0) << "nothing is shown";
}

TEST_F(GraftEditor, OpensAClosedPartWhereItIsDropped) {
  page_.ask({{"do", "open"}, {"sample", "bar"}, {"resolution", 16}});
  page_.ask({{"do", "part"}, {"what", "add"}, {"sample", "cactus"}, {"resolution", 24}});
  const Json at = {{"point", {0.5, 0, 2}}};
  const Json reply = page_.ask({{"do", "graft-drag"}, {"source", "cactus"}, {"at", at}, {"size", 0.3}});
  EXPECT_TRUE(reply.contains("transform"));
  const Json dragged = told(reply["graft"]);
  ASSERT_FALSE(dragged.contains("error")) << dragged;
  EXPECT_EQ(dragged["base"]["loops"], 1);
  const double height = dragged["base"]["height"];
  EXPECT_GT(height, 0);
  EXPECT_EQ(state()["graft"], nullptr) << "a drag is no part of the document";

  Json higher = at;
  higher["base"] = {{"height", 3 * height}};
  const Json raised =
      told(page_.ask({{"do", "graft-drag"}, {"source", "cactus"}, {"at", higher}, {"size", 0.3}})["graft"]);
  EXPECT_EQ(raised["base"]["height"], 3 * height);
  EXPECT_LT(shown(raised).numbers.at("positions").size(), shown(dragged).numbers.at("positions").size());
  const Json kept = graft({{"source", "cactus"}, {"at", higher}, {"size", 0.3}});
  expect_replayed(shown(kept));

  higher["base"] = {{"height", 1e6}};
  const Json outside = page_.ask({{"do", "graft-drag"}, {"at", higher}});
  EXPECT_EQ(told(outside["graft"])["error"]["id"], "merge.base_height_outside");
  page_.ask({{"do", "graft"}, {"what", "cancel"}});
  EXPECT_EQ(page_.ask({{"do", "graft-drag"}})["graft"], 0) << "nothing is shown";
  EXPECT_EQ(state()["graft"], nullptr);
}

TEST_F(GraftEditor, SupersedesPreviews) {
  open_bust_and_head();
  page_.ask({{"do", "graft"}, {"source", "head"}});
  int last = 0;
  for (int angle = 1; angle <= 60; ++angle)
    last = page_.send({{"do", "graft-drag"}, {"normal_angle_deg", angle}});
  const Json number = page_.reply_to(last)["result"]["graft"];
  int seen = 0;
  Json event;
  do {
    event = page_.event("graft");
    ++seen;
  } while (event["graft"] != number);
  EXPECT_LT(seen, 30) << "those between are not shown";
  const std::vector<float> dragged = shown(event).numbers.at("positions");
  EXPECT_EQ(state()["graft"]["step"].contains("normal_angle_deg"), false);
  EXPECT_EQ(shown(graft({{"normal_angle_deg", 60}})).numbers.at("positions"), dragged);
}

TEST_F(GraftEditor, AcceptsWithOneClickAndGoesOn) {
  open_bust_and_head();
  const Frame frame = shown(graft({{"source", "head"}}));
  for (const Json& request :
       {Json{{"do", "paint-handle"}, {"vertices", {0, 1}}}, Json{{"do", "region"}, {"select", "all"}},
        Json{{"do", "settings"}, {"settings", {{"stiffness", 1}}}},
        Json{{"do", "cut"}, {"plane", {{"point", {0, 0, 0}}, {"normal", {0, 0, 1}}}}},
        Json{{"do", "part"}, {"what", "edit"}, {"name", "head"}}}) {
    const Json error = page_.refusal(request);
    EXPECT_EQ(error["code"], "usage") << request;
    EXPECT_EQ(error["id"], "editor.graft_in_work");
    EXPECT_EQ(error["remedy"], "Accept or cancel it first.");
  }
  EXPECT_EQ(page_.refusal({{"do", "part"}, {"what", "remove"}, {"name", "head"}})["code"], "input");
  const Json pose = page_.ask({{"do", "accept"}})["pose"];
  const std::vector<float>& exact = page_.exact(pose);
  const std::vector<float>& previewed = frame.numbers.at("positions");
  ASSERT_EQ(exact.size(), previewed.size());
  for (std::size_t i = 0; i < exact.size(); ++i)
    ASSERT_NEAR(exact[i] + page_.offset()[i % 3], previewed[i] + frame.header["offset"][i % 3].get<double>(),
                1e-6);
  const Json accepted = state();
  EXPECT_EQ(accepted["graft"], nullptr);
  EXPECT_EQ(accepted["model"]["name"], "bust");
  EXPECT_EQ(accepted["model"]["vertices"], frame.header["vertices"]);
  EXPECT_EQ(accepted["model"]["loops"], 0);
  EXPECT_TRUE(accepted["parts"][0]["grafted"]);
  EXPECT_EQ(page_.refusal({{"do", "graft"}})["code"], "input") << "no part is left";

  double highest = -1e9;
  page_.vertices([&](double, double, double z) {
    highest = std::max(highest, z);
    return false;
  });
  const std::vector<int> top = page_.vertices([&](double, double, double z) { return z > highest - 0.2; });
  page_.ask({{"do", "paint-handle"}, {"vertices", top}, {"name", "crown"}});
  const Json bent = page_.ask({{"do", "pose"}, {"poses", {{"crown", {{"translate", {0.2, 0, 0}}}}}}})["pose"];
  const std::vector<float> shown_bent = page_.exact(bent);
  EXPECT_NE(shown_bent, frame.numbers.at("positions"));
  expect_replayed(shown_bent, page_.offset());
}

TEST_F(GraftEditor, UndoesToTheFirstBytes) {
  open_bust();
  const std::string first = saved("first.json");
  add_head();
  page_.ask({{"do", "cut"},
             {"mesh", "head"},
             {"plane", {{"point", {0, 0, -0.3}}, {"normal", {0, 0, 1}}}},
             {"keep", "above"}});
  page_.ask({{"do", "graft"}});
  page_.ask({{"do", "graft"}, {"normal_angle_deg", 10}});
  const std::vector<float> grafted = page_.exact(page_.ask({{"do", "accept"}})["pose"]);
  const std::string last = saved("last.json");
  const std::vector<std::string> labels{"accept", "graft", "start_graft", "cut", "add_part"};
  for (const std::string& label : labels) {
    EXPECT_EQ(state()["undo"], label);
    page_.ask({{"do", "undo"}});
  }
  EXPECT_EQ(saved("again.json"), first);
  EXPECT_EQ(state()["graft"], nullptr);
  Json pose;
  for (std::size_t k = 0; k < labels.size(); ++k) pose = page_.ask({{"do", "redo"}})["pose"];
  EXPECT_EQ(page_.exact(pose), grafted);
  EXPECT_EQ(saved("again.json"), last);
  page_.ask({{"do", "reset"}});
  EXPECT_EQ(saved("again.json"), first);
}

TEST_F(GraftEditor, CancelsAndSwaps) {
  open_bust_and_head();
  const std::string before = saved("before.json");
  EXPECT_EQ(page_.refusal({{"do", "graft"}, {"what", "cancel"}})["code"], "usage");
  EXPECT_EQ(page_.refusal({{"do", "graft"}, {"what", "swap"}})["code"], "usage");
  const Json start = {boundary_loops(make_sample("head", 18))[0][0],
                      boundary_loops(make_sample("bust", 20))[0][0]};
  const Json one = graft({{"pairs", {{{"source_loop", loop_0}, {"target_loop", loop_0}, {"start", start}}}}});
  const Json swapped = graft({{"what", "swap"}});
  ASSERT_FALSE(swapped.contains("error")) << swapped;
  EXPECT_NE(swapped["pairs"], one["pairs"]);
  EXPECT_EQ(state()["model"]["name"], "head");
  EXPECT_EQ(state()["graft"]["step"]["source"], "bust");
  expect_replayed(shown(swapped));
  page_.ask({{"do", "graft"}, {"what", "swap"}});
  page_.ask({{"do", "graft"}, {"what", "cancel"}});
  EXPECT_EQ(saved("after.json"), before);
  page_.ask({{"do", "part"}, {"what", "edit"}, {"name", "head"}});
  EXPECT_EQ(state()["model"]["name"], "head");
  EXPECT_EQ(state()["parts"][0]["name"], "bust");
}

TEST_F(GraftEditor, AddsAndCancelsADroppedPartByOneChange) {
  page_.ask({{"do", "open"}, {"sample", "bar"}, {"resolution", 20}});
  const Json drop = {{"do", "graft"}, {"source", "head"}, {"at", {{"point", {0.5, 0, 2}}}}};
  Json dropped = drop;
  dropped["with_part"] = true;
  const auto has_part = [&] { return !state()["parts"].empty(); };
  add_head();
  page_.ask(dropped);
  EXPECT_EQ(state()["undo"], "drop_part");
  page_.ask({{"do", "undo"}});
  EXPECT_FALSE(has_part());
  EXPECT_TRUE(state()["undo"].is_null());
  page_.ask({{"do", "redo"}});
  EXPECT_FALSE(state()["graft"].is_null());
  EXPECT_EQ(page_.refusal({{"do", "graft"}, {"what", "cancel"}, {"with_part", true}})["code"], "input");
  page_.ask({{"do", "graft"}, {"what", "cancel"}});
  EXPECT_FALSE(has_part());
  page_.ask({{"do", "undo"}});
  EXPECT_FALSE(state()["graft"].is_null()) << "one change, which undo takes back";
  page_.ask({{"do", "graft"}, {"what", "cancel"}});
  EXPECT_FALSE(has_part());

  add_head();
  page_.ask(drop);
  page_.ask({{"do", "graft"}, {"what", "cancel"}});
  EXPECT_TRUE(has_part()) << "a part that was there before stays";
}

TEST_F(GraftEditor, WithdrawsAPartThatWasNotDropped) {
  page_.ask({{"do", "open"}, {"sample", "bar"}, {"resolution", 20}});
  add_head();
  EXPECT_EQ(page_.refusal({{"do", "part"}, {"what", "withdraw"}, {"name", "other"}})["code"], "input");
  page_.ask({{"do", "part"}, {"what", "withdraw"}, {"name", "head"}});
  EXPECT_TRUE(state()["parts"].empty());
  EXPECT_TRUE(state()["undo"].is_null());
  EXPECT_TRUE(state()["redo"].is_null()) << "nothing is left to redo";
}

TEST_F(GraftEditor, ADropTakesInOnlyItsOwnPart) {
  page_.ask({{"do", "open"}, {"sample", "bar"}, {"resolution", 20}});
  add_head();
  page_.ask({{"do", "part"}, {"what", "add"}, {"sample", "bust"}, {"resolution", 20}});
  page_.ask({{"do", "graft"}, {"source", "head"}, {"at", {{"point", {0.5, 0, 2}}}}, {"with_part", true}});
  EXPECT_EQ(state()["undo"], "start_graft") << "the bust was added last, not the head";
}

TEST_F(GraftEditor, ClosesCutsWithPins) {
  page_.ask({{"do", "open"}, {"sample", "bar"}, {"resolution", 20}});
  page_.ask({{"do", "cut"},
             {"plane", {{"point", {0, 0, 2}}, {"normal", {0, 0, 1}}}},
             {"keep", "below"},
             {"pins", {{"count", 1}}}});
  EXPECT_EQ(state()["model"]["loops"], 0);
  const int pinned = state()["model"]["vertices"];
  page_.ask(
      {{"do", "step"}, {"what", "change"}, {"index", 0}, {"fields", {{"pins", nullptr}, {"cap", "flat"}}}});
  EXPECT_EQ(state()["model"]["loops"], 0);
  EXPECT_EQ(state()["model"]["vertices"], pinned - 97) << "three rings of 32 vertices, and one at the end";
}

TEST_F(GraftEditor, OpensAGraftThatWasSaved) {
  open_bust_and_head();
  const Frame frame = shown(graft({{"source", "head"}, {"normal_angle_deg", 5}}));
  saved("graft.json");
  Page other(editor_.url());
  other.ask({{"do", "open"}, {"path", "graft.json"}, {"resume", true}});
  const Json now = other.ask({{"do", "state"}});
  EXPECT_EQ(now["graft"]["step"]["normal_angle_deg"], 5);
  EXPECT_EQ(now["model"]["name"], "bust");
  EXPECT_EQ(other.frame(6).numbers.at("positions"), frame.numbers.at("positions"));
}

TEST_F(GraftEditor, AnOpenedGraftIsAcceptedAndCanBeEditedAgain) {
  open_bust_and_head();
  const Frame frame = shown(graft({{"source", "head"}}));
  saved("graft.json");
  Page other(editor_.url());
  other.ask({{"do", "open"}, {"path", "graft.json"}});
  const Json opened = other.ask({{"do", "state"}});
  EXPECT_EQ(opened["graft"], Json());
  EXPECT_EQ(opened["dirty"], false);
  EXPECT_EQ(opened["model"]["vertices"], frame.header["vertices"]);
  other.ask({{"do", "graft"}, {"what", "resume"}});
  const Json resumed = other.ask({{"do", "state"}});
  EXPECT_EQ(resumed["graft"]["step"]["source"], "head");
  EXPECT_EQ(resumed["undo"], "resume_graft");
  EXPECT_EQ(other.refusal({{"do", "graft"}, {"what", "resume"}})["id"], "editor.no_graft_to_resume");
  other.ask({{"do", "undo"}});
  EXPECT_EQ(other.ask({{"do", "state"}})["graft"], Json());
}

/// The first step is a graft; the second cuts its result.
TEST_F(GraftEditor, EarlierCutsAndGraftsChangeAndTheLaterStepsFollow) {
  open_bust_and_head();
  ASSERT_FALSE(graft({{"source", "head"}}).contains("error"));
  page_.ask({{"do", "accept"}});
  page_.ask({{"do", "cut"}, {"plane", {{"point", {0.01, 0, 0}}, {"normal", {1, 0, 0}}}}, {"keep", "above"}});
  const auto change = [&](std::size_t index, const Json& fields) {
    return Json{{"do", "step"}, {"what", "change"}, {"index", index}, {"fields", fields}};
  };
  const auto lowest_x = [&] {
    double least = 1e9;
    page_.vertices([&](double x, double, double) {
      least = std::min(least, x);
      return false;
    });
    return least;
  };
  const Json found = state()["steps"][0]["found"];
  EXPECT_GT(found["size"], 0);
  ASSERT_EQ(found["starts"].size(), 1U);
  EXPECT_NEAR(lowest_x(), 0.01, 1e-6);
  page_.ask(change(1, {{"plane", {{"point", {-0.05, 0, 0}}, {"normal", {1, 0, 0}}}}, {"snap", 0.2}}));
  EXPECT_NEAR(lowest_x(), -0.05, 1e-6);
  page_.ask(change(1, {{"keep", "below"}}));
  EXPECT_LT(lowest_x(), -0.1);
  page_.ask({{"do", "undo"}});
  EXPECT_NEAR(lowest_x(), -0.05, 1e-6);

  const double twice = 1.5 * found["size"].get<double>();
  page_.ask(change(0, {{"size", twice}, {"normal_angle_deg", 10}}));
  EXPECT_NEAR(state()["steps"][0]["found"]["size"].get<double>(), twice, 1e-6);
  const Json before = state();
  const Json refused =
      page_.refusal(change(0, {{"pairs", {{{"source_loop", {{"loop", 7}}}, {"target_loop", loop_0}}}}}));
  EXPECT_EQ(refused["id"], "script.no_such_loop") << refused;
  EXPECT_EQ(refused["step"], 0);
  EXPECT_EQ(state(), before) << "nothing is lost";

  page_.ask({{"do", "step"}, {"what", "change"}, {"index", 0}, {"twist", {{"pair", 0}, {"by_deg", 90}}}});
  const Json turned = state()["steps"][0];
  ASSERT_EQ(turned["fields"]["matches"].size(), 1U);
  EXPECT_NE(turned["found"]["starts"], before["steps"][0]["found"]["starts"]);
  page_.ask({{"do", "step"}, {"what", "change"}, {"index", 0}, {"twist", {{"pair", 0}, {"by_deg", -90}}}});
  EXPECT_NE(page_.refusal(
                {{"do", "step"}, {"what", "change"}, {"index", 0}, {"twist", {{"pair", 1}, {"by_deg", 1}}}}),
            Json());
}

/// The first step is a graft; the second cuts its result, and the third shapes it.
class GraftWithLaterSteps : public GraftEditor {
 protected:
  void SetUp() override {
    GraftEditor::SetUp();
    open_bust_and_head();
    EXPECT_FALSE(graft({{"source", "head"}}).contains("error"));
    page_.ask({{"do", "accept"}});
    page_.ask({{"do", "cut"}, {"plane", {{"point", {0.3, 0, 0}}, {"normal", {1, 0, 0}}}}, {"keep", "below"}});
    page_.ask(
        {{"do", "sculpt"}, {"action", "inflate"}, {"height", 0.01}, {"select", {{"indices", {0, 1, 2}}}}});
    accepted_ = state();
  }

  static std::vector<std::string> kinds(const Json& steps) {
    std::vector<std::string> list;
    for (const Json& step : steps) list.push_back(step["kind"]);
    return list;
  }

  Json resume() { return page_.ask({{"do", "graft"}, {"what", "resume"}, {"step", 0}}); }

  Json accepted_;
};

TEST_F(GraftWithLaterSteps, SetsThemAsideWhileTheGraftIsEditedAgain) {
  resume();
  const Json resumed = state();
  EXPECT_EQ(kinds(resumed["steps"]), std::vector<std::string>{"merge"});
  EXPECT_EQ(kinds(resumed["graft"]["set_aside"]), (std::vector<std::string>{"cut", "sculpt"}));
  const Json event = graft({{"normal_angle_deg", 12}});
  EXPECT_FALSE(event.contains("error")) << event;
  EXPECT_EQ(state()["graft"]["set_aside"], resumed["graft"]["set_aside"]);
  page_.ask({{"do", "accept"}});
  const Json now = state();
  EXPECT_EQ(kinds(now["steps"]), kinds(accepted_["steps"]));
  EXPECT_EQ(now["graft"], Json());
  EXPECT_EQ(now["steps"][0]["fields"]["normal_angle_deg"], 12);
  EXPECT_EQ(now["steps"][1]["fields"], accepted_["steps"][1]["fields"]);
  page_.ask({{"do", "undo"}});
  EXPECT_EQ(state()["graft"]["set_aside"], resumed["graft"]["set_aside"]);
}

TEST_F(GraftWithLaterSteps, CancelBringsAllBack) {
  resume();
  graft({{"normal_angle_deg", 12}});
  page_.ask({{"do", "graft"}, {"what", "cancel"}});
  const Json now = state();
  EXPECT_EQ(now["steps"], accepted_["steps"]);
  EXPECT_EQ(now["undo"], "cancel_graft");
  EXPECT_EQ(now["model"]["vertices"], accepted_["model"]["vertices"]);
}

TEST_F(GraftWithLaterSteps, AcceptIsRefusedWhereALaterStepNoLongerApplies) {
  double highest = -1e9;
  page_.vertices([&](double, double, double z) {
    highest = std::max(highest, z);
    return false;
  });
  page_.ask({{"do", "step"},
             {"what", "change"},
             {"index", 1},
             {"fields", {{"plane", {{"point", {0, 0, highest - 0.02}}, {"normal", {0, 0, 1}}}}}}});
  accepted_ = state();
  resume();
  const Json event = graft({{"size", 0.05}});
  const Json before = state();
  const Json refused = page_.refusal({{"do", "accept"}});
  EXPECT_EQ(refused["step"], 1) << refused << event;
  EXPECT_EQ(state(), before) << "the graft is still edited";
  page_.ask({{"do", "graft"}, {"what", "cancel"}});
  EXPECT_EQ(state()["steps"], accepted_["steps"]);
}

TEST_F(GraftWithLaterSteps, AreSavedWhileTheyAreSetAside) {
  resume();
  saved("aside.json");
  Page other(editor_.url());
  other.ask({{"do", "open"}, {"path", "aside.json"}});
  EXPECT_EQ(kinds(other.ask({{"do", "state"}})["steps"]), (std::vector<std::string>{"merge", "cut", "sculpt"}));
}

TEST_F(GraftWithLaterSteps, KeepTheGraftTheyWorkOn) {
  EXPECT_EQ(page_.refusal({{"do", "graft"}, {"what", "resume"}, {"step", 1}})["id"],
            "editor.no_graft_to_resume");
  resume();
  EXPECT_EQ(page_.refusal({{"do", "graft"}, {"what", "swap"}})["id"], "editor.steps_set_aside");
  EXPECT_EQ(page_.refusal({{"do", "step"}, {"what", "remove"}, {"index", 0}})["id"], "editor.steps_set_aside");
}

TEST_F(GraftWithLaterSteps, CancelKeepsWhatElseWasChangedMeanwhile) {
  const Json before = page_.ask({{"do", "state"}});
  resume();
  graft({{"normal_angle_deg", 12}});
  page_.ask({{"do", "group"}, {"name", "crown"}, {"select", {{"indices", {3, 4}}}}});
  page_.ask({{"do", "part"}, {"what", "add"}, {"sample", "bar"}, {"resolution", 4}});
  page_.ask({{"do", "graft"}, {"what", "cancel"}});
  const Json now = state();
  EXPECT_EQ(now["steps"], accepted_["steps"]);
  EXPECT_EQ(now["groups"].size(), before["groups"].size() + 1);
  EXPECT_EQ(now["parts"].size(), before["parts"].size() + 1);
  page_.ask({{"do", "undo"}});
  EXPECT_EQ(state()["graft"]["step"]["normal_angle_deg"], 12);
}

TEST_F(GraftWithLaterSteps, KeepTheOtherStepsAndWhatTheyUse) {
  page_.ask({{"do", "part"}, {"what", "add"}, {"sample", "bar"}, {"resolution", 4}});
  page_.ask({{"do", "cut"}, {"plane", {{"point", {-0.3, 0, 0}}, {"normal", {1, 0, 0}}}}, {"keep", "above"}});
  page_.ask({{"do", "group"}, {"name", "chest"}, {"select", {{"indices", {5, 6, 7}}}}});
  page_.ask({{"do", "sculpt"}, {"action", "inflate"}, {"height", 0.01}, {"select", "chest"}});
  resume();
  const Json before = state();
  const Json renamed = page_.refusal({{"do", "step"}, {"what", "rename"}, {"index", 0}, {"name", "neck"}});
  EXPECT_EQ(renamed["id"], "editor.steps_set_aside");
  EXPECT_EQ(page_.refusal({{"do", "group"}, {"name", "chest"}, {"remove", true}})["id"],
            "editor.selection_in_use");
  EXPECT_EQ(page_.refusal({{"do", "part"}, {"what", "remove"}, {"name", "head"}})["id"], "editor.part_in_use");
  EXPECT_EQ(state(), before);
  page_.ask({{"do", "part"}, {"what", "remove"}, {"name", "bar"}});
}

TEST_F(GraftEditor, StepsBeforeAGraftStayAsTheyAreWhileItIsEditedAgain) {
  open_bust_and_head();
  page_.ask({{"do", "sculpt"}, {"action", "inflate"}, {"height", 0.01}, {"select", {{"indices", {0, 1, 2}}}}});
  ASSERT_FALSE(graft({{"source", "head"}}).contains("error"));
  page_.ask({{"do", "accept"}});
  page_.ask({{"do", "graft"}, {"what", "resume"}});
  const Json before = state();
  for (const Json& change : {Json{{"what", "change"}, {"fields", {{"height", 0.02}}}},
                             Json{{"what", "rename"}, {"name", "trim"}}, Json{{"what", "remove"}}}) {
    Json request = change;
    request.update({{"do", "step"}, {"index", 0}});
    EXPECT_EQ(page_.refusal(request)["id"], "editor.step_beside_graft");
  }
  EXPECT_EQ(state(), before);
  page_.ask({{"do", "graft"}, {"what", "cancel"}});
  page_.ask({{"do", "step"}, {"what", "rename"}, {"index", 0}, {"name", "trim"}});
}

TEST(TwistedStart, TurnsAMirroredSourceTheSameWay) {
  const Mesh source = make_sample("cylinder", 20), target = make_sample("cylinder", 20);
  const std::vector<Index> from = boundary_loops(source)[0], to = boundary_loops(target)[1];
  const auto count = static_cast<int>(to.size());
  const Match start{from[3], to[5]}, turned = editor::twisted_start(source, target, start, 95, true);
  const auto steps = [&](const std::vector<Index>& loop, Index one, Index other) {
    const auto at = [&](Index v) { return std::find(loop.begin(), loop.end(), v) - loop.begin(); };
    return static_cast<int>(at(other) - at(one) + count) % count;
  };
  // The turn is what the target's vertex has gone, less what the source's vertex has gone the same way.
  const double deg =
      360.0 / count * (steps(to, start.target, turned.target) - steps(from, start.source, turned.source));
  EXPECT_NEAR(std::remainder(deg - 95, 360), 0, 180.0 / count);
}

TEST(TwistedStart, TurnsAlongTheTargetsLoop) {
  const Mesh source = make_sample("cylinder", 20), target = make_sample("cylinder", 20);
  const std::vector<Index> from = boundary_loops(source)[0], to = boundary_loops(target)[1];
  const Match start{from[3], to[5]};
  const auto by = [&](double deg) { return editor::twisted_start(source, target, start, deg); };
  EXPECT_EQ(by(0).source, start.source);
  EXPECT_EQ(by(0).target, start.target);
  EXPECT_EQ(by(360).target, start.target);
  EXPECT_EQ(by(180).target, to[(5 + to.size() / 2) % to.size()]);
  EXPECT_EQ(by(360.0 * 2 / static_cast<double>(to.size())).target, to[7]);
  EXPECT_THROW(editor::twisted_start(source, target, {from[3], target.vertex_count() / 2}, 5), Error);
}

}  // namespace
}  // namespace meshgraft::test
