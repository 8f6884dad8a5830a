#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "command_line.h"
#include "support/paths.h"

namespace meshgraft::test {
namespace {

using nlohmann::json;

TEST_F(CommandLine, ExitStatusesTellWhatIsWrong) {
  write("broken.json", "{");
  write("loose.json", R"({"format": "meshgraft-edit", "version": 2, "inputs": {"sheet": {"file": "sheet.obj"}},
      "steps": [{"kind": "deform", "mesh": "sheet", "handles": [
        {"name": "h", "select": {"indices": [3]}, "constrain": "position"}]}]})");
  write("no_mesh.json", R"({"format": "meshgraft-edit", "version": 2, "inputs": {"sheet": {"file": "no.obj"}},
      "steps": [{"kind": "deform", "mesh": "sheet"}]})");
  struct Case {
    const char* arguments;
    int status;
    const char* message;
  };
  const Case cases[] = {
      {"", 2, "subcommand"},
      {"defrom edit.json", 2, "'defrom' is not a command"},
      {"deform edit.json", 2, "--output"},
      {"deform edit.json -o ''", 2, "error: --output: its value is empty"},
      {"deform edit.json -o o.ply --report ''", 2, "error: --report: its value is empty"},
      {"compare edit.json --methods ''", 2, "error: --methods: its value is empty"},
      {"deform edit.json -o o.ply --feature loop:9", 3, "error: --feature loop:9: boundary loop 9"},
      {"deform edit.json -o o.ply --feature indices:0 --feature file:no.txt", 3, "error: --feature "},
      {"deform edit.json -o o.ply --weights cotan", 2, "'cotan' is not one of uniform, cotangent"},
      {"deform edit.json -o o.ply --method linear", 2,
       "'linear' is not one of ft05, rotation-aware, corotational, shell"},
      {"deform edit.json -o o.ply --stiffness -1", 2, "--stiffness"},
      {"deform edit.json -o o.ply --stiffness soft", 2, "--stiffness"},
      {"deform edit.json -o o.ply --iterations 1001", 2, "--iterations"},
      {"deform edit.json -o o.ply --iterations 1.5", 2, "--iterations"},
      {"deform edit.json -o o.ply --stiffness nan", 2, "--stiffness: 'nan' is not a number from 0 to 1000000"},
      {"deform edit.json -o o.ply --threads 0", 2, "not a whole number from 1 to 1024"},
      {"deform edit.json -o o.ply --picture p.png --from nan 0 1", 2, "--from: 'nan' is not a finite number"},
      {"deform edit.json -o o.ply --picture p.png --up 0 0 0", 2, "--up: 0 0 0 is no direction"},
      {"deform edit.json -o o.ply --from 1 0 0", 2, "--picture"},
      {"deform edit.json -o o.ply --report .", 5, ".: is a folder"},
      {"deform edit.json -o o.ply --report nowhere/r.json", 5, "nowhere"},
      {"deform edit.json -o o.ply --picture nowhere/p.png", 5, "nowhere"},
      {"deform edit.json -o o.ply --picture p.jpg", 2, "pictures are PNG files"},
      {"deform edit.json -o . --report r.json", 5, ".: is a folder"},
      {"deform edit.json -o out --report r.json", 3, "no extension"},
      {"sample bar --resolution 3.5 -o o.ply", 2, "--resolution: '3.5' is not a whole number from 4 to 4096"},
      {"deform edit.json -o edit.json", 2, "this is an input"},
      {"compare", 2, "edit"},
      {"compare edit.json --methods ft05,arpa-2007", 2, "Did you mean 'arap-2007'? Known are corotational"},
      {"compare edit.json --methods ft05,,arap-2007", 2, "there is no method named ''"},
      {"compare edit.json --methods ft05,ft05", 2, "'ft05' is given twice"},
      {"compare edit.json -o sheet.obj", 5, "this is not a folder"},
      {"compare edit.json -o nowhere/there", 5, "nowhere"},
      {"sample", 2, "no sample is named"},
      {"deform sheet.obj -o o.ply", 3, "error: sheet.obj: this is a mesh; the command takes an edit file"},
      {"deform edit.json -o sheet.obj/o.ply", 5, "error: sheet.obj: this is not a folder"},
      {"deform broken.json -o o.ply", 3, "broken.json, line 1, column 2: is not valid JSON"},
      {"deform edit.json -o o.xyz", 3, ".xyz"},
      {"sample nothing -o o.ply", 3, "octopus"},
      {"deform loose.json -o o.ply", 4, "loose.json: steps[0]"},
      {"deform no.json -o o.ply", 5, "no.json"},
      {"deform no_mesh.json -o o.ply", 5, "no_mesh.json: inputs.sheet"},
      {"compare no_mesh.json -o there", 5, "no_mesh.json: inputs.sheet"},
      {"deform edit.json -o nowhere/o.ply", 5, "nowhere"},
      {"info no.ply", 5, "no.ply"},
  };
  const std::vector<std::string> before = new_files();
  for (const Case& wrong : cases) {
    const Outcome outcome = run(wrong.arguments);
    EXPECT_EQ(outcome.status, wrong.status) << wrong.arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.err.find("meshgraft: error: "), 0u) << outcome.err;
    EXPECT_NE(outcome.err.find(wrong.message), std::string::npos) << wrong.arguments << "\n" << outcome.err;
    EXPECT_EQ(outcome.out, "") << wrong.arguments;
    EXPECT_EQ(new_files(), before) << wrong.arguments << " left something behind";
  }
}

