#include "derive/play/engine.hpp"

#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

#include "derive/play/judge.hpp"
#include "derive/play/live.hpp"
#include "derive/play/spec.hpp"

namespace cdot::play {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// Below the current directory alone.
json write_files(const json& files) {
  for (const auto& [name, text] : files.items()) {
    const fs::path path = fs::path(name).lexically_normal();
    if (path.empty() || path.is_absolute() || *path.begin() == "..")
      throw std::runtime_error(fmt::format("{} is outside of the playground's folder", name));
    if (path.has_parent_path()) fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary) << text.get<std::string>();
  }
  return json::object();
}

}  // namespace

Engine::Engine() = default;
Engine::~Engine() = default;

json Engine::answer(const json& request) {
  const std::string wanted = request.at("do");
  if (wanted == "write") return write_files(request.at("files"));
  if (wanted == "check") return check_spec(request.at("path"));
  if (wanted == "explain") return explain_spec(request.at("path"));
  if (wanted == "kernel") return kernel_of_spec(request.at("path"));
  if (wanted == "judge") return judge_hand(request.at("path"));
  if (wanted == "hand") return first_entry(request.at("path"));
  if (wanted == "load") {
    live_ = nullptr;
    live_ = LiveScene::load(request.at("path"), request);
    return live_->description();
  }
  if (!live_) throw std::runtime_error("no scene is loaded");
  if (wanted == "step") return live_->step(request.at("time"));
  if (wanted == "marks") return live_->marks(request);
  if (wanted == "change") live_->change(request);
  else if (wanted == "drag") live_->drag(request);
  else if (wanted == "drop") live_->drop();
  else if (wanted == "set") live_->set_parameter(request);
  else if (wanted == "motor") live_->set_motor(request);
  else throw std::runtime_error(fmt::format("there is no request \"{}\"", wanted));
  return live_->state();
}

std::string Engine::ask(const std::string& request) {
  constexpr auto invalid_bytes = json::error_handler_t::replace;
  try {
    return answer(json::parse(request)).dump(-1, ' ', false, invalid_bytes);
  } catch (const std::exception& error) {
    return json{{"problems", error.what()}}.dump(-1, ' ', false, invalid_bytes);
  }
}

}  // namespace cdot::play
