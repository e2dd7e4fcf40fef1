// From a derivation to the functions of the kernel contract, as programs.
#include "derive/kernel/plan.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "derive/derivation/forms.hpp"
#include "derive/expression/components.hpp"
#include "derive/expression/matrix.hpp"
#include "derive/expression/symbols.hpp"
#include "derive/kernel/factor.hpp"
#include "derive/kernel/stored_jacobian.hpp"

namespace cdot::derive {
namespace {

class BlockPlanner {
 public:
  BlockPlanner(const Joint& joint, const Block& block, std::string name)
      : joint_(joint),
        pool_(*joint.pool),
        block_(block),
        width_(columns_per_body(joint.dimension)),
        pose_(joint),
        J_(joint, block) {
    out_.name = std::move(name);
    out_.fields = J_.fields();
    out_.block = &block;
  }

  KernelBlock plan() {
    if (rows() == 0) return std::move(out_);
    add_position_and_jacobian();
    add_effective_mass();
    add("factor", "K = L D L^T; F holds L and, on the diagonal, D^-1", factor_outputs(block_));
    add("solve", "lambda = K^-1 rhs", solve_outputs(block_));
    add_velocity();
    add_apply();
    add_dense();
    add_inverse_mass_jacobian();
    if (joint_.dimension == 3) {
      isotropic_ = true;
      add_effective_mass();
      add_apply();
      add_inverse_mass_jacobian();
      isotropic_ = false;
    }
    if (block_.immovable < 0) add_what_variants_inherit();
    return std::move(out_);
  }

 private:
  std::size_t rows() const { return block_.rows.size(); }
  std::size_t bodies() const { return joint_.bodies.size(); }
  void add(std::string name, std::string summary, const std::vector<NamedExpr>& outputs) {
    if (isotropic_) summary += ", for sphere-like bodies";
    out_.functions.push_back({std::move(name), std::move(summary), assemble(outputs), isotropic_, {}});
  }

  void add_position_and_jacobian() {
    add_from_pose("position", "C", [&](PoseInputs& pose) { return position(pose); });
    const auto outputs = [&](PoseInputs& pose) { return position_and_jacobian(pose, &Field::value); };
    add_from_pose("jacobian", "C and J", outputs);
    add_from_pose_opened(outputs);
    const bool of_surface = std::any_of(block_.rows.begin(), block_.rows.end(),
                                        [](const ScalarRow& row) { return !row.gradients.empty(); });
    for (std::size_t b = 0; of_surface && b < bodies(); ++b) {
      PoseInputs carried(joint_, static_cast<int>(b));
      function("position").other.push_back(assemble(position(carried)));
      function("jacobian").other.push_back(assemble(position_and_jacobian(carried, &Field::entry)));
    }
  }

  std::vector<NamedExpr> position(PoseInputs& pose) const {
    std::vector<NamedExpr> outputs;
    for (std::size_t i = 0; i < rows(); ++i) outputs.push_back({element("C", i), pose.of(block_.rows[i].C)});
    return outputs;
  }

  std::vector<NamedExpr> position_and_jacobian(PoseInputs& pose, Expr Field::*number) const {
    std::vector<NamedExpr> outputs = position(pose);
    for (const Field& f : out_.fields) outputs.push_back({"J." + f.name, pose.of(f.*number)});
    return outputs;
  }

  KernelFunction& function(const std::string& name) {
    return *std::ranges::find(out_.functions, name, &KernelFunction::name);
  }

  // K in the simplified form of the derivation, from stored numbers of J. If that form needs other numbers, K falls
  // back to the plain sum over J's entries.
  void add_effective_mass() {
    Components components;
    std::map<const Node*, Expr> held;
    for (const Field& f : out_.fields) {
      held.emplace(&*f.value, f.symbol);
      held.emplace(&*(-f.value), -f.symbol);
    }
    const auto& K_of_rows = isotropic_ ? block_.K_isotropic : block_.K;
    std::vector<NamedExpr> simplified, plain;
    bool complete = true;
    for (std::size_t i = 0; i < rows(); ++i) {
      for (std::size_t j = 0; j <= i; ++j) {
        const Expr K = substitute(components.of(K_of_rows[i][j]), held);
        for (const Expr e : topological(std::span(&K, 1))) {
          complete = complete && (e->kind != Kind::symbol || e->role == Role::given || e->role == Role::inverse_mass ||
                                  e->role == Role::inverse_inertia || e->role == Role::constant);
        }
        simplified.push_back({triangle_element("K", i, j), K});
        plain.push_back({triangle_element("K", i, j), plain_effective_mass(i, j)});
      }
    }
    const std::string summary = "K = J M^-1 J^T, lower triangle, from J";
    add("effective_mass", summary, plain);
    if (complete) add_other_way(simplified);
    if (rows() == 1 && joint_.dimension == 3 && !isotropic_)
      add_other_way({{triangle_element("K", 0, 0), folded_mass()}});
  }

