#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
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
  /// dropped together.
  virtual void send_bytes(std::shared_ptr<const ByteParts> parts, std::string_view slot = {}) = 0;
};

/// Receives the messages of one page. Called on the server's thread, so calls must be short.
class PageSession {
 public:
  virtual ~PageSession() = default;
  virtual void receive(std::string_view text) = 0;
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;                               ///< 0: any free port
  bool or_free_port = false;                            ///< use any free port if `port` is taken
  std::size_t message_limit = 64u << 20;                ///< bytes of a message from the page
  std::uint64_t upload_limit = std::uint64_t{1} << 30;  ///< bytes of a file from the page
  std::size_t page_limit = 32;                          ///< pages open at the same time
  std::filesystem::path upload_folder;                  ///< for uploads; empty: uploads are refused
};

/// Serves one page, and a WebSocket to each tab that shows it, over HTTP on one address. All requests need
/// the server's own Host. The front page, the WebSocket and uploads need the token of `url()`. The WebSocket
/// and uploads also need the server's own Origin. Other requests are answered with 403. Malformed and
/// oversized requests are answered, and the server continues.
///
///   GET /?token=T, GET /assets/…     the page's files
///   GET /session?token=T             the WebSocket
///   POST /upload?token=T&name=NAME   a file into `upload_folder`; answers its path there
class Server {
 public:
  using MakeSession = std::function<std::unique_ptr<PageSession>(std::shared_ptr<Channel>)>;

  /// Binds the address. Throws Error(io) with the id server.address_not_taken if it cannot be bound.
  Server(ServerOptions options, std::span<const PageFile> page, MakeSession make_session);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::string url() const;  ///< contains the token
  std::uint16_t port() const;

  /// Serves until a stop is requested, then closes the connections and ends their sessions.
  void run(const std::stop_token& stop);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
