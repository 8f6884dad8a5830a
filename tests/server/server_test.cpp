// Checks that the server takes what its own page sends, and survives everything else.
#include "server/server.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <thread>

#include <gtest/gtest.h>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <meshgraft/core/error.h>

#include "server/access.h"

namespace meshgraft::test {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using namespace std::chrono_literals;

const PageFile page[] = {{"/index.html", "text/html", "<p>the page</p>"},
                         {"/assets/page.js", "text/javascript", "let x = 1;"}};

/// Counts the sessions that were made and are open, and keeps their channels.
struct Sessions {
  std::mutex mutex;
  std::condition_variable changed;
  int open = 0, made = 0;
  std::vector<std::shared_ptr<Channel>> channels;

  void wait_for_open(int count) {
    std::unique_lock lock(mutex);
    ASSERT_TRUE(changed.wait_for(lock, 10s, [&] { return open == count; })) << open << " are open";
  }
};

class Echo : public PageSession {
 public:
  Echo(Sessions& sessions, std::shared_ptr<Channel> channel)
      : sessions_(sessions), channel_(std::move(channel)) {
    const std::lock_guard lock(sessions_.mutex);
    ++sessions_.open;
    ++sessions_.made;
    sessions_.channels.push_back(channel_);
    sessions_.changed.notify_all();
  }
  ~Echo() override {
    const std::lock_guard lock(sessions_.mutex);
    --sessions_.open;
    sessions_.changed.notify_all();
  }
  void receive(std::string_view text) override { channel_->send_text("you said " + std::string(text)); }

 private:
  Sessions& sessions_;
  std::shared_ptr<Channel> channel_;
};

/// Runs a server on a thread of its own.
class Running {
 public:
  explicit Running(ServerOptions options = {})
      : server_(std::move(options), page,
                [this](std::shared_ptr<Channel> channel) {
                  return std::make_unique<Echo>(sessions, std::move(channel));
                }),
        thread_([this](std::stop_token stop) { server_.run(stop); }) {}

  std::uint16_t port() const { return server_.port(); }
  std::string host() const { return "127.0.0.1:" + std::to_string(port()); }
  std::string token() const {
    const std::string url = server_.url();
    return url.substr(url.find('=') + 1);
  }
  void end_after_pages() { server_.end_after_pages(); }
  void wait_until_ended() { thread_.join(); }
  void stop() {
    thread_.request_stop();
    thread_.join();
  }

  Sessions sessions;

 private:
  Server server_;
  std::jthread thread_;
};

tcp::socket connect_to(asio::io_context& io, std::uint16_t port) {
  tcp::socket socket(io);
  socket.connect({asio::ip::make_address("127.0.0.1"), port});
  return socket;
}

struct Answer {
  http::status status = http::status::unknown;
  std::string body;
};

struct Ask {
  http::verb method = http::verb::get;
  std::string target = "/";
  std::string host{}, origin{}, body{};
  bool upgrade = false;
};

Answer ask(const Running& server, const Ask& what) {
  asio::io_context io;
  tcp::socket socket = connect_to(io, server.port());
  http::request<http::string_body> request(what.method, what.target, 11);
  request.set(http::field::host, what.host.empty() ? server.host() : what.host);
  if (!what.origin.empty()) request.set(http::field::origin, what.origin);
  if (what.upgrade) {
    request.set(http::field::connection, "Upgrade");
    request.set(http::field::upgrade, "websocket");
  }
  request.body() = what.body;
  request.prepare_payload();
  beast::error_code ignored;
  http::write(socket, request, ignored);  // an answer may come before all is sent
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  if (what.method == http::verb::head) parser.skip(true);
  beast::error_code failed;
  http::read(socket, buffer, parser, failed);
  EXPECT_FALSE(failed) << failed.message();
  return {parser.get().result(), parser.get().body()};
}

/// Sends raw bytes, and returns the answer until the server closes.
std::string send_raw(const Running& server, const std::string& bytes) {
  asio::io_context io;
  tcp::socket socket = connect_to(io, server.port());
  beast::error_code ignored;
  asio::write(socket, asio::buffer(bytes), ignored);
  socket.shutdown(tcp::socket::shutdown_send, ignored);
  std::string answer(4096, '\0');
  answer.resize(asio::read(socket, asio::buffer(answer), ignored));
  return answer;
}

/// A browser's tab: a WebSocket to the server.
class Tab {
 public:
  Tab(const Running& server, const std::string& token, const std::string& origin)
      : socket_(connect_to(io_, server.port())) {
    socket_.set_option(websocket::stream_base::decorator(
        [origin](websocket::request_type& request) { request.set(http::field::origin, origin); }));
    socket_.handshake(server.host(), "/session?token=" + token, failed_);
    socket_.read_message_max(1 << 30);
  }
  explicit Tab(const Running& server) : Tab(server, server.token(), "http://" + server.host()) {}

