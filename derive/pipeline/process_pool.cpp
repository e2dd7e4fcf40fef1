#include "derive/pipeline/process_pool.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fmt/format.h>
#include <iostream>
#include <numeric>
#include <optional>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>

namespace cdot::derive {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double slow = 10;         // seconds that a task may take without a word
const std::string well = "well: ";  // how what a process says begins, if it has a result

[[noreturn]] void raise_errno(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

struct Process {
  std::size_t task;
  pid_t id;
  int output;  // the end of its pipe that is read here
  std::string said;
  Clock::time_point begun = Clock::now();
};

// One line that is overwritten, on a terminal.
class Progress {
 public:
  explicit Progress(std::size_t tasks) : tasks_(tasks) {}

  void show(std::size_t done, const std::string& running) {
    if (terminal_) fmt::print(stderr, "\r\033[K[{} of {}] {}", done, tasks_, running), shown_ = true;
  }
  void clear() {
    if (shown_) fmt::print(stderr, "\r\033[K"), shown_ = false;
  }
  void finished(const std::string& task, double seconds) {
    if (!terminal_ && seconds > slow) fmt::print(stderr, "{}: took {:.0f} s\n", task, seconds);
  }

 private:
  std::size_t tasks_;
  bool terminal_ = isatty(STDERR_FILENO) == 1, shown_ = false;
};

void write_all(int file, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(file, text.data(), text.size());
    if (written < 0 && errno != EINTR) _exit(1);
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
}

class Running {
 public:
  explicit Running(const Tasks& tasks) : tasks_(tasks), progress_(tasks.names.size()), answers_(tasks.names.size()) {}
  ~Running() {  // after an exception; else none is left
    for (const Process& process : processes_) kill(process.id, SIGKILL), waitpid(process.id, nullptr, 0);
  }

  void begin(std::size_t task) {
    int ends[2];
    if (pipe(ends) != 0) raise_errno("no pipe");
    std::cout.flush(), std::cerr.flush(), std::fflush(nullptr);
    const pid_t parent = getpid(), id = fork();
    if (id < 0) raise_errno("no process");
    if (id == 0) child(task, parent, ends[1]);
    close(ends[1]);
    processes_.push_back({task, id, ends[0], ""});
  }

  // Until one of them ends.
  void wait() {
    show();
    for (bool ended = false; !ended;) {
      std::vector<pollfd> polled;
      for (const Process& process : processes_) polled.push_back({process.output, POLLIN, 0});
      if (poll(polled.data(), polled.size(), -1) < 0 && errno != EINTR) raise_errno("no news");
      for (std::size_t i = polled.size(); i-- > 0;) {
        if (polled[i].revents == 0 || !at_end(processes_[i])) continue;
        end(i);
        ended = true;
      }
    }
    hand_over();
  }

  std::size_t count() const { return processes_.size(); }

 private:
  // Dies when the parent does, however that comes: by Ctrl-C, or killed.
  [[noreturn]] void child(std::size_t task, pid_t parent, int output) const {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(1);
    std::string said;
    try {
      said = well + tasks_.run(task);
    } catch (const std::exception& e) {
      said = std::string("failed: ") + e.what();
    }
    write_all(output, said);
    _exit(0);
  }

  static bool at_end(Process& process) {
    char buffer[1 << 16];
    const ssize_t n = read(process.output, buffer, sizeof buffer);
    if (n > 0) process.said.append(buffer, static_cast<std::size_t>(n));
    return n == 0 || (n < 0 && errno != EINTR);
  }

  void end(std::size_t i) {
    Process process = std::move(processes_[i]);
    processes_.erase(processes_.begin() + static_cast<std::ptrdiff_t>(i));
    close(process.output);
    int status = 0;
    while (waitpid(process.id, &status, 0) < 0 && errno == EINTR) {
    }
    answers_[process.task] = answer(process.said, status);
    ++done_;
    progress_.clear();
    progress_.finished(tasks_.names[process.task], std::chrono::duration<double>(Clock::now() - process.begun).count());
  }

  static Answer answer(const std::string& said, int status) {
    if (WIFSIGNALED(status)) {
      return {"", fmt::format("killed by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))};
    }
    if (WEXITSTATUS(status) == 0 && said.starts_with(well)) return {said.substr(well.size()), ""};
    return {"", said.empty() ? "ended without a word" : said};
  }

  void hand_over() {
    for (; next_ < answers_.size() && answers_[next_]; ++next_) {
      progress_.clear();
      tasks_.take(next_, *answers_[next_]);
      *answers_[next_] = {};
    }
  }

  void show() {
    std::string names;
    for (const Process& process : processes_) names += (names.empty() ? "" : ", ") + tasks_.names[process.task];
    progress_.show(done_, names);
  }

  const Tasks& tasks_;
  Progress progress_;
  std::vector<Process> processes_;
  std::vector<std::optional<Answer>> answers_;
  std::size_t next_ = 0, done_ = 0;
};

}  // namespace

void in_processes(const Tasks& tasks, int processes) {
  std::vector<std::size_t> order = tasks.order;
  if (order.empty()) {
    order.resize(tasks.names.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
  }
  Running running(tasks);
  for (const std::size_t task : order) {
    if (running.count() >= static_cast<std::size_t>(std::max(processes, 1))) running.wait();
    running.begin(task);
  }
  while (running.count() > 0) running.wait();
}

int usual_processes() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

}  // namespace cdot::derive
