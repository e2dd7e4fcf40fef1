#include "runtime/command_line/waiting.hpp"

#include <chrono>
#include <fmt/format.h>
#include <unistd.h>

#include "runtime/text/stage.hpp"

namespace cdot::command_line {

Waiting::Waiting(std::string for_what) {
  if (isatty(STDERR_FILENO) == 1) shows_ = std::thread([this, what = std::move(for_what)] { show(what); });
}

Waiting::~Waiting() {
  if (!shows_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  ends_.notify_one();
  shows_.join();
}

void Waiting::show(const std::string& for_what) {
  using namespace std::chrono_literals;
  const auto begun = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  bool shown = false;
  while (!ends_.wait_for(lock, 200ms, [&] { return ended_; })) {
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begun;
    const char* const stage = text::place_of_stage()->load();
    if (seconds.count() < unnoticed || stage == nullptr) continue;
    fmt::print(stderr, "\r\033[K{}: {} ({:.0f} s)", for_what, stage, seconds.count());
    shown = true;
  }
  if (shown) fmt::print(stderr, "\r\033[K");
}

}  // namespace cdot::command_line
