#include "page_client.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <future>
#include <stdexcept>

#include <gtest/gtest.h>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

namespace meshgraft::test {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using namespace std::chrono_literals;

namespace {

constexpr auto patience = 60s;  // enough for a sanitizer on a busy machine

template <class T>
std::vector<T> take(const char*& from, std::size_t length) {
  std::vector<T> values(length);
  if (length > 0) std::memcpy(values.data(), from, length * sizeof(T));
  from += length * sizeof(T);
  return values;
}

// Reads bytes that are padded to a multiple of 4.
void take_bytes(const char*& from, std::size_t length, std::string& bytes) {
  bytes.assign(from, length);
  from += (length + 3) / 4 * 4;
}

std::string host_of(const std::string& url) {
  const std::size_t begin = std::string("http://").size();
  return url.substr(begin, url.find('/', begin) - begin);
}

tcp::endpoint address_of(const std::string& url) {
  const std::string host = host_of(url);
  return {asio::ip::make_address("127.0.0.1"),
          static_cast<std::uint16_t>(std::stoi(host.substr(host.find(':') + 1)))};
}

}  // namespace

RunningEditor::RunningEditor(const std::vector<std::filesystem::path>& folders,
                             const std::vector<std::filesystem::path>& models) {
  std::promise<std::string> url;
  std::future<std::string> listening = url.get_future();
  thread_ = std::jthread([folders, models, url = std::move(url)](const std::stop_token& stop) mutable {
    editor::EditorOptions options;
    options.folders = folders;
    options.models = models;
    editor::run_editor(
        options, [&](const editor::EditorAddress& address) { url.set_value(address.url); }, stop);
  });
  url_ = listening.get();
}

RunningEditor::~RunningEditor() = default;

struct Page::Socket {
  asio::io_context io;
  beast::websocket::stream<tcp::socket> stream{io};
};

Page::Page(const std::string& url) : socket_(std::make_unique<Socket>()), url_(url) {
  const std::string host = host_of(url);
  auto& stream = socket_->stream;
  stream.next_layer().connect(address_of(url));
  stream.set_option(beast::websocket::stream_base::decorator(
      [host](auto& request) { request.set(beast::http::field::origin, "http://" + host); }));
  stream.handshake(host, "/session" + url.substr(url.find('?')));
  stream.read_message_max(std::size_t{1} << 30);
}

Page::Page(Page&&) noexcept = default;
Page& Page::operator=(Page&&) noexcept = default;

Page::~Page() {
  if (!socket_) return;
  beast::error_code ignored;
  socket_->stream.next_layer().close(ignored);
}

std::string Page::upload(const std::string& name, const std::string& bytes) const {
  namespace http = beast::http;
  asio::io_context io;
  tcp::socket socket(io);
  socket.connect(address_of(url_));
  http::request<http::string_body> request(http::verb::post,
                                           "/upload" + url_.substr(url_.find('?')) + "&name=" + name, 11);
  request.set(http::field::host, host_of(url_));
  request.set(http::field::origin, "http://" + host_of(url_));
  request.body() = bytes;
  request.prepare_payload();
  http::write(socket, request);
  beast::flat_buffer buffer;
  http::response<http::string_body> response;
  http::read(socket, buffer, response);
  EXPECT_EQ(response.result(), http::status::ok);
  return response.body();
}

void Page::note(const char* from, const Json& message) {
  conversation_ += Json{{"from", from}, {"message", message}}.dump() + "\n";
}

int Page::send(Json request) {
  request["id"] = ++last_id_;
  note("page", request);
  send_text(request.dump());
  return last_id_;
}

void Page::send_text(const std::string& text) {
  socket_->stream.text(true);
  socket_->stream.write(asio::buffer(text));
}

void Page::read() {
  beast::flat_buffer buffer;
  bool arrived = false;
  beast::error_code failed;
  socket_->stream.async_read(buffer, [&](beast::error_code error, std::size_t) {
    failed = error;
    arrived = true;
  });
  socket_->io.restart();
  socket_->io.run_for(patience);
  if (!arrived) {
    socket_->stream.next_layer().close();
    socket_->io.restart();
    socket_->io.run();
    throw std::runtime_error("nothing came");
  }
  if (failed) throw std::runtime_error(failed.message());
  const std::string bytes = beast::buffers_to_string(buffer.data());
  if (socket_->stream.got_binary()) return bytes.starts_with("MGFP") ? take_part(bytes) : take_frame(bytes);
  const Json message = Json::parse(bytes);
  note("engine", message);
  if (message.contains("event"))
    events_.push_back(message);
  else
    replies_[message["re"].is_number() ? message["re"].get<int>() : 0] = message;
}

void Page::take_part(const std::string& bytes) {
  std::uint64_t at = 0, length = 0;
  std::memcpy(&at, bytes.data() + 8, 8);
  std::memcpy(&length, bytes.data() + 16, 8);
  ASSERT_EQ(at, parts_.size());
  parts_ += bytes.substr(24);
  ++parts_seen_;
  ASSERT_LE(parts_.size(), length);
  if (parts_.size() == length) take_frame(std::exchange(parts_, {}));
}

void Page::take_frame(const std::string& bytes) {
  ASSERT_EQ(bytes.substr(0, 4), "MGF1");
  Frame frame;
  std::uint32_t header_length = 0;
  std::memcpy(&frame.kind, bytes.data() + 4, 4);
  std::memcpy(&header_length, bytes.data() + 8, 4);
  ASSERT_EQ(header_length % 4, 0u);
  frame.header = Json::parse(bytes.substr(12, header_length));
  note("header", frame.header);
  const char* from = bytes.data() + 12 + header_length;
  for (const Json& array : frame.header["arrays"]) {
    const auto length = array["length"].get<std::size_t>();
    if (array["name"] == "handle")
      frame.handles[array["of"]] = take<std::int32_t>(from, length);
    else if (array["name"] == "picture")
      take_bytes(from, length, frame.pictures[array["of"].get<int>()]);
    else if (array["type"] == "float32")
      frame.numbers[array["name"]] = take<float>(from, length);
    else if (array["type"] == "uint32")
      frame.indices[array["name"]] = take<std::int32_t>(from, length);
    else
      take_bytes(from, length, frame.bytes[array["name"]]);
  }
  EXPECT_EQ(from, bytes.data() + bytes.size());
  if (frame.kind == 1 && frame.header["role"] == "model") {
    shown_ = rest_ = frame.numbers["positions"];
    offset_ = frame.header["offset"].get<std::vector<double>>();
    mesh_ = frame.header["mesh"];
  }
  if (frame.kind == 2) {
    EXPECT_EQ(frame.header["mesh"], mesh_);
    const std::vector<float>& positions = frame.numbers["positions"];
    if (!frame.indices.contains("vertices")) {
      shown_ = positions;
    } else {
      shown_ = rest_;
      const auto& vertices = frame.indices["vertices"];
      for (std::size_t i = 0; i < vertices.size(); ++i)
        std::copy_n(positions.begin() + static_cast<std::ptrdiff_t>(3 * i), 3,
                    shown_.begin() + 3 * vertices[i]);
    }
  }
  frames_.push_back(std::move(frame));
}

Json Page::reply_to(int id) {
  while (!replies_.contains(id)) read();
  return replies_[id];
}

Json Page::ask(const Json& request) {
  const Json reply = reply_to(send(request));
  EXPECT_TRUE(reply.contains("result")) << request << " is answered by " << reply;
  return reply.value("result", Json());
}

Json Page::refusal(const Json& request) {
  const Json reply = reply_to(send(request));
  EXPECT_TRUE(reply.contains("error")) << request << " is answered by " << reply;
  return reply.value("error", Json());
}

Json Page::event(const std::string& name, const std::function<bool(const Json&)>& is_right) {
  for (std::size_t i = 0;; ++i) {
    while (i >= events_.size()) read();
    if (events_[i]["event"] != name || (is_right && !is_right(events_[i]))) continue;
    const Json found = events_[i];
    events_.erase(events_.begin() + static_cast<std::ptrdiff_t>(i));
    return found;
  }
}

Frame Page::frame(std::uint32_t kind, const std::function<bool(const Frame&)>& is_right) {
  for (std::size_t i = 0;; ++i) {
    while (i >= frames_.size()) read();
    if (frames_[i].kind != kind || (is_right && !is_right(frames_[i]))) continue;
    const Frame found = frames_[i];
    frames_.erase(frames_.begin() + static_cast<std::ptrdiff_t>(i));
    return found;
  }
}

const std::vector<float>& Page::exact(const Json& pose) {
  frame(2, [&](const Frame& frame) {
    return frame.header["accuracy"] == "exact" && frame.header["pose"] >= pose;
  });
  return shown_;
}

std::vector<int> Page::vertices(const std::function<bool(double, double, double)>& is_inside) const {
  std::vector<int> found;
  for (std::size_t v = 0; v < rest_.size() / 3; ++v)
    if (is_inside(rest_[3 * v] + offset_[0], rest_[3 * v + 1] + offset_[1], rest_[3 * v + 2] + offset_[2]))
      found.push_back(static_cast<int>(v));
  return found;
}

}  // namespace meshgraft::test
