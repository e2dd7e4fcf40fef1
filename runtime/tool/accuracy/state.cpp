#include "runtime/tool/accuracy/state.hpp"

#include <cstdint>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "runtime/tool/run/output.hpp"

namespace cdot {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Way& way) {
  return {way.integrator, way.solver, way.drift, way.iterations, way.single, way.adaptive};
}
Way way_of(const Json& json) { return {json[0], json[1], json[2], json[3], json[4], json[5]}; }

Json json_of(const Frame& frame) {
  Json bodies = Json::array();
  for (const BodyState& b : frame.bodies)
    bodies.push_back({b.x, b.y, b.angle, b.vx, b.vy, b.w, b.z, b.vz, b.e0, b.e1, b.e2, b.e3, b.wx, b.wy, b.wz});
  return {{"time", frame.time}, {"energy", frame.energy}, {"bodies", bodies}};
}
Frame frame_of(const Json& json) {
  Frame frame;
  frame.time = json.at("time");
  frame.energy = json.at("energy");
  for (const Json& b : json.at("bodies"))
    frame.bodies.push_back({b.at(0), b.at(1), b.at(2), b.at(3), b.at(4), b.at(5), b.at(6), b.at(7), b.at(8), b.at(9),
                            b.at(10), b.at(11), b.at(12), b.at(13), b.at(14)});
  return frame;
}

Json json_of(const Errors& e) { return {e.position, e.angle, e.C, e.Cdot, e.energy}; }
Errors errors_of(const Json& json) { return {json.at(0), json.at(1), json.at(2), json.at(3), json.at(4)}; }

Json json_of(const Point& p) {
  return {{"way", json_of(p.way)},  {"level", p.level},     {"failure", p.failure}, {"errors", json_of(p.errors)},
          {"explored", p.explored}, {"looking", p.looking}, {"rounds", p.rounds}};
}
Point point_of(const Json& json) {
  return {way_of(json.at("way")),
          json.at("level"),
          json.at("failure"),
          errors_of(json.at("errors")),
          json.at("explored"),
          json.at("looking"),
          json.at("rounds").get<std::vector<double>>()};
}

Json json_of(const ReferenceRun& reference) {
  Json frames = Json::array();
  for (const Frame& frame : reference.frames) frames.push_back(json_of(frame));
  return {
      {"made_by", reference.made_by},
      {"settled", reference.settled},
      {"times", reference.times},
      {"disagree", reference.disagree},
      {"sensitivity", {reference.sensitivity.condition, reference.sensitivity.round_off, reference.sensitivity.slight}},
      {"verdict", reference.verdict},
      {"frames", frames}};
}
ReferenceRun reference_of(const Json& json) {
  ReferenceRun reference;
  reference.made_by = json.at("made_by");
  reference.settled = json.at("settled");
  reference.times = json.at("times").get<std::vector<double>>();
  reference.disagree = json.at("disagree").get<std::vector<double>>();
  const Json& sensitivity = json.at("sensitivity");
  reference.sensitivity = {sensitivity.at(0), sensitivity.at(1), sensitivity.at(2)};
  reference.verdict = json.at("verdict");
  for (const Json& frame : json.at("frames")) reference.frames.push_back(frame_of(frame));
  return reference;
}

std::string contents_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::stringstream text;
  text << file.rdbuf();
  if (!file) throw Error(path + ": cannot be read");
  return text.str();
}

}  // namespace

// FNV-1a
std::string hash_of(const std::string& text) {
  std::uint64_t hash = 14695981039346656037ull;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
  return fmt::format("{:016x}", hash);
}

std::string hash_of_program() { return hash_of(contents_of("/proc/self/exe")); }

void write_state(const std::string& path, const Fingerprint& fingerprint, const SweepState& state) {
  Json points = Json::array();
  for (const Point& point : state.points) points.push_back(json_of(point));
  const Json json = {{"program", fingerprint.program},
                     {"scene", fingerprint.scene},
                     {"reference", json_of(state.reference)},
                     {"points", points}};
  write_file(path, json.dump() + "\n");
}

SweepState read_state(const std::string& path, const Fingerprint& fingerprint) {
  const std::string text = contents_of(path);
  try {
    const Json json = Json::parse(text);
    if (json.at("scene") != fingerprint.scene)
      throw Error(path + ": the scene, its duration or its reference has changed since: start anew, without --resume");
    if (json.at("program") != fingerprint.program)
      throw Error(path + ": written by another build of cdot-run: start anew, without --resume");
    SweepState state;
    state.reference = reference_of(json.at("reference"));
    for (const Json& point : json.at("points")) state.points.push_back(point_of(point));
    return state;
  } catch (const nlohmann::json::exception&) {
    throw Error(path + ": this is no interrupted sweep");
  }
}

}  // namespace cdot
