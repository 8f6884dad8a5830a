#include "sha256.h"

#include <array>

#include <fmt/format.h>
#include <openssl/evp.h>

#include <meshgraft/core/error.h>

#include "script/facts.h"

namespace meshgraft {

std::string sha256(std::string_view bytes) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  if (EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr) != 1)
    throw Error(facts::script::Sha256Failed{});
  std::string text;
  for (unsigned int k = 0; k < length; ++k) text += fmt::format("{:02x}", digest[k]);
  return text;
}

}  // namespace meshgraft
