#include <string>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/core/version.h>

#include "command_tree.h"
#include "commands.h"
#include "exit_status.h"

namespace meshgraft::cli {

namespace {

// Escapes text so that roff prints it literally.
std::string roff(const std::string& text) {
  std::string escaped;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool starts_line = i == 0 || text[i - 1] == '\n';
    if (starts_line && (text[i] == '.' || text[i] == '\'')) escaped += "\\&";
    if (text[i] == '\\')
      escaped += "\\e";
    else if (text[i] == '-')
      escaped += "\\-";
    else
      escaped += text[i];
  }
  return escaped;
}

std::string usage_of(const CLI::App& command) {
  std::string usage = fmt::format("\\fBmeshgraft {}\\fR", roff(command.get_name()));
  for (const CLI::Option* argument : arguments_of(command)) {
    const std::string name = fmt::format("\\fI{}\\fR", roff(argument->get_type_name()));
    const std::string repeated = argument->get_items_expected_max() > 1 ? name + "..." : name;
    usage += argument->get_required() ? " " + repeated : fmt::format(" [{}]", repeated);
  }
  for (const CLI::Option* option : dashed_options(command))
    if (option->get_required())
      usage += fmt::format(" \\fB{}\\fR \\fI{}\\fR", roff(spellings(*option).front()),
                           roff(option->get_type_name()));
  return usage + " [options]";
}

std::string option_entry(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : spellings(option))
    names += fmt::format("{}\\fB{}\\fR", names.empty() ? "" : ", ", roff(name));
  if (takes_value(option)) names += fmt::format(" \\fI{}\\fR", roff(option.get_type_name()));
  return fmt::format(".TP\n{}\n{}.\n", names, roff(option.get_description()));
}

std::string argument_entry(const CLI::Option& argument) {
  return fmt::format(".TP\n\\fI{}\\fR\n{}.\n", roff(argument.get_type_name()),
                     roff(argument.get_description()));
}

// Returns the remarks and examples of a command. Its footer has paragraphs of remarks, a blank line, then a
// heading line and indented commands.
std::string footer_section(const CLI::App& command) {
  const std::string footer = command.get_footer();
  const std::size_t end_of_remarks = footer.rfind("\n\n");
  const std::size_t heading = end_of_remarks == std::string::npos ? 0 : end_of_remarks + 2;
  const std::size_t end_of_heading = footer.find('\n', heading);
  if (end_of_heading == std::string::npos) return {};
  const std::string remarks = heading == 0 ? "" : ".PP\n" + roff(footer.substr(0, end_of_remarks)) + "\n";
  return remarks + fmt::format(".PP\n{}\n.PP\n.EX\n{}\n.EE\n",
                               roff(footer.substr(heading, end_of_heading - heading)),
                               roff(footer.substr(end_of_heading + 1)));
}

std::string command_section(const CLI::App& command) {
  std::string text = fmt::format(".SS meshgraft {}\n{}\n.PP\n{}.\n", roff(command.get_name()),
                                 usage_of(command), roff(command.get_description()));
  for (const CLI::Option* argument : arguments_of(command)) text += argument_entry(*argument);
  for (const CLI::Option* option : dashed_options(command)) text += option_entry(*option);
  return text + footer_section(command);
}

std::string exit_section() {
  const auto entry = [](int status, std::string_view meaning) {
    return fmt::format(".TP\n\\fB{}\\fR\n{}\n", status, meaning);
  };
  return ".SH EXIT STATUS\n" + entry(0, "Done.") +
         entry(exit_status(ErrorCode::usage), "The command line is malformed.") +
         entry(exit_status(ErrorCode::input), "A file, a mesh or a setting is not acceptable.") +
         entry(exit_status(ErrorCode::unsolvable), "The edit has no unique solution.") +
         entry(exit_status(ErrorCode::io), "A file cannot be read or written.") +
         entry(exit_status(ErrorCode::memory), "The machine has too little memory for it.") +
         entry(exit_status(ErrorCode::internal), "A bug in meshgraft.") +
         entry(exit_status(ErrorCode::cancelled), "Stopped by Ctrl\\-C; nothing was written.");
}

std::string manual(const CLI::App& program) {
  std::string text =
      fmt::format(".TH MESHGRAFT 1 \"\" \"meshgraft {}\" \"User Commands\"\n", MESHGRAFT_VERSION);
  text += ".SH NAME\nmeshgraft \\- mesh editing with affine\\-invariant Laplacian coordinates\n.SH SYNOPSIS\n";
  for (const CLI::App* command : commands_of(program)) text += usage_of(*command) + "\n.br\n";
  text +=
      ".SH DESCRIPTION\nMoves, turns, scales and bends parts of detailed meshes by a few handles; the details "
      "follow.\nAn edit is described by a file, which says what may move, what stays, and where the handles "
      "go.\nOutput files appear whole or not at all, and never in the place of an input unless asked.\n";
  text += ".SH OPTIONS\n";
  for (const CLI::Option* option : dashed_options(program)) text += option_entry(*option);
  text += ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(program)) text += command_section(*command);
  return text + exit_section();
}

}  // namespace

void add_man(CLI::App& program, Action& action) {
  CLI::App* command = program.add_subcommand("man", "Print the manual page");
  command->footer("Example:\n  meshgraft man > meshgraft.1 && man ./meshgraft.1");
  command->callback(
      [&program, &action] { action = [&program](const Context&) { fmt::print("{}", manual(program)); }; });
}

}  // namespace meshgraft::cli
