// The sign and the scale of C are the author's choice, equation by equation. The chosen ones have the fewest differing
// entries of C, Cdot, J and b in the whole entry, and the fewest differing terms in them.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

#include "derive/diff/entry.hpp"
#include "derive/diff/terms.hpp"

namespace cdot::derive {
namespace {

// The factors of the rows of J, Cdot and K, and of C.
struct Scale {
  Expr of_J, of_C;
  bool operator==(const Scale&) const = default;
};

struct Misfit {
  int blocks = 0;         // differing ones
  int blocks_on_C = 0;    // those that differ on C = 0, too; counted where scales have equally many others
  std::size_t terms = 0;  // differing ones in them
  friend auto operator<=>(const Misfit&, const Misfit&) = default;
};

// v or w of a body.
int block_of(const Entry& entry, int column) {
  return 2 * (column / entry.width()) + (column % entry.width() < entry.joint.dimension ? 0 : 1);
}

// One row of an item beside the generated one.
struct Witness {
  const Part& part;
  const HandItem& item;
  std::size_t row;

  const Matrix& mine() const { return generated_of(part, item); }
  bool fits() const { return item.value && item.value->rows == mine().rows && item.value->columns == mine().columns; }
  Expr hand(int column) const { return item.value->at(static_cast<int>(row), column); }
  Expr generated(int column, const Scale& scale) const {
    const Expr factor = item.what == "b" ? -scale.of_J : item.what == "C" ? scale.of_C : scale.of_J;
    return scaled(factor, mine().at(static_cast<int>(row), column));
  }
};

// Calls `wrong(column, is_of_a_new_block)` for the columns that differ at these poses, if the row has this scale.
// Columns of v, or of w, of one body are one block.
template <class Wrong>
void each_misfit(const Entry& entry, const Poses& poses, const Witness& witness, const Scale& scale, Wrong wrong) {
  int block = -1;
  for (int c = 0; witness.fits() && c < witness.mine().columns; ++c) {
    if (poses.equal(witness.hand(c), witness.generated(c, scale))) continue;
    wrong(c, block_of(entry, c) != block);
    block = block_of(entry, c);
  }
}

Misfit misfit_of(const Entry& entry, const Witness& witness, const Scale& scale) {
  Misfit misfit;
  each_misfit(entry, entry.poses(), witness, scale, [&](int c, bool is_new) {
    const Leftover left = leftover_terms(witness.hand(c), witness.generated(c, scale), entry.joint, Opened::everything);
    misfit.blocks += is_new ? 1 : 0;
    misfit.terms += left.hand.size() + left.generated.size();
  });
  return misfit;
}

// The rows of one vector equation have one sign: its C is the author's choice as a whole. Others are alone.
std::vector<std::size_t> first_of_equation(const std::vector<ScalarRow>& rows) {
  std::vector<std::size_t> first;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const bool joins = i > 0 && rows[i].row && rows[i].row == rows[i - 1].row;
    first.push_back(joins ? first.back() : i);
  }
  return first;
}

// From K alone: D K D with the D = diag(+-1) that fits best; the first equation's sign is free.
std::vector<Expr> signs_of_mass(const Entry& entry, const Part& part) {
  const Matrix& K = part.generated.K;
  const std::vector<std::size_t> first = first_of_equation(part.rows);
  int best = -1;
  std::vector<Rational> kept(part.rows.size(), Rational(1));
  for (unsigned pattern = 0; pattern < (1u << part.rows.size()); pattern += 2) {
    std::vector<Rational> sign;
    bool together = true;
    for (std::size_t i = 0; i < part.rows.size(); ++i) {
      sign.push_back((pattern >> i) & 1 ? -1 : 1);
      together = together && sign[i] == sign[first[i]];
    }
    if (!together) continue;
    int agreed = 0;
    for (const HandItem& item : part.hand->items) {
      if (item.kind != HandItem::Kind::quantity || item.what != "K" || !item.value) continue;
      if (item.value->rows != K.rows || item.value->columns != K.columns) continue;
      for (int i = 0; i < K.rows; ++i) {
        for (int j = 0; j < K.columns; ++j) {
          const Rational s = sign[static_cast<std::size_t>(i)] * sign[static_cast<std::size_t>(j)];
          agreed += entry.poses().equal(item.value->at(i, j), s * K.at(i, j)) ? 1 : 0;
        }
      }
    }
    if (agreed > best) best = agreed, kept = sign;
  }
  std::vector<Expr> scale;
  for (const Rational sign : kept) scale.push_back(entry.pool().number(sign));
  return scale;
}

// The rational number with a small denominator that k is, but for round-off.
std::optional<Rational> rational_near(double k) {
  constexpr int largest = 64;
  if (!(std::abs(k) < 1e6)) return {};
  for (int den = 1; den <= largest; ++den) {
    const double num = std::round(k * den);
    if (num != 0 && std::abs(k * den - num) < 1e-7) return Rational(static_cast<std::int64_t>(num), den);
  }
  return {};
}

// True if e is undefined where p is 0.
bool divides_by(Expr e, Expr p) {
  return std::ranges::any_of(topological(std::span(&e, 1)), [&](Expr part) {
    for (std::size_t i = 0; part->kind == Kind::product && i < part->args.size(); ++i)
      if (part->args[i] == p && part->exponents[i] < 0) return true;
    return false;
  });
}

// 1, and powers of a parameter that are not zero wherever this C and the source's are defined.
std::vector<Expr> factors_without_zeros(const Joint& joint, Expr C) {
  std::vector<Expr> factors = {joint.pool->number(1)};
  for (const Parameter& p : joint.parameters) {
    if (p.kind != ParameterKind::scalar) continue;
    const bool never_zero = p.above >= 0 || p.below <= 0;
    for (const int power : {-1, -2, 1, 2})
      if (power < 0 || never_zero || divides_by(C, p.symbol)) factors.push_back(pow(p.symbol, power));
  }
  return factors;
}

// The constant k with published = k * generated in these rows, if it is a rational number.
std::optional<Rational> common_ratio(const Entry& entry, const Matrix& published, const Matrix& generated, Expr factor,
                                     std::size_t first, std::size_t rows) {
  std::optional<Rational> common;
  for (std::size_t r = first; r < first + rows; ++r) {
    const std::optional<double> ratio =
        entry.poses().constant_ratio(published.entries[r], scaled(factor, generated.entries[r]));
    const std::optional<Rational> k = ratio ? rational_near(*ratio) : std::nullopt;
    if (!k || (common && *common != *k)) return {};
    common = k;
  }
  return common;
}

// Other functions with the zeros of C = A - B, with a B that no pose changes: A^2 - B^2, and without the squares.
struct OtherForm {
  Expr C;
  Scale by;  // on C = 0
};
std::vector<OtherForm> other_forms(Expr C) {
  std::vector<OtherForm> forms;
  if (C->kind != Kind::sum || C->args.size() != 2) return forms;
  const auto is_still = [](Expr e) {
    const std::vector<Expr> leaves = leaves_of(std::span(&e, 1));
    return std::ranges::all_of(leaves, [](Expr leaf) { return leaf->role == Role::parameter && !leaf->vector; });
  };
  for (const std::size_t i : {0u, 1u}) {
    const Expr A = C->coefs[i] * C->args[i], B = -(C->coefs[1 - i] * C->args[1 - i]);
    if (!is_still(B) || is_still(A)) continue;
    forms.push_back({pow(A, 2) - pow(B, 2), {2 * A, A + B}});
    const Term square = split_coefficient(A);
    if (square.e->kind != Kind::dot || square.e->args[0] != square.e->args[1]) continue;
    const Expr rest = Rational(1) / square.coef * B;
    const Expr root = norm(square.e->args[0]), of_B = call(Fn::sqrt, std::span(&rest, 1));
    forms.push_back({root - of_B, {pow(2 * square.coef * root, -1), pow(square.coef * (root + of_B), -1)}});
  }
  return forms;
}

// The scale that the first entry of an equation shows, of Cdot, b, J or K (there twice over): a number times a factor.
std::optional<Scale> scale_shown(const Entry& entry, const Part& part, const HandItem& item, std::size_t first,
                                 Expr factor) {
  const Matrix& mine = generated_of(part, item);
  if (!item.value || item.value->rows != mine.rows || item.value->columns != mine.columns) return {};
  const bool of_K = item.what == "K";
  const int row = static_cast<int>(first);
  int column = of_K ? row : 0;
  while (column < mine.columns && is_zero(mine.at(row, column))) ++column;
  if (column == mine.columns) return {};
  const Expr right = scaled(item.what == "b" ? -factor : of_K ? factor * factor : factor, mine.at(row, column));
  const std::optional<double> ratio = entry.poses().constant_ratio(item.value->at(row, column), right);
  const std::optional<Rational> k = ratio ? rational_near(of_K ? std::sqrt(*ratio) : *ratio) : std::nullopt;
  if (!k) return {};
  const Expr scale = *k * factor;
  return Scale{scale, scale};
}

// Scales that two quantities of the part show alike: their C is not given, but it has this scale.
std::vector<Scale> shown_twice(const Entry& entry, const Part& part, std::size_t first) {
  std::vector<Scale> once, twice;
  for (const Expr factor : factors_without_zeros(entry.joint, part.generated.C.entries[first]))
    for (const HandItem& item : part.hand->items) {
      if (item.kind != HandItem::Kind::quantity || item.what == "C") continue;
      const std::optional<Scale> shown = scale_shown(entry, part, item, first, factor);
      if (!shown) continue;
      // K shows the size, not the sign.
      const Scale opposite{-shown->of_J, -shown->of_J};
      for (const Scale& scale : {*shown, opposite}) {
        if (scale == opposite && item.what != "K") continue;
        (std::ranges::find(once, scale) == once.end() ? once : twice).push_back(scale);
      }
    }
  return twice;
}

// The scales by which the source's C may be that of the spec: 1, -1, and their ratio where that is a number, or a
// number times a power of a parameter.
std::vector<Scale> candidates(const Entry& entry, const Part& part, std::size_t first, std::size_t rows) {
  Pool& pool = entry.pool();
  const auto both = [](Expr scale) { return Scale{scale, scale}; };
  std::vector<Scale> all = {both(pool.number(1)), both(pool.number(-1))};
  if (!part.rows[first].row) return all;  // the value of a coordinate counts, not its zero alone
  const auto add = [&](const Scale& scale) {
    if (std::ranges::find(all, scale) == all.end()) all.push_back(scale);
  };
  const auto is_C = [](const HandItem& item) { return item.kind == HandItem::Kind::quantity && item.what == "C"; };
  if (std::ranges::none_of(part.hand->items, is_C))
    for (const Scale& scale : shown_twice(entry, part, first)) add(scale);
  for (const HandItem& item : part.hand->items) {
    if (!is_C(item) || !item.value) continue;
    const Matrix& mine = part.generated.C;
    if (item.value->rows != mine.rows || item.value->columns != 1) continue;
    for (const Expr factor : factors_without_zeros(entry.joint, mine.entries[first])) {
      const std::optional<Rational> k = common_ratio(entry, *item.value, mine, factor, first, rows);
      if (!k) continue;
      add(both(*k * factor));
      break;
    }
    if (rows != 1) continue;
    for (const OtherForm& form : other_forms(mine.entries[first])) {
      const std::optional<double> ratio = entry.poses().constant_ratio(item.value->entries[first], form.C);
      const std::optional<Rational> k = ratio ? rational_near(*ratio) : std::nullopt;
      if (k) all.push_back({*k * form.by.of_J, *k * form.by.of_C});
    }
  }
  return all;
}

// 2/l for 2*1/l
std::string as_quotient(std::string product) {
  if (const std::size_t at = product.find("*1/"); at != product.npos) product.erase(at, 2);
  return product;
}

}  // namespace

