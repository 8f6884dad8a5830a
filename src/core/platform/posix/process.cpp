#include "core/platform/process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

extern char** environ;  // some systems declare it in no header

namespace meshgraft::platform {

bool set_environment_variable(const char* name, const std::string& value) {
  return ::setenv(name, value.c_str(), 1) == 0;
}

void restart_program([[maybe_unused]] char** arguments) {
#ifdef __linux__
  ::execv("/proc/self/exe", arguments);
#endif
}

void open_in_browser(const std::string& url) {
#ifdef __APPLE__
  std::string program = "open", argument = url;
#else
  std::string program = "xdg-open", argument = url;
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

void report_failed_writes() {
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace meshgraft::platform