  // K of one row, each product of two components of w once.
  Expr folded_mass() const {
    Expr K = pool_.number(0);
    for (std::size_t b = 0; b < bodies(); ++b) {
      if (static_cast<int>(b) == block_.immovable) continue;
      const Expr inv_I = body_symbols(joint_, static_cast<int>(b)).inv_I;
      for (std::size_t k = 0; k < 3; ++k) K = K + J_.entry(0, 6 * b + k) * weighted(0, 6 * b + k);
      // w' I w = x (I_xx x + 2 (I_xy y + I_xz z)) + y (I_yy y + 2 I_yz z) + I_zz z^2
      const auto w = [&](std::size_t k) { return J_.entry(0, 6 * b + 3 + k); };
      for (std::size_t k = 0; k < 3; ++k) {
        Expr beside = pool_.number(0);
        for (std::size_t l = k + 1; l < 3; ++l) beside = beside + tensor_component(inv_I, k, l) * w(l);
        K = K + w(k) * (tensor_component(inv_I, k, k) * w(k) + Rational(2) * beside);
      }
    }
    return K;
  }

  Expr plain_effective_mass(std::size_t i, std::size_t j) const {
    Expr K = pool_.number(0);
    for (std::size_t b = 0; b < bodies(); ++b) {
      if (static_cast<int>(b) == block_.immovable) continue;
      for (std::size_t k = 0; k < width_; ++k) {
        K = K + J_.entry(i, width_ * b + k) * weighted(j, width_ * b + k);
      }
    }
    return K;
  }

  // A number of (M^-1 J^T)^T.
  Expr weighted(std::size_t row, std::size_t column) const {
    return inverse_mass_times(column, [&](std::size_t c) { return J_.entry(row, c); });
  }

  // Row `column` of M^-1 times a column of numbers: 1/m for translation, 1/I or the tensor I^-1 for rotation.
  template <class Numbers>
  Expr inverse_mass_times(std::size_t column, Numbers numbers) const {
    const BodySymbols body = body_symbols(joint_, static_cast<int>(column / width_));
    const std::size_t k = column % width_, first = column - k + 3;
    if (k < static_cast<std::size_t>(joint_.dimension)) return body.inv_m * numbers(column);
    if (joint_.dimension == 2 || isotropic_) return body.inv_I * numbers(column);
    Expr sum = pool_.number(0);
    for (std::size_t l = 0; l < 3; ++l) {
      sum = sum + tensor_component(body.inv_I, k - 3, l) * numbers(first + l);
    }
    return sum;
  }

  std::vector<Expr> velocity_components(std::size_t b) const {
    const BodySymbols body = body_symbols(joint_, static_cast<int>(b));
    Components components;
    std::vector<Expr> v = components.of_vector(body.v);
    const std::vector<Expr> w = body.w->vector ? components.of_vector(body.w) : std::vector{body.w};
    v.insert(v.end(), w.begin(), w.end());
    return v;
  }

  void add_velocity() {
    std::vector<NamedExpr> outputs;
    for (std::size_t i = 0; i < rows(); ++i) {
      Expr Jv = pool_.number(0);
      for (std::size_t b = 0; b < bodies(); ++b) {
        const std::vector<Expr> v = velocity_components(b);
        for (std::size_t k = 0; k < width_; ++k) Jv = Jv + J_.entry(i, width_ * b + k) * v[k];
      }
      outputs.push_back({element("Jv", i), Jv});
    }
    add("velocity", "J v", outputs);
  }

  // J^T lambda
  Expr force(std::size_t column) const {
    Expr force = pool_.number(0);
    for (std::size_t i = 0; i < rows(); ++i) {
      force = force + J_.entry(i, column) * pool_.symbol("lambda_" + std::to_string(i + 1), Role::multiplier);
    }
    return force;
  }