  bool is_open() const { return !failed_; }
  void say(const std::string& text) { socket_.write(asio::buffer(text), failed_); }
  /// Returns the next message, or an empty one where the connection ended.
  std::string hear() {
    beast::flat_buffer buffer;
    socket_.read(buffer, failed_);
    return beast::buffers_to_string(buffer.data());
  }
  websocket::stream<tcp::socket>& socket() { return socket_; }

 private:
  asio::io_context io_;
  websocket::stream<tcp::socket> socket_;
  beast::error_code failed_;
};

/// Returns the status of the server's answer to a request for a session.
http::status ask_for_session(const Running& server, const std::string& token, const std::string& origin) {
  return ask(server,
             {.target = "/session?token=" + token, .host = {}, .origin = origin, .body = {}, .upgrade = true})
      .status;
}

// The page's files are the same for everybody.
TEST(Server, ServesThePage) {
  const Running server;
  const std::string target = "/?token=" + server.token();
  EXPECT_EQ(ask(server, {.target = "/"}).body, "<p>the page</p>");
  EXPECT_EQ(ask(server, {.target = target}).body, "<p>the page</p>");
  EXPECT_EQ(ask(server, {.target = "/assets/page.js"}).body, "let x = 1;");
  EXPECT_EQ(ask(server, {.method = http::verb::head, .target = target}).status, http::status::ok);
  EXPECT_EQ(ask(server, {.target = target, .host = "localhost:" + std::to_string(server.port())}).status,
            http::status::ok);
}

TEST(Server, TokensAreLongAndEachServersOwn) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) tokens.insert(random_token());
  EXPECT_EQ(tokens.size(), 100u);
  EXPECT_EQ(tokens.begin()->size(), 32u);
}

TEST(Server, RefusesWhoHasNoToken) {
  const Running server;
  std::string wrong = server.token();
  wrong.back() = wrong.back() == '0' ? '1' : '0';
  for (const std::string& target :
       {std::string("/session"), "/session?token=" + wrong, std::string("/session?token="),
        "/session?token=" + server.token() + "0", "/session?tokens=" + server.token()})
    EXPECT_EQ(ask(server, {.target = target}).status, http::status::forbidden) << target;
  EXPECT_EQ(ask(server, {.target = "/session?token=" + server.token()}).status, http::status::upgrade_required);
  EXPECT_EQ(ask_for_session(server, wrong, "http://" + server.host()), http::status::forbidden);
  EXPECT_EQ(server.sessions.made, 0);
}

TEST(Server, RefusesOtherHostsAndOrigins) {
  const Running server;
  const std::string target = "/?token=" + server.token();
  for (const std::string& host :
       {std::string("evil.example"), std::string("127.0.0.1"), std::string("evil.example:80"),
        std::string("127.0.0.1.evil.example:") + std::to_string(server.port())})
    EXPECT_EQ(ask(server, {.target = target, .host = host}).status, http::status::forbidden) << host;
  for (const std::string& origin :
       {std::string("http://evil.example"), "https://" + server.host(), std::string("null"), std::string(),
        "http://" + server.host() + ".evil.example"}) {
    EXPECT_FALSE(Tab(server, server.token(), origin).is_open()) << origin;
    EXPECT_EQ(ask_for_session(server, server.token(), origin), http::status::forbidden) << origin;
  }
  EXPECT_EQ(server.sessions.made, 0);
}

TEST(Server, KnowsNoFilesButThePages) {
  const Running server;
  for (const char* target : {"/etc/passwd", "/../../etc/passwd", "/assets/../index.html", "/%2e%2e/etc/passwd",
                             "/assets/page.js%00", "/sessions", "//index.html"})
    EXPECT_EQ(ask(server, {.target = target}).status, http::status::not_found) << target;
  EXPECT_EQ(ask(server, {.method = http::verb::delete_, .target = "/index.html"}).status,
            http::status::method_not_allowed);
  EXPECT_EQ(ask(server, {.target = "/%zz"}).status, http::status::bad_request);
}

