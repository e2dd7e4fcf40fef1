// Expressions of scenes: values, units, inputs, and messages with their places.
#include "derive/interpret/formula.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace cdot {
namespace {

const Vocabulary words{
    2,
    {"rod", "cart"},
    {{"pin.angle", "rad"}, {"rate(pin.angle)", "rad/s"}, {"force(pin)", "N", true}, {"energy", "J"}}};

double value(std::string_view text, const std::vector<double>& inputs) {
  const Formula::Reading read = Formula::read(text, words);
  EXPECT_TRUE(read.formula) << text << ": " << (read.mistakes.empty() ? "" : read.mistakes[0].cause);
  if (!read.formula) return 0;
  EXPECT_EQ(read.formula->inputs().size(), inputs.size()) << text;
  return read.formula->inputs().size() == inputs.size() ? (*read.formula)(inputs) : 0;
}

FormulaMistake mistake(std::string_view text, std::string_view unit = {}) {
  const Formula::Reading read = Formula::read(text, words, unit);
  EXPECT_EQ(read.mistakes.size(), 1u) << text;
  EXPECT_FALSE(read.formula) << text;
  return read.mistakes.empty() ? FormulaMistake{} : read.mistakes[0];
}

TEST(Formula, Values) {
  EXPECT_EQ(value("2 + 3 * 4", {}), 14);
  EXPECT_NEAR(value("10 [N] * sin(2 [rad/s] * time)", {0.3}), 10 * std::sin(0.6), 1e-15);
  EXPECT_NEAR(value("90 [deg]", {}), std::acos(0.0), 1e-16);
  EXPECT_NEAR(value("sin(pin.angle)^2", {0.4}), std::pow(std::sin(0.4), 2), 1e-16);
  EXPECT_EQ(value("rate(pin.angle) * 2", {0.25}), 0.5);
  EXPECT_EQ(value("norm(force(pin))", {3, 4}), 5);
}

TEST(Formula, InputsOfBodies) {
  const auto formula =
      Formula::read("dot(v(cart), perp(cart.x)) + (x(rod) - x(cart)).y / 1 [s] + w(rod) * 1 [m]", words);
  ASSERT_TRUE(formula.formula) << formula.mistakes[0].cause;
  std::vector<double> inputs;
  for (const Formula::Input& input : formula.formula->inputs()) {
    const bool rod = input.index == 0;
    switch (input.of) {
      case Formula::Input::position: inputs.push_back(rod ? 5 : 2); break;
      case Formula::Input::velocity: inputs.push_back(input.component == 0 ? 1.5 : -0.5); break;
      case Formula::Input::axis: inputs.push_back(input.component == 0 ? 0.6 : 0.8); break;
      case Formula::Input::spin: inputs.push_back(7); break;
      default: FAIL();
    }
  }
  // perp(0.6, 0.8) = (-0.8, 0.6)
  EXPECT_NEAR((*formula.formula)(inputs), -0.8 * 1.5 - 0.6 * 0.5 + 3 + 7, 1e-14);
  EXPECT_EQ(formula.formula->unit(), "m/s");
}

// The way from the origin of the scene, where no body has this name.
TEST(Formula, PlacesFromTheOrigin) {
  EXPECT_EQ(value("(x(rod) - origin).y", {3}), 3);
  EXPECT_EQ(value("norm(x(cart) - origin)", {3, 4}), 5);
  EXPECT_EQ(mistake("x(rod).y").fix, "a vector has: write `(x(rod) - origin).y`");
  EXPECT_EQ(mistake("x(rod)").fix, "a component of its way from another point: (x(rod) - origin).y");
  const Vocabulary taken{2, {"origin"}, {}};
  EXPECT_TRUE(Formula::read("dot(v(origin), origin.x)", taken).formula);
  EXPECT_FALSE(Formula::read("norm(x(origin) - origin)", taken).formula);
}

TEST(Formula, MistakesHaveTheirPlaces) {
  const FormulaMistake unknown = mistake("2 * energie");
  EXPECT_EQ(unknown.begin, 4);
  EXPECT_EQ(unknown.end, 11);
  EXPECT_EQ(unknown.fix, "did you mean `energy`?");
  EXPECT_EQ(mistake("rate(pin.agle)").fix, "did you mean `rate(pin.angle)`?");
  EXPECT_EQ(mistake("2 * pin.agle").begin, 4);
  EXPECT_EQ(mistake("2 * pin.agle").fix, "did you mean `pin.angle`?");
  EXPECT_EQ(mistake("norm(force(pin)").fix.empty(), false);
  EXPECT_NE(mistake("pin.angle + energy").cause.find("adds joules to radians"), std::string::npos);
  EXPECT_NE(mistake("x(rod)").cause.find("a number is needed"), std::string::npos);
  EXPECT_NE(mistake("10 * time", "N").cause.find("newtons are needed"), std::string::npos);
  EXPECT_NE(mistake("2 [N] )").cause.find("closes nothing"), std::string::npos);
}

// Products of their digits fit no fraction: they are rounded as doubles are.
TEST(Formula, OfTheTimeWithLongNumbers) {
  const auto read = FormulaInTime::read("0.123456789012345 [m] * sin(3.14159265358979 [rad/s] * time)", "m");
  ASSERT_TRUE(read.formula) << read.mistakes[0].cause;
  constexpr double A = 0.123456789012345, w = 3.14159265358979, t = 0.3;
  const auto [x, v, a] = read.formula->at(t);
  EXPECT_NEAR(x, A * std::sin(w * t), 1e-16);
  EXPECT_NEAR(v, A * w * std::cos(w * t), 1e-15);
  EXPECT_NEAR(a, -A * w * w * std::sin(w * t), 1e-15);
  EXPECT_NEAR(value("1.2345678901234 * 1.2345678901234", {}), 1.2345678901234 * 1.2345678901234, 1e-15);
  const auto far = FormulaInTime::read("1e-9 [m] * sin(1e-8 [rad/s] * time)", "m");
  ASSERT_EQ(far.mistakes.size(), 1u);
  EXPECT_NE(far.mistakes[0].cause.find("below 1e-18"), std::string::npos);
}

}  // namespace
}  // namespace cdot
