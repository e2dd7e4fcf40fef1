// The law of an effect: forces that are not opposite, and the power of what has no energy.
#include <cmath>
#include <fmt/format.h>

#include "derive/check/parts.hpp"
#include "derive/expression/symbols.hpp"

namespace cdot::derive {
namespace {

constexpr int states = 256;

// The power U . Cdot of the part of the force without an energy, over C, rates and positive parameters.
Expr power_of(const DerivedLaw& law) {
  Expr power;
  for (std::size_t i = 0; i < law.unstored.size(); ++i) {
    if (is_zero(law.unstored[i])) continue;
    const Expr of_row = law.unstored[i] * law.rate[i];
    power = power ? power + of_row : of_row;
  }
  return power;
}

struct Power {
  double least = 0, most = 0;
  std::string at_most;  // rates of the state with the largest power
};

// Values and rates of either sign, at random; parameters are positive.
Power power_at_random(const Joint& joint, const DerivedLaw& law, Expr power) {
  Power range;
  for (std::uint64_t seed = 0; seed < states; ++seed) {
    Sample sample = random_sample(joint, std::span(&power, 1), seed);
    Random random(seed);
    for (const Expr leaf : leaves_of(std::span(&power, 1)))
      if (!sample.scalars.contains(leaf->symbol)) sample.scalars[leaf->symbol] = random.between(-2, 2);
    for (const auto* leaves : {&law.value, &law.rate})
      for (const Expr leaf : *leaves)
        if (leaf && sample.scalars.contains(leaf->symbol)) sample.scalars[leaf->symbol] = random.between(-2, 2);
    const double value = Numbers(sample).scalar(power);
    range.least = std::fmin(range.least, value);
    if (!(value > range.most)) continue;
    range.most = value;
    range.at_most.clear();
    for (std::size_t i = 0; i < law.rate.size(); ++i)
      if (const auto rate = sample.scalars.find(law.rate[i]->symbol); rate != sample.scalars.end())
        range.at_most += fmt::format("{}{} = {:.2g}", range.at_most.empty() ? "" : ", ", rate->first, rate->second);
  }
  return range;
}

}  // namespace

void check_law(const Derivation& derivation, const Proof& proof, Findings& findings) {
  const DerivedLaw& law = *derivation.law;
  const Span where = derivation.joint.rows.front().where;
  if (const Law& opposite = proof.of(LawId::opposite); !opposite.text.empty())
    findings.add(
        Level::note, "momentum", where, opposite.text,
        "if nothing outside takes it, push a second body with the opposite force, along the line between them");
  const Expr power = power_of(law);
  if (!power) return;
  const Power range = power_at_random(derivation.joint, law, power);
  const double rounding = 1e-12 * std::fmax(range.most, -range.least);
  if (range.most <= rounding)
    findings.add(Level::note, "power", where,
                 fmt::format("the force without an energy only takes energy, at each of {} random states with positive "
                             "parameters",
                             states));
  else
    findings.add(Level::note, "power", where,
                 fmt::format("the force without an energy can put energy in, for instance {:.2g} W{}{}", range.most,
                             range.at_most.empty() ? "" : " where ", range.at_most));
}

}  // namespace cdot::derive
