// Engines of pages as processes of this machine, for pages without WebAssembly: each has a folder of its own, and ends
// with its page.
#pragma once

#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <string>

namespace cdot::play {

// Answers requests of engine.hpp, a line each, from standard input to standard output.
int answer_lines();

class NativeEngines {
 public:
  // `program engine` runs answer_lines().
  explicit NativeEngines(std::filesystem::path program);
  ~NativeEngines();
  NativeEngines(const NativeEngines&) = delete;
  NativeEngines& operator=(const NativeEngines&) = delete;

  // The answer of the engine of that name, which begins with its first request. Throws std::runtime_error if the engine
  // broke down; the next request begins anew.
  std::string ask(const std::string& name, const std::string& request);
  void end(const std::string& name);

 private:
  struct Process;
  std::shared_ptr<Process> process_of(const std::string& name);

  const std::filesystem::path program_, folder_;
  std::mutex mutex_;                               // of the list
  std::list<std::shared_ptr<Process>> processes_;  // the last one used first
};

}  // namespace cdot::play
