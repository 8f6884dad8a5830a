#include "access.h"

#include <algorithm>
#include <cctype>
#include <random>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "core/hex_digit.h"
#include "server/facts.h"

namespace meshgraft {

namespace {

std::string decode(std::string_view text) {
  std::string decoded;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      decoded += text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1,
              low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
    if (high < 0 || low < 0) throw Error(facts::server::BadEscape{});
    decoded += static_cast<char>(16 * high + low);
    i += 2;
  }
  return decoded;
}

}  // namespace

std::string random_token() {
  std::random_device source;
  std::string token;
  for (int part = 0; part < 4; ++part) token += fmt::format("{:08x}", source());
  return token;
}

std::string Target::field(const std::string& name) const {
  const auto found = fields.find(name);
  return found == fields.end() ? std::string() : found->second;
}

Target parse_target(std::string_view target) {
  if (!target.starts_with('/')) throw Error(facts::server::TargetWithoutSlash{});
  const std::size_t question = std::min(target.find('?'), target.size());
  Target parsed{decode(target.substr(0, question)), {}};
  std::string_view query = target.substr(std::min(question + 1, target.size()));
  while (!query.empty()) {
    const std::string_view field = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(field.size() + 1, query.size()));
    const std::size_t equals = std::min(field.find('='), field.size());
    parsed.fields[decode(field.substr(0, equals))] = decode(field.substr(std::min(equals + 1, field.size())));
  }
  return parsed;
}

bool is_origin(std::string_view text) {
  const std::size_t colon = text.find("://");
  if (colon == std::string_view::npos || colon == 0) return false;
  const auto consists_of = [](std::string_view part, std::string_view others) {
    return !part.empty() && std::all_of(part.begin(), part.end(), [&](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || others.find(c) != std::string_view::npos;
    });
  };
  return consists_of(text.substr(0, colon), "+-.") && consists_of(text.substr(colon + 3), "-._:[]");
}

Access::Access(std::string token, std::uint16_t port, const std::vector<std::string>& proxies)
    : token_(std::move(token)) {
  for (const char* name : {"127.0.0.1", "[::1]", "localhost"}) {
    hosts_.push_back(fmt::format("{}:{}", name, port));
    origins_.push_back("http://" + hosts_.back());
  }
  for (const std::string& proxy : proxies) {
    hosts_.push_back(proxy.substr(proxy.find("://") + 3));
    origins_.push_back(proxy);
  }
}

bool Access::allows_host(std::string_view host) const {
  return std::find(hosts_.begin(), hosts_.end(), host) != hosts_.end();
}

bool Access::allows_origin(std::string_view origin) const {
  return std::find(origins_.begin(), origins_.end(), origin) != origins_.end();
}

bool Access::allows_token(std::string_view token) const {
  if (token.size() != token_.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < token.size(); ++i)
    difference |= static_cast<unsigned char>(token[i]) ^ static_cast<unsigned char>(token_[i]);
  return difference == 0;
}

}  // namespace meshgraft
