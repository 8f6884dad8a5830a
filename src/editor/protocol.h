#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>

#include "server/server.h"

namespace meshgraft::editor {

using Json = nlohmann::json;

/// A request of a page (protocol.schema.json).
struct Request {
  Json id;           ///< a number or a word that the page chooses and the reply repeats
  std::string what;  ///< the field `do`
  Json message;      ///< the whole message
};

/// Parses a request. Throws Error(input); `id` is set even then, if the text has one.
Request parse_request(std::string_view text, Json& id);

/// Sends messages to one page; callable from any thread.
class Outbox {
 public:
  explicit Outbox(std::shared_ptr<Channel> channel) : channel_(std::move(channel)) {}

  void reply(const Json& id, Json result) const;
  void refuse(const Json& id, const Error& error) const;
  /// Sends an event. An event with a slot replaces an unsent event of the same slot.
  void tell(std::string_view event, Json fields, std::string_view slot = {}) const;
  /// Sends a frame; one of more than `part_bytes` is sent in parts.
  void send(std::vector<std::byte> frame, std::string_view slot = {}) const;

 private:
  std::shared_ptr<Channel> channel_;
};

/// Returns the fields of the event `progress`. `of` is the id of the request; null for the set-up or the
/// graft in the background.
Json progress_fields(const Json& of, const Progress& progress);

/// Tells that the work in the background whose progress was told in this slot has ended, done or not.
void tell_progress_ended(const Outbox& outbox, std::string_view slot);

/// Returns what `to_json` returns, with the parts of the location that the page names: step, handle, pair and
/// file. `location` is what is left of it within the step.
Json error_json(const Error& error);

}  // namespace meshgraft::editor
