#include "derive/compile/equations.hpp"

#include <fmt/format.h>

#include "derive/kernel/factor.hpp"
#include "derive/program/print.hpp"
#include "runtime/direct/elimination_order.hpp"

namespace cdot::compile {
namespace {

using derive::element;
using derive::triangle_element;
using Values = std::map<std::string, int>;

// A number of J: a constant, or a member of the header's Jacobian.
struct Stored {
  std::optional<double> constant;
  std::string member;
};

class EquationWriter {
 public:
  EquationWriter(const Mechanism& mechanism, const Names& names, const derive::SpecsFolder& specs)
      : mechanism_(mechanism), names_(names) {
    for (const Joint& joint : mechanism.joints) {
      if (!types_.contains(joint.type)) types_[joint.type] = programs_of(specs, joint.type);
      first_row_.push_back(out_.rows.size());
      const JointPrograms& type = types_.at(joint.type);
      const std::size_t j = first_row_.size() - 1;
      for (std::size_t r = 0; r < type.rows(); ++r)
        out_.rows.push_back({names.joints[j] + "_" + type.row_names[r], j, r});
      out_.driven |= type.has_rates;
    }
  }

  Equations write() {
    order_rows();
    write_evaluate();
    write_errors();
    write_rates();
    write_gamma();
    write_solve();
    drop_unread();
    return std::move(out_);
  }

 private:
  const JointPrograms& type_of(std::size_t joint) const { return types_.at(mechanism_.joints[joint].type); }
  const Body& body(std::size_t joint, std::size_t k) const {
    return mechanism_.bodies[static_cast<std::size_t>(mechanism_.joints[joint].bodies[k])];
  }
  const std::string& body_name(int index) const { return names_.bodies[static_cast<std::size_t>(index)]; }

  // f(joint) for joints with rows.
  template <class F>
  void each_joint(F f) const {
    for (std::size_t j = 0; j < mechanism_.joints.size(); ++j)
      if (type_of(j).rows() > 0) f(j);
  }

  // What the kernel of a joint reads, in this scene: places and velocities of its bodies, masses, parameters.
  Values inputs_of(Algebra& algebra, std::size_t j) const {
    Values in;
    const Joint& joint = mechanism_.joints[j];
    const JointPrograms& type = type_of(j);
    for (std::size_t k = 0; k < type.bodies.size(); ++k) add_body(algebra, in, type.bodies[k], joint.bodies[k]);
    for (std::size_t p = 0; p < type.parameters.size(); ++p) {
      const std::string& field = type.parameters[p];
      const std::string plain = field.starts_with("p.") ? field.substr(2) : field;
      in[field] = algebra.value(joint.parameters[p], names_.joints[j] + "_" + plain);
    }
    in["pi"] = algebra.value(3.14159265358979323846);
    in["time"] = algebra.input("time");
    return in;
  }

  void add_body(Algebra& algebra, Values& in, const std::string& L, int index) const {
    const Body& b = mechanism_.bodies[static_cast<std::size_t>(index)];
    const std::string& name = body_name(index);
    const auto place = [&](double number, const std::string& member) {
      return b.moves ? algebra.input(fmt::format("q[{}].{}", name, member), member.size() == 1 && member > "w")
                     : algebra.value(number);
    };
    const auto speed = [&](const std::string& member) {
      return b.moves ? algebra.input(fmt::format("v[{}].{}", name, member)) : algebra.value(0);
    };
    in["x_" + L + "_x"] = place(b.x, "x"), in["x_" + L + "_y"] = place(b.y, "y");
    in["theta_" + L] = place(b.angle, "angle");
    in[L + ".c"] = place(std::cos(b.angle), "c"), in[L + ".s"] = place(std::sin(b.angle), "s");
    in["v_" + L + "_x"] = speed("x"), in["v_" + L + "_y"] = speed("y"), in["w_" + L] = speed("w");
    in["inv_m_" + L] = inverse_mass(algebra, index, 0), in["inv_I_" + L] = inverse_mass(algebra, index, 2);
  }

  // The column is 0, 1 for x and y, 2 for the angle.
  int inverse_mass(Algebra& algebra, int index, std::size_t column) const {
    const Body& b = mechanism_.bodies[static_cast<std::size_t>(index)];
    if (!b.moves) return algebra.value(0);
    return column < 2 ? algebra.value(b.inv_m, body_name(index) + "_inv_m")
                      : algebra.value(b.inv_I, body_name(index) + "_inv_I");
  }

