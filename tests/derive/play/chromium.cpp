#include "tests/derive/play/chromium.hpp"

#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <poll.h>
#include <stdexcept>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace cdot::test {
namespace {

using nlohmann::json;

constexpr int longest_silence = 60000;  // [ms] of a browser that is busy

std::string decoded(const std::string& base64) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char c : base64) {
    const std::size_t digit = digits.find(c);
    if (digit == digits.npos) continue;
    bits = bits << 6 | static_cast<unsigned>(digit), count += 6;
    if (count >= 8) bytes += static_cast<char>(bits >> (count -= 8) & 255u);
  }
  return bytes;
}

// In the child: the browser reads messages at descriptor 3 and writes them at 4.
[[noreturn]] void become_browser(int reads, int writes, const std::string& profile) {
  const int in = fcntl(reads, F_DUPFD, 10), out = fcntl(writes, F_DUPFD, 10), nothing = open("/dev/null", O_RDWR);
  dup2(in, 3), dup2(out, 4), dup2(nothing, 1), dup2(nothing, 2);
  close(in), close(out);
  const std::string folder = "--user-data-dir=" + profile;
  execl(CDOT_CHROMIUM, CDOT_CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run",
        "--disable-background-networking", "--disable-component-update", "--disable-sync", "--remote-debugging-pipe",
        "--window-size=1200,800", folder.c_str(), "about:blank", nullptr);
  _exit(127);
}

}  // namespace

Chromium::Chromium(const std::string& address, const std::string& first, std::function<void(const std::string&)> asked)
    : asked_(std::move(asked)),
      profile_(std::filesystem::temp_directory_path() / fmt::format("cdot_chromium_{}", getpid())) {
  std::filesystem::create_directories(profile_);
  int to[2], from[2];
  if (pipe2(to, O_CLOEXEC) != 0 || pipe2(from, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  browser_ = fork();
  if (browser_ == 0) become_browser(to[0], from[1], profile_);
  close(to[0]), close(from[1]);
  to_browser_ = to[1], from_browser_ = from[0];
  std::signal(SIGPIPE, SIG_IGN);  // a browser that ended is told by its silence
  const std::string target = call("Target.createTarget", {{"url", "about:blank"}})["targetId"];
  session_ = call("Target.attachToTarget", {{"targetId", target}, {"flatten", true}})["sessionId"];
  call("Page.enable");
  call("Runtime.enable");
  call("Runtime.addBinding", {{"name", "ask"}});
  call("Page.addScriptToEvaluateOnNewDocument", {{"source", first}});
  call("Page.navigate", {{"url", address}});
  if (!becomes_true("location.href !== 'about:blank' && document.readyState === 'complete'"))
    throw std::runtime_error("the browser does not open " + address);
}

Chromium::~Chromium() { end(); }

void Chromium::end() {
  close(to_browser_), close(from_browser_);
  kill(browser_, SIGTERM);
  waitpid(browser_, nullptr, 0);
  std::error_code some_files_are_in_use;
  std::filesystem::remove_all(profile_, some_files_are_in_use);
}

json Chromium::receive() {
  for (std::size_t end; (end = received_.find('\0')) == received_.npos;) {
    pollfd waiting{from_browser_, POLLIN, 0};
    char bytes[65536];
    const ssize_t count = poll(&waiting, 1, longest_silence) == 1 ? read(from_browser_, bytes, sizeof bytes) : 0;
    if (count <= 0) throw std::runtime_error("the browser does not answer");
    received_.append(bytes, static_cast<std::size_t>(count));
  }
  const std::size_t end = received_.find('\0');
  json message = json::parse(received_.substr(0, end));
  received_.erase(0, end + 1);
  return message;
}

json Chromium::call(const std::string& method, const json& parameters) {
  const int number = ++number_;
  json message{{"id", number}, {"method", method}, {"params", parameters}};
  if (!session_.empty()) message["sessionId"] = session_;
  const std::string text = message.dump();
  for (std::size_t at = 0; at < text.size() + 1;) {
    const ssize_t count = write(to_browser_, text.c_str() + at, text.size() + 1 - at);
    if (count <= 0) throw std::runtime_error("the browser does not read");
    at += static_cast<std::size_t>(count);
  }
  while (!answers_.contains(number)) {
    json message = receive();
    if (message.value("method", "") == "Runtime.bindingCalled")
      asked_(
          message["params"]["payload"].get<std::string>());  // which may call, and so receive the answer to this call
    if (message.contains("id")) answers_[message["id"].get<int>()] = message;
  }
  json answer = std::move(answers_.extract(number).mapped());
  if (answer.contains("error")) throw std::runtime_error(method + ": " + answer["error"].dump());
  return answer["result"];
}

json Chromium::value(const std::string& expression) {
  const json result =
      call("Runtime.evaluate", {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
  if (result.contains("exceptionDetails")) throw std::runtime_error(result["exceptionDetails"].dump());
  return result["result"].value("value", json());
}

bool Chromium::becomes_true(const std::string& expression, double seconds) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (value("!!(" + expression + ")") != true) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return true;
}

void Chromium::mouse(const std::string& type, double x, double y) {
  const bool held = type != "mouseReleased";
  call("Input.dispatchMouseEvent", {{"type", type},
                                    {"x", x},
                                    {"y", y},
                                    {"button", "left"},
                                    {"buttons", held ? 1 : 0},
                                    {"clickCount", type == "mouseMoved" ? 0 : 1}});
}

void Chromium::click(const std::string& selector) {
  const json at =
      value(fmt::format("(() => {{ const r = document.querySelector('{}').getBoundingClientRect();"
                        "return [r.x + r.width / 2, r.y + r.height / 2]; }})()",
                        selector));
  for (const char* type : {"mousePressed", "mouseReleased"}) mouse(type, at[0], at[1]);
}

void Chromium::key(const std::string& key, bool shift) {
  const json pressed{{"key", key}, {"modifiers", shift ? 8 : 0}};
  for (const char* type : {"rawKeyDown", "keyUp"}) {
    json event = pressed;
    event["type"] = type;
    call("Input.dispatchKeyEvent", event);
  }
}

void Chromium::type(const std::string& text) {
  value("document.activeElement.select()");
  call("Input.insertText", {{"text", text}});
}

void Chromium::resize(int width, int height) {
  call("Emulation.setDeviceMetricsOverride",
       {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", width < height}});
}

void Chromium::screenshot(const std::filesystem::path& to) {
  const std::string picture = call("Page.captureScreenshot")["data"];
  std::ofstream(to, std::ios::binary) << decoded(picture);
}

}  // namespace cdot::test
