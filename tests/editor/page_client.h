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

/// Runs the editor on a thread of its own.
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
  std::map<std::string, std::vector<std::int32_t>> handles;  ///< arrays `handle`, by the handles' names
  std::map<int, std::string> pictures;                       ///< arrays `picture`, by number
};

/// Stands for the editor's page: a WebSocket that sends requests, and keeps the positions that a page would
/// show.
class Page {
 public:
  explicit Page(const std::string& url);
  ~Page();
  Page(Page&&) noexcept;
  Page& operator=(Page&&) noexcept;

  /// Sends a request without waiting, and returns its id.
  int send(Json request);
  void send_text(const std::string& text);
  /// Waits for the reply to a request, and returns all of it.
  Json reply_to(int id);
  /// Sends a request and returns its result; the test fails if it is refused.
  Json ask(const Json& request);
  /// Sends a request and returns its error; the test fails if there is a result.
  Json refusal(const Json& request);

  /// Sends a file, and returns its name among the uploads.
  std::string upload(const std::string& name, const std::string& bytes) const;

  /// Waits for an event, or a frame of one kind. Earlier ones count unless they were returned before.
  Json event(const std::string& name, const std::function<bool(const Json&)>& is_right = {});
  Frame frame(std::uint32_t kind, const std::function<bool(const Frame&)>& is_right = {});
  /// Waits for the exact frame of a pose. Returns the positions that are then shown, 3 floats a vertex,
  /// relative to `offset`.
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
  std::string parts_;  // received so far of a frame
  std::size_t parts_seen_ = 0;
  std::vector<float> rest_, shown_;
  std::vector<double> offset_;
  int mesh_ = 0;
  std::string conversation_;
};

}  // namespace meshgraft::test
