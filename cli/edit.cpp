#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
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

constexpr const char* word_of(editor::EditorEnd end) {
  switch (end) {
    case editor::EditorEnd::done: return "done";
    case editor::EditorEnd::closed: return "closed";
    case editor::EditorEnd::stopped: break;
  }
  return "stopped";
}

// Requests a stop when the program that waits for the result has ended, which closes this program's input.
class StopWithInput {
 public:
  StopWithInput(const std::stop_source& source, bool watches) {
    if (watches)
      thread_ = std::jthread([source](const std::stop_token& ended) mutable {
        if (platform::wait_for_closed_input(ended)) source.request_stop();
      });
  }

 private:
  std::jthread thread_;
};

void run_edit(const EditArguments& arguments, const Context& context) {
  editor::EditorOptions options = arguments.options;
  options.port = static_cast<std::uint16_t>(arguments.port.value_or(usual_port));
  options.or_free_port = !arguments.port;
  if (options.models.empty() && options.folders.empty()) options.folders = {std::filesystem::current_path()};
  const auto started = [&](const editor::EditorAddress& address) {
    fmt::print("{}\n", address.url);
    std::fflush(stdout);
    if (!arguments.no_browser) platform::open_in_browser(address.page.string());
  };
  const bool is_waited_for = !options.result.empty();
  std::stop_source stop;
  const std::stop_callback on_stop(context.stop_token, [&] { stop.request_stop(); });
  const StopWithInput watch(stop, is_waited_for);
  const editor::EditorEnd end = editor::run_editor(options, started, stop.get_token());
  if (is_waited_for) fmt::print("{}\n", word_of(end));
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
      ->add_option("--folder", arguments->options.folders,
                   "A folder that may be read and written; repeatable. Without it and without models: the "
                   "folder you are in")
      ->type_name("DIR")
      ->allow_extra_args(false);
  command->add_flag("--no-browser", arguments->no_browser, "Print the address, and open no browser");
  command
      ->add_option(
          "--result", arguments->options.result,
          "For a program that waits: an edit file, written with every change. The page's button Done, and "
          "closing the page, end the editor")
      ->type_name("JSON");
  command
      ->add_option("--frame-origin", arguments->options.frame_origins,
                   "An origin whose pages may frame the editor's, as http://HOST:PORT; repeatable")
      ->type_name("ORIGIN")
      ->allow_extra_args(false);
  command->footer("Example:\n  meshgraft edit octopus.ply");
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_edit(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
