#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include <meshgraft/script/edit_file.h>

namespace meshgraft::cli {

/// Returns the words that an option takes, or nothing if it takes free text. The type name of the option
/// lists them: "a|b|c".
std::vector<std::string> choices_of(const CLI::Option& option);

/// Refuses everything but `words`. The error names the word nearest to the given one.
CLI::Validator one_of(const std::vector<std::string>& words);

/// Adds an option that takes one of a few words, each with its value.
template <class T>
CLI::Option* add_choice(CLI::App& command, const std::string& name, std::optional<T>& value,
                        const std::vector<std::pair<std::string, T>>& choices, const std::string& description) {
  std::vector<std::string> words;
  for (const auto& [word, meaning] : choices) words.push_back(word);
  const auto set = [&value, choices](const std::string& given) {
    for (const auto& [word, meaning] : choices)
      if (word == given) value = meaning;
  };
  return command.add_option_function<std::string>(name, set, description)
      ->type_name(CLI::detail::join(words, "|"))
      ->check(one_of(words));
}

/// Validators that refuse all but finite numbers of a range. Their messages state the range.
CLI::Validator finite_number();
CLI::Validator positive_number();
CLI::Validator number_from(double least, double most);
CLI::Validator whole_number_from(int least, int most);

/// Adds `--as-published`, which sets the preset.
CLI::Option* add_as_published(CLI::App& command, std::optional<Preset>& preset);

/// Adds `--threads N`.
CLI::Option* add_threads(CLI::App& command, int& threads);

/// Adds `--upright`, which `parse_upright` reads.
CLI::Option* add_upright(CLI::App& command, std::string& text);

/// Adds `--memory`, in bytes here and MB on the command line; 0 without it, as in Context.
CLI::Option* add_memory(CLI::App& command, std::uint64_t& bytes);

}  // namespace meshgraft::cli
