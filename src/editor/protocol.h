#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>

#include "server/server.h"

namespace meshgraft::editor {

using Json = nlohmann::json;

/// What a page asks for (protocol.schema.json).
struct Request {
  Json id;           ///< a number or a word of the page's choice, which the reply repeats
  std::string what;  ///< its `do`
  Json message;      ///< all of it
};

/// The request that `text` is. Throws Error(input); what `id` it has is in `id` even then.
Request parse_request(std::string_view text, Json& id);

/// A file is there, or is not what it was, and was not said to be overwritten.
class ReplaceError : public Error {
 public:
  ReplaceError(const Error& error, std::filesystem::path file)
      : Error(error), file_(std::make_shared<const std::filesystem::path>(std::move(file))) {}
  const std::filesystem::path& file() const noexcept { return *file_; }

 private:
  std::shared_ptr<const std::filesystem::path> file_;  // copying must not throw
};

/// What is sent to one page, from any thread.
class Outbox {
 public:
  explicit Outbox(std::shared_ptr<Channel> channel) : channel_(std::move(channel)) {}

  void reply(const Json& id, Json result) const;
  void refuse(const Json& id, const Error& error) const;
  /// An event with a slot takes the place of an unsent one.
  void tell(std::string_view event, Json fields, std::string_view slot = {}) const;
  /// A frame of more than `part_bytes` goes in parts.
  void send(std::vector<std::byte> frame, std::string_view slot = {}) const;

 private:
  std::shared_ptr<Channel> channel_;
};

/// {code, problem, location, remedy}, and the file that would be replaced.
Json error_json(const Error& error);

}  // namespace meshgraft::editor
