// The parts of the search for a singular K: minors of J, and sentences about where they vanish.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "derive/check/mass.hpp"
#include "derive/syntax/source.hpp"

namespace cdot::derive {
namespace {

std::string who(const std::set<std::string>& bodies, std::string_view last) {
  return listed(std::vector<std::string>(bodies.begin(), bodies.end()), last);
}

std::string abilities(const Way& way, std::string_view last, std::string_view between) {
  std::string s;
  if (!way.move.empty()) s += who(way.move, last) + " can move";
  if (!way.move.empty() && !way.turn.empty()) s += between;
  if (!way.turn.empty()) s += who(way.turn, last) + " can turn";
  return s;
}

}  // namespace

std::string in_words(const std::vector<Way>& ways) {
  Way any;
  bool single = true;
  for (const Way& way : ways) {
    single = single && way.move.size() <= 1 && way.turn.size() <= 1;
    any.move.insert(way.move.begin(), way.move.end());
    any.turn.insert(way.turn.begin(), way.turn.end());
  }
  const std::size_t all = std::max<std::size_t>(1, any.move.size()) * std::max<std::size_t>(1, any.turn.size());
  if (single && ways.size() == all) return abilities(any, " or ", ", and ");
  constexpr std::size_t most_ways = 3;
  std::vector<std::string> parts;
  for (const Way& way : ways)
    if (parts.size() < most_ways) parts.push_back(abilities(way, " and ", " and "));
  if (ways.size() > most_ways) parts.push_back(fmt::format("in {} other ways", ways.size() - most_ways));
  return listed(parts, ", or ");
}

ex Minors::of(const std::vector<std::size_t>& columns) {
  if (columns.empty()) return 1;
  if (const auto found = made_.find(columns); found != made_.end()) return found->second;
  const std::vector<ex>& row = J_[J_.size() - columns.size()];
  ex sum = 0;
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const ex& entry = row[columns[k]];
    if (entry.is_zero()) continue;
    std::vector<std::size_t> others = columns;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const ex part = entry * of(others);
    sum = k % 2 == 0 ? sum + part : sum - part;
  }
  return made_.emplace(columns, expanded_if_short(sum).value_or(sum)).first->second;
}

bool is_positive(const ex& expanded, const std::vector<ex>& symbols) {
  const GiNaC::exvector terms =
      is_a<GiNaC::add>(expanded) ? GiNaC::exvector(expanded.begin(), expanded.end()) : GiNaC::exvector{expanded};
  bool constant = false;
  for (const ex& term : terms) {
    ex factor = term;
    for (const ex& s : symbols) {
      const int degree = factor.degree(s);
      if (degree % 2 != 0) return false;
      factor = factor.coeff(s, degree);
    }
    if (!factor.info(GiNaC::info_flags::positive)) return false;
    constant = constant || is_a<numeric>(term);
  }
  return constant;
}

double number_of_choices(std::size_t n, std::size_t k) {
  double product = 1;
  for (std::size_t i = 0; i < k; ++i) {
    product *= static_cast<double>(n - i) / static_cast<double>(i + 1);
  }
  return product;
}

}  // namespace cdot::derive
