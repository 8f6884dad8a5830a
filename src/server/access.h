#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace meshgraft {

/// 128 random bits of the system's source, as 32 hexadecimal digits.
std::string random_token();

/// A request's target taken apart: its path, and the fields of its query, percent signs decoded.
struct Target {
  std::string path;
  std::map<std::string, std::string> fields;

  std::string field(const std::string& name) const;  ///< empty where there is none
};

/// Throws Error(input) for a target that does not begin with a slash, or whose escapes are broken.
Target parse_target(std::string_view target);

/// Who may talk to the server: pages that it served itself, to whoever knows its address. Another site in the
/// same browser cannot read the token, sends its own Origin, and by another name for this address (DNS
/// rebinding) another Host.
class Access {
 public:
  Access(std::string token, std::string_view address, std::uint16_t port);

  bool allows_host(std::string_view host) const;
  bool allows_origin(std::string_view origin) const;
  bool allows_token(std::string_view token) const;  ///< takes as long for any wrong one of the same length

 private:
  std::string token_;
  std::vector<std::string> hosts_;
};

}  // namespace meshgraft