TEST(Server, TalksToEachTabByItself) {
  Running server;
  {
    Tab first(server), second(server);
    first.say("one");
    second.say("two");
    EXPECT_EQ(second.hear(), "you said two");
    EXPECT_EQ(first.hear(), "you said one");
    server.sessions.wait_for_open(2);
  }
  server.sessions.wait_for_open(0);
}

TEST(Server, SurvivesWhatIsMalformed) {
  const Running server;
  EXPECT_NE(send_raw(server, "no request at all\r\n\r\n").find("400"), std::string::npos);
  EXPECT_NE(send_raw(server, "GET / HTTP/9.9\r\nHost: x\r\n\r\n").find("400"), std::string::npos);
  EXPECT_NE(send_raw(server, "GET /" + std::string(100'000, 'a') + " HTTP/1.1\r\n\r\n").find("400"),
            std::string::npos);
  send_raw(server, "");
  send_raw(server, std::string(1000, '\0'));
  send_raw(server, "GET / HTTP/1.1\r\nHost: " + server.host());
  EXPECT_NE(send_raw(server, "GET /session?token=" + server.token() + " HTTP/1.1\r\nHost: " + server.host() +
                                 "\r\nOrigin: http://" + server.host() +
                                 "\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\r\n")
                .find("400"),
            std::string::npos);
  Tab tab(server);
  tab.say("still there");
  EXPECT_EQ(tab.hear(), "you said still there");
}

TEST(Server, EndsAConversationOfMessagesThatAreTooLarge) {
  ServerOptions options;
  options.message_limit = 1000;
  Running server(options);
  Tab tab(server);
  tab.say(std::string(1000, 'x'));
  EXPECT_EQ(tab.hear().size(), 1009u);
  tab.say(std::string(1001, 'x'));
  EXPECT_EQ(tab.hear(), "");
  EXPECT_FALSE(tab.is_open());
  server.sessions.wait_for_open(0);
  EXPECT_TRUE(Tab(server).is_open());
}

TEST(Server, TakesAFreePortForATakenOneWhereItMay) {
  const Running first;
  ServerOptions options;
  options.port = first.port();
  EXPECT_THROW(Running{options}, Error);
  options.or_free_port = true;
  const Running second(options);
  EXPECT_NE(second.port(), first.port());
}

TEST(Server, TakesSoManyTabsAndNoMore) {
  ServerOptions options;
  options.page_limit = 2;
  Running server(options);
  const Tab first(server);
  {
    const Tab second(server);
    EXPECT_FALSE(Tab(server).is_open());
    EXPECT_EQ(ask_for_session(server, server.token(), "http://" + server.host()),
              http::status::service_unavailable);
  }
  server.sessions.wait_for_open(1);
  EXPECT_TRUE(Tab(server).is_open());
}

TEST(Server, DropsSupersededMessages) {
  Running server;
  Tab tab(server);
  tab.say("hello");
  EXPECT_EQ(tab.hear(), "you said hello");
  const std::shared_ptr<Channel> channel = server.sessions.channels.front();
  // The tab does not read, so messages wait; each slot keeps only the newest.
  constexpr int frames = 200;
  for (int frame = 0; frame < frames; ++frame)
    channel->send_bytes(std::make_shared<ByteParts>(2, std::vector(1 << 19, static_cast<std::byte>(frame))),
                        "frame");
  channel->send_text("and done");
  std::vector<int> heard;
  for (std::string message = tab.hear(); message != "and done"; message = tab.hear())
    heard.push_back(static_cast<unsigned char>(message.at(0)));
  EXPECT_LT(heard.size(), frames / 2u);
  ASSERT_EQ(heard.size() % 2, 0u);
  for (std::size_t i = 0; i < heard.size(); i += 2) EXPECT_EQ(heard[i], heard[i + 1]);  // parts stay together
  EXPECT_EQ(heard.back(), frames - 1);
  EXPECT_TRUE(std::is_sorted(heard.begin(), heard.end()));
}

// Frames that are small enough for the socket's buffers would otherwise all be sent, and seen late.
TEST(Server, AFrameWaitsUntilTheTabHasReadTheOneBefore) {
  Running server;
  Tab tab(server);
  server.sessions.wait_for_open(1);
  const std::shared_ptr<Channel> channel = server.sessions.channels.front();
  constexpr int frames = 20;
  for (int frame = 0; frame < frames; ++frame) {
    channel->send_bytes(std::make_shared<ByteParts>(2, std::vector(100, static_cast<std::byte>(frame))),
                        "frame");
    std::this_thread::sleep_for(5ms);
  }
  std::vector<int> heard;
  while (heard.size() < 2 || heard.back() != frames - 1 || heard[heard.size() - 2] != frames - 1)
    heard.push_back(static_cast<unsigned char>(tab.hear().at(0)));
  EXPECT_LE(heard.size(), 4u);  // two parts each of an early frame and of the last
}

TEST(Server, DisconnectsATabForWhichTooMuchWaits) {
  ServerOptions options;
  options.queue_limit = std::size_t{1} << 20;
  Running server(options);
  Tab slow(server);
  server.sessions.wait_for_open(1);
  const std::shared_ptr<Channel> channel = server.sessions.channels.front();
  const auto parts = std::make_shared<const ByteParts>(1, std::vector<std::byte>(std::size_t{1} << 19));
  for (int message = 0; message < 200; ++message) channel->send_bytes(parts);  // more than sockets buffer
  server.sessions.wait_for_open(0);
  Tab next(server);
  EXPECT_TRUE(next.is_open());
}

// Connections that ask for nothing keep nobody out.
TEST(Server, AFurtherConnectionClosesTheOldestIdleOne) {
  ServerOptions options;
  options.connection_limit = 2;
  const Running server(options);
  asio::io_context io;
  std::vector<tcp::socket> idle;
  for (int k = 0; k < 6; ++k) idle.push_back(connect_to(io, server.port()));
  char byte = 0;
  for (int k = 0; k < 4; ++k) {
    beast::error_code closed;
    idle[k].read_some(asio::buffer(&byte, 1), closed);
    EXPECT_TRUE(closed) << k;
  }
  EXPECT_EQ(ask(server, {.target = "/"}).status, http::status::ok);
  idle[5].non_blocking(true);
  beast::error_code open;
  idle[5].read_some(asio::buffer(&byte, 1), open);
  EXPECT_EQ(open, asio::error::would_block);
}

TEST(Server, ClosesIdleConnections) {
  ServerOptions options;
  options.patience = 200ms;
  const Running server(options);
  asio::io_context io;
  tcp::socket idle = connect_to(io, server.port());
  char byte = 0;
  beast::error_code closed;
  idle.read_some(asio::buffer(&byte, 1), closed);
  EXPECT_EQ(closed, asio::error::eof);
}

// A loop that tries again at once takes a whole processor.
TEST(Server, WaitsWhereDescriptorsRunOut) {
  const Running server;
  asio::io_context io;
  tcp::socket waiting(io, tcp::v4());  // needs no descriptor later
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const int lowest_free = ::dup(0);
  ::close(lowest_free);
  const rlimit none{static_cast<rlim_t>(lowest_free), before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &none), 0);
  const std::clock_t start = std::clock();
  waiting.connect({asio::ip::address_v4::loopback(), server.port()});
  std::this_thread::sleep_for(500ms);
  const double processor_seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &before), 0);
  EXPECT_LT(processor_seconds, 0.2);
  asio::write(waiting, asio::buffer("GET / HTTP/1.1\r\nHost: " + server.host() + "\r\n\r\n"));
  std::string answer(12, '\0');
  asio::read(waiting, asio::buffer(answer));
  EXPECT_EQ(answer, "HTTP/1.1 200");
}

