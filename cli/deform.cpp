#include <memory>

#include "commands.h"
#include "edit_run.h"

namespace meshgraft::cli {

void add_deform(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<EditRunArguments>();
  CLI::App* command = program.add_subcommand("deform", "Run an edit file: deform meshes by their handles");
  command->add_option("-o,--output", arguments->output, "The mesh file to write; its extension is the format")
      ->required()
      ->type_name("FILE");
  add_edit_run_options(*command, *arguments);
  command->footer("Example:\n  meshgraft deform examples/octopus_wave.json -o waving.ply --report report.json");
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_edit_file(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
