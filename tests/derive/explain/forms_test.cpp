// The displayed J in forms (b) and (c) times the velocities of that form is Cdot. Finite differences of C in Euler
// parameters of any length confirm the statement about dC/de.
#include <algorithm>
#include <cmath>

#include "formula_value.hpp"
#include "support.hpp"

using namespace cdot::derive;

namespace {

struct Shown {
  const Joint& joint;
  Form form;
  Explanation explanation;
  const Block& block;
  Sample sample;
  Values values;
};

Values with_orientations(const Joint& joint, const Sample& sample) {
  Values values = world_values(joint, sample);
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    for (std::size_t k = 0; k < 4; ++k)
      values["e_" + joint.bodies[b] + "_" + std::to_string(k)] = sample.bodies[b].e[k];
  }
  return values;
}

Shown shown(const Derivation& derivation, Form form, std::uint64_t seed) {
  const Joint& joint = derivation.joint;
  Shown s{joint, form, explain(derivation, form), derivation.rows, {}, {}};
  std::vector<Expr> leaves = leaves_shown(joint, s.explanation);
  for (const ScalarRow& row : s.block.rows) leaves.insert(leaves.end(), {row.C, row.Cdot});
  s.sample = random_sample(joint, leaves, seed);
  s.values = with_orientations(joint, s.sample);
  return s;
}

const Chain* find_chain(const Explanation& explanation, const std::string& left) {
  for (const Step& step : explanation.steps) {
    for (const Item& item : step.items) {
      if (item.kind == Item::Kind::chain && item.chain.left.name == left) return &item.chain;
    }
  }
  return nullptr;
}

// v and w' = A^T w, or v and e_dot = 1/2 G^T w.
std::vector<std::vector<double>> velocities(const Shown& s) {
  std::vector<std::vector<double>> all;
  for (std::size_t b = 0; b < s.joint.bodies.size(); ++b) {
    const Sample::Body& body = s.sample.bodies[b];
    all.push_back({body.v.begin(), body.v.end()});
    const std::string letter = s.form == Form::local ? "A" : "G";
    const Array M = value_of_formula(leaf({}, letter + "_" + s.joint.bodies[b]), s.values);
    std::vector<double> rates(M.columns);
    for (std::size_t j = 0; j < M.columns; ++j) {
      for (std::size_t i = 0; i < 3; ++i) rates[j] += (s.form == Form::local ? 1 : 0.5) * M.at(i, j) * body.w[i];
    }
    all.push_back(rates);
  }
  return all;
}

// dC/de of the rows of one statement, by central differences: a row for each.
std::vector<double> slopes(const Shown& s, const std::string& row_name, std::size_t body) {
  std::vector<double> result;
  for (const ScalarRow& row : s.block.rows) {
    if (!row_name.empty() && row.row->name != row_name && row.row->name != "C" + row_name) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto C = [&](double step) {
        Sample there = s.sample;
        there.bodies[body].e[k] += step;
        return Numbers(there).scalar(row.C);
      };
      result.push_back((C(1e-6) - C(-1e-6)) / 2e-6);
    }
  }
  return result;
}

int check_partial_derivatives(const Shown& s) {
  int checked = 0;
  for (const Step& step : s.explanation.steps) {
    for (const Item& item : step.items) {
      const Formula& left = item.chain.left;
      if (item.kind != Item::Kind::chain || left.shape != Shape::quotient || !left.args[1].name.starts_with("de_"))
        continue;
      const std::string row = left.args[0].name.size() > 3 ? left.args[0].name.substr(3) : "";
      const std::size_t body = static_cast<std::size_t>(left.args[1].name.back() - 'a');
      const Array told = value_of_formula(item.chain.links[0].formula, s.values);
      const std::vector<double> seen = slopes(s, row, body);
      EXPECT_EQ(told.entries.size(), seen.size()) << s.joint.name << " " << row;
      for (std::size_t i = 0; i < std::min(seen.size(), told.entries.size()); ++i) {
        EXPECT_NEAR(told.entries[i], seen[i], 1e-7 * (1 + std::fabs(seen[i]))) << s.joint.name << " " << row;
        ++checked;
      }
    }
  }
  return checked;
}

std::vector<Derivation> spatial_joints() {
  std::vector<Derivation> all;
  for (const auto& [name, text] : unusual_specs()) {
    if (Derivation d = read_text(name, text); d.joint.dimension == 3) all.push_back(std::move(d));
  }
  for (const std::string& name : spec_names()) {
    if (!name.starts_with("spatial/")) continue;
    if (Derivation d = read_spec(name); !d.joint.rows.empty()) all.push_back(std::move(d));
  }
  return all;
}

}  // namespace

TEST(ExplainForms, EachTimesItsVelocitiesIsCdot) {
  for (const Derivation& derivation : spatial_joints()) {
    for (const Form form : {Form::local, Form::euler}) {
      const Shown s = shown(derivation, form, 5);
      const Chain* chain = find_chain(s.explanation, "J_" + std::string(name_of(form)));
      ASSERT_NE(chain, nullptr) << s.joint.name;
      const std::vector<double> Jv = blocks_times(chain->links[0].formula, velocities(s), s.values);
      ASSERT_EQ(Jv.size(), s.block.rows.size()) << s.joint.name;
      for (std::size_t i = 0; i < Jv.size(); ++i) {
        const double Cdot = evaluate(s.block.rows[i].Cdot, s.values) - evaluate(s.block.rows[i].C_t, s.values);
        EXPECT_NEAR(Jv[i], Cdot, 1e-9 * (1 + std::fabs(Cdot))) << s.joint.name;
      }
    }
  }
}

TEST(ExplainForms, WhatIsSaidAboutThePartialDerivativeIsTrue) {
  int checked = 0;
  for (const Derivation& derivation : spatial_joints()) {
    checked += check_partial_derivatives(shown(derivation, Form::euler, 6));
  }
  std::cout << checked << " derivatives by Euler parameters checked\n";
  EXPECT_GT(checked, 50);
}

TEST(ExplainForms, AWrongPartialDerivativeIsFound) {
  const auto specs = unusual_specs();
  const auto hinge = std::find_if(specs.begin(), specs.end(), [](const auto& s) { return s.first == "hinge"; });
  const Derivation derivation = read_text(hinge->first, hinge->second);
  const Shown s = shown(derivation, Form::euler, 6);
  const std::string text = explanation_text(s.explanation);
  EXPECT_NE(text.find("dC_pin/de_a = -2 S(ra) G_a + 2 ra e_a'"), std::string::npos) << text;
  EXPECT_NE(text.find("agrees with it on e · e_dot = 0 only"), std::string::npos) << text;
  EXPECT_NE(text.find("is the partial derivative where C = 0"), std::string::npos) << text;
  const std::vector<double> seen = slopes(s, "pin", 0);
  const Array alone = value_of_formula(
      product({number(-2), shaped(Shape::skew, leaf(s.joint.pool->find("ra"))), leaf({}, "G_a")}), s.values);
  double worst = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) worst = std::max(worst, std::fabs(seen[i] - alone.entries[i]));
  EXPECT_GT(worst, 1e-3);  // J_euler differs from dC/de
}