TEST(Server, StopsWithTabsOpen) {
  Running server;
  Tab first(server), second(server);
  server.sessions.wait_for_open(2);
  const std::shared_ptr<Channel> channel = server.sessions.channels.front();
  server.stop();
  EXPECT_EQ(first.hear(), "");
  EXPECT_FALSE(first.is_open());
  channel->send_text("to nobody");
}

class Uploads : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) / ("uploads-" + random_token());
    std::filesystem::create_directory(folder_);
    options_.upload_folder = folder_;
    options_.upload_limit = 1 << 20;
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::size_t kept() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator()));
  }
  static Ask upload(const Running& server, const std::string& name, std::string body) {
    return {.method = http::verb::post,
            .target = "/upload?token=" + server.token() + "&name=" + name,
            .host = {},
            .origin = "http://" + server.host(),
            .body = std::move(body)};
  }

  std::filesystem::path folder_;
  ServerOptions options_;
};

TEST_F(Uploads, AreKeptUnderNamesOfTheServersOwn) {
  const Running server(options_);
  for (const char* name :
       {"head.ply", "..%2F..%2Fetc%2Fpasswd", "%2Ftmp%2Fx.obj", "a%20b%00.stl", "", "...."}) {
    const Answer answer = ask(server, upload(server, name, std::string("content of ") + name));
    ASSERT_EQ(answer.status, http::status::ok) << name << ": " << answer.body;
    const std::filesystem::path path = folder_ / answer.body;
    EXPECT_EQ(path.parent_path(), folder_);
    std::ifstream file(path, std::ios::binary);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}), std::string("content of ") + name);
  }
  EXPECT_EQ(kept(), 6u);
  EXPECT_TRUE(ask(server, upload(server, "head.ply", "x")).body.ends_with(".ply"));
}

