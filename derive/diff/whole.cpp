// One slip that explains all differences of a published matrix: an order, an inverse, a frame, a factor. A reading
// turns the generated numbers into those that such a slip gives; it is named if these are the published ones at every
// pose.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "derive/diff/entry.hpp"
#include "derive/expression/symbols.hpp"
#include "derive/numbers/elimination.hpp"

namespace cdot::derive {
namespace {

constexpr double rounding = 1e-8;
constexpr int most_ordered = 6;  // whose orders are tried

using List = std::vector<double>;

bool alike(double a, double b) { return std::abs(a - b) <= rounding * (1 + std::abs(a) + std::abs(b)); }
bool alike(const List& a, const List& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) { return alike(x, y); });
}

// The inverse of a square matrix, row by row.
List inverted(const List& matrix) {
  const auto n = static_cast<std::size_t>(std::lround(std::sqrt(static_cast<double>(matrix.size()))));
  std::vector<List> rows(n, List(n));
  for (std::size_t i = 0; i < n * n; ++i) rows[i / n][i % n] = matrix[i];
  List inverse(n * n);
  for (std::size_t c = 0; c < n; ++c) {
    List unit(n);
    unit[c] = 1;
    const List column = derive::solved(rows, unit, [](double a, double pivot) { return a / pivot; });
    for (std::size_t r = 0; r < n; ++r) inverse[r * n + c] = column[r];
  }
  return inverse;
}

class Whole {
 public:
  Whole(const Entry& entry, const Part* part, const std::string& what, const Matrix& published, const Matrix& generated)
      : entry_(entry), part_(part), what_(what), hand_(published), mine_(generated) {
    for (const Sample& sample : entry.poses().samples()) {
      published_.push_back(values_at(published.entries, sample));
      generated_.push_back(values_at(generated.entries, sample));
    }
  }

  std::optional<Slip> slip() const {
    for (const auto reading : {&Whole::other_rows, &Whole::other_columns, &Whole::other_form, &Whole::inverse,
                               &Whole::wrong_sign, &Whole::wrong_sign_of_terms, &Whole::masses, &Whole::turned_inertia,
                               &Whole::lever, &Whole::other_body, &Whole::lever_of_other_body, &Whole::multiple})
      if (std::optional<Slip> found = (this->*reading)()) return found;
    return {};
  }

 private:
  std::string row_name(int row) const { return part_ ? name_of_row(*part_, row) : std::to_string(row + 1); }
  std::size_t at(int row, int column) const { return static_cast<std::size_t>(row * mine_.columns + column); }

  // True if the published numbers are `expected(numbers, pose)` of the generated ones.
  template <class Expected>
  bool is(Expected expected) const {
    for (std::size_t i = 0; i < published_.size(); ++i)
      if (!alike(published_[i], expected(i))) return false;
    return !published_.empty();
  }
  // The generated matrix with its rows and columns in another order.
  List reordered(const List& from, const Order* rows, const Order* columns) const {
    List to;
    for (int r = 0; r < mine_.rows; ++r)
      for (int c = 0; c < mine_.columns; ++c)
        to.push_back(from[at(rows ? (*rows)[static_cast<std::size_t>(r)] : r,
                             columns ? (*columns)[static_cast<std::size_t>(c)] : c)]);
    return to;
  }

  std::optional<Slip> other_rows() const {
    std::optional<Slip> found;
    if (mine_.rows < 2 || mine_.rows > most_ordered) return found;
    std::vector<std::string> names;
    for (int r = 0; r < mine_.rows; ++r) names.push_back(row_name(r));
    any_order(mine_.rows, [&](const Order& order) {
      const Order* const columns = what_ == "K" ? &order : nullptr;
      if (!is([&](std::size_t i) { return reordered(generated_[i], &order, columns); })) return false;
      found = Slip{"order", words_of(order, what_ == "K" ? "rows and columns" : "rows", names)};
      return true;
    });
    return found;
  }

  // Bodies in another order; of each body, w before v.
  std::optional<Slip> other_columns() const {
    if (!by_velocities_) return {};
    const int bodies = static_cast<int>(entry_.joint.bodies.size()), width = entry_.width();
    const auto matches = [&](auto column) {
      Order columns;
      for (int c = 0; c < mine_.columns; ++c) columns.push_back(column(c / width, c % width));
      return is([&](std::size_t i) { return reordered(generated_[i], nullptr, &columns); });
    };
    std::optional<Slip> found;
    any_order(bodies, [&](const Order& order) {
      if (!matches([&](int b, int k) { return order[static_cast<std::size_t>(b)] * width + k; })) return false;
      found = Slip{"order", words_of(order, "the columns of", entry_.joint.bodies)};
      return true;
    });
    if (found) return found;
    const int turns = width - entry_.joint.dimension;
    if (matches([&](int b, int k) { return b * width + (k < turns ? entry_.joint.dimension + k : k - turns); }))
      found = Slip{"order", "the columns of w stand before those of v"};
    return found;
  }