  // The members of Velocity<T>, in the order of J's columns.
  static std::string velocity_member(std::size_t k, std::size_t width) {
    static const char* const planar[] = {"x", "y", "w"};
    static const char* const spatial[] = {"x", "y", "z", "wx", "wy", "wz"};
    return width == 3 ? planar[k] : spatial[k];
  }

  void add_apply() {
    std::vector<NamedExpr> outputs;
    for (std::size_t c = 0; c < width_ * bodies(); ++c) {
      const Expr change = inverse_mass_times(c, [&](std::size_t column) { return force(column); });
      if (static_cast<int>(c / width_) == block_.immovable || is_zero(change)) continue;
      outputs.push_back({element("v", c / width_) + "." + velocity_member(c % width_, width_),
                         velocity_components(c / width_)[c % width_] + change});
    }
    add("apply", "v += M^-1 J^T lambda", outputs);
  }

  void add_dense() {
    std::vector<NamedExpr> J;
    for (std::size_t i = 0; i < rows(); ++i) {
      for (std::size_t c = 0; c < width_ * bodies(); ++c) J.push_back({element(element("D", i), c), J_.entry(i, c)});
    }
    add("dense", std::string("J with its zeros: ") + (width_ == 3 ? "v_x, v_y, w" : "v, w") + " of each body", J);
  }

  void add_inverse_mass_jacobian() {
    std::vector<NamedExpr> outputs;
    for (std::size_t i = 0; i < rows(); ++i) {
      for (std::size_t c = 0; c < width_ * bodies(); ++c)
        outputs.push_back({element(element("D", i), c), weighted(i, c)});
    }
    add("inverse_mass_jacobian", "(M^-1 J^T)^T, laid out like dense", outputs);
  }

  // Functions outside the inner loops of solvers: a variant inherits them from the general block.
  void add_what_variants_inherit() {
    if (joint_.dimension == 3) add_other_forms();
    add_rates_and_stiffness();
  }

  // The other two velocity forms in space.
  void add_other_forms() {
    add_form("local_jacobian", "form (b), J by v and the body-local w' = A^T w of each body: J diag(E, A)",
             Form::local);
    add_form("euler_jacobian", "form (c), J by v and the rates of the Euler parameters: J diag(E, 2 G)", Form::euler);
  }

  void add_form(const std::string& name, const std::string& summary, Form form) {
    std::vector<NamedExpr> J;
    for (std::size_t i = 0; i < rows(); ++i) {
      for (std::size_t b = 0, c = 0; b < bodies(); ++b) {
        std::vector<Expr> global;
        for (std::size_t k = 0; k < 6; ++k) global.push_back(J_.entry(i, 6 * b + k));
        for (const Expr e : columns_in(form, global, joint_, static_cast<int>(b))) {
          J.push_back({element(element("D", i), c++), e});
        }
      }
    }
    add(name, summary, J);
  }

  // A function of the pose, with the z axes of whole frames turned into the world or as cross products.
  template <class Outputs>
  void add_from_pose(const std::string& name, const std::string& summary, Outputs outputs) {
    const std::vector<NamedExpr> turned = outputs(pose_);
    add(name, summary, turned);
    add_with_cross_products(turned, outputs);
  }

  template <class Outputs>
  void add_with_cross_products(const std::vector<NamedExpr>& turned, Outputs outputs) {
    const std::vector<std::string> frames = whole_frames(joint_, turned);
    if (frames.empty()) return;
    PoseInputs crossed(joint_, -1, frames);
    add_other_way(outputs(crossed));
  }

  // C and J share products term by term: the products of u × v + s × t in C stand alone in J.
  template <class Outputs>
  void add_from_pose_opened(Outputs outputs) {
    const auto opened = [&](PoseInputs& pose) {
      std::vector<NamedExpr> all = outputs(pose);
      for (NamedExpr& output : all) output.e = with_open_sums(output.e);
      return all;
    };
    const std::vector<NamedExpr> turned = outputs(pose_), open = opened(pose_);
    const auto same = [](const NamedExpr& a, const NamedExpr& b) { return a.e == b.e; };
    if (std::equal(turned.begin(), turned.end(), open.begin(), open.end(), same)) return;
    add_other_way(open);
    add_with_cross_products(open, opened);
  }

