#include "runtime/tool/accuracy/state.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "runtime/number/hash.hpp"
#include "runtime/tool/run/output.hpp"

namespace cdot {

// A file keeps these members; a sweep goes on without the others.
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Way, integrator, solver, drift, iterations, single, adaptive)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Errors, position, angle, C, Cdot, energy)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Point, way, level, failure, errors, explored, looking, rounds)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(BodyState, x, y, angle, vx, vy, w, z, vz, e0, e1, e2, e3, wx, wy, wz)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Frame, time, energy, bodies)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Sensitivity, condition, round_off, slight)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ReferenceRun, made_by, settled, times, disagree, sensitivity, verdict, frames)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SweepState, reference, points)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Fingerprint, program, scene)

std::string hash_of(const std::string& text) {
  Hash hash;
  hash.bytes(text.data(), text.size());
  return fmt::format("{:016x}", hash.value);
}

std::string hash_of_program() { return hash_of(read_file("/proc/self/exe")); }

void write_state(const std::string& path, const Fingerprint& fingerprint, const SweepState& state) {
  write_file(path, nlohmann::json{{"of", fingerprint}, {"state", state}}.dump() + "\n");
}

SweepState read_state(const std::string& path, const Fingerprint& fingerprint) {
  const std::string text = read_file(path);
  try {
    const auto json = nlohmann::json::parse(text);
    const Fingerprint of = json.at("of");
    if (of.scene != fingerprint.scene)
      throw Error(path + ": the scene, its duration or its reference has changed since: start anew, without --resume");
    if (of.program != fingerprint.program)
      throw Error(path + ": written by another build of cdot-run: start anew, without --resume");
    return json.at("state");
  } catch (const nlohmann::json::exception&) {
    throw Error(path + ": this is no interrupted sweep");
  }
}

}  // namespace cdot
