// What a long run shares with the process around it: the CPU's clock, whether somebody asked it to stop, and a line
// that says how far it is.
#pragma once

#include <chrono>
#include <string>

namespace cdot {

double cpu_now();  // spent by this thread [s]

// While one lives, Ctrl-C does not end the process but is noted. They do not nest.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;
  static bool asked();  // since the last one was made

 private:
  void (*previous_)(int);
};

// A line on stderr that is written over, and goes when this does.
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