namespace {

// All that an entry says of one equation.
struct Evidence {
  std::vector<Scale> scales;
  std::vector<Witness> witnesses;
};

// Scales with equally many wrong blocks differ by those on C = 0, where the source may be meant.
const Scale& best_scale(Entry& entry, const Evidence& evidence) {
  std::vector<Misfit> misfits;
  for (const Scale& scale : evidence.scales) {
    misfits.emplace_back();
    for (const Witness& witness : evidence.witnesses) {
      const Misfit of_one = misfit_of(entry, witness, scale);
      misfits.back().blocks += of_one.blocks;
      misfits.back().terms += of_one.terms;
    }
  }
  const auto best = [&] { return std::min_element(misfits.begin(), misfits.end()) - misfits.begin(); };
  const int least = misfits[static_cast<std::size_t>(best())].blocks;
  const bool tie = least > 0 && std::ranges::count(misfits, least, &Misfit::blocks) > 1;
  for (std::size_t k = 0; tie && k < misfits.size(); ++k)
    for (const Witness& witness : evidence.witnesses)
      if (misfits[k].blocks == least)
        each_misfit(entry, entry.poses_on_constraint(), witness, evidence.scales[k],
                    [&](int, bool is_new) { misfits[k].blocks_on_C += is_new ? 1 : 0; });
  return evidence.scales[static_cast<std::size_t>(best())];
}

}  // namespace

