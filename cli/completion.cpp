#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <meshgraft/samples/samples.h>

#include "choices.h"
#include "command_tree.h"
#include "commands.h"

namespace meshgraft::cli {

namespace {

enum class Shell { bash, zsh, fish };

bool wants_file(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  return type == "FILE" || type == "FOLDER" || type == "MESH" || type == "EDIT.json";
}

// Returns the words that a command's first argument can be, where they are known.
std::vector<std::string> argument_words(const CLI::App& command) {
  std::vector<std::string> words;
  for (const CLI::Option* argument : arguments_of(command)) {
    if (argument->get_type_name() == "NAME")
      for (const SampleInfo& sample : sample_list()) words.emplace_back(sample.name);
    for (const std::string& word : choices_of(*argument)) words.push_back(word);
  }
  return words;
}

std::vector<std::string> all_spellings(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : dashed_options(command))
    for (const std::string& name : spellings(*option)) names.push_back(name);
  return names;
}

// Returns the text in single quotes. Shells end a quotation to escape a quote in it.
std::string shell_quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string bash_command(const CLI::App& command) {
  std::string text = fmt::format("    {})\n      case $previous in\n", command.get_name());
  for (const CLI::Option* option : dashed_options(command)) {
    if (!takes_value(*option)) continue;
    const std::vector<std::string> words = choices_of(*option);
    const std::string reply =
        !words.empty()
            ? fmt::format("compgen -W {} -- \"$word\"", shell_quoted(fmt::format("{}", fmt::join(words, " "))))
        : wants_file(*option) ? std::string("compgen -f -- \"$word\"")
                              : std::string(":");
    text += fmt::format("        {}) mapfile -t COMPREPLY < <({}); return ;;\n",
                        fmt::join(spellings(*option), "|"), reply);
  }
  text += "      esac\n";
  const std::vector<std::string> words = argument_words(command);
  text += fmt::format("      if [[ $word == -* ]]; then mapfile -t COMPREPLY < <(compgen -W {} -- \"$word\")\n",
                      shell_quoted(fmt::format("{}", fmt::join(all_spellings(command), " "))));
  text += words.empty() ? std::string("      else mapfile -t COMPREPLY < <(compgen -f -- \"$word\")\n")
                        : fmt::format("      else mapfile -t COMPREPLY < <(compgen -W {} -- \"$word\")\n",
                                      shell_quoted(fmt::format("{}", fmt::join(words, " "))));
  return text + "      fi ;;\n";
}

std::string bash_script(const CLI::App& program) {
  std::vector<std::string> first = all_spellings(program);
  std::string cases;
  for (const CLI::App* command : commands_of(program)) {
    first.push_back(command->get_name());
    cases += bash_command(*command);
  }
  return fmt::format(
      "# bash completion for meshgraft\n"
      "_meshgraft() {{\n"
      "  local word=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}}\n"
      "  COMPREPLY=()\n"
      "  if ((COMP_CWORD == 1)); then mapfile -t COMPREPLY < <(compgen -W {} -- \"$word\"); return; fi\n"
      "  case ${{COMP_WORDS[1]}} in\n{}  esac\n"
      "}}\n"
      "complete -o filenames -F _meshgraft meshgraft\n",
      shell_quoted(fmt::format("{}", fmt::join(first, " "))), cases);
}

// Escapes brackets and colons, which have a meaning of their own in a description for zsh.
std::string zsh_text(const std::string& text) {
  std::string escaped;
  for (const char c : text)
    escaped += c == '[' || c == ']' || c == ':' ? fmt::format("\\{}", c) : std::string(1, c);
  return escaped;
}

std::string zsh_action(const CLI::Option& option) {
  const std::vector<std::string> words = choices_of(option);
  if (!words.empty()) return fmt::format("({})", fmt::join(words, " "));
  return wants_file(option) ? "_files" : "";
}

std::string zsh_command(const CLI::App& command) {
  std::string text = fmt::format("    {})\n      _arguments", command.get_name());
  for (const CLI::Option* option : dashed_options(command)) {
    for (const std::string& name : spellings(*option)) {
      std::string spec = fmt::format("{}[{}]", name, zsh_text(option->get_description()));
      if (takes_value(*option))
        spec += fmt::format(":{}:{}", zsh_text(option->get_type_name()), zsh_action(*option));
      text += " \\\n        " + shell_quoted(spec);
    }
  }
  const std::vector<std::string> words = argument_words(command);
  const std::string argument = words.empty() ? "_files" : fmt::format("({})", fmt::join(words, " "));
  if (!arguments_of(command).empty()) text += " \\\n        " + shell_quoted("*:argument:" + argument);
  return text + " ;;\n";
}

std::string zsh_script(const CLI::App& program) {
  std::string names, cases;
  for (const CLI::App* command : commands_of(program)) {
    names += "    " + shell_quoted(command->get_name() + ":" + zsh_text(command->get_description())) + "\n";
    cases += zsh_command(*command);
  }
  return fmt::format(
      "#compdef meshgraft\n"
      "_meshgraft() {{\n"
      "  local -a commands=(\n{}  )\n"
      "  if ((CURRENT == 2)); then _describe command commands; return; fi\n"
      "  shift words; ((CURRENT--))\n"
      "  case $words[1] in\n{}  esac\n"
      "}}\n"
      "_meshgraft \"$@\"\n",
      names, cases);
}

std::string fish_option(const std::string& command, const CLI::Option& option) {
  std::string line = fmt::format("complete -c meshgraft -n '__fish_seen_subcommand_from {}'", command);
  for (const std::string& name : option.get_snames()) line += " -s " + name;
  for (const std::string& name : option.get_lnames()) line += " -l " + name;
  const std::vector<std::string> words = choices_of(option);
  if (!words.empty())
    line += fmt::format(" -x -a {}", shell_quoted(fmt::format("{}", fmt::join(words, " "))));
  else if (takes_value(option))
    line += wants_file(option) ? " -r -F" : " -x";
  return fmt::format("{} -d {}\n", line, shell_quoted(option.get_description()));
}

std::string fish_script(const CLI::App& program) {
  std::string text = "# fish completion for meshgraft\n";
  for (const CLI::App* command : commands_of(program)) {
    text += fmt::format("complete -c meshgraft -n __fish_use_subcommand -x -a {} -d {}\n", command->get_name(),
                        shell_quoted(command->get_description()));
    for (const CLI::Option* option : dashed_options(*command))
      text += fish_option(command->get_name(), *option);
    if (const auto words = argument_words(*command); !words.empty())
      text += fmt::format("complete -c meshgraft -n '__fish_seen_subcommand_from {}' -x -a {}\n",
                          command->get_name(), shell_quoted(fmt::format("{}", fmt::join(words, " "))));
  }
  return text;
}

std::string script(const CLI::App& program, Shell shell) {
  switch (shell) {
    case Shell::bash: return bash_script(program);
    case Shell::zsh: return zsh_script(program);
    case Shell::fish: return fish_script(program);
  }
  return {};
}

}  // namespace

void add_completion(CLI::App& program, Action& action) {
  const auto shell = std::make_shared<std::optional<Shell>>();
  CLI::App* command = program.add_subcommand("completion", "Print the completion script for a shell");
  add_choice<Shell>(*command, "shell", *shell,
                    {{"bash", Shell::bash}, {"zsh", Shell::zsh}, {"fish", Shell::fish}}, "The shell")
      ->required();
  command->footer("Example:\n  source <(meshgraft completion bash)");
  command->callback([shell, &program, &action] {
    action = [shell, &program](const Context&) { fmt::print("{}", script(program, **shell)); };
  });
}

}  // namespace meshgraft::cli
