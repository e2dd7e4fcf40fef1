// The laws, one function each: the derivation and GiNaC's result from the same C must be equal.
#include "derive/proof/prove.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "derive/proof/laws.hpp"

namespace cdot::derive {
namespace {

class Prover {
 public:
  Prover(const Joint& joint, const Block& block, std::int64_t slopes)
      : joint_(joint),
        block_(block),
        names_(joint, Algebra::Route::names, block.immovable, slopes),
        raw_(joint, Algebra::Route::raw, block.immovable, slopes) {
    for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
      names_.coordinates(static_cast<int>(b));  // in the order of the spec
      raw_.coordinates(static_cast<int>(b));
    }
    for (const ScalarRow& row : block.rows) {
      const bool position = row.kind != RowKind::velocity;
      names_.shorten(position ? row.C : row.Cdot);
      raw_.shorten(position ? row.C : row.Cdot);
      if (position) names_.of(row.C);
      names_.of(row.Cdot);
      Cdot_.push_back(position ? names_.rate(names_.of(row.C)) : names_.of(row.Cdot));
    }
  }

  Proof run();

  void momentum(Law& law) { conserves_momentum(law, joint_, block_, names_); }
  void rank(Law& law) {
    if (joint_.law) law.verdict = Verdict::does_not_apply;  // the coordinates of an effect may depend on each other
    else rows_are_independent(law, block_);
  }

  bool movable(std::size_t body) const { return static_cast<int>(body) != block_.immovable; }

  void rate(Law& law) {
    law.verdict = Verdict::does_not_apply;
    for (std::size_t i = 0; i < block_.rows.size(); ++i) {
      const ScalarRow& row = block_.rows[i];
      if (row.kind == RowKind::velocity) continue;
      if (law.verdict == Verdict::does_not_apply) law.verdict = Verdict::holds;
      require_zero(law, names_, names_.of(row.Cdot) - Cdot_[i], row, ": Cdot is not the time derivative of C");
    }
  }

  // d2 Cdot / dv_i dv_j = 0
  void linear(Law& law) {
    for (std::size_t i = 0; i < block_.rows.size(); ++i) {
      const std::vector<ex> v = velocities(names_);
      for (std::size_t j = 0; j < v.size(); ++j) {
        const ex slope = names_.derivative(Cdot_[i], v[j]);
        for (std::size_t k = 0; k <= j; ++k) {
          require_zero(law, names_, names_.derivative(slope, v[k]), block_.rows[i],
                       ": Cdot is not linear in the velocities");
        }
      }
    }
  }

  void jacobian(Law& law) {
    for (std::size_t i = 0; i < block_.rows.size(); ++i) {
      const ScalarRow& row = block_.rows[i];
      ex Jv = names_.of(row.C_t);
      for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
        const auto v = names_.velocities(static_cast<int>(b));
        const auto J = entries(names_, row.J[b]);
        for (std::size_t k = 0; k < J.size(); ++k) Jv += J[k] * v[k];
      }
      require_zero(law, names_, Jv - Cdot_[i], row, ": J v + dC/dt is not Cdot");
    }
  }

