#include "runtime/tool/run/process.hpp"

#include <atomic>
#include <csignal>
#include <ctime>
#include <fmt/format.h>
#include <sys/resource.h>

namespace cdot {
namespace {

constexpr long long apart = 300'000'000;                     // [ns]
std::atomic<long long> interrupted_at = 0;                   // [ns]; 0: not
static_assert(std::atomic<long long>::is_always_lock_free);  // a signal may find it half written otherwise

// A second one ends the program, unless it belongs to the first: `timeout -s INT` signals its child, and at once all of
// the child's group.
void interrupt(int) {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  const long long before = interrupted_at, at = 1'000'000'000LL * now.tv_sec + now.tv_nsec;
  if (before == 0) interrupted_at = at;
  else if (at - before > apart) std::signal(SIGINT, SIG_DFL), std::raise(SIGINT);
}

}  // namespace

double cpu_now() {
  timespec now{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double cpu_of_children() {
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

Interrupt::Interrupt() {
  interrupted_at = 0;
  previous_ = std::signal(SIGINT, interrupt);
}
Interrupt::~Interrupt() { std::signal(SIGINT, previous_); }
bool Interrupt::asked() { return interrupted_at != 0; }

bool ProgressLine::due() {
  const auto now = Clock::now();
  if (now - last_ < std::chrono::milliseconds(500)) return false;
  last_ = now;
  return true;
}

void ProgressLine::show(const std::string& text) {
  if (!wanted_) return;
  fmt::print(stderr, "\r{:78}\r{}", "", text);
  std::fflush(stderr);
  shown_ = true;
}

void ProgressLine::clear() {
  if (shown_) fmt::print(stderr, "\r{:78}\r", "");
  shown_ = false;
}

}  // namespace cdot
