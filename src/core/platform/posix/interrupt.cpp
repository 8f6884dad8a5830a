#include "core/platform/interrupt.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <system_error>
#include <utility>

namespace meshgraft::platform {

namespace {

// A signal handler may call few functions, so it writes a byte to a pipe that a thread reads. The handler can
// reach the pipe only through a global.
std::array<int, 2> signal_pipe{-1, -1};
constexpr char signalled = 's', finished = 'f';

// The signals that ask the program to end. A terminal that closes sends SIGHUP.
constexpr std::array signals{SIGINT, SIGTERM, SIGHUP};

// `nohup` starts programs that are to outlast their terminal.
bool outlasts_terminal() {
  struct sigaction action{};
  return sigaction(SIGHUP, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

void on_signal(int) {
  const int saved = errno;
  [[maybe_unused]] const auto written = ::write(signal_pipe[1], &signalled, 1);
  errno = saved;
}

// Waits for a signal. Returns false if there are no more signals to wait for.
bool wait_for_signal() {
  char byte = 0;
  ssize_t count = 0;
  do {
    count = ::read(signal_pipe[0], &byte, 1);
  } while (count < 0 && errno == EINTR);
  return count == 1 && byte == signalled;
}

}  // namespace

InterruptWatch::InterruptWatch(std::function<void()> on_interrupt) : on_interrupt_(std::move(on_interrupt)) {
  if (::pipe(signal_pipe.data()) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  watcher_ = std::thread([this] {
    while (wait_for_signal()) on_interrupt_();
  });
  struct sigaction action{};
  action.sa_handler = on_signal;
  action.sa_flags = SA_RESTART;
  for (const int signal : signals)
    if (signal != SIGHUP || !outlasts_terminal()) sigaction(signal, &action, nullptr);
}

InterruptWatch::~InterruptWatch() {
  for (const int signal : signals)
    if (signal != SIGHUP || !outlasts_terminal()) std::signal(signal, SIG_DFL);
  [[maybe_unused]] const auto written = ::write(signal_pipe[1], &finished, 1);
  watcher_.join();
  ::close(signal_pipe[0]);
  ::close(signal_pipe[1]);
}

}  // namespace meshgraft::platform
