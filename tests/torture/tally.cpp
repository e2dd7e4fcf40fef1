#include "tests/torture/tally.hpp"

#include <fmt/format.h>
#include <set>

#include <cdot/methods.hpp>

namespace cdot::torture {
namespace {

// The first line of a reason with # for numbers: reasons that differ only in numbers are one kind.
std::string kind_of(const std::string& reason) {
  std::string kind;
  for (const char c : reason) {
    const bool digit = (c >= '0' && c <= '9');
    if (digit && !kind.empty() && kind.back() == '#') continue;
    kind += digit ? '#' : c == '\n' ? ' ' : c;
  }
  return kind.substr(0, 160);
}

const char* word(Outcome outcome) {
  switch (outcome) {
    case Outcome::held: return "held";
    case Outcome::refused: return "refused";
    case Outcome::limited: return "limited";
    case Outcome::broken: return "BROKEN";
  }
  return "";
}

}  // namespace

std::string way_of(const Scene& scene) {
  return fmt::format("{} {} {}", name_of(solvers, scene.settings.solver),
                     name_of(integrators, scene.settings.integrator), name_of(precisions, scene.single));
}

void Tally::add(const Mechanism& mechanism, const Verdict& verdict) {
  ++mechanisms_;
  ++outcomes_[verdict.outcome];
  energy_ += verdict.judged_energy, momentum_ += verdict.judged_momentum;
  left_out_ += mechanism.left_out;
  if (verdict.outcome == Outcome::held) steps_ += steps_of(mechanism.scene);
  const std::string way = way_of(mechanism.scene);
  ++ways_[way];
  std::set<std::string> types;
  for (const SceneJoint& joint : mechanism.scene.joints) types.insert(joint.definition.type);
  for (const std::string& type : types) ++joints_[{mechanism.scene.dimension, type}][way];
  for (const std::string& reason : mechanism.refused) ++reasons_["a joint refused: " + kind_of(reason)];
  if (!verdict.what.empty())
    ++reasons_[fmt::format("{}: {} ({})", word(verdict.outcome), kind_of(verdict.what),
                           verdict.outcome == Outcome::refused ? "" : way)];
}

int Tally::count(Outcome outcome) const {
  const auto found = outcomes_.find(outcome);
  return found == outcomes_.end() ? 0 : found->second;
}

int Tally::drawn(Dimension dimension, const std::string& joint) const {
  const auto found = joints_.find({dimension, joint});
  int sum = 0;
  if (found != joints_.end())
    for (const auto& [way, count] : found->second) sum += count;
  return sum;
}

std::string Tally::outcomes() const {
  std::string text;
  for (const auto& [outcome, count] : outcomes_)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", word(outcome), count);
  return text;
}

std::string Tally::text() const {
  std::string text = fmt::format(
      "{} mechanisms, {} steps held; energy judged in {}, momentum in {}; joints left out for want of a pose {}\n",
      mechanisms_, steps_, energy_, momentum_, left_out_);
  for (const auto& [outcome, count] : outcomes_) text += fmt::format("  {:8} {}\n", word(outcome), count);
  text += "mechanisms by way:\n";
  for (const auto& [way, count] : ways_) text += fmt::format("  {:28} {}\n", way, count);
  text += "mechanisms by joint, and in how many of the 20 ways:\n";
  for (const Dimension dimension : {Dimension::planar, Dimension::spatial})
    for (const JointType& type : joint_types(dimension)) {
      const auto found = joints_.find({dimension, std::string(type.name)});
      text += fmt::format("  {} {:26} {:5} {:3}\n", dimension == Dimension::planar ? "2D" : "3D", type.name,
                          drawn(dimension, std::string(type.name)), found == joints_.end() ? 0 : found->second.size());
    }
  if (!reasons_.empty()) text += "reasons:\n";
  for (const auto& [reason, count] : reasons_) text += fmt::format("  {:5} {}\n", count, reason);
  return text;
}

}  // namespace cdot::torture
