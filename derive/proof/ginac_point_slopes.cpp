// Slopes of steps by all symbols at once, by the chain rule from step to step. They are as many as the steps, however
// long GiNaC's own derivative would be, and however many symbols there are.
#include <algorithm>
#include <array>

#include "derive/proof/ginac_point.hpp"
#include "derive/proof/ginac_walks.hpp"

namespace cdot::derive {

std::size_t Steps::sum(std::span<const std::size_t> terms) {
  if (terms.empty()) return place_of(0);
  return terms.size() == 1 ? terms[0] : add(Kind::sum, terms);
}

std::size_t Steps::product(std::span<const std::size_t> factors) {
  std::vector<std::size_t> others;
  for (const std::size_t factor : factors)
    if (factor != place_of(1)) others.push_back(factor);
  if (others.empty()) return place_of(1);
  return others.size() == 1 ? others[0] : add(Kind::product, others);
}

std::size_t Steps::slope(std::size_t last, const ex& symbol) {
  const auto [found, fresh] = gradients_.try_emplace(last);
  if (fresh) found->second = gradient(last);
  const auto slope = found->second.find(place_of(symbol));
  return slope == found->second.end() ? place_of(0) : slope->second;
}

// From users to operands: a step adds its own slope, times its partial derivative, to that of each operand.
std::map<std::size_t, std::size_t> Steps::gradient(std::size_t last) {
  std::map<std::size_t, std::size_t> by_symbols;
  std::unordered_map<std::size_t, std::vector<std::size_t>> terms = {{last, {place_of(1)}}};
  const std::vector<std::size_t> parts = parts_of(last);
  for (auto place = parts.rbegin(); place != parts.rend(); ++place) {
    if (steps_[*place].constant) continue;
    const std::size_t slope = sum(terms.at(*place));
    terms.erase(*place);
    const Step step = steps_[*place];
    if (step.kind == Kind::leaf) by_symbols.emplace(*place, slope);
    const std::vector<std::size_t> operands(operands_.begin() + static_cast<std::ptrdiff_t>(step.begin),
                                            operands_.begin() + static_cast<std::ptrdiff_t>(step.end));
    const std::vector<std::size_t> factors = factors_of_slopes(step, operands);
    for (std::size_t i = 0; i < operands.size(); ++i)
      if (!steps_[operands[i]].constant) terms[operands[i]].push_back(product(std::array{factors[i], slope}));
  }
  return by_symbols;
}

// The partial derivatives of a step by its operands.
std::vector<std::size_t> Steps::factors_of_slopes(const Step& step, std::span<const std::size_t> operands) {
  std::vector<std::size_t> factors(operands.size(), place_of(1));
  if (step.kind == Kind::product) {
    for (std::size_t i = 0; i < operands.size(); ++i) {
      if (steps_[operands[i]].constant) continue;
      std::vector<std::size_t> others(operands.begin(), operands.end());
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
      factors[i] = product(others);
    }
  }
  if (step.kind == Kind::power || step.kind == Kind::function) {
    const Partials partials(step.e);
    // The operands take the places of the fresh symbols; the exponent of a power is a number.
    for (std::size_t i = 0; i < operands.size(); ++i) put(partials.symbols[i], operands[i]);
    for (std::size_t i = 0; i < operands.size(); ++i) {
      const ex slope =
          step.kind == Kind::power ? step.e.op(1) * pow(partials.symbols[0], step.e.op(1) - 1) : partials.slopes[i];
      factors[i] = place_of(slope);
    }
  }
  return factors;
}

}  // namespace cdot::derive
