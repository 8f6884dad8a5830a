#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace meshgraft {

/// Returns 128 random bits from the system's source, as 32 hexadecimal digits.
std::string random_token();

/// A request's target, parsed: its path and the fields of its query, percent-decoded.
struct Target {
  std::string path;
  std::map<std::string, std::string> fields;

  std::string field(const std::string& name) const;  ///< empty if there is none
};

/// Parses a target. Throws Error(input) if it does not begin with a slash, or if its escapes are broken.
Target parse_target(std::string_view target);

/// Returns whether a text is an origin as browsers write it, SCHEME://HOST or SCHEME://HOST:PORT.
bool is_origin(std::string_view text);

/// Decides which requests the server accepts: those from its own pages, opened with the full address. Another
/// site in the same browser cannot read the token and sends its own Origin. Under another name for this
/// address (DNS rebinding) it sends another Host.
class Access {
 public:
  /// `proxies`: origins of servers that forward requests to this one, and leave Host and Origin as they are.
  Access(std::string token, std::uint16_t port, const std::vector<std::string>& proxies = {});

  bool allows_host(std::string_view host) const;
  bool allows_origin(std::string_view origin) const;
  bool allows_token(std::string_view token) const;  ///< constant time for tokens of one length

 private:
  std::string token_;
  std::vector<std::string> hosts_, origins_;
};

}  // namespace meshgraft