void find_signs(Entry& entry, std::vector<Part>& parts) {
  std::map<std::string, Evidence> evidence;  // by the first row of an equation; several parts may have it
  for (const Part& part : parts) {
    const std::vector<std::size_t> first = first_of_equation(part.rows);
    for (std::size_t row = 0; row < part.rows.size(); ++row) {
      for (const HandItem& item : part.hand->items) {
        if (item.kind != HandItem::Kind::quantity || item.what == "K") continue;
        Evidence& of = evidence[part.rows[first[row]].name];
        if (of.scales.empty()) {
          const auto rows = static_cast<std::size_t>(std::count(first.begin(), first.end(), first[row]));
          of.scales = candidates(entry, part, first[row], rows);
        }
        of.witnesses.push_back({part, item, row});
      }
    }
  }
  std::map<std::string, Scale> best;
  for (const auto& [equation, of] : evidence) best.emplace(equation, best_scale(entry, of));
  for (Part& part : parts) {
    bool any = false;
    for (const std::size_t first : first_of_equation(part.rows)) {
      const auto found = best.find(part.rows[first].name);
      any = any || found != best.end();
      const Expr one = entry.pool().number(1);
      part.scale.push_back(found != best.end() ? found->second.of_J : one);
      part.scale_of_C.push_back(found != best.end() ? found->second.of_C : one);
    }
    if (!any) part.scale = part.scale_of_C = signs_of_mass(entry, part);
  }
}