  // The same with J as it was stored.
  Values inputs_with_jacobian(Algebra& algebra, std::size_t j) const {
    Values in = inputs_of(algebra, j);
    for (const auto& [field, stored] : stored_.at(j))
      in["J." + field] = stored.constant ? algebra.value(*stored.constant) : algebra.input("J." + stored.member);
    return in;
  }

  Values call(Algebra& algebra, std::size_t j, const std::string& function, const Values& in) const {
    return algebra.inlined(
        type_of(j).function(function), [&](const std::string& text) { return in.at(text); }, names_.joints[j]);
  }

  // --- order ---

  void order_rows() {
    std::vector<int> rows;
    std::vector<std::size_t> joints;
    each_joint([&](std::size_t j) { joints.push_back(j), rows.push_back(static_cast<int>(type_of(j).rows())); });
    std::vector<std::vector<int>> neighbours(joints.size());
    for (std::size_t i = 0; i < joints.size(); ++i)
      for (std::size_t k = 0; k < joints.size(); ++k)
        if (i != k && share_a_body(joints[i], joints[k])) neighbours[i].push_back(static_cast<int>(k));
    for (const Elimination& one : minimum_degree_order(rows, neighbours, 1))
      for (const int block : one.blocks)
        for (std::size_t r = 0; r < type_of(joints[static_cast<std::size_t>(block)]).rows(); ++r)
          order_.push_back(first_row_[joints[static_cast<std::size_t>(block)]] + r);
  }

  bool share_a_body(std::size_t i, std::size_t k) const {
    for (const int a : mechanism_.joints[i].bodies)
      for (const int b : mechanism_.joints[k].bodies)
        if (a == b && mechanism_.bodies[static_cast<std::size_t>(a)].moves) return true;
    return false;
  }

  // --- evaluate ---

  void write_evaluate() {
    Algebra algebra(out_.constants);
    const std::size_t n = out_.rows.size();
    K_.assign(n, std::vector<int>(n, -1));
    each_joint([&](std::size_t j) {
      Values in = inputs_of(algebra, j);
      store_jacobian(algebra, j, call(algebra, j, "jacobian", in), in);
      if (type_of(j).has_rates) store_rates(algebra, j, in);
      const std::size_t first = first_row_[j];
      const Values K = call(algebra, j, "effective_mass", in);
      for (std::size_t r = 0; r < type_of(j).rows(); ++r)
        for (std::size_t c = 0; c <= r; ++c) K_[first + r][first + c] = K.at(triangle_element("K", r, c));
      dense_[j] = call(algebra, j, "dense", in);
    });
    each_joint([&](std::size_t i) {
      each_joint([&](std::size_t k) {
        if (k < i && share_a_body(i, k)) couple(algebra, i, k);
      });
    });
    factor(algebra);
    out_.evaluate = algebra.finish();
  }

  void store_jacobian(Algebra& algebra, std::size_t j, const Values& J, Values& in) {
    for (const std::string& field : type_of(j).fields) {
      const int op = J.at("J." + field);
      in["J." + field] = op;
      Stored& stored = stored_[j][field];
      stored = {algebra.constant(op), names_.joints[j] + "_" + field};
      if (!stored.constant) store(algebra, stored.member, op);
    }
  }

  void store_rates(Algebra& algebra, std::size_t j, const Values& in) {
    const Values C_t = call(algebra, j, "time_derivative", in);
    for (std::size_t r = 0; r < type_of(j).rows(); ++r)
      store(algebra, out_.rows[first_row_[j] + r].name + "_rate", C_t.at(element("C_t", r)));
  }

  void store(Algebra& algebra, const std::string& member, int op) {
    algebra.output("J." + member, op);
    out_.stored.push_back(member);
  }

