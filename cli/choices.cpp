#include "choices.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

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

namespace {

// Returns the number that the whole text spells, or nothing.
template <class T>
std::optional<T> number_in(std::string_view text) {
  T value{};
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <class T, class Test>
CLI::Validator numbers_that(const std::string& words, Test test) {
  return CLI::Validator(
      [=](const std::string& given) {
        const auto value = number_in<T>(given);
        return value && test(*value) ? std::string() : fmt::format("'{}' is not {}", given, words);
      },
      "");
}

}  // namespace

CLI::Validator finite_number() {
  return numbers_that<double>("a finite number", [](double value) { return std::isfinite(value); });
}

CLI::Validator positive_number() {
  return numbers_that<double>("a positive number",
                              [](double value) { return value > 0 && std::isfinite(value); });
}

CLI::Validator number_from(double least, double most) {
  return numbers_that<double>(fmt::format("a number from {} to {}", least, most),
                              [=](double value) { return value >= least && value <= most; });
}

CLI::Validator whole_number_from(int least, int most) {
  return numbers_that<int>(fmt::format("a whole number from {} to {}", least, most),
                           [=](int value) { return value >= least && value <= most; });
}

CLI::Option* add_as_published(CLI::App& command, std::optional<Preset>& preset) {
  return command.add_flag_callback(
      "--as-published", [&preset] { preset = Preset::as_published; },
      "Solve as Fu and Tai's paper of 2005 says; other options beside it win");
}

CLI::Option* add_threads(CLI::App& command, int& threads) {
  return command
      .add_option("--threads", threads,
                  "Worker threads; the result does not depend on it (default: one per core)")
      ->type_name("N")
      ->check(whole_number_from(1, 1024));
}

CLI::Option* add_upright(CLI::App& command, std::string& text) {
  return command
      .add_option(
          "--upright", text,
          "Axes that are up and front in target and source, such as z,-y:y,z (default: guessed); a start "
          "that is found brings up to up and front to front")
      ->type_name("UP,FRONT:UP,FRONT");
}

CLI::Option* add_memory(CLI::App& command, std::uint64_t& bytes) {
  return command
      .add_option_function<std::uint64_t>(
          "--memory", [&bytes](std::uint64_t megabytes) { bytes = megabytes * 1'000'000; },
          "The most memory that reading a file may take, in MB (default: three quarters of what there is)")
      ->type_name("MB")
      ->check(whole_number_from(1, 1'000'000'000));
}

}  // namespace meshgraft::cli
