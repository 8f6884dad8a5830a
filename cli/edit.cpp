#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "choices.h"
#include "commands.h"
#include "core/platform/process.h"
#include "editor/editor.h"

namespace meshgraft::cli {

namespace {

// The port is the same each time, because the browser keeps a page's stored data per address.
constexpr int usual_port = 8417;

struct EditArguments {
  editor::EditorOptions options;
  std::optional<int> port;
  bool no_browser = false;
};

void run_edit(const EditArguments& arguments, const Context& context) {
  editor::EditorOptions options = arguments.options;
  options.port = static_cast<std::uint16_t>(arguments.port.value_or(usual_port));
  options.or_free_port = !arguments.port;
  const auto started = [&](const editor::EditorAddress& address) {
    fmt::print("{}\n", address.url);
    std::fflush(stdout);
    if (!arguments.no_browser) platform::open_in_browser(address.page.string());
  };
  editor::run_editor(options, started, context.stop_token);
}

}  // namespace

void add_edit(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<EditArguments>();
  CLI::App* command =
      program.add_subcommand("edit", "Start the editor's engine, for a browser on this machine");
  command
      ->add_option("models", arguments->options.models,
                   "Models and edit files to offer; their folders may be used")
      ->type_name("MODEL");
  command
      ->add_option(
          "--port", arguments->port,
          fmt::format(
              "The port to listen to; 0: one that is free. Without: {}, or a free one where it is taken",
              usual_port))
      ->type_name("N")
      ->check(whole_number_from(0, 65535));
  command
      ->add_option("--folder", arguments->options.folders, "A folder that may be read and written; repeatable")
      ->type_name("DIR")
      ->allow_extra_args(false);
  command->add_flag("--no-browser", arguments->no_browser, "Print the address, and open no browser");
  command->footer("Example:\n  meshgraft edit octopus.ply");
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_edit(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
