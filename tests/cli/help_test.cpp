#include <filesystem>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command_line.h"
#include "support/paths.h"

namespace meshgraft::test {
namespace {

using nlohmann::json;

std::vector<std::string> commands() {
  return {"info", "check", "repair", "run", "deform", "compare", "cut", "merge", "sample", "completion", "man"};
}

TEST_F(CommandLine, EveryCommandHasHelpWithAnExample) {
  const std::string overview = run("--help").out;
  for (const std::string& command : commands()) {
    EXPECT_NE(overview.find("\n  " + command), std::string::npos) << overview;
    const Outcome outcome = run(command + " --help");
    EXPECT_EQ(outcome.status, 0);
    EXPECT_NE(outcome.out.find("Example"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("meshgraft " + command), std::string::npos) << outcome.out;
    EXPECT_FALSE(std::regex_search(outcome.out, std::regex("\\(\\d+x\\)| x \\d|[A-Z]=[a-z]"))) << outcome.out;
  }
  EXPECT_NE(run("run --help").out.find("Usage: meshgraft run [OPTIONS] EDIT.json\n"), std::string::npos);
  EXPECT_NE(run("run --help").out.find("--as-morph-target [NAME] "), std::string::npos);
  EXPECT_NE(run("run --help").out.find("--feature SELECTION ... "), std::string::npos);
  if (const Outcome render = run("render --help"); render.status == 0) {
    EXPECT_NE(render.out.find("Usage: meshgraft render [OPTIONS] MESH...\n"), std::string::npos) << render.out;
    EXPECT_NE(render.out.find("--from X Y Z "), std::string::npos) << render.out;
  }
  EXPECT_EQ(run("--version").out.find("meshgraft "), 0u);
}

TEST_F(CommandLine, TheManualAndTheCompletionsKnowEveryCommandAndOption) {
  const std::string manual = run("man").out;
  EXPECT_EQ(manual.find(".TH MESHGRAFT 1"), 0u);
  for (const std::string& command : commands())
    EXPECT_NE(manual.find(".SS meshgraft " + command), std::string::npos) << command;
  EXPECT_NE(manual.find(".PP\nPairs of loops and of vertices"), std::string::npos) << "remarks are no examples";
  EXPECT_NE(manual.find(".PP\nExamples:\n.PP\n.EX\n  meshgraft merge torso"), std::string::npos);
  for (const char* shell : {"bash", "zsh", "fish"}) {
    const Outcome outcome = run(std::string("completion ") + shell);
    EXPECT_EQ(outcome.status, 0);
    for (const std::string& command : commands())
      EXPECT_NE(outcome.out.find(command), std::string::npos) << shell << " " << command;
    for (const char* option : {"degenerate", "report", "in-place", "cotangent", "octopus"})
      EXPECT_NE(outcome.out.find(option), std::string::npos) << shell << " " << option;
  }
  for (const char* option : {"\\-\\-degenerate", "\\-\\-report", "\\-\\-in\\-place", "ft05\\-noise|apex|auto"})
    EXPECT_NE(manual.find(option), std::string::npos) << option;
}

TEST_F(CommandLine, MessagesNameCommandsAndOptionsThatExist) {
  std::string known = run("completion fish").out + " -l help -l version";
  if (run("render --help").status != 0) known += " -l from -l up";  // built without the renderer
  const std::regex named("--([a-z][a-z-]+)|'meshgraft ([a-z]+)");
  for (const char* table : {"cli/facts.json", "cli/texts.json"}) {
    const std::string text = read_text(source_path(table));
    for (std::sregex_iterator one(text.begin(), text.end(), named), end; one != end; ++one) {
      const std::string word = (*one)[1].matched ? " -l " + (*one)[1].str() : " -a " + (*one)[2].str();
      EXPECT_NE(known.find(word), std::string::npos) << table << ": " << one->str();
    }
  }
}

TEST_F(CommandLine, BashCompletesCommandsOptionsAndValues) {
  write("complete.sh", std::string("source <('") + program() +
                           "' completion bash)\n"
                           "complete_words() { COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _meshgraft; echo "
                           "\"${COMPREPLY[*]}\"; }\n"
                           "complete_words meshgraft de\n"
                           "complete_words meshgraft deform --wei\n"
                           "complete_words meshgraft deform --weights c\n"
                           "complete_words meshgraft sample oct\n"
                           "complete_words meshgraft info she\n"
                           "complete_words meshgraft compare --methods ar\n");
  const Outcome outcome = run("--version > /dev/null; bash complete.sh");
  EXPECT_EQ(outcome.out, "deform\n--weights\ncotangent\noctopus\nsheet.obj\narap-2007\n") << outcome.err;
}

}  // namespace
}  // namespace meshgraft::test
