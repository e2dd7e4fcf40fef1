// The law of an effect: forces that are not opposite, and the power of what has no energy.
#include <cmath>
#include <fmt/format.h>

#include "derive/check/parts.hpp"
#include "derive/expression/symbols.hpp"

namespace cdot::derive {
namespace {

constexpr int states = 256;

// The power U . Cdot of the part of the force without an energy, a term per row, over C, rates and positive parameters.
std::vector<Expr> power_of(const DerivedLaw& law) {
  std::vector<Expr> terms;
  for (std::size_t i = 0; i < law.unstored.size(); ++i)
    if (!is_zero(law.unstored[i])) terms.push_back(law.unstored[i] * law.rate[i]);
  return terms;
}

struct Power {
  double least = 0, most = 0;
  double largest_term = 0;  // measures the rounding where rows cancel
  std::string at_most;      // rates of the state with the largest power
};

// Values and rates of either sign, at random; parameters are positive.
Sample state_at_random(const Joint& joint, const DerivedLaw& law, const std::vector<Expr>& power, std::uint64_t seed) {
  Sample sample = random_sample(joint, power, seed);
  Random random(seed);
  for (const Expr leaf : leaves_of(power))
    if (!sample.scalars.contains(leaf->symbol)) sample.scalars[leaf->symbol] = random.between(-2, 2);
  for (const auto* leaves : {&law.value, &law.rate})
    for (const Expr leaf : *leaves)
      if (leaf && sample.scalars.contains(leaf->symbol)) sample.scalars[leaf->symbol] = random.between(-2, 2);
  return sample;
}

Power power_at_random(const Joint& joint, const DerivedLaw& law, const std::vector<Expr>& power) {
  Power range;
  for (std::uint64_t seed = 0; seed < states; ++seed) {
    const Sample sample = state_at_random(joint, law, power, seed);
    Numbers numbers(sample);
    double value = 0;
    for (const Expr term : power) {
      const double of_row = numbers.scalar(term);
      value += of_row;
      range.largest_term = std::fmax(range.largest_term, std::fabs(of_row));
    }
    range.least = std::fmin(range.least, value);
    if (!(value > range.most)) continue;
    range.most = value;
    range.at_most.clear();
    for (const Expr rate : law.rate)
      if (const auto at = sample.scalars.find(rate->symbol); at != sample.scalars.end())
        range.at_most += fmt::format("{}{} = {:.2g}", range.at_most.empty() ? "" : ", ", at->first, at->second);
  }
  return range;
}

void check_bounded(const Derivation& derivation, Findings& findings) {
  for (std::size_t i = 0; i < derivation.bounded.size(); ++i) {
    const BoundedRow& row = derivation.joint.law->bounded[i];
    if (!row.rate) continue;
    const bool drives = !is_zero(row.rate);
    findings.add(Level::note, "power", row.where,
                 drives ? "the row " + row.name + " prescribes a rate: its force can put energy in"
                        : "the force of the row " + row.name + " only takes energy, while 0 lies within its bounds");
  }
}

void check_forces(const Derivation& derivation, const Proof& proof, Findings& findings) {
  const DerivedLaw& law = *derivation.law;
  const Joint& joint = derivation.joint;
  const Span where = joint.on_any_coordinate() ? joint.law->free->where : joint.rows.front().where;
  if (const Law& opposite = proof.of(LawId::opposite); !opposite.text.empty())
    findings.add(
        Level::note, "momentum", where, opposite.text,
        opposite.text.find("torques") != std::string::npos
            ? "if nothing outside takes it, turn a second body with the opposite torque"
            : "if nothing outside takes it, push a second body with the opposite force, along the line between them");
  const std::vector<Expr> power = power_of(law);
  if (power.empty()) return;
  const Power range = power_at_random(derivation.joint, law, power);
  const double rounding = 1e-12 * range.largest_term;
  const char* does = -range.least <= rounding ? "has no power" : "only takes energy";
  if (range.most <= rounding)
    findings.add(Level::note, "power", where,
                 fmt::format("the force without an energy {}, at each of {} random states with positive parameters",
                             does, states));
  else
    findings.add(Level::note, "power", where,
                 fmt::format("the force without an energy can put energy in, for instance {:.2g} W{}{}", range.most,
                             range.at_most.empty() ? "" : " where ", range.at_most));
}

}  // namespace

void check_law(const Derivation& derivation, const Proof& proof, Findings& findings) {
  if (derivation.law) check_forces(derivation, proof, findings);
  check_bounded(derivation, findings);
}

}  // namespace cdot::derive
