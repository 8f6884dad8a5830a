#include "server.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <exception>
#include <limits>
#include <list>
#include <mutex>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <meshgraft/core/error.h>

#include "access.h"
#include "server/facts.h"
#include "utf8.h"

namespace meshgraft {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

using Socket = websocket::stream<beast::tcp_stream>;
using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;

constexpr std::size_t header_limit = 16 * 1024;
constexpr std::chrono::seconds longest_wait_for_pong(5);

/// Allows only the page's own files and this server; `blob:` and `data:` are for pictures that the page
/// makes. No page may frame this one, except those of the given origins.
std::string content_policy(const std::vector<std::string>& frame_origins) {
  return fmt::format(
      "default-src 'self'; img-src 'self' blob: data:; style-src 'self' 'unsafe-inline'; worker-src 'self' "
      "blob:; frame-ancestors {}",
      frame_origins.empty() ? "'none'" : fmt::to_string(fmt::join(frame_origins, " ")));
}

Response respond(const Request& request, http::status status, std::string_view content_type,
                 std::string_view body) {
  Response response(status, request.version());
  response.set(http::field::content_type, beast::string_view(content_type.data(), content_type.size()));
  response.set(http::field::cache_control, "no-store");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.keep_alive(request.keep_alive());
  response.body().assign(body);
  response.prepare_payload();
  if (request.method() == http::verb::head) response.body().clear();
  return response;
}

Response refuse(const Request& request, http::status status, std::string_view why) {
  Response response = respond(request, status, "text/plain; charset=utf-8", fmt::format("{}\n", why));
  response.keep_alive(false);
  return response;
}

// Returns whether the client sends the body only after the status 100, or after a wait (RFC 9110, 10.1.1).
bool awaits_continue(const Request& request) {
  return request.version() >= 11 && beast::iequals(request[http::field::expect], "100-continue");
}

std::string_view view(beast::string_view text) { return {text.data(), text.size()}; }

/// The queue of messages to one tab. The mailbox outlives the connection; after that it discards messages.
class Mailbox : public Channel {
 public:
  struct Message {
    std::variant<std::string, std::shared_ptr<const ByteParts>> content;
    std::string slot;
  };

  /// Calls `wake`, on any thread, for each message that is queued. Closes itself if more bytes wait than
  /// `limit`.
  Mailbox(std::function<void()> wake, std::size_t limit) : wake_(std::move(wake)), limit_(limit) {}

  void send_text(std::string text, std::string_view slot) override {
    put({std::move(text), std::string(slot)});
  }
  void send_bytes(std::shared_ptr<const ByteParts> parts, std::string_view slot) override {
    put({std::move(parts), std::string(slot)});
  }

  /// Returns the next message, or none if it is a frame and frames must wait. Messages keep their order.
  std::optional<Message> take(bool frames_wait) {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty() || (frames_wait && is_frame(waiting_.front()))) return std::nullopt;
    Message message = std::move(waiting_.front());
    waiting_.pop_front();
    bytes_ -= size_of(message);
    return message;
  }

  /// Returns whether a message is binary and has a slot.
  static bool is_frame(const Message& message) {
    return !std::holds_alternative<std::string>(message.content) && !message.slot.empty();
  }

  void close() {
    const std::lock_guard lock(mutex_);
    wake_ = nullptr;
    waiting_.clear();
  }

  /// Returns whether more waited than the limit allows.
  bool overflowed() const {
    const std::lock_guard lock(mutex_);
    return bytes_ > limit_;
  }

 private:
  void put(Message message) {
    const std::lock_guard lock(mutex_);
    if (!wake_) return;
    if (!message.slot.empty())
      std::erase_if(waiting_, [&](const Message& old) {
        const bool superseded = old.slot == message.slot;
        if (superseded) bytes_ -= size_of(old);
        return superseded;
      });
    bytes_ += size_of(message);
    waiting_.push_back(std::move(message));
    if (bytes_ > limit_) waiting_.clear();
    wake_();
    if (bytes_ > limit_) wake_ = nullptr;
  }

  static std::size_t size_of(const Message& message) {
    if (const auto* text = std::get_if<std::string>(&message.content)) return text->size();
    std::size_t bytes = 0;
    for (const auto& part : *std::get<std::shared_ptr<const ByteParts>>(message.content)) bytes += part.size();
    return bytes;
  }

  mutable std::mutex mutex_;
  std::function<void()> wake_;
  std::deque<Message> waiting_;
  std::size_t bytes_ = 0, limit_;
};

