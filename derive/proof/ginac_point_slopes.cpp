// Slopes of steps, by the chain rule from step to step. They are as many as the steps, however long GiNaC's own
// derivative would be.
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
  const std::size_t by = place_of(symbol);
  for (const std::size_t place : parts_of(last)) {
    if (slopes_.contains({place, by})) continue;
    const std::size_t slope = slope_of_step(place, by);
    slopes_.emplace(std::pair(place, by), slope);
  }
  return slopes_.at({last, by});
}

// f(x, y)' = f_x x' + f_y y'
std::size_t Steps::slope_of_step(std::size_t place, std::size_t by) {
  if (place == by) return place_of(1);
  const Step step = steps_[place];
  const std::vector<std::size_t> operands(operands_.begin() + static_cast<std::ptrdiff_t>(step.begin),
                                          operands_.begin() + static_cast<std::ptrdiff_t>(step.end));
  const std::size_t zero = place_of(0);
  std::vector<std::size_t> slopes, terms;
  for (const std::size_t operand : operands) slopes.push_back(slopes_.at({operand, by}));
  if (std::ranges::all_of(slopes, [&](std::size_t slope) { return slope == zero; })) return zero;
  const std::vector<std::size_t> factors = factors_of_slopes(step, operands);
  for (std::size_t i = 0; i < operands.size(); ++i) {
    if (slopes[i] != zero) terms.push_back(product(std::array{factors[i], slopes[i]}));
  }
  return sum(terms);
}

// The partial derivatives of a step by its operands.
std::vector<std::size_t> Steps::factors_of_slopes(const Step& step, std::span<const std::size_t> operands) {
  std::vector<std::size_t> factors(operands.size(), place_of(1));
  if (step.kind == Kind::product) {
    for (std::size_t i = 0; i < operands.size(); ++i) {
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