  // The rows of two joints that share bodies: K_ik = sum over columns of J_i M^-1 J_k.
  void couple(Algebra& algebra, std::size_t i, std::size_t k) {
    const std::vector<int>&of_i = mechanism_.joints[i].bodies, &of_k = mechanism_.joints[k].bodies;
    for (std::size_t r = 0; r < type_of(i).rows(); ++r) {
      for (std::size_t s = 0; s < type_of(k).rows(); ++s) {
        Summands terms;
        for (std::size_t a = 0; a < of_i.size(); ++a)
          for (std::size_t b = 0; b < of_k.size(); ++b)
            for (std::size_t c = 0; of_i[a] == of_k[b] && c < 3; ++c) {
              const int x = dense_[i].at(element(element("D", r), 3 * a + c));
              const int y = dense_[k].at(element(element("D", s), 3 * b + c));
              terms.add(1, algebra.product({inverse_mass(algebra, of_i[a], c), x, y}, {1, 1, 1}));
            }
        const int K = algebra.sum(terms);
        if (!algebra.is_zero(K)) K_[first_row_[i] + r][first_row_[k] + s] = K;
      }
    }
  }

  int K(std::size_t i, std::size_t j) const { return K_[std::max(i, j)][std::min(i, j)]; }

  // K = L D L^T in the order of elimination, with U = L D. Numbers of rows are those of the order.
  void factor(Algebra& algebra) {
    const std::size_t n = order_.size();
    L_.assign(n, std::vector<bool>(n, false));
    std::vector<std::vector<int>> U(n, std::vector<int>(n, -1)), L(U);
    for (std::size_t j = 0; j < n; ++j) {
      const std::string at = std::to_string(j);
      int inverse = -1;
      for (std::size_t i = j; i < n; ++i) {
        Summands terms;
        if (const int k = K(order_[i], order_[j]); k >= 0) terms.add(1, k);
        for (std::size_t k = 0; k < j; ++k)
          if (U[i][k] >= 0 && L[j][k] >= 0) terms.add(-1, algebra.times(U[i][k], L[j][k]));
        if (terms.args.empty()) continue;
        const std::string place = i == j ? at : fmt::format("{}_{}", i, j);
        const int entry = algebra.sum(terms, (i == j ? "D_" : "U_") + place);
        if (i == j) {
          inverse = algebra.function(Fn::pivot, {entry, K(order_[j], order_[j])}, "inv_D_" + at);
          store_factor(algebra, "inv_D_" + at, inverse);
          continue;
        }
        if (algebra.is_zero(entry)) continue;
        U[i][j] = entry;
        L[i][j] = algebra.times(entry, inverse, "L_" + place);
        L_[i][j] = true;
        store_factor(algebra, "L_" + place, L[i][j]);
      }
    }
  }

  void store_factor(Algebra& algebra, const std::string& member, int op) {
    if (const std::optional<double> known = algebra.constant(op)) factor_constants_[member] = *known;
    else store(algebra, member, op);
  }

  int factored(Algebra& algebra, const std::string& member) const {
    const auto known = factor_constants_.find(member);
    return known == factor_constants_.end() ? algebra.input("J." + member) : algebra.value(known->second);
  }

  // --- the other functions ---

  void write_errors() {
    Algebra algebra(out_.constants);
    each_joint([&](std::size_t j) {
      const Values C = call(algebra, j, "position", inputs_of(algebra, j));
      for (std::size_t r = 0; r < type_of(j).rows(); ++r)
        algebra.output(element("C", first_row_[j] + r), C.at(element("C", r)));
    });
    out_.errors = algebra.finish();
  }

  void write_rates() {
    Algebra algebra(out_.constants);
    each_joint([&](std::size_t j) {
      const Values Jv = call(algebra, j, "velocity", inputs_with_jacobian(algebra, j));
      for (std::size_t r = 0; r < type_of(j).rows(); ++r) {
        Summands terms{{Jv.at(element("Jv", r))}, {1}};
        const std::size_t row = first_row_[j] + r;
        if (type_of(j).has_rates) terms.add(1, algebra.input("J." + out_.rows[row].name + "_rate"));
        algebra.output(element("Cdot", row), algebra.sum(terms));
      }
    });
    out_.rates = algebra.finish();
  }

  void write_gamma() {
    Algebra algebra(out_.constants);
    each_joint([&](std::size_t j) {
      const Values g = call(algebra, j, "gamma", inputs_of(algebra, j));
      for (std::size_t r = 0; r < type_of(j).rows(); ++r)
        algebra.output(element("g", first_row_[j] + r), g.at(element("g", r)));
    });
    out_.gamma = algebra.finish();
  }

