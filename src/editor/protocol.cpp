#include "protocol.h"

#include <utility>

#include <meshgraft/script/edit_file.h>

#include "binary_message.h"
#include "document.h"
#include "editor/facts.h"
#include "folders.h"
#include "script/fact_json.h"
#include "script/facts.h"
#include "script/json_value.h"

namespace meshgraft::editor {

namespace {

// File names need not be valid UTF-8.
std::string text_of(const Json& message) {
  return message.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

Request parse_request(std::string_view text, Json& id) {
  Request request;
  request.message = json::parse(text, "message", edit_file_depth_limit);
  const std::string document = "message";
  const json::Value root(request.message, document);
  if (!root.is_object()) root.fail_type(facts::script::Type::object);
  const Json given = request.message.value("id", Json());
  if (!given.is_number_integer() && !given.is_string()) root.fail(facts::editor::IdUnusable{});
  id = request.id = given;
  if (!request.message.contains("do")) root.fail(facts::script::MissingField{.field = "do"});
  request.what = root.member("do").name();
  return request;
}

void Outbox::reply(const Json& id, Json result) const {
  channel_->send_text(text_of({{"re", id}, {"result", std::move(result)}}));
}

void Outbox::refuse(const Json& id, const Error& error) const {
  channel_->send_text(text_of({{"re", id}, {"error", error_json(with_upload_names(error))}}));
}

void Outbox::tell(std::string_view event, Json fields, std::string_view slot) const {
  fields["event"] = event;
  channel_->send_text(text_of(fields), slot);
}

void Outbox::send(std::vector<std::byte> frame, std::string_view slot) const {
  auto parts = std::make_shared<ByteParts>();
  if (frame.size() <= part_bytes)
    parts->push_back(std::move(frame));
  else
    *parts = parts_of(frame);
  channel_->send_bytes(std::move(parts), slot);
}

Json progress_fields(const Json& of, const Progress& progress) {
  Json fields = {{"of", of}, {"stage", progress.stage}, {"fraction", progress.fraction}};
  if (!progress.within.empty()) fields["within"] = progress.within;
  return fields;
}

void tell_progress_ended(const Outbox& outbox, std::string_view slot) {
  outbox.tell("progress", progress_fields(nullptr, {.stage = "solve", .fraction = 1}), slot);
}

Json error_json(const Error& error) {
  Json told = to_json(error);
  const ErrorLocation location = parts_of_location(error.location());
  told["location"] = location.rest;
  if (location.step) told["step"] = *location.step;
  if (location.handle) told["handle"] = *location.handle;
  if (location.pair) told["pair"] = *location.pair;
  if (location.file) told["file"] = *location.file;
  return told;
}

}  // namespace meshgraft::editor
