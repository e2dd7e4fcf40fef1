// A page in a headless Chromium, driven by the DevTools protocol over a pipe: clicks, keys, scripts, and calls from the
// page back to the test.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <sys/types.h>

namespace cdot::test {

class Chromium {
 public:
  // `asked(text)`: the page called ask(text). `first` is a script that runs before those of the page. Throws
  // std::runtime_error if no browser answers.
  Chromium(const std::string& address, const std::string& first, std::function<void(const std::string&)> asked);
  Chromium(const Chromium&) = delete;
  Chromium& operator=(const Chromium&) = delete;
  ~Chromium();

  // The value of an expression; of a promise after it is settled. Throws what the script throws.
  nlohmann::json value(const std::string& expression);
  // Asks until the expression is true; false after `seconds`.
  bool becomes_true(const std::string& expression, double seconds = 20);
  // Pressed, moved and released buttons of the mouse: "mousePressed", "mouseMoved", "mouseReleased".
  void mouse(const std::string& type, double x, double y);
  void click(const std::string& selector);
  void key(const std::string& key, bool shift = false);
  // The text replaces that of the focused element.
  void type(const std::string& text);
  void resize(int width, int height);
  void screenshot(const std::filesystem::path& to);

 private:
  nlohmann::json call(const std::string& method, const nlohmann::json& parameters = nlohmann::json::object());
  nlohmann::json receive();
  void end();

  std::function<void(const std::string&)> asked_;
  std::filesystem::path profile_;
  std::map<int, nlohmann::json> answers_;  // to calls that still wait
  std::string session_, received_;
  pid_t browser_ = -1;
  int to_browser_ = -1, from_browser_ = -1, number_ = 0;
};

}  // namespace cdot::test
