// The derivation is true: the formulas of each chain have equal values, and J v = Cdot. The text equals the golden
// texts (CDOT_UPDATE=1 rewrites them).
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "formula_value.hpp"
#include "support.hpp"

using namespace cdot::derive;

namespace {

struct Told {
  int equations = 0;
  std::string wrong;  // errors found
};

// All formulas of a chain with numeric values are equal.
void check_chain(const std::string& heading, const Chain& chain, const Values& values, Told& told) {
  std::vector<const Formula*> formulas{&chain.left};
  for (const Link& link : chain.links) formulas.push_back(&link.formula);
  std::vector<Array> known;
  for (const Formula* f : formulas) {
    try {
      known.push_back(value_of_formula(*f, values));
    } catch (const NoValue&) {
    }
  }
  for (std::size_t i = 1; i < known.size(); ++i) {
    ++told.equations;
    if (difference(known[0], known[i]) > 1e-9) {
      told.wrong += heading + ": formula " + std::to_string(i) + " of a chain differs from its first\n";
    }
  }
}

std::vector<double> components(Expr e, const Values& values) {
  if (!e->vector) return {evaluate(e, values)};
  const Triple<double> v = Numbers(values).vector(e);
  return {v.begin(), v.begin() + e->pool->dimension()};
}

std::vector<double> J_times_v(const Formula& J, const Joint& joint, const Values& values) {
  std::vector<std::vector<double>> velocities;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const BodySymbols body = body_symbols(joint, static_cast<int>(b));
    velocities.push_back(components(body.v, values));
    velocities.push_back(components(body.w, values));
  }
  return blocks_times(J, velocities, values);
}

void check_J(const Formula& J, const Joint& joint, const Block& block, const Values& values, Told& told) {
  const std::vector<double> Jv = J_times_v(J, joint, values);
  if (Jv.size() != block.rows.size()) {
    told.wrong += "J has " + std::to_string(Jv.size()) + " rows\n";
    return;
  }
  for (std::size_t i = 0; i < Jv.size(); ++i) {
    const double Cdot = evaluate(block.rows[i].Cdot, values) - evaluate(block.rows[i].C_t, values);
    ++told.equations;
    if (std::abs(Jv[i] - Cdot) > 1e-9 * (1 + std::abs(Cdot))) told.wrong += "J v differs from Cdot\n";
  }
}

Values values_for(const Joint& joint, const Explanation& explanation, std::uint64_t seed) {
  return world_values(joint, random_sample(joint, leaves_shown(joint, explanation), seed));
}

Told check(const Derivation& derivation, const Explanation& explanation) {
  Told told;
  const Joint& joint = derivation.joint;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Values values = values_for(joint, explanation, seed);
    for (const Step& step : explanation.steps) {
      for (const Item& item : step.items) {
        if (item.kind != Item::Kind::chain) continue;
        check_chain(step.heading, item.chain, values, told);
        if (item.chain.left.name == "J") {
          check_J(item.chain.links[0].formula, joint, derivation.rows, values, told);
        }
      }
    }
  }
  return told;
}

std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream all;
  all << in.rdbuf();
  return all.str();
}

}  // namespace

TEST(Explain, EveryEquationOfTheCatalogueIsTrue) {
  int equations = 0;
  for (const std::string& name : spec_names()) {
    const Derivation derivation = read_spec(name);
    const Told told = check(derivation, explain(derivation));
    EXPECT_EQ(told.wrong, "") << name;
    // On the coordinate of any joint there are no rows, and bounds are no equations.
    EXPECT_TRUE(told.equations > 0 || derivation.joint.on_any_coordinate()) << name;
    equations += told.equations;
  }
  std::cout << equations << " equations checked, at three poses each counted\n";
}

TEST(Explain, EveryEquationOfUnusualJointsIsTrue) {
  for (const auto& [name, text] : unusual_specs()) {
    const Derivation derivation = read_text(name, text);
    const Told told = check(derivation, explain(derivation));
    EXPECT_EQ(told.wrong, "") << name << "\n" << explanation_text(explain(derivation));
    EXPECT_GT(told.equations, 0) << name;
  }
}

// The check can fail: it finds a flipped sign anywhere in a derivation.
TEST(Explain, AFlippedSignIsFound) {
  const Derivation derivation = read_spec("line");
  const Explanation right = explain(derivation);
  int flipped = 0, found = 0;
  for (std::size_t s = 0; s < right.steps.size(); ++s) {
    for (std::size_t i = 0; i < right.steps[s].items.size(); ++i) {
      const Item& item = right.steps[s].items[i];
      if (item.kind != Item::Kind::chain || item.chain.left.name.starts_with("J_")) continue;
      Explanation wrong = right;
      Formula& f = wrong.steps[s].items[i].chain.links.back().formula;
      f = f.shape == Shape::matrix ? matrix(f.columns, {negative(f.args[0]), f.args[1], f.args[2], f.args[3]})
                                   : negative(f);
      ++flipped;
      if (!check(derivation, wrong).wrong.empty()) ++found;
    }
  }
  EXPECT_GT(flipped, 15);
  EXPECT_EQ(found, flipped);
}

TEST(Explain, ReadsAsItWasRead) {
  const bool update = std::getenv("CDOT_UPDATE") != nullptr;
  std::vector<std::pair<std::string, std::string>> texts;
  for (const std::string name : {"line", "revolute", "distance", "driven_crank", "pulley", "breaking"}) {
    texts.emplace_back(name, explanation_text(explain(read_spec(name))));
  }
  for (const auto& [name, text] : unusual_specs()) {
    if (name != "hinge") continue;
    texts.emplace_back("hinge", explanation_text(explain(read_text(name, text), Form::euler)));
  }
  for (const auto& [name, text] : texts) {
    const std::string path = std::string(CDOT_SOURCE_DIR "/tests/derive/explain") + "/golden/" + name + ".txt";
    if (update) std::ofstream(path, std::ios::binary) << text;
    EXPECT_EQ(text, content(path)) << path << " (CDOT_UPDATE=1 rewrites it)";
  }
}

// The text is the same in every run: it depends neither on addresses nor on earlier derivations.
TEST(Explain, SaysTheSameTwice) {
  for (const std::string& name : spec_names()) {
    EXPECT_EQ(explanation_text(explain(read_spec(name))), explanation_text(explain(read_spec(name)))) << name;
  }
}
