// Units of the language: products, vanishing radians, names.
#include <gtest/gtest.h>

#include "derive/expression/unit.hpp"
#include "derive/syntax/source.hpp"

namespace cdot::derive {
namespace {

const Unit metre{.m = 1}, radian{.rad = 1}, second{.s = 1}, kilogram{.kg = 1};

TEST(Units, MultiplyAndDivide) {
  EXPECT_EQ(text(metre * metre / second), "m^2/s");
  EXPECT_EQ(text(Unit{} / second), "1/s");
  EXPECT_EQ(text(kilogram * metre / (second * second)), "kg*m/s^2");
  EXPECT_EQ(metre / metre, Unit{});
}

TEST(Units, RadiansVanishBesideOtherUnits) {
  EXPECT_EQ(radian * metre, metre);
  EXPECT_EQ(text(radian / second), "rad/s");
  EXPECT_EQ(text(radian / metre), "1/m");
  EXPECT_EQ(text(radian * radian), "rad^2");
}

TEST(Units, RootsHalve) {
  EXPECT_EQ(pow(metre * metre, Rational(1, 2)), metre);
  EXPECT_EQ(text(pow(metre, Rational(1, 2))), "m^(1/2)");
}

TEST(Units, AreSpokenAsPeopleDo) {
  EXPECT_EQ(spoken(metre), "metres");
  EXPECT_EQ(spoken(radian / second), "radians per second");
  EXPECT_EQ(spoken(Unit{}), "a pure number");
  EXPECT_EQ(spoken(metre * metre * kilogram), "kg*m^2");
}

TEST(Messages, AlignCaretsUnderTabsAndWideCharacters) {
  const SourceFile file("f", "\tä\tb\n");
  Diagnostics d;
  d.error({4, 5}, "here");
  EXPECT_EQ(file.column(4), 4);
  EXPECT_EQ(render(file, d), "f:1:4: error: here\n    1 | \tä\tb\n      | \t \t^\n");
}

TEST(Messages, ShowTheTextAroundTheCaretOfALongLine) {
  const std::string long_line = std::string(500, 'x') + "y" + std::string(500, 'x');
  const SourceFile file("f", long_line);
  Diagnostics d;
  d.error({500, 501}, "here");
  const std::string shown = render(file, d);
  const std::size_t line = shown.find('\n') + 1, carets = shown.find('\n', line) + 1;
  EXPECT_LT(shown.size(), 300u);
  EXPECT_EQ(shown.find('y') - line, shown.find('^') - carets);
}

TEST(Messages, SuggestOnlyWhatIsNear) {
  const std::vector<std::string> words = {"norm", "unit", "point"};
  EXPECT_EQ(nearest("nrom", words), "norm");
  EXPECT_EQ(nearest("Point", words), "point");
  EXPECT_EQ(nearest("cross", words), "");
  EXPECT_EQ(nearest("q", words), "");
}

}  // namespace
}  // namespace cdot::derive