/// The socket of one tab. Used only on the server's thread.
class Connection {
 public:
  Connection(asio::io_context& io, beast::tcp_stream stream) : socket_(std::move(stream)), wake_(io) {
    socket_.control_callback([this](websocket::frame_type kind, beast::string_view) {
      if (kind != websocket::frame_type::pong) return;
      awaits_pong_ = false;
      wake_.cancel();
    });
  }
  ~Connection() { mailbox_->close(); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  static std::shared_ptr<Connection> make(asio::io_context& io, beast::tcp_stream stream,
                                          std::size_t queue_limit) {
    auto connection = std::make_shared<Connection>(io, std::move(stream));
    const auto wake = [&io, weak = std::weak_ptr(connection)] {
      asio::post(io, [weak] {
        if (const auto awake = weak.lock()) awake->wake();
      });
    };
    connection->mailbox_ = std::make_shared<Mailbox>(wake, queue_limit);
    return connection;
  }

  Socket& socket() { return socket_; }
  const std::shared_ptr<Mailbox>& mailbox() const { return mailbox_; }

  /// Writes the messages from the mailbox until the socket closes. A ping follows each frame, and the next
  /// frame waits for the pong: the socket's buffers would otherwise hold seconds of frames for a tab that reads
  /// slowly, and each would show a pose of long ago. The wait has an end, for clients that answer no ping.
  asio::awaitable<void> write() {
    while (!closed_) {
      const std::optional<Mailbox::Message> message = mailbox_->take(awaits_pong_);
      if (!message) {
        error_code woken;
        wake_.expires_at(awaits_pong_ ? pong_due_ : asio::steady_timer::time_point::max());
        co_await wake_.async_wait(asio::redirect_error(asio::use_awaitable, woken));
        if (!woken) awaits_pong_ = false;
        continue;
      }
      if (const auto* text = std::get_if<std::string>(&message->content)) {
        co_await write_one(asio::buffer(*text), true);
        continue;
      }
      for (const auto& part : *std::get<std::shared_ptr<const ByteParts>>(message->content)) {
        if (closed_) break;
        co_await write_one(asio::buffer(part), false);
      }
      if (Mailbox::is_frame(*message)) co_await write_ping();
    }
  }

  /// Makes `write` look into the mailbox. A tab for which too much waits is disconnected; its page connects
  /// anew.
  void wake() {
    if (mailbox_->overflowed()) return close();
    wake_.cancel();
  }

  /// Closes the connection without waiting for the other side.
  void close() {
    if (std::exchange(closed_, true)) return;
    mailbox_->close();
    wake_.cancel();
    beast::get_lowest_layer(socket_).close();
  }

 private:
  asio::awaitable<void> write_one(asio::const_buffer content, bool is_text) {
    error_code failed;
    socket_.text(is_text);
    co_await socket_.async_write(content, asio::redirect_error(asio::use_awaitable, failed));
    if (failed) close();
  }

  asio::awaitable<void> write_ping() {
    error_code failed;
    awaits_pong_ = true;
    pong_due_ = std::chrono::steady_clock::now() + longest_wait_for_pong;
    co_await socket_.async_ping({}, asio::redirect_error(asio::use_awaitable, failed));
    if (failed) close();
  }

  Socket socket_;
  asio::steady_timer wake_;
  std::shared_ptr<Mailbox> mailbox_;
  asio::steady_timer::time_point pong_due_;
  bool awaits_pong_ = false;
  bool closed_ = false;
};

/// Keeps the connection alive while it writes.
asio::awaitable<void> write_of(std::shared_ptr<Connection> connection) { co_await connection->write(); }

}  // namespace

struct Server::Impl {
  ServerOptions options;
  std::span<const PageFile> page;
  MakeSession make_session;
  // One thread runs the context, so nothing here needs a lock.
  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  std::string token = random_token();
  std::unique_ptr<Access> access;
  std::string policy;
  asio::steady_timer leaving{io};  // runs while no page is open
  bool ends_after_pages = false;
  std::list<std::weak_ptr<Connection>> pages;
  std::size_t connections = 0;
  std::list<beast::tcp_stream*> waiting;  // connections without a request, the oldest first
  std::uint64_t uploaded_bytes = 0;