  // a + (b + c) as a + b + c, unless a let names b + c.
  Expr with_open_sums(Expr e) const {
    if (e->kind != Kind::sum || e->named_by_let) return e;
    std::vector<Term> terms;
    for (const Term& term : terms_of(e)) {
      const Expr open = with_open_sums(term.e);
      if (open->kind != Kind::sum || open->named_by_let) terms.push_back(term);
      else
        for (const Term& inner : terms_of(open)) terms.push_back({term.coef * inner.coef, inner.e});
    }
    return sum(pool_, terms, false);
  }

  void add_rates_and_stiffness() {
    add_gamma();
    add_from_pose("time_derivative", "dC/dt at fixed q", [&](PoseInputs& pose) {
      std::vector<NamedExpr> C_t;
      for (std::size_t i = 0; i < rows(); ++i) C_t.push_back({element("C_t", i), pose.of(block_.rows[i].C_t)});
      return C_t;
    });
    add_from_pose(
        "stiffness",
        std::string("d(J^T lambda)/dq: ") + (width_ == 3 ? "x, y, angle" : "x, y, z and small turns") + " of each body",
        [&](PoseInputs& pose) {
          std::vector<NamedExpr> H;
          for (std::size_t r = 0; r < block_.stiffness.size(); ++r) {
            for (std::size_t c = 0; c < block_.stiffness[r].size(); ++c)
              H.push_back({element(element("H", r), c), pose.of(block_.stiffness[r][c])});
          }
          return H;
        });
  }

  // The cheaper of two forms. At equal cost that by J's entries: it loses fewer digits if the bodies move nearly alike.
  void add_gamma() {
    const auto outputs = [&](Expr ScalarRow::*form) {
      return [this, form](PoseInputs& pose) {
        std::vector<NamedExpr> gamma;
        for (std::size_t i = 0; i < rows(); ++i) gamma.push_back({element("g", i), pose.of(block_.rows[i].*form)});
        return gamma;
      };
    };
    add_from_pose("gamma", "-Jdot v - d/dt(dC/dt)", outputs(&ScalarRow::gamma));
    const std::vector<NamedExpr> by_entries = outputs(&ScalarRow::gamma_by_entries)(pose_);
    add_with_cross_products(by_entries, outputs(&ScalarRow::gamma_by_entries));
    add_other_way(by_entries);
  }

  // An alternative for the function added last; taken unless it is more expensive.
  void add_other_way(const std::vector<NamedExpr>& outputs) {
    out_.functions.back().other.push_back(assemble(outputs));
  }

  const Joint& joint_;
  Pool& pool_;
  const Block& block_;
  std::size_t width_;       // columns of J per body
  bool isotropic_ = false;  // inverse inertias are numbers, not tensors
  PoseInputs pose_;
  StoredJacobian J_;
  KernelBlock out_;
};

KernelBlock plan_block(const Joint& joint, const Block& block, const std::string& name) {
  KernelBlock out = BlockPlanner(joint, block, name).plan();
  for (const Block& variant : block.variants) {
    const std::string& body = joint.bodies[static_cast<std::size_t>(variant.immovable)];
    out.variants.push_back(BlockPlanner(joint, variant, body + "_immovable").plan());
  }
  return out;
}

}  // namespace

Kernel plan(const Derivation& derivation) {
  const Joint& joint = derivation.joint;
  Kernel kernel;
  kernel.derivation = &derivation;
  if (joint.on_any_coordinate()) kernel.rows.block = &derivation.rows;
  else kernel.rows = plan_block(joint, derivation.rows, joint.name);
  if (derivation.law) plan_law(joint, *derivation.law, kernel.rows.functions);
  for (const Block& coordinate : derivation.coordinates) {
    kernel.coordinates.push_back(plan_block(joint, coordinate, coordinate.name));
  }
  for (std::size_t i = 0; i < derivation.bounded.size(); ++i) {
    kernel.bounded.push_back(plan_bound(joint, joint.law->bounded[i], derivation.bounded[i]));
  }
  for (std::size_t i = 0; i < joint.parameters.size(); ++i) {
    const Expr by_default = joint.parameters[i].default_value;
    const bool is_value = joint.on_any_coordinate() && by_default == joint.law->free->value;
    if (by_default && !is_value) {
      kernel.defaults.push_back(plan_default(joint, static_cast<int>(i)));
    }
  }
  return kernel;
}

}  // namespace cdot::derive