  // Of J in space: the columns for angular velocities along other axes. w . v = w' . v' with w' = A^T w.
  std::optional<Slip> other_form() const {
    if (what_ != "J" || entry_.joint.dimension == 2 || entry_.form == Form::euler) return {};
    const bool to_local = entry_.form == Form::global;
    const auto turned = [&](std::size_t pose) {
      List to = generated_[pose];
      for (int r = 0; r < mine_.rows; ++r)
        for (int c = 0; c < mine_.columns; c += 6) {
          const auto axes = axes_of(entry_.poses().samples()[pose].bodies[static_cast<std::size_t>(c / 6)].e);
          for (std::size_t i = 0; i < 3; ++i) {
            double& component = to[at(r, c + 3) + i];
            component = 0;
            for (std::size_t k = 0; k < 3; ++k)
              component += (to_local ? axes[i][k] : axes[k][i]) * generated_[pose][at(r, c + 3) + k];
          }
        }
      return to;
    };
    if (!is(turned)) return {};
    return Slip{"frame", fmt::format("its columns of w are for angular velocities along the axes of {}: say `form {}`",
                                     to_local ? "the bodies" : "the world", to_local ? "local" : "global")};
  }

  std::optional<Slip> inverse() const {
    if (what_ != "K" || !is([&](std::size_t pose) { return inverted(generated_[pose]); })) return {};
    return Slip{"inverse", "this is K^-1, the inverse of K"};
  }

  // True if the published numbers are the generated ones at samples changed by `change`.
  template <class Change>
  bool at_changed(Change change) const {
    return is([&](std::size_t i) {
      Sample sample = entry_.poses().samples()[i];
      change(sample);
      return values_at(mine_.entries, sample);
    });
  }

  std::vector<std::string> tensor_names(const std::string& body) const {
    if (entry_.joint.dimension == 2) return {"inv_I_" + body};
    std::vector<std::string> names;
    for (const char* ij : {"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"}) {
      std::string key(ij);
      std::sort(key.begin(), key.end());
      names.push_back("inv_I_" + body + "_" + key);
    }
    return names;
  }
  // The inverse inertia of a body, 1 or 9 numbers; empty if nothing here depends on it.
  List inverse_inertia(const Sample& sample, const std::string& body) const {
    List numbers;
    for (const std::string& name : tensor_names(body)) {
      const auto found = sample.scalars.find(name);
      if (found == sample.scalars.end()) return {};
      numbers.push_back(found->second);
    }
    return numbers;
  }
  template <class Changed>
  void change_inertia(Sample& sample, Changed changed) const {
    for (std::size_t b = 0; b < entry_.joint.bodies.size(); ++b) {
      const std::string& body = entry_.joint.bodies[b];
      const List before = inverse_inertia(sample, body);
      if (before.empty()) continue;
      const List after = changed(before, b);
      const std::vector<std::string> names = tensor_names(body);
      for (std::size_t k = 0; k < names.size(); ++k) sample.scalars[names[k]] = after[k];
    }
  }
  // Of one body, or of all: columns of J, or the terms of velocities; all of them, those of v or those of w.
  std::optional<Slip> wrong_sign() const {
    const int width = entry_.width(), linear = entry_.joint.dimension;
    const auto& bodies = entry_.joint.bodies;
    for (int b = -1; b < static_cast<int>(bodies.size()); ++b)
      for (const auto& [v, w, of] :
           {std::tuple(true, true, "body "), std::tuple(true, false, "v_"), std::tuple(false, true, "w_")}) {
        const auto turned = [&, v = v, w = w](std::size_t pose) {
          List to = generated_[pose];
          for (int c = 0; c < mine_.columns; ++c)
            for (int r = 0; r < mine_.rows && (b < 0 || c / width == b); ++r)
              if (c % width < linear ? v : w) to[at(r, c)] *= -1;
          return to;
        };
        const auto reversed = [&, v = v, w = w](Sample& sample) {
          for (std::size_t i = 0; i < bodies.size(); ++i)
            for (std::size_t k = 0; k < 3 && (b < 0 || static_cast<int>(i) == b); ++k) {
              if (v) sample.bodies[i].v[k] *= -1;
              if (w) sample.bodies[i].w[k] *= -1;
            }
        };
        if (by_velocities_ ? !is(turned) : !at_changed(reversed)) continue;
        if (b < 0 && v && w) return Slip{"sign", "all of it has the wrong sign"};
        const std::string whose = b < 0 ? (v ? "v" : "w") : of + bodies[static_cast<std::size_t>(b)];
        return Slip{"sign", fmt::format("the {} of {} have the wrong sign", what_ == "J" ? "columns" : "terms", whose)};
      }
    return {};
  }