  // Columns of J against the slopes of C as each body moves and turns, or at velocity level against dCdot/dv.
  void raw(Law& law) {
    for (const ScalarRow& row : block_.rows) {
      const bool position = row.kind != RowKind::velocity;
      const ex source = raw_.of(position ? row.C : row.Cdot);
      for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
        const auto J = entries(raw_, row.J[b]);
        const auto v = raw_.velocities(static_cast<int>(b));
        for (std::size_t k = 0; k < J.size(); ++k) {
          const ex expected = position ? raw_.slope(source, static_cast<int>(b), k) : raw_.derivative(source, v[k]);
          require_zero(law, raw_, J[k] - expected, row, ", column " + column(b, k) + ": J is not the derivative of C");
        }
      }
    }
  }

  // K(i, j) = J_i M^-1 J_j^T, and the same with i and j exchanged.
  void mass(Law& law) {
    for (std::size_t i = 0; i < block_.rows.size(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const std::string where = ": K(" + std::to_string(i + 1) + "," + std::to_string(j + 1) + ") is not J M^-1 J^T";
        const ex K = names_.of(block_.K[i][j]);
        require_zero(law, names_, K - product(i, j), block_.rows[i], where);
        if (i != j) require_zero(law, names_, K - product(j, i), block_.rows[i], where);
      }
    }
  }

  ex product(std::size_t i, std::size_t j) {
    ex total = 0;
    for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
      if (!movable(b)) continue;
      const BodySymbols body = body_symbols(joint_, static_cast<int>(b));
      const ex inv_m = names_.of(body.inv_m);
      const auto Ji = entries(names_, block_.rows[i].J[b]);
      const auto Jj = entries(names_, block_.rows[j].J[b]);
      const std::size_t linear = static_cast<std::size_t>(joint_.dimension);
      for (std::size_t k = 0; k < linear; ++k) total += Ji[k] * inv_m * Jj[k];
      for (std::size_t k = linear; k < Ji.size(); ++k) {
        for (std::size_t l = linear; l < Jj.size(); ++l) {
          total += Ji[k] * inverse_inertia_entry(body.inv_I, k - linear, l - linear) * Jj[l];
        }
      }
    }
    return total;
  }

  ex inverse_inertia_entry(Expr inv_I, std::size_t k, std::size_t l) {
    return names_.of(joint_.dimension == 2 ? inv_I : tensor_component(inv_I, k, l));
  }

  void gamma(Law& law) {
    if (block_.immovable >= 0) law.verdict = Verdict::does_not_apply;
    for (std::size_t i = 0; i < block_.rows.size(); ++i) {
      const ScalarRow& row = block_.rows[i];
      for (const Expr gamma : {row.gamma, row.gamma_by_entries}) {
        if (!gamma) continue;
        require_zero(law, names_, names_.of(gamma) + names_.rate(Cdot_[i]), row,
                     ": gamma is not minus the second time derivative of C without accelerations");
      }
    }
  }

  // d(J^T lambda)/dq, J^T lambda being the gradient of lambda . C where there is a C.
  void stiffness(Law& law) {
    if (block_.stiffness.empty()) law.verdict = Verdict::does_not_apply;
    const std::size_t width = columns_per_body(joint_.dimension);
    for (std::size_t row = 0; row < block_.stiffness.size(); ++row) {
      const ex force = generalised_force(row / width, row % width);
      for (std::size_t c = 0; c < block_.stiffness.size(); ++c) {
        const ex H = raw_.of(block_.stiffness[row][c]);
        const ex expected = movable(row / width) ? raw_.slope(force, static_cast<int>(c / width), c % width) : ex(0);
        require_zero(law, raw_, H - expected, block_.rows.front(),
                     ", entry (" + column(row / width, row % width) + ", " + column(c / width, c % width) +
                         "): the geometric stiffness is not d(J^T lambda)/dq");
      }
    }
  }

  ex generalised_force(std::size_t b, std::size_t k) {
    ex force = 0;
    if (!movable(b)) return force;
    for (std::size_t i = 0; i < block_.rows.size(); ++i) {
      const ScalarRow& row = block_.rows[i];
      const ex slope = row.kind == RowKind::velocity ? entries(raw_, row.J[b])[k]
                                                     : raw_.slope(raw_.of(row.C), static_cast<int>(b), k);
      force += raw_.of(block_.lambda[i]) * slope;
    }
    return force;
  }

  // Derivatives along body axes, de/dt = 1/2 e (0, w'), and along the Euler parameters themselves. GiNaC takes them
  // from C in raw coordinates, a route without w. dC/de = J_c + (dC/de . e) e^T.
  void forms(Law& law) {
    law.verdict = Verdict::does_not_apply;
    if (joint_.dimension == 2) return;
    for (const ScalarRow& row : block_.rows) {
      if (row.kind == RowKind::velocity) continue;
      if (law.verdict == Verdict::does_not_apply) law.verdict = Verdict::holds;
      for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
        if (movable(b)) forms_of(law, row, static_cast<int>(b));
      }
    }
  }

  void forms_of(Law& law, const ScalarRow& row, int b) {
    const auto J = entries(raw_, row.J[static_cast<std::size_t>(b)]);
    const std::vector<ex> q = raw_.coordinates(b);
    const EulerParameters<ex> e = {q[3], q[4], q[5], q[6]}, conjugate = {e[0], -e[1], -e[2], -e[3]};
    const auto A = axes_of(e);
    const Triple<ex> J_w = {J[3], J[4], J[5]};
    std::array<ex, 4> slope;
    for (std::size_t k = 0; k < 4; ++k) slope[k] = raw_.derivative(raw_.of(row.C), e[k]);
    const ex half = numeric(1, 2), along = raw_.of(time_derivative(row.C, joint_, {.stretched = b}));
    for (std::size_t k = 0; k < 3; ++k) {
      EulerParameters<ex> turn = {0, 0, 0, 0};
      turn[k + 1] = half;
      const EulerParameters<ex> rate = cdot::derive::product(e, turn);
      ex expected = 0;
      for (std::size_t m = 0; m < 4; ++m) expected += slope[m] * rate[m];
      require_zero(law, raw_, inner_product(J_w, A[k]) - expected, row,
                   ", column w'_" + joint_.bodies[static_cast<std::size_t>(b)] + "." + "xyz"[k] +
                       ": J diag(E, A) is not the derivative of C along the body's axes");
    }
    for (std::size_t k = 0; k < 4; ++k) {
      // Column k of 2 G: the w of de_k/dt = 1 alone.
      EulerParameters<ex> unit = {0, 0, 0, 0};
      unit[k] = 2;
      const EulerParameters<ex> w = cdot::derive::product(unit, conjugate);
      require_zero(law, raw_, inner_product(J_w, Triple<ex>{w[1], w[2], w[3]}) - (slope[k] - along * e[k]), row,
                   ", column e" + std::to_string(k) + " of " + joint_.bodies[static_cast<std::size_t>(b)] +
                       ": J diag(E, 2 G) is not dC/de - (dC/de . e) e^T");
    }
  }

 private:
  std::vector<ex> velocities(Algebra& algebra) const {
    std::vector<ex> all;
    for (std::size_t b = 0; b < joint_.bodies.size(); ++b) {
      for (const ex& v : algebra.velocities(static_cast<int>(b))) all.push_back(v);
    }
    return all;
  }

  static std::vector<ex> entries(Algebra& algebra, const JacobianEntry& entry) {
    std::vector<ex> columns;
    for (const Expr e : columns_of(entry)) columns.push_back(algebra.of(e));
    return columns;
  }

  std::string column(std::size_t body, std::size_t k) const {
    const std::size_t linear = static_cast<std::size_t>(joint_.dimension);
    const std::string& name = joint_.bodies[body];
    if (k < linear) return "v_" + name + "." + "xyz"[k];
    return "w_" + name + (linear == 2 ? "" : std::string(".") + "xyz"[k - linear]);
  }

  const Joint& joint_;
  const Block& block_;
  Algebra names_, raw_;
  std::vector<ex> Cdot_;  // by GiNaC
};

