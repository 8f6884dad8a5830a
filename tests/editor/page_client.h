#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include <nlohmann/json.hpp>

#include "editor/editor.h"

namespace meshgraft::test {

using Json = nlohmann::json;

/// The editor on a thread of its own.
class RunningEditor {
 public:
  explicit RunningEditor(const std::vector<std::filesystem::path>& folders,
                         const std::vector<std::filesystem::path>& models = {});
  ~RunningEditor();

  const std::string& url() const { return url_; }

 private:
  std::string url_;
  std::jthread thread_;
};

/// A binary message.
struct Frame {
  std::uint32_t kind = 0;
  Json header;
  std::map<std::string, std::vector<float>> numbers;
  std::map<std::string, std::vector<std::int32_t>> indices;
  std::map<std::string, std::string> bytes;
};

/// What the editor's page is to the engine: a WebSocket that asks, and shows what comes.
class Page {
 public:
  explicit Page(const std::string& url);
  ~Page();
  Page(Page&&) noexcept;
  Page& operator=(Page&&) noexcept;

  /// Sends a request, or any text, without waiting.
  int send(Json request);
  void send_text(const std::string& text);
  /// The whole reply to a request.
  Json reply_to(int id);
  /// The result of a request; a failure if it is refused.
  Json ask(const Json& request);
  /// The error of a request; a failure if there is a result.
  Json refusal(const Json& request);

  /// Sends a file; its name among the uploads.
  std::string upload(const std::string& name, const std::string& bytes) const;

  /// Waits for an event, or a frame of one kind; those that came before count until they were asked for.
  Json event(const std::string& name, const std::function<bool(const Json&)>& is_right = {});
  Frame frame(std::uint32_t kind, const std::function<bool(const Frame&)>& is_right = {});
  /// Waits for the exact frame of a pose; the positions that are then shown, 3 floats a vertex, relative to
  /// `offset`.
  const std::vector<float>& exact(const Json& pose);

  const std::vector<float>& shown() const { return shown_; }
  const std::vector<double>& offset() const { return offset_; }
  std::vector<int> vertices(const std::function<bool(double, double, double)>& is_inside) const;

  /// All messages so far: {"from": "page" | "engine" | "header", "message"}, one line each.
  const std::string& conversation() const { return conversation_; }
  std::size_t waiting_frames() const { return frames_.size(); }
  std::size_t parts_seen() const { return parts_seen_; }

 private:
  void read();
  void take_part(const std::string& bytes);
  void take_frame(const std::string& bytes);
  void note(const char* from, const Json& message);

  struct Socket;
  std::unique_ptr<Socket> socket_;
  std::string url_;
  int last_id_ = 0;
  std::map<int, Json> replies_;
  std::vector<Json> events_;
  std::vector<Frame> frames_;
  std::string parts_;  // of the frame that comes
  std::size_t parts_seen_ = 0;
  std::vector<float> rest_, shown_;
  std::vector<double> offset_;
  int mesh_ = 0;
  std::string conversation_;
};

}  // namespace meshgraft::test
