// Frames -> lines of a file; saved states.
#include "runtime/tool/run/output.hpp"

#include <fmt/format.h>
#include <iterator>

namespace cdot {

std::string csv_head(const Scene& scene) {
  std::string head = "time";
  for (const SceneBody& body : scene.bodies)
    for (const StateColumn& column : state_columns(scene.dimension))
      head += fmt::format(",{}.{}", body.name, column.name);
  for (const Sensor& sensor : scene.sensors) head += "," + sensor.name;
  return head + "\n";
}

std::string csv_row(const Scene& scene, const Frame& frame) {
  std::string row = fmt::format("{}", frame.time);
  for (const BodyState& body : frame.bodies)
    for (const StateColumn& column : state_columns(scene.dimension))
      fmt::format_to(std::back_inserter(row), ",{}", body.*column.number);
  for (const double value : frame.sensors) fmt::format_to(std::back_inserter(row), ",{}", value);
  return row + "\n";
}

Snapshot read_state(const std::string& path) {
  const std::string text = read_file(path);
  try {
    return Snapshot::read(text);
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", path, error.what()));
  }
}

}  // namespace cdot