  // Of K: the terms with inertias, or those with masses; of all bodies, or of one.
  std::optional<Slip> wrong_sign_of_terms() const {
    if (what_ != "K") return {};
    const auto& bodies = entry_.joint.bodies;
    for (std::size_t b = 0; b <= bodies.size(); ++b)
      for (const auto& [stem, words] : {std::pair("inv_I_", "inertias"), std::pair("inv_m_", "masses")}) {
        const std::string start = stem + (b < bodies.size() ? bodies[b] : "");
        const auto reversed = [&](Sample& sample) {
          for (auto& [name, value] : sample.scalars)
            if (name.starts_with(start)) value *= -1;
        };
        if (!at_changed(reversed)) continue;
        return Slip{"sign", b < bodies.size()
                                ? fmt::format("the terms with the {} of {} have the wrong sign", words, bodies[b])
                                : fmt::format("the terms with {} have the wrong sign", words)};
      }
    return {};
  }

  std::optional<Slip> masses() const {
    const auto invert_masses = [&](Sample& sample) {
      for (const std::string& body : entry_.joint.bodies)
        if (const auto m = sample.scalars.find("inv_m_" + body); m != sample.scalars.end()) m->second = 1 / m->second;
    };
    const auto invert_inertia = [&](Sample& sample) {
      change_inertia(sample, [](const List& I, std::size_t) { return inverted(I); });
    };
    if (at_changed(invert_masses)) return Slip{"inverse", "masses m stand where 1/m belongs"};
    if (at_changed(invert_inertia))
      return Slip{"inverse", entry_.joint.dimension == 2 ? "inertias I stand where 1/I belongs"
                                                         : "inertias I stand where I^-1 belongs"};
    if (at_changed([&](Sample& sample) { invert_masses(sample), invert_inertia(sample); }))
      return Slip{"inverse", "masses and inertias stand where their inverses belong: J M J^T in place of J M^-1 J^T"};
    return {};
  }

  // Of W = A B A^T with B in the body's axes: B itself, or A^T W A in place of W where W is meant in body axes.
  std::optional<Slip> turned_inertia() const {
    if (entry_.joint.dimension == 2) return {};
    // R W R^T, or R^T W R
    const auto turned = [&](Sample& sample, int times) {
      change_inertia(sample, [&](List W, std::size_t b) {
        const auto axes = axes_of(sample.bodies[b].e);  // columns of A
        for (int t = 0; t < times; ++t) {
          List next(9);
          for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
              for (std::size_t k = 0; k < 3; ++k)
                for (std::size_t l = 0; l < 3; ++l) next[3 * i + j] += axes[i][k] * W[3 * k + l] * axes[j][l];
          W = next;
        }
        return W;
      });
    };
    if (at_changed([&](Sample& sample) { turned(sample, 1); }))
      return Slip{"frame", "the inertia is left in the axes of its body: A^T I^-1 A stands where I^-1 belongs"};
    if (at_changed([&](Sample& sample) { turned(sample, 2); }))
      return Slip{"frame", "the inertia is turned to the wrong side: A^T I^-1 A in place of A I^-1 A^T"};
    return {};
  }

  // An arm, or a name that the spec gives to a vector, times 1/2, 2 or -1.
  std::optional<Slip> lever() const {
    std::vector<std::pair<std::string, Expr>> levers;
    for (const Parameter& p : entry_.joint.parameters)
      if (p.kind == ParameterKind::point && p.body >= 0) levers.emplace_back(p.symbol->symbol, p.symbol);
    for (const Let& let : entry_.joint.lets)
      if (let.value->vector) levers.emplace_back(let.name, let.value);
    std::map<const Node*, Expr> named;  // stays as it is
    for (const Let& let : entry_.joint.lets) named.emplace(&*let.value, let.value);
    for (const auto& [name, lever] : levers)
      for (const auto& [factor, words] : {std::pair(Rational(1, 2), "half of {} stands where {} belongs"),
                                          std::pair(Rational(2), "twice {} stands where {} belongs"),
                                          std::pair(Rational(-1), "-{} stands where {} belongs")})
        if (is_with(named, lever, factor * lever))
          return Slip{factor == Rational(-1) ? "sign" : "factor", fmt::format(fmt::runtime(words), name, name)};
    return {};
  }