TEST_F(CommandLine, AFullDiskIsAnError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  const std::string mesh = (folder_ / "sheet.obj").string();
  const int status =
      std::system((std::string("'") + program() + "' info '" + mesh + "' > /dev/full 2> /dev/null").c_str());
  EXPECT_EQ(WEXITSTATUS(status), 5);
}

TEST_F(CommandLine, NeverWritesOverAnInputUnlessAsked) {
  const std::string before = read_text(folder_ / "sheet.obj");
  std::filesystem::create_symlink("sheet.obj", folder_ / "link.obj");
  for (const char* output : {"sheet.obj", "./sheet.obj", "link.obj"}) {
    const Outcome outcome = run(std::string("deform edit.json -o ") + output);
    EXPECT_EQ(outcome.status, 2) << output;
    EXPECT_NE(outcome.err.find("--force"), std::string::npos) << outcome.err;
    EXPECT_EQ(read_text(folder_ / "sheet.obj"), before);
  }
  for (const char* option : {"--report", "--force --report"}) {
    EXPECT_EQ(run(std::string("deform edit.json -o o.obj ") + option + " sheet.obj").status, 2);
    EXPECT_EQ(run(std::string("deform edit.json -o o.obj ") + option + " edit.json").status, 2);
    EXPECT_EQ(run(std::string("deform edit.json -o o.obj ") + option + " o.obj").status, 2);
  }
  EXPECT_EQ(run("deform edit.json --force -o edit.json").status, 2);
  EXPECT_EQ(read_text(folder_ / "sheet.obj"), before);
  EXPECT_EQ(read_text(folder_ / "edit.json"), edit());

  const Outcome outcome = run("deform edit.json -o sheet.obj --in-place");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(read_text(folder_ / "sheet.obj"), before);
}

// Waits until the process has used processor time for work, in which it catches signals, or has ended.
void wait_until_at_work(pid_t process) {
  const auto at_work = static_cast<std::uint64_t>(sysconf(_SC_CLK_TCK)) / 4;
  for (;;) {
    const std::string stat = read_text("/proc/" + std::to_string(process) + "/stat");
    const std::size_t end_of_name = stat.rfind(')');
    if (end_of_name == std::string::npos) return;
    std::istringstream fields(stat.substr(end_of_name + 2));
    std::string state, skipped;
    std::uint64_t user = 0, system = 0;
    fields >> state;
    for (int field = 4; field < 14; ++field) fields >> skipped;
    fields >> user >> system;
    if (state == "Z" || user + system >= at_work) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

TEST_F(CommandLine, CtrlCLeavesNothingBehind) {
  write(
      "long.json",
      R"({"format": "meshgraft-edit", "version": 2, "inputs": {"m": {"sample": "bumpy_plane", "resolution": 1500}},
      "steps": [{"kind": "deform", "mesh": "m", "fixed": {"loop": 0}}]})");
  for (const char* command : {"deform", "compare"}) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      if (chdir(folder_.c_str()) != 0 || !std::freopen(".err", "w", stderr)) _exit(99);
      execl(program(), program(), command, "long.json", "-o", "long.ply", nullptr);
      _exit(99);
    }
    wait_until_at_work(child);
    kill(child, SIGINT);
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status)) << command;
    EXPECT_EQ(WEXITSTATUS(status), 130) << command << read_text(folder_ / ".err");
    EXPECT_NE(read_text(folder_ / ".err").find("cancelled"), std::string::npos) << command;
    EXPECT_EQ(new_files(), std::vector<std::string>{"long.json"}) << command;
  }
}

