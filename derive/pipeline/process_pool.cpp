#include "derive/pipeline/process_pool.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <iostream>
#include <numeric>
#include <optional>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>

#include "runtime/command_line/waiting.hpp"
#include "runtime/text/stage.hpp"

namespace cdot::derive {
namespace {

using Clock = std::chrono::steady_clock;
constexpr double slow = 10;         // [s]; longer tasks are reported
const std::string well = "well: ";  // precedes the result in a process's answer

[[noreturn]] void raise_errno(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

struct Process {
  std::size_t task;
  pid_t id;
  std::FILE* said;  // in memory that both processes share, as its stage
  text::StageName* stage;
  Clock::time_point begun = Clock::now();
};

// Runs a task in the child. The child dies with its parent, also by Ctrl-C or SIGKILL.
[[noreturn]] void work(const Tasks& tasks, std::size_t task, pid_t parent, std::FILE* file, text::StageName* stage) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);
  text::place_of_stage() = stage;
  std::string said;
  try {
    said = well + tasks.run(task);
  } catch (const std::exception& e) {
    said = std::string("failed: ") + e.what();
  }
  const bool written = std::fwrite(said.data(), 1, said.size(), file) == said.size() && std::fflush(file) == 0;
  _exit(written ? 0 : 1);
}

text::StageName* shared_stage() {
  void* const memory =
      mmap(nullptr, sizeof(text::StageName), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) raise_errno("no memory for a stage");
  return new (memory) text::StageName(nullptr);
}

std::string content_of(std::FILE* file) {
  std::fseek(file, 0, SEEK_END);
  std::string content(static_cast<std::size_t>(std::ftell(file)), ' ');
  std::rewind(file);
  content.resize(std::fread(content.data(), 1, content.size(), file));
  return content;
}

Answer answer_of(const std::string& said, int status) {
  if (WIFSIGNALED(status)) {
    return {"", fmt::format("killed by signal {} ({})", WTERMSIG(status), strsignal(WTERMSIG(status)))};
  }
  if (WEXITSTATUS(status) == 0 && said.starts_with(well)) return {said.substr(well.size()), ""};
  return {"", said.empty() ? "ended without a word" : said};
}

class Running {
 public:
  explicit Running(const Tasks& tasks) : tasks_(tasks), answers_(tasks.names.size()) {}
  ~Running() {  // after an exception; else none is left
    for (const Process& process : processes_) kill(process.id, SIGKILL), waitpid(process.id, nullptr, 0);
  }

  void begin(std::size_t task) {
    std::FILE* const said = fdopen(memfd_create("cdot", MFD_CLOEXEC), "w+");
    if (said == nullptr) raise_errno("no memory for an answer");
    text::StageName* const stage = shared_stage();
    std::cout.flush(), std::cerr.flush(), std::fflush(nullptr);
    const pid_t parent = getpid(), id = fork();
    if (id < 0) raise_errno("no process");
    if (id == 0) work(tasks_, task, parent, said, stage);
    processes_.push_back({task, id, said, stage});
  }

  // Waits until one of them ends.
  void wait() {
    show();
    int status = 0;
    auto ended = processes_.end();
    while (ended == processes_.end()) {  // a shell that became this program may have left children of its own
      const pid_t id = waitpid(-1, &status, terminal_ ? WNOHANG : 0);
      if (id < 0 && errno != EINTR) raise_errno("no news");
      if (id == 0) pause_and_show();
      ended = std::ranges::find(processes_, id, &Process::id);
    }
    answers_[ended->task] = answer_of(content_of(ended->said), status);
    std::fclose(ended->said);
    munmap(ended->stage, sizeof(text::StageName));
    ++done_;
    clear();
    const std::chrono::duration<double> seconds = Clock::now() - ended->begun;
    if (!terminal_ && seconds.count() > slow) {
      fmt::print(stderr, "{}: took {:.0f} s\n", tasks_.names[ended->task], seconds.count());
    }
    processes_.erase(ended);
    for (; next_ < answers_.size() && answers_[next_]; ++next_) {
      tasks_.take(next_, *answers_[next_]);
      *answers_[next_] = {};
    }
  }

  std::size_t count() const { return processes_.size(); }

 private:
  // One line that is overwritten, on a terminal.
  void show() const {
    std::string names;
    for (const Process& process : processes_) {
      names += (names.empty() ? "" : ", ") + tasks_.names[process.task];
      const std::chrono::duration<double> seconds = Clock::now() - process.begun;
      const char* const stage = process.stage->load();
      if (seconds.count() > command_line::unnoticed && stage != nullptr)
        names += fmt::format(": {} ({:.0f} s)", stage, seconds.count());
    }
    if (terminal_) fmt::print(stderr, "\r\033[K[{} of {}] {}", done_, tasks_.names.size(), names);
  }
  // News of children are looked for often, the line is written anew now and then.
  void pause_and_show() {
    constexpr int often = 10;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (++pauses_ % often == 0) show();
  }
  void clear() const {
    if (terminal_) fmt::print(stderr, "\r\033[K");
  }

  const Tasks& tasks_;
  const bool terminal_ = isatty(STDERR_FILENO) == 1;
  std::vector<Process> processes_;
  std::vector<std::optional<Answer>> answers_;
  std::size_t next_ = 0, done_ = 0, pauses_ = 0;
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
