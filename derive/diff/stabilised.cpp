// Terms that a solver adds on purpose: b with a Baumgarte term, -Cdot - beta/h C, and K with the softness of its rows
// on the diagonal. Both are right: they are told, and taken off before anything is compared.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "derive/diff/entry.hpp"
#include "derive/diff/terms.hpp"

namespace cdot::derive {
namespace {

constexpr double rate_rounding = 1e-8, least_divisor = 1e-6;
constexpr std::size_t longest_term = 60;

// The same parameters, masses and free symbols, with the bodies of another sample.
Sample with_bodies_of(const Sample& other, Sample sample) {
  sample.bodies = other.bodies;
  return sample;
}

// True if e / divisor has the same value whatever the bodies do, and the sign `sign`.
bool is_constant_share(Expr e, Expr divisor, int sign, const Poses& poses) {
  const std::vector<Sample>& all = poses.samples();
  int seen = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::vector<double> here = values_at({e, divisor}, all[i]);
    const std::vector<double> there = values_at({e, divisor}, with_bodies_of(all[(i + 1) % all.size()], all[i]));
    if (std::abs(here[1]) < least_divisor || std::abs(there[1]) < least_divisor) continue;
    const double share = here[0] / here[1];
    if (!(share * sign > 0) || std::abs(there[0] / there[1] - share) > rate_rounding * (1 + std::abs(share)))
      return false;
    ++seen;
  }
  return seen > 0;
}

bool depends_on_masses(Expr e) {
  const std::vector<Expr> leaves = leaves_of(std::span(&e, 1));
  return std::any_of(leaves.begin(), leaves.end(),
                     [](Expr leaf) { return leaf->role == Role::inverse_mass || leaf->role == Role::inverse_inertia; });
}

std::string in_short(Expr e, const Entry& entry, const std::string& otherwise) {
  const std::string written = in_names_of_spec(brief_text(e, entry.joint), entry.joint);
  return written.size() > longest_term ? otherwise : written;
}

}  // namespace

Matrix without_baumgarte(Entry& entry, const Part& part, const HandItem& item, Matrix generated) {
  if (item.what != "b" || item.value->rows != generated.rows || item.value->columns != 1) return generated;
  for (std::size_t r = 0; r < part.rows.size(); ++r) {
    const Expr published = item.value->entries[r], C = scaled(part.scale_of_C[r], part.generated.C.entries[r]);
    const Expr added = difference_of(published, -scaled(part.scale[r], generated.entries[r]), entry.joint);
    if (is_zero(C) || entry.poses().equal(added, C->pool->number(0))) continue;
    if (!is_constant_share(added, C, -1, entry.poses())) {
      if (is_constant_share(added, C, 1, entry.poses()))
        entry.verdict.remarks.push_back(
            fmt::format("in row {} of b a Baumgarte term has the wrong sign: it drives C away from 0",
                        name_of_row(part, static_cast<int>(r))));
      continue;
    }
    generated.entries[r] = scaled(-pow(part.scale[r], -1), published);
    entry.verdict.remarks.push_back(fmt::format("b agrees in row {}, plus a Baumgarte term that drives C to 0: {}",
                                                name_of_row(part, static_cast<int>(r)),
                                                in_short(added, entry, "a multiple of C")));
  }
  return generated;
}

Matrix without_softness(Entry& entry, const Part& part, const HandItem& item, Matrix generated) {
  if (item.value->rows != generated.rows || item.value->columns != generated.columns) return generated;
  const Expr one = entry.pool().number(1);
  for (std::size_t r = 0; r < part.rows.size(); ++r) {
    const std::size_t at = r * part.rows.size() + r;
    const Expr square = part.scale[r] * part.scale[r];
    const Expr published = item.value->entries[at],
               added = difference_of(published, scaled(square, generated.entries[at]), entry.joint);
    if (is_zero(added) || free_symbols(added).empty() || depends_on_masses(added)) continue;
    if (!is_constant_share(added, one, 1, entry.poses())) continue;
    generated.entries[at] = scaled(pow(square, -1), published);
    entry.verdict.remarks.push_back(fmt::format("K agrees in row {}, plus softness on the diagonal: {}",
                                                name_of_row(part, static_cast<int>(r)),
                                                in_short(added, entry, "a positive number")));
  }
  return generated;
}

}  // namespace cdot::derive