TEST_F(CommandLine, CtrlCEndsTheWriteOfAReportIntoAFullPipe) {
  const std::filesystem::path report = folder_ / "report.json";
  for (const std::vector<const char*>& arguments :
       {std::vector<const char*>{"repair", "sheet.obj", "-o", "out.obj", "--report", "report.json"},
        {"cut", "sheet.obj", "--plane", "x=3.3", "-o", "out.obj", "--report", "report.json"},
        {"deform", "edit.json", "-o", "out.obj", "--report", "report.json"}}) {
    ASSERT_EQ(mkfifo(report.c_str(), 0600), 0);
    const int reader = open(report.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    ASSERT_GE(reader, 0);
    // Each command finds the pipe full.
    const std::string filling(std::size_t{1} << 16, 'x');
    while (::write(reader, filling.data(), filling.size()) > 0) {
    }
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      if (chdir(folder_.c_str()) != 0 || !std::freopen(".err", "w", stderr)) _exit(99);
      std::vector<const char*> all = {program()};
      all.insert(all.end(), arguments.begin(), arguments.end());
      all.push_back(nullptr);
      execv(program(), const_cast<char* const*>(all.data()));
      _exit(99);
    }
    // The report comes last, after the mesh.
    for (int waits = 0; waits < 3000 && !std::filesystem::exists(folder_ / "out.obj"); ++waits)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out.obj")) << arguments[0];
    kill(child, SIGINT);
    int status = 0, waits = 0;
    while (waitpid(child, &status, WNOHANG) == 0) {
      if (++waits == 3000) kill(child, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    close(reader);
    ASSERT_TRUE(WIFEXITED(status)) << arguments[0];
    EXPECT_EQ(WEXITSTATUS(status), 130) << arguments[0] << read_text(folder_ / ".err");
    std::filesystem::remove(folder_ / "out.obj");
    std::filesystem::remove(report);
  }
}

#ifdef MESHGRAFT_HAS_EDITOR

TEST_F(CommandLine, EditServesUntilCtrlC) {
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    if (chdir(folder_.c_str()) != 0 || !std::freopen(".out", "w", stdout)) _exit(99);
    execl(program(), program(), "edit", "--no-browser", "--folder", ".", "sheet.obj", nullptr);
    _exit(99);
  }
  for (int waits = 0; waits < 1000 && read_text(folder_ / ".out").empty(); ++waits)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(read_text(folder_ / ".out").find("http://127.0.0.1:"), 0u);
  kill(child, SIGINT);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  EXPECT_EQ(run("edit missing.ply --no-browser").status, 5);
}

// Everybody on the machine may read the arguments and names of processes.
TEST_F(CommandLine, EditKeepsItsTokenFromOtherUsers) {
  std::filesystem::create_directory(folder_ / "bin");
  write("bin/xdg-open", "#!/bin/sh\ncp \"$1\" .page && stat -c %a \"$1\" > .mode && echo \"$1\" > .opened\n");
  std::filesystem::permissions(folder_ / "bin/xdg-open", std::filesystem::perms::owner_all);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const std::string path = (folder_ / "bin").string() + ":" + std::getenv("PATH");
    if (chdir(folder_.c_str()) != 0 || !std::freopen(".out", "w", stdout)) _exit(99);
    setenv("PATH", path.c_str(), 1);
    execl(program(), program(), "edit", "--port", "0", "sheet.obj", nullptr);
    _exit(99);
  }
  for (int waits = 0; waits < 1000 && read_text(folder_ / ".opened").empty(); ++waits)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  std::string name = read_text("/proc/" + std::to_string(child) + "/comm");
  const std::string url = read_text(folder_ / ".out"), opened = read_text(folder_ / ".opened");
  kill(child, SIGINT);
  waitpid(child, nullptr, 0);
  const std::string token = url.substr(url.find("token=") + 6, 32);
  EXPECT_EQ(token.size(), 32u);
  EXPECT_EQ(opened.find(token), std::string::npos) << opened;
  EXPECT_NE(read_text(folder_ / ".page").find(token), std::string::npos);
  EXPECT_EQ(read_text(folder_ / ".mode"), "600\n");
  EXPECT_FALSE(std::filesystem::exists(opened.substr(0, opened.find('\n')))) << "removed at the end";
  if (!name.empty()) {
    EXPECT_EQ(name, "meshgraft\n");
  }
}
#endif

TEST_F(CommandLine, OutputsAreToldApartHoweverTheyAreSpelled) {
  std::filesystem::create_directory(folder_ / "sub");
  std::filesystem::create_directory_symlink(folder_, folder_ / "sub/here");
  for (const char* report : {"./o.obj", "sub/../o.obj", "sub/here/o.obj"}) {
    const Outcome outcome = run(std::string("deform edit.json -o o.obj --report ") + report);
    EXPECT_EQ(outcome.status, 2) << report;
    EXPECT_NE(outcome.err.find("two outputs have this name"), std::string::npos) << outcome.err;
    const Outcome cut = run(std::string("cut sheet.obj --plane x=3.3 -o o.obj --report ") + report);
    EXPECT_EQ(cut.status, 2) << report;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "o.obj"));
}

TEST_F(CommandLine, OutputsThatLinksMakeOneAreRefused) {
  std::filesystem::create_symlink("later.obj", folder_ / "link.obj");  // its target does not exist yet
  EXPECT_EQ(run("repair sheet.obj -o later.obj --report link.obj").status, 2);
  EXPECT_EQ(run("repair sheet.obj -o link.obj --report later.obj").status, 2);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "later.obj"));
}

}  // namespace
}  // namespace meshgraft::test
