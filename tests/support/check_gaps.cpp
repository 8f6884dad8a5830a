#include "check_gaps.h"

#include <ctime>

#include <atomic>
#include <mutex>
#include <string_view>
#include <utility>

#include <meshgraft/core/context.h>

// The linker sends the library's calls of both functions to these (--wrap), and theirs to the library's own.
extern "C" {
void real_step(const meshgraft::Context*, std::string_view, double) __asm__(
    "__real__ZNK9meshgraft7Context4stepESt17basic_string_viewIcSt11char_traitsIcEEd");
void wrapped_step(const meshgraft::Context*, std::string_view, double) __asm__(
    "__wrap__ZNK9meshgraft7Context4stepESt17basic_string_viewIcSt11char_traitsIcEEd");
void real_throw_if_stopped(const meshgraft::Context*) __asm__(
    "__real__ZNK9meshgraft7Context16throw_if_stoppedEv");
void wrapped_throw_if_stopped(const meshgraft::Context*) __asm__(
    "__wrap__ZNK9meshgraft7Context16throw_if_stoppedEv");
}

namespace meshgraft::test {
namespace {

std::atomic<long> measurement = 0;  // 0: none runs
std::atomic<long> last_measurement = 0;
std::atomic<long> check_count = 0;
std::atomic<double> longest = 0;

std::atomic<long> stopping_check = 0;
std::stop_source stop_to_request;

std::mutex stage_mutex;
std::string running_stage, longest_stage;

thread_local long thread_measurement = 0;  // that the thread's last check belongs to
thread_local double last_check = 0;

double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void check() {
  const long current = measurement.load(std::memory_order_relaxed);
  if (current == 0) return;
  if (check_count.fetch_add(1) + 1 == stopping_check) stop_to_request.request_stop();
  const double now = thread_seconds();
  const double gap = thread_measurement == current ? now - last_check : 0;
  thread_measurement = current;
  last_check = now;
  if (gap <= longest.load(std::memory_order_relaxed)) return;
  const std::lock_guard lock(stage_mutex);
  if (gap <= longest) return;
  longest = gap;
  longest_stage = running_stage;
}

// A check through a Context without a stop token stops nothing.
void check(const Context& context) {
  if (context.stop_token.stop_possible()) check();
}

}  // namespace

CheckGaps::CheckGaps() {
  check_count = -1;  // the first check is our own
  stopping_check = 0;
  longest = 0;
  running_stage.clear();
  longest_stage.clear();
  measurement = ++last_measurement;
  check();
}

CheckGaps::~CheckGaps() { measurement = 0; }

void CheckGaps::end() {
  check();
  --check_count;
  measurement = 0;
}

double CheckGaps::longest_seconds() const { return longest; }

void CheckGaps::stop_at(long check, std::stop_source stop) {
  stop_to_request = std::move(stop);
  stopping_check = check;
}

long CheckGaps::checks() const { return check_count; }

std::string CheckGaps::stage() const {
  const std::lock_guard lock(stage_mutex);
  return longest_stage;
}

}  // namespace meshgraft::test

void wrapped_step(const meshgraft::Context* context, std::string_view stage, double fraction) {
  meshgraft::test::check(*context);
  {
    const std::lock_guard lock(meshgraft::test::stage_mutex);
    meshgraft::test::running_stage = stage;
  }
  real_step(context, stage, fraction);
}

void wrapped_throw_if_stopped(const meshgraft::Context* context) {
  meshgraft::test::check(*context);
  real_throw_if_stopped(context);
}
