#include "runtime/tool/run/process.hpp"

#include <csignal>
#include <ctime>
#include <fmt/format.h>
#include <sys/resource.h>

namespace cdot {
namespace {

volatile std::sig_atomic_t interrupted = 0;
// The second one ends the program.
void interrupt(int) {
  if (interrupted) std::signal(SIGINT, SIG_DFL), std::raise(SIGINT);
  interrupted = 1;
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
  interrupted = 0;
  previous_ = std::signal(SIGINT, interrupt);
}
Interrupt::~Interrupt() { std::signal(SIGINT, previous_); }
bool Interrupt::asked() { return interrupted != 0; }

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