// Of which equations C has another sign or scale, and the consequence.
std::vector<std::string> remarks_on_signs(const std::vector<Part>& parts) {
  std::map<std::string, std::pair<Expr, std::string>> names;  // of equations, by the text of their scale
  std::set<std::string> of_other_form;
  for (const Part& part : parts) {
    for (std::size_t i = 0; i < part.rows.size(); ++i) {
      const std::string name = "`" + (part.rows[i].row ? part.rows[i].row->name : part.rows[i].name) + "`";
      if (part.scale[i] != part.scale_of_C[i]) of_other_form.insert(text(part.scale[i]));
      auto& [scale, said] = names[text(part.scale[i])];
      scale = part.scale[i];
      if (said.find(name) == said.npos) said += (said.empty() ? "" : ", ") + name;
    }
  }
  std::vector<std::string> remarks;
  for (const auto& [words, of_scale] : names) {
    const auto& [scale, equations] = of_scale;
    if (is_one(scale)) continue;
    const std::string of = names.size() == 1 ? "" : " of " + equations;
    remarks.push_back(
        of_other_form.contains(words)
            ? fmt::format("C{} is another function with the same zeros: J is scaled by {}, and K twice over", of,
                          as_quotient(words))
        : scale->kind != Kind::number
            ? fmt::format("C{} is scaled by {}: J is, too, and K twice over", of, as_quotient(words))
        : !is_number(scale, -1)
            ? fmt::format("C{} is {} times that of the spec: J is, too, and K twice over", of, words)
        : names.size() == 1
            ? "C has the opposite sign: J changes its sign, K does not"
            : fmt::format("C{} has the opposite sign: its rows of J change their sign, and K between them "
                          "and others",
                          of));
  }
  return remarks;
}

}  // namespace cdot::derive
