#include "runtime/tool/run/process.hpp"

#include <csignal>
#include <ctime>
#include <fmt/format.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

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

std::vector<double> in_child(double cpu, const std::function<std::vector<double>()>& f) {
  int ends[2];
  if (::pipe(ends) != 0) return {};
  std::fflush(nullptr);  // else the child would write what waits in the parent's buffers
  const pid_t child = ::fork();
  if (child == 0) {
    const auto whole = static_cast<time_t>(cpu);
    const itimerval limit{{0, 0}, {whole, static_cast<suseconds_t>(1e6 * (cpu - static_cast<double>(whole))) + 1}};
    ::setitimer(ITIMER_VIRTUAL, &limit, nullptr);  // its signal ends the process
    const std::vector<double> numbers = f();
    const std::size_t bytes = numbers.size() * sizeof(double);
    ::_exit(::write(ends[1], numbers.data(), bytes) == static_cast<ssize_t>(bytes) ? 0 : 1);
  }
  ::close(ends[1]);
  std::vector<double> numbers(64);
  const ssize_t bytes = child < 0 ? 0 : ::read(ends[0], numbers.data(), numbers.size() * sizeof(double));
  ::close(ends[0]);
  int status = 1;
  if (child > 0) ::waitpid(child, &status, 0);
  numbers.resize(status == 0 && bytes > 0 ? static_cast<std::size_t>(bytes) / sizeof(double) : 0);
  return numbers;
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
