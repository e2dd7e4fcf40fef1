// A line on the terminal for a command that takes longer than a second: its stage, and the time so far.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace cdot::command_line {

constexpr double unnoticed = 1;  // [s]; before it nothing is shown

// Standard error, if that is a terminal. Nothing else writes there meanwhile.
class Waiting {
 public:
  explicit Waiting(std::string for_what);
  ~Waiting();

 private:
  void show(const std::string& for_what);

  std::mutex mutex_;
  std::condition_variable ends_;
  bool ended_ = false;
  std::thread shows_;
};

}  // namespace cdot::command_line
