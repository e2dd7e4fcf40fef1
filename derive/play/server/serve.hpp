// The page, served on this machine alone. A scene or spec that changes on disk changes in the open page.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace cdot::play {

class PageServer {
 public:
  // Of the page for `start` (page.hpp), made anew whenever it is asked for. Where there is no engine in WebAssembly,
  // the page asks this machine: `program engine` (native_engine.hpp). On this port, or on any that is free if this one
  // is 0 or taken. Throws std::runtime_error if there is no page.
  PageServer(const std::string& start, const std::filesystem::path& specs, const std::filesystem::path& engine,
             const std::filesystem::path& program, int port);
  ~PageServer();

  std::string address() const;  // http://127.0.0.1:8060/
  void run();                   // until stop(), which another thread calls
  void stop();                  // waits until it runs

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace cdot::play