TEST_F(Uploads, NeedTokenAndOrigin) {
  const Running server(options_);
  Ask other = upload(server, "head.ply", "x");
  other.origin = "http://evil.example";
  EXPECT_EQ(ask(server, other).status, http::status::forbidden);
  Ask wrong = upload(server, "head.ply", "x");
  wrong.target = "/upload?token=0&name=head.ply";
  EXPECT_EQ(ask(server, wrong).status, http::status::forbidden);
  EXPECT_EQ(kept(), 0u);
}

TEST_F(Uploads, ThatAreTooLargeLeaveNothing) {
  const Running server(options_);
  EXPECT_EQ(ask(server, upload(server, "exact.ply", std::string(1 << 20, 'x'))).status, http::status::ok);
  EXPECT_EQ(ask(server, upload(server, "large.ply", std::string((1 << 20) + 1, 'x'))).status,
            http::status::payload_too_large);
  // One upload announces two gigabytes; another sends too much without announcing it.
  const std::string head = "POST /upload?name=x.ply&token=" + server.token() +
                           " HTTP/1.1\r\nHost: " + server.host() + "\r\nOrigin: http://" + server.host() +
                           "\r\n";
  EXPECT_NE(send_raw(server, head + "Content-Length: 2147483648\r\n\r\n").find("413"), std::string::npos);
  std::string chunks = head + "Transfer-Encoding: chunked\r\n\r\n";
  for (int i = 0; i < 20; ++i) chunks += "10000\r\n" + std::string(0x10000, 'x') + "\r\n";
  EXPECT_NE(send_raw(server, chunks).find("413"), std::string::npos);
  EXPECT_EQ(kept(), 1u);
  // This upload breaks off before its announced length.
  send_raw(server, head + "Content-Length: 1000\r\n\r\nnot so much");
  EXPECT_EQ(kept(), 1u);
  EXPECT_EQ(ask(server, upload(server, "next.ply", "x")).status, http::status::ok);
}

// The client sends the body only when it is told to go on, as curl does for a second.
TEST_F(Uploads, AreAskedForWhereTheClientAwaitsIt) {
  options_.patience = 2s;  // a server that does not ask closes the connection
  const Running server(options_);
  const auto exchange = [&](std::size_t announced, const char* expectation) {
    asio::io_context io;
    tcp::socket socket = connect_to(io, server.port());
    const Ask what = upload(server, "head.ply", "");
    http::request<http::empty_body> head(what.method, what.target, 11);
    head.set(http::field::host, server.host());
    head.set(http::field::origin, what.origin);
    head.set(http::field::expect, expectation);
    head.content_length(announced);
    http::request_serializer<http::empty_body> serializer(head);
    http::write_header(socket, serializer);
    std::vector<http::status> answers;
    beast::flat_buffer buffer;
    beast::error_code failed;
    while (!failed) {
      http::response_parser<http::string_body> parser;
      http::read(socket, buffer, parser, failed);
      if (failed) break;
      answers.push_back(parser.get().result());
      if (answers.back() != http::status::continue_) break;
      asio::write(socket, asio::buffer(std::string(announced, 'x')), failed);
    }
    return answers;
  };
  const std::vector<http::status> asked{http::status::continue_, http::status::ok};
  EXPECT_EQ(exchange(1000, "100-continue"), asked);
  EXPECT_EQ(exchange(1000, "100-Continue"), asked);
  EXPECT_EQ(kept(), 2u);
  EXPECT_EQ(exchange(2 << 20, "100-continue"), std::vector{http::status::payload_too_large})
      << "not even asked";
}