  void take_address();
  void end();
  void end_after(std::chrono::milliseconds time);
  void note_page_left();
  void note_request();
  error_code listen(std::uint16_t port);
  error_code listen(const asio::ip::address& address, std::uint16_t port);
  asio::awaitable<void> accept();
  asio::awaitable<void> serve(beast::tcp_stream stream);
  asio::awaitable<void> talk(beast::tcp_stream stream, const Request& request);
  asio::awaitable<Response> receive_file(beast::tcp_stream& stream, beast::flat_buffer& buffer,
                                         http::request_parser<http::empty_body>& head, const Target& target);
  std::filesystem::path new_upload(std::string_view name) const;
  Response find_file(const Request& request, const Target& target) const;
  Response open_session_refusal(const Request& request, const Target& target) const;
};

error_code Server::Impl::listen(std::uint16_t port) {
  const error_code failed = listen(asio::ip::address_v4::loopback(), port);
  const bool has_no_v4 = failed == asio::error::address_family_not_supported ||
                         failed == asio::error::network_unreachable ||
                         failed == boost::system::errc::address_not_available;
  return has_no_v4 ? listen(asio::ip::address_v6::loopback(), port) : failed;
}

error_code Server::Impl::listen(const asio::ip::address& address, std::uint16_t port) {
  error_code failed;
  const tcp::endpoint endpoint(address, port);
  acceptor = tcp::acceptor(io);
  acceptor.open(endpoint.protocol(), failed);
  if (!failed && port != 0) acceptor.set_option(tcp::acceptor::reuse_address(true), failed);
  if (!failed) acceptor.bind(endpoint, failed);
  if (!failed) acceptor.listen(asio::socket_base::max_listen_connections, failed);
  return failed;
}

void Server::Impl::take_address() {
  error_code failed = listen(options.port);
  if (failed == asio::error::address_in_use && options.or_free_port) failed = listen(0);
  if (failed)
    throw Error(facts::server::AddressNotTaken{.reason = failed.message()},
                Location::place(fmt::format("127.0.0.1:{}", options.port)));
  access = std::make_unique<Access>(token, acceptor.local_endpoint().port(), options.frame_origins);
}

void Server::Impl::end() {
  error_code ignored;
  acceptor.close(ignored);
  for (const auto& one : pages)
    if (const auto connection = one.lock()) connection->close();
  io.stop();
}

// A page that loads needs its files first, and they may take long to arrive and to run.
void Server::Impl::note_request() {
  if (options.linger && !ends_after_pages && leaving.expiry() > std::chrono::steady_clock::now())
    end_after(*options.linger);
}

void Server::Impl::end_after(std::chrono::milliseconds time) {
  leaving.expires_after(time);
  leaving.async_wait([this](error_code cancelled) {
    if (!cancelled && (pages.empty() || ends_after_pages)) end();
  });
}

void Server::Impl::note_page_left() {
  if (!pages.empty()) return;
  if (ends_after_pages) return end();
  if (options.linger) end_after(*options.linger);
}

asio::awaitable<void> Server::Impl::accept() {
  while (acceptor.is_open()) {
    error_code failed;
    tcp::socket socket = co_await acceptor.async_accept(asio::redirect_error(asio::use_awaitable, failed));
    if (failed) {  // too many descriptors, for example: waits until some may be free
      asio::steady_timer pause(io, std::chrono::milliseconds(100));
      co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, failed));
      continue;
    }
    if (connections >= options.connection_limit) {  // the oldest idle connection makes room
      if (waiting.empty()) continue;                // closes the new socket
      waiting.front()->close();
      waiting.pop_front();
    }
    socket.set_option(tcp::no_delay(true), failed);
    ++connections;
    asio::co_spawn(io, serve(beast::tcp_stream(std::move(socket))),
                   [this](const std::exception_ptr&) { --connections; });
  }
}

Response Server::Impl::find_file(const Request& request, const Target& target) const {
  if (request.method() != http::verb::get && request.method() != http::verb::head)
    return refuse(request, http::status::method_not_allowed, "only GET is answered here");
  if (target.path == "/session")
    return access->allows_token(target.field("token"))
               ? refuse(request, http::status::upgrade_required, "This is the address of a WebSocket.")
               : refuse(request, http::status::forbidden, "The token is wrong.");
  const std::string path = target.path == "/" ? "/index.html" : target.path;
  const auto file = std::find_if(page.begin(), page.end(), [&](const PageFile& f) { return f.path == path; });
  if (file == page.end()) return refuse(request, http::status::not_found, "There is no such file.");
  return respond(request, http::status::ok, file->content_type, file->bytes);
}

// Returns whether no file system or shell gives the character a special meaning.
bool is_plain(char c) {
  constexpr std::string_view special = "/\\:*?\"<>|";
  return static_cast<unsigned char>(c) >= 0x20 && c != 0x7f && special.find(c) == std::string_view::npos;
}