  void write_solve() {
    Algebra algebra(out_.constants);
    const std::size_t n = order_.size();
    const auto L = [&](std::size_t i, std::size_t j) { return factored(algebra, fmt::format("L_{}_{}", i, j)); };
    std::vector<int> y(n), x(n), lambda(n);
    for (std::size_t i = 0; i < n; ++i) {
      Summands terms{{algebra.input(element("b", order_[i]))}, {1}};
      for (std::size_t k = 0; k < i; ++k)
        if (L_[i][k]) terms.add(-1, algebra.times(L(i, k), y[k]));
      y[i] = algebra.sum(terms, "y_" + std::to_string(i));
    }
    for (std::size_t i = n; i-- > 0;) {
      Summands terms{{algebra.times(factored(algebra, "inv_D_" + std::to_string(i)), y[i])}, {1}};
      for (std::size_t k = i + 1; k < n; ++k)
        if (L_[k][i]) terms.add(-1, algebra.times(L(k, i), x[k]));
      lambda[order_[i]] = x[i] = algebra.sum(terms, "lambda_" + out_.rows[order_[i]].name);
    }
    for (std::size_t i = n; i-- > 0;) algebra.output(element("lambda", order_[i]), x[i]);
    write_changes(algebra, lambda);
    out_.solve = algebra.finish();
  }

  // d = M^-1 J^T lambda: each joint's impulses, with masses of 1 and bodies at rest, added up.
  void write_changes(Algebra& algebra, const std::vector<int>& lambda) {
    std::map<std::pair<int, std::size_t>, Summands> forces;
    each_joint([&](std::size_t j) {
      Values in = inputs_with_jacobian(algebra, j);
      for (const std::string& L : type_of(j).bodies) {
        in["inv_m_" + L] = in["inv_I_" + L] = algebra.value(1);
        in["v_" + L + "_x"] = in["v_" + L + "_y"] = in["w_" + L] = algebra.value(0);
      }
      for (std::size_t r = 0; r < type_of(j).rows(); ++r)
        in[fmt::format("lambda_{}", r + 1)] = lambda[first_row_[j] + r];
      const Values v = call(algebra, j, "apply", in);
      for (std::size_t k = 0; k < type_of(j).bodies.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c)
          if (const auto found = v.find(element("v", k) + "." + "xyw"[c]); found != v.end())
            forces[{mechanism_.joints[j].bodies[k], c}].add(1, found->second);
    });
    for (int b = 0; b < static_cast<int>(mechanism_.bodies.size()); ++b)
      for (std::size_t c = 0; mechanism_.bodies[static_cast<std::size_t>(b)].moves && c < 3; ++c)
        algebra.output(fmt::format("d[{}].{}", body_name(b), "xyw"[c]),
                       algebra.times(inverse_mass(algebra, b, c), algebra.sum(forces[{b, c}])));
  }

  // Numbers that nobody reads are not stored, and c and s of no body that nobody reads.
  void drop_unread() {
    std::set<std::string> read;
    for (const Program* program : {&out_.evaluate, &out_.errors, &out_.rates, &out_.gamma, &out_.solve})
      read.merge(derive::inputs_read(*program, {}));
    const auto unread = [&](const std::string& member) { return !read.contains("J." + member); };
    std::erase_if(out_.stored, unread);
    std::erase_if(out_.evaluate.outputs, [&](const derive::Output& o) { return !read.contains(o.name); });
    for (const std::string& name : names_.bodies)
      if (read.contains("q[" + name + "].c") || read.contains("q[" + name + "].s")) out_.turning.insert(name);
  }

  const Mechanism& mechanism_;
  const Names& names_;
  std::map<std::string, JointPrograms> types_;
  std::vector<std::size_t> first_row_;  // of each joint
  std::vector<std::size_t> order_;      // of elimination
  std::map<std::size_t, std::map<std::string, Stored>> stored_;
  std::map<std::size_t, Values> dense_;
  std::vector<std::vector<int>> K_;   // lower triangle; -1: zero
  std::vector<std::vector<bool>> L_;  // which entries are not zero
  std::map<std::string, double> factor_constants_;
  Equations out_;
};

}  // namespace

Equations equations_of(const Mechanism& mechanism, const Names& names, const derive::SpecsFolder& specs) {
  return EquationWriter(mechanism, names, specs).write();
}

}  // namespace cdot::compile
