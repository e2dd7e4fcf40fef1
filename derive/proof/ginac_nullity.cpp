// The zero-test at random points modulo the prime. All tests of a joint share the points: once the roots of its
// formulas have values there, later tests need no others.
#include <algorithm>
#include <iterator>

#include "derive/proof/ginac.hpp"

namespace cdot::derive {

const Draws::Leaves& Algebra::leaves_at(std::size_t place) {
  const auto [found, fresh] = leaves_of_parts_.try_emplace(place);
  if (!fresh) return found->second;
  for (const std::size_t part : steps_.parts_of(place)) {
    const auto drawn = drawn_with_.find(steps_.leaf(part));
    if (drawn != drawn_with_.end()) found->second.insert(drawn->second);
  }
  return found->second;
}

void Algebra::put(const Draws& draws, const ex& symbol, PointValues& values) const {
  const std::string& leaf = drawn_with_.at(symbol);
  const std::vector<ex>& together = drawn_together_.at(leaf);
  values.draw_by(draws.seed_of(leaf));
  if (together.size() == 1) values.put(symbol);
  else values.put_direction(together);
}

// The order in which a point is tried: what the roots of a formula need, by the number of roots nested in it, then the
// rest. An attempt ends at the first level with a root of a non-square: most of them end early, at the same level
// whatever GiNaC's order of terms.
std::vector<std::vector<std::size_t>> Algebra::order_of_trial(const std::vector<std::size_t>& parts) const {
  if (std::ranges::none_of(parts, [&](std::size_t place) { return steps_.is_root(place); })) return {parts};
  std::vector<bool> needed(parts.back() + 1);
  for (auto place = parts.rbegin(); place != parts.rend(); ++place) {
    if (steps_.is_root(*place)) needed[*place] = true;
    for (const std::size_t operand : steps_.operands(*place))
      if (needed[*place]) needed[operand] = true;
  }
  std::vector<std::vector<std::size_t>> levels(1);
  for (const std::size_t place : parts) {
    if (!needed[place]) continue;
    if (levels.size() <= steps_.level(place)) levels.resize(steps_.level(place) + 1);
    levels[steps_.level(place)].push_back(place);
  }
  levels.emplace_back();
  std::ranges::copy_if(parts, std::back_inserter(levels.back()), [&](std::size_t p) { return !needed[p]; });
  return levels;
}

// One leaf of each root without a value is drawn again. GiNaC's order of parts differs from run to run, so the choice
// is made from sets of names alone.
void Algebra::draw_again(Point& point, std::span<const std::size_t> roots, std::span<const std::size_t> without_value) {
  Draws::Leaves of_others, chosen;
  for (const std::size_t place : roots)
    if (point.known.has(place)) of_others.insert(leaves_at(place).begin(), leaves_at(place).end());
  for (const std::size_t place : without_value) {
    if (leaves_at(place).empty()) return point.give_up();
    chosen.insert(point.choice(leaves_at(place), of_others));
  }
  for (const std::string& leaf : chosen) {
    point.again(leaf);
    for (const ex& symbol : drawn_together_.at(leaf)) point.values->forget(symbol);
  }
  ++point.known.generation;
}

// These roots without a value, and those that share leaves with them, directly or by others.
std::vector<std::size_t> Algebra::related(std::vector<std::size_t> without_value, std::span<const std::size_t> roots) {
  std::set<std::size_t> found(without_value.begin(), without_value.end());
  for (std::size_t next = 0; next < without_value.size(); ++next) {
    const Draws::Leaves& leaves = leaves_at(without_value[next]);
    const auto shared = [&](const std::string& leaf) { return leaves.contains(leaf); };
    for (const std::size_t place : roots)
      if (std::ranges::any_of(leaves_at(place), shared) && found.insert(place).second) without_value.push_back(place);
  }
  return {found.begin(), found.end()};
}

// Values of earlier tests stay known, so a test costs what is new in it.
Nullity Algebra::nullity_of(const std::vector<std::size_t>& parts) {
  const auto occurs = [&](const std::vector<std::size_t>& all) { return std::ranges::includes(parts, all); };
  if (std::ranges::any_of(never_together_, occurs)) return Nullity::unknown;
  std::vector<std::size_t> roots;
  std::ranges::copy_if(parts, std::back_inserter(roots), [&](std::size_t place) { return steps_.is_root(place); });
  std::vector<std::vector<std::size_t>> anew;  // the order where nothing is known
  PointValues::Undefined undefined;
  const auto value_at = [&](Point& point) -> std::optional<std::pair<Modular, bool>> {
    constexpr std::int64_t work_of_attempt = 128;
    if (point.known.has(parts.back())) return point.value_at(parts.back());
    if (!point.values) point.values.emplace(point.seed(), PointValues::Roots::of_squares);
    const auto source = [&](const ex& symbol) { put(point, symbol, *point.values); };
    const bool fresh = !point.known.any();
    if (fresh && anew.empty()) anew = order_of_trial(parts);
    const auto has_values = [&](const std::vector<std::size_t>& some) {
      left_for_points_ -= static_cast<std::int64_t>(some.size()) + work_of_attempt;
      undefined = point.values->evaluate(steps_, some, point.known, source);
      return undefined.empty();
    };
    const auto known = [&](std::size_t place) { return point.known.has(place); };
    if (fresh ? std::ranges::all_of(anew, has_values)
              : std::ranges::all_of(order_of_trial(steps_.parts_of(parts.back(), known)), has_values))
      return point.value_at(parts.back());
    if (!undefined.never.empty() || left_for_points_ < 0) point.give_up();
    else draw_again(point, roots, undefined.roots);
    return std::nullopt;
  };
  const bool patient = left_for_points_ > 0;
  const Nullity found = nullity(std::span(points_), value_at, patient ? attempts_at_points : least_attempts);
  if (!undefined.never.empty()) never_together_.push_back({undefined.never[0]});
  else if (patient && !undefined.roots.empty()) never_together_.push_back(related(undefined.roots, roots));
  return found;
}

}  // namespace cdot::derive
