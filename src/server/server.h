#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace meshgraft {

/// A file of the page.
struct PageFile {
  std::string_view path;  ///< path in the request, e.g. "/index.html"
  std::string_view content_type;
  std::string_view bytes;
};

/// Binary messages that belong together.
using ByteParts = std::vector<std::vector<std::byte>>;

/// The channel for messages to one page. Safe to use from any thread, and after the page is closed.
class Channel {
 public:
  virtual ~Channel() = default;

  /// Queues a message. A message with a `slot` replaces any unsent one with the same slot, so that a slow
  /// page receives only the newest frame.
  virtual void send_text(std::string text, std::string_view slot = {}) = 0;
  /// Does the same with one binary message for each of `parts`. The parts stay together, and are sent or
  /// dropped together. With a `slot` they wait, and all messages after them, until the browser has read the
  /// binary messages that were sent before with any slot.
  virtual void send_bytes(std::shared_ptr<const ByteParts> parts, std::string_view slot = {}) = 0;
};

/// Receives the messages of one page. Called on the server's thread, so calls must be short.
class PageSession {
 public:
  virtual ~PageSession() = default;
  virtual void receive(std::string_view text) = 0;
};

struct ServerOptions {
  std::uint16_t port = 0;                          ///< 0: any free port
  bool or_free_port = false;                       ///< use any free port if `port` is taken
  std::size_t message_limit = 64u << 20;           ///< bytes of a message from the page
  std::size_t queue_limit = std::size_t{1} << 31;  ///< bytes that wait for a tab; above, it is disconnected
  std::uint64_t upload_limit = std::uint64_t{1} << 30;   ///< bytes of a file from the page
  std::uint64_t uploads_limit = std::uint64_t{8} << 30;  ///< bytes of all files from pages
  std::size_t page_limit = 32;                           ///< pages open at the same time
  std::size_t connection_limit = 256;  ///< at the same time; a further one closes the oldest idle one
  std::chrono::milliseconds patience = std::chrono::seconds(30);  ///< with a request that makes no progress
  std::filesystem::path upload_folder;                            ///< for uploads; empty: uploads are refused
  /// Origins, SCHEME://HOST:PORT, of other pages that may frame this one, and of servers that may forward
  /// requests to this one.
  std::vector<std::string> frame_origins;
  /// The server ends this long after the last page was closed and no request came; none: never.
  std::optional<std::chrono::milliseconds> linger;
};

/// Serves one page, and a WebSocket to each tab that shows it, over HTTP on this machine's loopback address.
/// All requests need the server's own Host. The WebSocket and uploads need the token of `url()` and the
/// server's own Origin. The page's files need no token: they are those of the program, the same for everybody.
/// Other requests are answered with 403. Malformed and oversized requests are answered, and the server
/// continues.
///
///   GET /, GET /assets/…             the page's files
///   GET /session?token=T             the WebSocket; without an upgrade, 426 for a valid token
///   POST /upload?token=T&name=NAME   a file into `upload_folder`; answers its path there
class Server {
 public:
  using MakeSession = std::function<std::unique_ptr<PageSession>(std::shared_ptr<Channel>)>;

  /// Binds 127.0.0.1, or ::1 on a machine without IPv4. Throws Error(io) with the id server.address_not_taken
  /// if it cannot be bound.
  Server(ServerOptions options, std::span<const PageFile> page, MakeSession make_session);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::string url() const;  ///< contains the token
  std::uint16_t port() const;

  /// Serves until a stop is requested or all pages are gone (`linger`), then closes the connections and ends
  /// their sessions.
  void run(const std::stop_token& stop);

  /// Ends the server as soon as no page is open, and at the latest after `linger`. Safe to call from any
  /// thread.
  void end_after_pages();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