/// Returns the path of a new file in the upload folder. Keeps the name from the page as far as possible, and
/// the extension, by which readers recognise the format.
std::filesystem::path Server::Impl::new_upload(std::string_view name) const {
  constexpr std::size_t most_bytes = 120;  // leaves room for additions to the name, here and for journals
  const std::filesystem::path given = std::filesystem::path(name).filename();
  std::string stem = whole_characters(given.stem().string(), most_bytes);
  std::string extension = given.extension().string().substr(0, 16);
  for (char& c : stem)
    if (!is_plain(c)) c = '_';
  if (stem.starts_with('.')) stem.front() = '_';  // otherwise the file would be hidden
  std::erase_if(extension, [](char c) { return c != '.' && std::isalnum(static_cast<unsigned char>(c)) == 0; });
  return options.upload_folder /
         fmt::format("{}-{}{}", is_utf8(stem) && !stem.empty() ? stem : "model", random_token(), extension);
}

asio::awaitable<Response> Server::Impl::receive_file(beast::tcp_stream& stream, beast::flat_buffer& buffer,
                                                     http::request_parser<http::empty_body>& head,
                                                     const Target& target) {
  const Request request = head.get();
  if (options.upload_folder.empty())
    co_return refuse(request, http::status::not_found, "Files are not taken here.");
  const auto too_large = [&] {
    return refuse(request, http::status::payload_too_large,
                  fmt::format("Files of more than {} MB are not taken: open them from the folder they are in.",
                              options.upload_limit / 1'000'000));
  };
  const std::uint64_t announced = head.content_length().value_or(0);
  if (announced > options.upload_limit) co_return too_large();
  const auto no_room = [&] {
    return refuse(
        request, http::status::insufficient_storage,
        fmt::format("The files that were dropped onto the page take more than {} MB together: open further "
                    "ones from the folder they are in.",
                    options.uploads_limit / 1'000'000));
  };
  if (uploaded_bytes + std::max<std::uint64_t>(announced, 1) > options.uploads_limit) co_return no_room();
  uploaded_bytes += announced;

  const std::filesystem::path path = new_upload(target.field("name"));
  error_code failed;
  if (awaits_continue(request)) {
    http::response<http::empty_body> go_on(http::status::continue_, request.version());
    stream.expires_after(options.patience);
    co_await http::async_write(stream, go_on, asio::redirect_error(asio::use_awaitable, failed));
  }
  http::request_parser<http::file_body> parser(std::move(head));
  parser.body_limit(options.upload_limit);
  buffer.reserve(std::size_t{1} << 16);  // the buffer's capacity limits each read
  if (!failed) parser.get().body().open(path.c_str(), beast::file_mode::write_new, failed);
  while (!failed && !parser.is_done()) {
    stream.expires_after(options.patience);
    co_await http::async_read_some(stream, buffer, parser, asio::redirect_error(asio::use_awaitable, failed));
  }
  parser.get().body().close();
  std::error_code ignored;
  const std::uint64_t bytes = failed ? 0 : std::filesystem::file_size(path, ignored);
  uploaded_bytes = uploaded_bytes - announced + bytes;
  if (!failed)
    co_return respond(request, http::status::ok, "text/plain; charset=utf-8", path.filename().string());
  std::filesystem::remove(path, ignored);
  if (failed == http::error::body_limit) co_return too_large();
  if (failed == http::error::bad_chunk || failed == http::error::bad_chunk_extension)
    co_return refuse(request, http::status::bad_request,
                     fmt::format("The request is malformed: {}.", failed.message()));
  co_return refuse(request, http::status::insufficient_storage,
                   fmt::format("The file could not be kept: {}.", failed.message()));
}

/// Returns a response that says why a session is refused, with status ok if it is accepted.
Response Server::Impl::open_session_refusal(const Request& request, const Target& target) const {
  if (!access->allows_origin(view(request[http::field::origin])))
    return refuse(request, http::status::forbidden, "The page is not from this server.");
  if (!access->allows_token(target.field("token")))
    return refuse(request, http::status::forbidden,
                  "The token is wrong. Open the address that meshgraft printed.");
  return respond(request, http::status::ok, "text/plain", "");
}

