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
  std::string_view path;  ///< as it is asked for, e.g. "/index.html"
  std::string_view content_type;
  std::string_view bytes;
};

/// Messages of bytes that belong together.
using ByteParts = std::vector<std::vector<std::byte>>;

/// One page's way to be told things. Safe to use from any thread, and after the page has gone.
class Channel {
 public:
  virtual ~Channel() = default;

  /// Queues a message. One with a `slot` takes the place of an unsent one with the same slot: of frames that
  /// the page is too slow for, only the newest is sent.
  virtual void send_text(std::string text, std::string_view slot = {}) = 0;
  /// The same; a message each of `parts`, which stay together, and are sent or dropped together.
  virtual void send_bytes(std::shared_ptr<const ByteParts> parts, std::string_view slot = {}) = 0;
};

/// What the server talks to on behalf of one page. Called on the server's thread, so calls must be short.
class PageSession {
 public:
  virtual ~PageSession() = default;
  virtual void receive(std::string_view text) = 0;
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;                               ///< 0: one that is free
  bool or_free_port = false;                            ///< one that is free, where `port` is taken
  std::size_t message_limit = 64u << 20;                ///< bytes of a message from the page
  std::uint64_t upload_limit = std::uint64_t{1} << 30;  ///< bytes of a file from the page
  std::size_t page_limit = 32;                          ///< pages at the same time
  std::filesystem::path upload_folder;                  ///< where they go; empty: none are taken
};

/// Serves one page, and a WebSocket to each tab that shows it, over HTTP on one address. All of it needs the
/// token of `url()`, the server's own Host and, on the WebSocket and uploads, its own Origin; what has not is
/// answered with 403 and goes no further. Malformed and oversized requests are answered and survived.
///
///   GET /?token=T, GET /assets/…     the page's files
///   GET /session?token=T             the WebSocket
///   POST /upload?token=T&name=NAME   a file into `upload_folder`; answers its path there
class Server {
 public:
  using MakeSession = std::function<std::unique_ptr<PageSession>(std::shared_ptr<Channel>)>;

  /// Takes the address. Throws Error(io) where it cannot be taken.
  Server(ServerOptions options, std::span<const PageFile> page, MakeSession make_session);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::string url() const;  ///< with the token
  std::uint16_t port() const;

  /// Serves until a stop is requested; then pages are told, and their sessions ended.
  void run(const std::stop_token& stop);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