// clang-format off
const struct {
  std::string_view word, name;
  void (Prover::*prove)(Law&) = nullptr;  // null: of what is specialised from a block
} laws[] = {  // in the order of LawId
    {"rate",      "Cdot is the time derivative of C",                                  &Prover::rate},
    {"linear",    "Cdot is linear in v",                                               &Prover::linear},
    {"jacobian",  "J v + dC/dt = Cdot",                                                &Prover::jacobian},
    {"raw",       "J agrees with C in raw coordinates",                                &Prover::raw},
    {"mass",      "K is symmetric and J M^-1 J^T",                                     &Prover::mass},
    {"gamma",     "gamma = -Jdot v - d/dt dC/dt",                                      &Prover::gamma},
    {"stiffness", "the geometric stiffness is the Hessian of lambda . C",              &Prover::stiffness},
    {"forms",     "J_b = J diag(E, A) and J_c = J diag(E, 2 G) are derivatives of C",  &Prover::forms},
    {"momentum",  "momentum is conserved",                                             &Prover::momentum},
    {"rank",      "the rows are independent",                                          &Prover::rank},
    {"immovable", "a body made immovable only loses its own terms"},
    {"isotropic", "K of isotropic bodies is K"},
    {"force",     "F is -dE/dC and what the spec adds"},
    {"slopes",    "k = -dF/dC, d = -dF/d(rate)"},
    {"opposite",  "the forces together conserve momentum"},
};
// clang-format on

