#include "choices.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace meshgraft::cli {

std::vector<std::string> choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  if (type.find('|') == std::string::npos) return {};
  return CLI::detail::split(type, '|');
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  const auto check = [words](const std::string& given) {
    if (std::find(words.begin(), words.end(), given) != words.end()) return std::string();
    return fmt::format("'{}' is not one of {}", given, fmt::join(words, ", "));
  };
  return CLI::Validator(check, "");
}

CLI::Option* add_threads(CLI::App& command, int& threads) {
  return command
      .add_option("--threads", threads,
                  "Worker threads; the result does not depend on it (default: one per core)")
      ->type_name("N")
      ->check(CLI::Validator(
          [](const std::string& given) {
            int count = 0;
            const bool valid = CLI::detail::lexical_cast(given, count) && count >= 1 && count <= 1024;
            return valid ? std::string() : fmt::format("'{}' is not a number from 1 to 1024", given);
          },
          ""));
}

}  // namespace meshgraft::cli
