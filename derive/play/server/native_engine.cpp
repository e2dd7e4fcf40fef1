#include "derive/play/server/native_engine.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <fmt/format.h>
#include <iostream>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

#include "derive/play/engine.hpp"

namespace cdot::play {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_processes = 16;  // two a page

fs::path scratch_folder() {
  std::string path = (fs::temp_directory_path() / "cdot_play_XXXXXX").string();
  if (!mkdtemp(path.data()))
    throw std::runtime_error(fmt::format("{}: cannot be made. Fix: set TMPDIR to a folder with room", path));
  return path;
}

}  // namespace

int answer_lines() {
  Engine engine;
  for (std::string line; std::getline(std::cin, line);) std::cout << engine.ask(line) << std::endl;
  return 0;
}

struct NativeEngines::Process {
  std::string name;
  std::mutex mutex;  // one request at a time
  pid_t pid = -1;
  std::FILE *to = nullptr, *from = nullptr;

  Process(const fs::path& program, const fs::path& folder, const std::string& of) : name(of) {
    fs::create_directories(folder);
    int in[2], out[2];
    if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0) throw std::runtime_error("no pipe to an engine");
    pid = fork();
    if (pid == 0) {
      dup2(in[0], STDIN_FILENO), dup2(out[1], STDOUT_FILENO);
      if (chdir(folder.c_str()) == 0) execl(program.c_str(), program.c_str(), "engine", nullptr);
      _exit(127);
    }
    close(in[0]), close(out[1]);
    to = fdopen(in[1], "w"), from = fdopen(out[0], "r");
    if (pid < 0) throw std::runtime_error("no process for an engine");
  }
  ~Process() {
    if (pid > 0) kill(pid, SIGKILL), waitpid(pid, nullptr, 0);
    if (to) std::fclose(to);
    if (from) std::fclose(from);
  }

  std::string ask(const std::string& request) {
    const std::lock_guard one(mutex);
    std::fputs(request.c_str(), to), std::fputc('\n', to);
    if (std::fflush(to) != 0) throw std::runtime_error("the engine ended");
    std::string answer;
    for (int c; (c = std::fgetc(from)) != '\n'; answer += static_cast<char>(c))
      if (c == EOF) throw std::runtime_error("the engine ended");
    return answer;
  }
};

NativeEngines::NativeEngines(fs::path program) : program_(std::move(program)), folder_(scratch_folder()) {
  std::signal(SIGPIPE, SIG_IGN);  // an engine that ended is told by its silence
}

NativeEngines::~NativeEngines() {
  processes_.clear();
  std::error_code none;
  fs::remove_all(folder_, none);
}

std::shared_ptr<NativeEngines::Process> NativeEngines::process_of(const std::string& name) {
  const std::lock_guard list(mutex_);
  const auto known = std::ranges::find(processes_, name, [](const auto& process) { return process->name; });
  if (known != processes_.end()) processes_.splice(processes_.begin(), processes_, known);
  else processes_.push_front(std::make_shared<Process>(program_, folder_ / name, name));
  if (processes_.size() > most_processes) processes_.pop_back();
  return processes_.front();
}

std::string NativeEngines::ask(const std::string& name, const std::string& request) {
  const std::shared_ptr<Process> process = process_of(name);
  try {
    return process->ask(request);
  } catch (const std::runtime_error&) {
    end(name);
    throw;
  }
}

void NativeEngines::end(const std::string& name) {
  const std::lock_guard list(mutex_);
  for (const auto& process : processes_)
    if (process->name == name) kill(process->pid, SIGKILL);  // a request in progress ends now
  std::erase_if(processes_, [&](const auto& process) { return process->name == name; });
}

}  // namespace cdot::play