  bool is_with(std::map<const Node*, Expr> named, Expr lever, Expr other) const {
    named[&*lever] = other;
    const std::vector<Expr> entries = substituted(mine_, named);
    return is([&](std::size_t i) { return values_at(entries, entry_.poses().samples()[i]); });
  }

  // Undone in the published matrix, the exchange gives the generated one.
  std::optional<Slip> other_body() const {
    for (const Exchange& exchange : exchanges(entry_.joint)) {
      const std::vector<Expr> mended = substituted(hand_, exchange.replacements);
      bool right = true;
      for (std::size_t i = 0; right && i < generated_.size(); ++i)
        right = alike(values_at(mended, entry_.poses().samples()[i]), generated_[i]);
      if (right) return Slip{"wrong body", exchange.words};
    }
    return {};
  }

  // Of K: in the terms of one body, the arm of another.
  std::optional<Slip> lever_of_other_body() const {
    if (what_ != "K") return {};
    std::vector<Expr> arms;
    for (const Parameter& p : entry_.joint.parameters)
      if (p.kind == ParameterKind::point && p.body >= 0) arms.push_back(p.symbol);
    for (const std::string& body : entry_.joint.bodies)
      for (const Expr arm : arms)
        for (const Expr other : arms) {
          if (arm == other) continue;
          const std::vector<Expr> exchanged = substituted(mine_, {{&*arm, other}});
          const auto expected = [&](std::size_t pose) {
            const Sample& sample = entry_.poses().samples()[pose];
            Sample without = sample;
            for (auto& [name, value] : without.scalars)
              if (name == "inv_m_" + body || name.starts_with("inv_I_" + body)) value = 0;
            List of = values_at(exchanged, sample);
            const List rest = values_at(exchanged, without), others = values_at(mine_.entries, without);
            for (std::size_t i = 0; i < of.size(); ++i) of[i] += others[i] - rest[i];
            return of;
          };
          if (is(expected))
            return Slip{"wrong body", fmt::format("in the terms of body {}, {} stands where {} belongs", body,
                                                  other->symbol, arm->symbol)};
        }
    return {};
  }

  static std::vector<Expr> substituted(const Matrix& in, const std::map<const Node*, Expr>& replacements) {
    std::vector<Expr> entries;
    for (const Expr e : in.entries) entries.push_back(substitute(e, replacements, KeepNames::no));
    return entries;
  }

  // All of it, or one row, times a constant.
  std::optional<Slip> multiple() const {
    const std::optional<double> all = ratio(0, mine_.rows);
    if (all) return Slip{"factor", fmt::format("all of it is {:.6g} times what it should be", *all)};
    for (int r = 0; r < mine_.rows && what_ != "K"; ++r) {
      bool others = true;
      for (std::size_t i = 0; i < published_.size(); ++i)
        for (int s = 0; s < mine_.rows; ++s)
          for (int c = 0; c < mine_.columns; ++c)
            others = others && (s == r || alike(published_[i][at(s, c)], generated_[i][at(s, c)]));
      const std::optional<double> k = others ? ratio(r, r + 1) : std::nullopt;
      if (k) return Slip{"factor", fmt::format("row {} is {:.6g} times what it should be", row_name(r), *k)};
    }
    return {};
  }
  std::optional<double> ratio(int first, int end) const {
    std::optional<double> k;
    for (std::size_t i = 0; i < published_.size(); ++i)
      for (int r = first; r < end; ++r)
        for (int c = 0; c < mine_.columns; ++c) {
          const double p = published_[i][at(r, c)], g = generated_[i][at(r, c)];
          if (!k && std::abs(g) > 1e-3) k = p / g;
          if (k ? !alike(p, *k * g) : !alike(p, 0)) return {};
        }
    return k;
  }

  const Entry& entry_;
  const Part* part_;  // null: of a claim
  const std::string what_;
  const bool by_velocities_ =
      what_ == "J" || what_ == "update";  // its columns: the row is M^-1 J^T lambda of an update
  const Matrix &hand_, &mine_;
  std::vector<List> published_, generated_;  // by pose
};

}  // namespace

std::optional<Slip> slip_of_whole(const Entry& entry, const Part* part, const std::string& what,
                                  const Matrix& published, const Matrix& generated) {
  return Whole(entry, part, what, published, generated).slip();
}

}  // namespace cdot::derive
