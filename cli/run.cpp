#include <memory>

#include "choices.h"
#include "commands.h"
#include "edit_run.h"

namespace meshgraft::cli {

void add_run(CLI::App& program, Action& action) {
  const auto arguments = std::make_shared<EditRunArguments>();
  CLI::App* command = program.add_subcommand("run", "Run an edit file, whatever its steps are");
  command
      ->add_option("-o,--output", arguments->output,
                   "The mesh file to write of the edit's output; its extension is the format")
      ->type_name("FILE");
  command
      ->add_option("--save", arguments->saves,
                   "Write another mesh of the edit as its last step leaves it; repeatable")
      ->type_name("NAME=FILE")
      ->expected(1)
      ->take_all();
  add_edit_run_options(*command, *arguments);
  add_choice<MergeShape>(*command, "--shape", arguments->run.overrides.shape,
                         {{"similar", MergeShape::similar}, {"ft05", MergeShape::ft05}},
                         "How sources deform: only within the reach (similar), or as in the paper (ft05)");
  command->add_flag("--strict", arguments->run.strict, "Fail where a merge's result intersects itself");
  command->footer(
      "Without -o and --save no mesh is written: it tells what the edit does.\n\n"
      "Example:\n  meshgraft run edit.json -o whole.ply --save body=body.ply");
  command->callback([arguments, &action] {
    action = [arguments](const Context& context) { run_edit_file(*arguments, context); };
  });
}

}  // namespace meshgraft::cli
