#include "interrupt.h"

#include <array>
#include <cerrno>
#include <csignal>
#include <string_view>
#include <system_error>

#include <unistd.h>

#include <meshgraft/core/error.h>

namespace meshgraft::cli {

namespace {

// A signal handler may hardly do anything, so it writes a byte that a thread waits for. It can only know the
// pipe by a global.
std::array<int, 2> signal_pipe{-1, -1};
constexpr char signalled = 's', finished = 'f';

void on_signal(int) {
  const int saved = errno;
  [[maybe_unused]] const auto written = write(signal_pipe[1], &signalled, 1);
  errno = saved;
}

void say(std::string_view text) {
  [[maybe_unused]] const auto written = write(STDERR_FILENO, text.data(), text.size());
}

void watch(std::stop_source source) {  // NOLINT(performance-unnecessary-value-param): a thread's own
  char byte = 0;
  while (true) {
    const auto count = read(signal_pipe[0], &byte, 1);
    if (count < 0 && errno == EINTR) continue;
    if (count != 1 || byte == finished) return;
    if (!source.request_stop()) _exit(exit_status(ErrorCode::cancelled));
    if (isatty(STDERR_FILENO)) say("\nmeshgraft: stopping; press Ctrl-C again to stop at once\n");
  }
}

}  // namespace

Interrupt::Interrupt() {
  if (pipe(signal_pipe.data()) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  watcher_ = std::thread(watch, source_);
  struct sigaction action{};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  // Writing then fails with a reason, and what was half-written goes.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
}

Interrupt::~Interrupt() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
  [[maybe_unused]] const auto written = write(signal_pipe[1], &finished, 1);
  watcher_.join();
  close(signal_pipe[0]);
  close(signal_pipe[1]);
}

}  // namespace meshgraft::cli
