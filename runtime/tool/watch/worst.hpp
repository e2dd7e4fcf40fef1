// The worst diagnosis of each island over a run, and its meaning for the scene's method.
#pragma once

#include <vector>

#include "runtime/diagnose/concerns.hpp"
#include "runtime/text/json.hpp"
#include "runtime/tool/scene/scene.hpp"

namespace cdot {

// Each number is the worst of the run, with its time [s].
struct WorstOfIsland {
  Diagnosis::Island island;
  double condition_time = 0, rank_time = 0, stiffest_time = 0, decay_time = 0, spin_time = 0;
};

// Adds the diagnosis at one time. Islands are identified by their first body, and `worst` is in its order.
void add_diagnosis(const Diagnosis& now, double time, std::vector<WorstOfIsland>& worst);

// With the names of the scene, each once. `warnings_only`: without notes.
std::vector<Concern> concerns_about(const Scene& scene, const std::vector<WorstOfIsland>& worst, bool warnings_only);

text::Json concerns_json(const std::vector<Concern>& concerns);

// The name of a body or a joint; empty if there is none.
template <class List>
std::string name_in(const List& list, int index) {
  const bool known = index >= 0 && static_cast<std::size_t>(index) < list.size();
  return known ? list[static_cast<std::size_t>(index)].name : std::string();
}
// In quotes; "nothing" and "no joint" of -1.
std::string body_name(const Scene& scene, int body);
std::string joint_name(const Scene& scene, int joint);

}  // namespace cdot