Proof Prover::run() {
  Proof proof;
  for (int i = 0; i < number_of_laws; ++i) {
    proof.laws.push_back(judged(static_cast<LawId>(i), [&](Law& law) { (this->*laws[i].prove)(law); }));
  }
  return proof;
}

}  // namespace

Law judged(LawId id, const std::function<void(Law&)>& check) {
  Law law;
  law.id = id;
  try {
    check(law);
  } catch (const std::exception&) {
    law.verdict = Verdict::undecided;
    law.text = "an intermediate formula is undefined";
  }
  return law;
}

void require_zero(Law& law, Algebra& algebra, const ex& difference, const ScalarRow& row, const std::string& where) {
  if (law.verdict == Verdict::fails) return;
  const Algebra::Zero zero = algebra.is_zero(difference);
  if (zero == Algebra::Zero::shown && law.verdict == Verdict::holds) law.verdict = Verdict::shown;
  if (zero <= Algebra::Zero::shown) return;
  law.row = row.row;
  const bool differs = zero == Algebra::Zero::no;
  law.verdict = differs ? Verdict::fails : Verdict::undecided;
  law.text = row.name + where +
             (differs ? ", for instance " + algebra.witness(difference)
                      : ": equal to 60 digits at random poses, but not proved");
}

std::string_view word_of(LawId id) { return laws[static_cast<std::size_t>(id)].word; }
std::string_view name_of(LawId id) { return laws[static_cast<std::size_t>(id)].name; }

std::optional<LawId> law_of(std::string_view word) {
  const auto found = std::find_if(std::begin(laws), std::end(laws), [&](auto& t) { return t.word == word; });
  if (found == std::end(laws)) return std::nullopt;
  return static_cast<LawId>(found - std::begin(laws));
}

std::string_view name_of(Verdict v) {
  switch (v) {
    case Verdict::holds: return "holds";
    case Verdict::shown: return "shown at random points";
    case Verdict::fails: return "fails";
    case Verdict::undecided: return "undecided";
    case Verdict::does_not_apply: return "does not apply";
  }
  return "";
}

bool is_broken(const Law& law) { return law.verdict == Verdict::fails || law.verdict == Verdict::undecided; }

bool Proof::holds() const { return std::none_of(laws.begin(), laws.end(), is_broken); }

Proof prove(const Joint& joint, const Block& block, std::int64_t slopes) { return Prover(joint, block, slopes).run(); }

std::vector<Proved> prove_blocks(const Derivation& derivation) {
  const Joint& joint = derivation.joint;
  std::vector<Proved> all = {{"", {}, prove(joint, derivation.rows)}};
  if (joint.law) std::ranges::copy(laws_of_effect(derivation), std::back_inserter(all[0].proof.laws));
  for (std::size_t i = 0; i < joint.coordinates.size(); ++i) {
    const Coordinate& coordinate = joint.coordinates[i];
    all.push_back({coordinate.name, coordinate.where, prove(joint, derivation.coordinates[i])});
  }
  return all;
}

std::vector<Proved> prove(const Derivation& derivation) {
  std::vector<Proved> all = prove_blocks(derivation);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Block& block = i == 0 ? derivation.rows : derivation.coordinates[i - 1];
    all[i].proof.laws.push_back(variants_are_the_block(derivation.joint, block));
    all[i].proof.laws.push_back(isotropic_is_the_block(derivation.joint, block));
  }
  return all;
}

}  // namespace cdot::derive