TEST_F(Uploads, TakeSoManyBytesTogetherAndNoMore) {
  options_.uploads_limit = 3000;
  const Running server(options_);
  const std::string kilobyte(1000, 'x');
  for (int k = 0; k < 2; ++k)
    EXPECT_EQ(ask(server, upload(server, "a.ply", kilobyte)).status, http::status::ok);
  const Answer refused = ask(server, upload(server, "a.ply", kilobyte + "x"));
  EXPECT_EQ(refused.status, http::status::insufficient_storage);
  EXPECT_NE(refused.body.find("from the folder they are in"), std::string::npos) << refused.body;
  EXPECT_EQ(ask(server, upload(server, "a.ply", kilobyte)).status, http::status::ok);
  EXPECT_EQ(ask(server, upload(server, "a.ply", "x")).status, http::status::insufficient_storage);
  EXPECT_EQ(kept(), 3u);
}

TEST(Server, OnlyGivenOriginsMayFrameThePageAndForwardRequests) {
  ServerOptions options;
  options.frame_origins = {"https://hub.example", "http://localhost:8888"};
  const Running server(options), closed;
  const auto policy = [](const Running& running) {
    const std::string answer =
        send_raw(running, "GET / HTTP/1.1\r\nHost: " + running.host() + "\r\nConnection: close\r\n\r\n");
    const std::size_t begin = answer.find("frame-ancestors");
    return answer.substr(begin, answer.find("\r\n", begin) - begin);
  };
  EXPECT_EQ(policy(server), "frame-ancestors https://hub.example http://localhost:8888");
  EXPECT_EQ(policy(closed), "frame-ancestors 'none'");

  const auto open = [&](const std::string& host, const std::string& origin) {
    Ask session;
    session.target = "/session?token=wrong";
    session.host = host;
    session.origin = origin;
    session.upgrade = true;
    return ask(server, session).body;
  };
  EXPECT_NE(open("hub.example", "https://hub.example").find("token is wrong"), std::string::npos);
  EXPECT_NE(open("localhost:8888", "http://localhost:8888").find("token is wrong"), std::string::npos);
  EXPECT_NE(open("hub.example", "http://hub.example").find("not from this server"), std::string::npos);
  EXPECT_NE(open("hub.example:8888", "https://hub.example").find("by that name"), std::string::npos);
}

TEST(Server, KnowsOrigins) {
  for (const char* origin :
       {"http://localhost:8888", "https://hub.example", "http://[::1]:80", "vscode-webview://1-a"})
    EXPECT_TRUE(is_origin(origin)) << origin;
  for (const char* text : {"", "localhost:8888", "://a", "http://", "http://a/", "http://a b",
                           "http://a;script-src", "http://a,b", "http://a'", "http://u@a", "http://*.a"})
    EXPECT_FALSE(is_origin(text)) << text;
}

TEST(Server, EndsOnceItsPagesAreGone) {
  ServerOptions options;
  options.linger = 100ms;
  Running lingering(options);
  {
    const Tab first(lingering);
    lingering.sessions.wait_for_open(1);
  }
  lingering.wait_until_ended();
  EXPECT_EQ(lingering.sessions.made, 1);

  options.linger = 24h;  // a page that is back in time keeps the server
  Running busy(options);
  {
    const Tab first(busy);
    busy.sessions.wait_for_open(1);
  }
  busy.sessions.wait_for_open(0);
  {
    const Tab again(busy);
    busy.sessions.wait_for_open(1);
    busy.end_after_pages();
    EXPECT_EQ(ask(busy, {}).status, http::status::ok);  // it waits for the page
  }
  busy.wait_until_ended();

  options.linger = 100ms;
  Running stubborn(options);
  const Tab stays(stubborn);
  stubborn.sessions.wait_for_open(1);
  stubborn.end_after_pages();
  stubborn.wait_until_ended();
}

TEST(Server, AnAddressThatIsTakenIsNamed) {
  const Running first;
  ServerOptions options;
  options.port = first.port();
  try {
    const Running second(options);
    FAIL() << "took an address twice";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::io);
    EXPECT_EQ(error.id(), "server.address_not_taken");
    EXPECT_NE(std::string(error.what()).find(first.host()), std::string::npos);
  }
}

}  // namespace
}  // namespace meshgraft::test