asio::awaitable<void> Server::Impl::talk(beast::tcp_stream stream, const Request& request) {
  stream.expires_never();
  const auto connection = Connection::make(io, std::move(stream), options.queue_limit);
  Socket& socket = connection->socket();
  socket.set_option(websocket::stream_base::timeout::suggested(beast::role_type::server));
  socket.read_message_max(options.message_limit);
  error_code failed;
  co_await socket.async_accept(request, asio::redirect_error(asio::use_awaitable, failed));
  if (failed) co_return;
  pages.push_back(connection);
  if (!ends_after_pages) leaving.expires_at({});
  asio::co_spawn(io, write_of(connection), asio::detached);
  std::unique_ptr<PageSession> session = make_session(connection->mailbox());
  beast::flat_buffer buffer;
  while (!failed) {
    co_await socket.async_read(buffer, asio::redirect_error(asio::use_awaitable, failed));
    if (failed) break;
    const auto bytes = buffer.cdata();
    if (socket.got_text()) session->receive({static_cast<const char*>(bytes.data()), bytes.size()});
    buffer.consume(buffer.size());
  }
  connection->close();
  session.reset();
  pages.remove_if([&](const auto& one) { return one.lock() == connection; });
  note_page_left();
}

asio::awaitable<void> Server::Impl::serve(beast::tcp_stream stream) {
  beast::flat_buffer buffer(header_limit + 64 * 1024);
  error_code failed;
  bool goes_on = true;
  while (goes_on) {
    http::request_parser<http::empty_body> parser;
    parser.header_limit(header_limit);
    parser.body_limit(std::numeric_limits<std::uint64_t>::max());  // the reader of the body sets a limit
    stream.expires_after(options.patience);
    waiting.push_back(&stream);
    co_await http::async_read_header(stream, buffer, parser, asio::redirect_error(asio::use_awaitable, failed));
    waiting.remove(&stream);
    if (failed == http::error::end_of_stream || failed == beast::error::timeout ||
        failed == asio::error::operation_aborted)
      break;
    const Request request = parser.get();
    Response response;
    try {
      if (failed) {
        response = refuse(request, http::status::bad_request,
                          fmt::format("The request is malformed: {}.", failed.message()));
      } else if (!access->allows_host(view(request[http::field::host]))) {
        response = refuse(request, http::status::forbidden, "This server does not go by that name.");
      } else {
        const Target target = parse_target(view(request.target()));
        if (target.path == "/session" && websocket::is_upgrade(request)) {
          response = open_session_refusal(request, target);
          if (response.result() == http::status::ok && pages.size() >= options.page_limit)
            response = refuse(request, http::status::service_unavailable, "Too many pages are open.");
          if (response.result() == http::status::ok) {
            co_await talk(std::move(stream), request);
            co_return;
          }
        } else if (target.path == "/upload" && request.method() == http::verb::post) {
          response = open_session_refusal(request, target);
          if (response.result() == http::status::ok)
            response = co_await receive_file(stream, buffer, parser, target);
        } else {
          response = find_file(request, target);
        }
      }
    } catch (const Error& error) {
      response = refuse(request, http::status::bad_request, error.what());
    }
    response.set("Content-Security-Policy", policy);
    goes_on = response.keep_alive();
    note_request();
    stream.expires_after(options.patience);
    co_await http::async_write(stream, response, asio::redirect_error(asio::use_awaitable, failed));
    if (failed) break;
  }
  error_code ignored;
  stream.socket().shutdown(tcp::socket::shutdown_send, ignored);
}

Server::Server(ServerOptions options, std::span<const PageFile> page, MakeSession make_session)
    : impl_(std::make_unique<Impl>()) {
  impl_->options = std::move(options);
  impl_->policy = content_policy(impl_->options.frame_origins);
  impl_->page = page;
  impl_->make_session = std::move(make_session);
  impl_->take_address();
}

Server::~Server() = default;

std::string Server::url() const {
  const bool is_v6 = impl_->acceptor.local_endpoint().address().is_v6();
  return fmt::format("http://{}:{}/?token={}", is_v6 ? "[::1]" : "127.0.0.1", port(), impl_->token);
}

std::uint16_t Server::port() const { return impl_->acceptor.local_endpoint().port(); }

void Server::run(const std::stop_token& stop) {
  asio::co_spawn(impl_->io, impl_->accept(), asio::detached);
  const std::stop_callback on_stop(stop, [this] { asio::post(impl_->io, [this] { impl_->end(); }); });
  impl_->io.run();
}

void Server::end_after_pages() {
  asio::post(impl_->io, [this] {
    impl_->ends_after_pages = true;
    if (impl_->pages.empty()) return impl_->end();
    if (impl_->options.linger) impl_->end_after(*impl_->options.linger);
  });
}

}  // namespace meshgraft
