// A scene that runs while a person looks: steps, a spring from the pointer, other settings on the way.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace cdot::play {

class LiveScene {
 public:
  virtual ~LiveScene() = default;
  // Throws cdot::SceneError, cdot::Error. `wishes` as of the request `load`.
  static std::unique_ptr<LiveScene> load(const std::string& path, const nlohmann::json& wishes);

  virtual nlohmann::json description() const = 0;
  virtual nlohmann::json state() = 0;
  virtual nlohmann::json step(double time) = 0;
  virtual void change(const nlohmann::json& wishes) = 0;
  virtual void drag(const nlohmann::json& request) = 0;
  virtual void drop() = 0;
  virtual void set_parameter(const nlohmann::json& request) = 0;
  virtual void set_motor(const nlohmann::json& request) = 0;
  virtual nlohmann::json marks(const nlohmann::json& request) = 0;
};

}  // namespace cdot::play
