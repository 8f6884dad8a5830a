#include "core/platform/process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <system_error>

extern char** environ;  // some systems declare it in no header

namespace meshgraft::platform {

bool set_environment_variable(const char* name, const std::string& value) {
  return ::setenv(name, value.c_str(), 1) == 0;
}

void restart_program([[maybe_unused]] char** arguments) {
#ifdef __linux__
  // By its own path, so that the process keeps its name; by the link where the file was replaced meanwhile.
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (!error) ::execv(program.c_str(), arguments);
  ::execv("/proc/self/exe", arguments);
#endif
}

void open_in_browser(const std::string& page) {
#ifdef __APPLE__
  std::string program = "open", argument = page;
#else
  std::string program = "xdg-open", argument = page;
#endif
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  char* const words[] = {program.data(), argument.data(), nullptr};
  pid_t child = 0;
  if (posix_spawnp(&child, program.c_str(), &actions, nullptr, words, environ) == 0)
    ::waitpid(child, nullptr, 0);
  posix_spawn_file_actions_destroy(&actions);
}

bool wait_for_closed_input(const std::stop_token& stop) {
  constexpr int between_looks_ms = 100;
  while (!stop.stop_requested()) {
    pollfd input{STDIN_FILENO, 0, 0};
    if (::poll(&input, 1, between_looks_ms) > 0 && (input.revents & (POLLHUP | POLLERR)) != 0) return true;
    if ((input.revents & POLLNVAL) != 0) return false;
  }
  return false;
}

void report_failed_writes() {
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace meshgraft::platform
