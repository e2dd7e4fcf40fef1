// Diagnoses at several times -> the worst of each island.
#include "runtime/tool/watch/worst.hpp"

#include <algorithm>
#include <set>

#include "runtime/text/json.hpp"

namespace cdot {
namespace {

Names names_of(const Scene& scene) {
  return {[&](int body) { return body_name(scene, body); }, [&](int joint) { return joint_name(scene, joint); }};
}

void add_island(const Diagnosis::Island& now, double time, WorstOfIsland& worst) {
  Diagnosis::Island& so_far = worst.island;
  if (now.rank < so_far.rank || now.redundant.size() > so_far.redundant.size()) {
    so_far.rows = now.rows, so_far.rank = now.rank, so_far.redundant = now.redundant;
    worst.rank_time = time;
  }
  if (now.mobility < so_far.mobility || (now.mobility == so_far.mobility && so_far.nearly_redundant.empty()))
    so_far.mobility = now.mobility, so_far.nearly_redundant = now.nearly_redundant;
  if (now.condition > so_far.condition) {
    so_far.condition = now.condition, so_far.smallest_pivot = now.smallest_pivot, so_far.weakest = now.weakest;
    worst.condition_time = time;
  }
  if (now.stiffest.square > so_far.stiffest.square) so_far.stiffest = now.stiffest, worst.stiffest_time = time;
  if (now.fastest_decay.rate > so_far.fastest_decay.rate)
    so_far.fastest_decay = now.fastest_decay, worst.decay_time = time;
  if (now.fastest_spin > so_far.fastest_spin) {
    so_far.fastest_spin = now.fastest_spin, so_far.spinning = now.spinning;
    worst.spin_time = time;
  }
  so_far.farthest = std::max(so_far.farthest, now.farthest);
}

}  // namespace

std::string body_name(const Scene& scene, int body) {
  const std::string name = name_in(scene.bodies, body);
  return name.empty() ? "nothing" : "\"" + name + "\"";
}
std::string joint_name(const Scene& scene, int joint) {
  const std::string name = name_in(scene.joints, joint);
  return name.empty() ? "no joint" : "\"" + name + "\"";
}

void add_diagnosis(const Diagnosis& now, double time, std::vector<WorstOfIsland>& worst) {
  const auto first = [](const WorstOfIsland& one) { return one.island.bodies.front(); };
  for (const Diagnosis::Island& island : now.islands) {
    const auto known = std::ranges::lower_bound(worst, island.bodies.front(), {}, first);
    if (known != worst.end() && first(*known) == island.bodies.front()) add_island(island, time, *known);
    else worst.insert(known, {island, time, time, time, time, time});
  }
}

std::vector<Concern> concerns_about(const Scene& scene, const std::vector<WorstOfIsland>& worst, bool warnings_only) {
  std::vector<Concern> all;
  std::set<Concern> listed;
  for (const WorstOfIsland& one : worst)
    for (Concern& concern : concerns_about(one.island, scene.settings, scene.single,
                                           scene.step / scene.settings.substeps, names_of(scene)))
      if ((concern.warning || !warnings_only) && listed.insert(concern).second) all.push_back(std::move(concern));
  return all;
}

text::Json concerns_json(const std::vector<Concern>& concerns) {
  text::Json json = text::Json::array();
  for (const Concern& one : concerns)
    json.push_back({{"level", one.warning ? "warning" : "note"}, {"what", one.what}, {"fix", one.fix}});
  return json;
}

}  // namespace cdot
