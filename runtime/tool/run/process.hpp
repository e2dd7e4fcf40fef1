// A long run and its process: the CPU's clock, Ctrl-C, and a line of progress.
#pragma once

#include <chrono>
#include <string>

namespace cdot {

double cpu_now();          // CPU time of this thread [s]
double cpu_of_children();  // that of programs that it ran to their end

// While an Interrupt lives, the first Ctrl-C only sets asked(); one that comes 0.3 s later ends the program. Do not
// nest them.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  static bool asked();  // since the last Interrupt was made

 private:
  void (*previous_)(int);
};

// A line on stderr that is overwritten; the destructor clears it.
class ProgressLine {
 public:
  explicit ProgressLine(bool wanted) : wanted_(wanted) {}
  ~ProgressLine() { clear(); }
  bool due();  // at most twice a second
  double elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }  // [s]
  void show(const std::string& text);
  void clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool wanted_, shown_ = false;
  Clock::time_point start_ = Clock::now(), last_ = start_;
};

}  // namespace cdot
