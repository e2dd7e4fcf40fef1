// Tables and functions of time: values and derivatives between rows, jumps, what lies beyond the ends, mistakes.
#include <cmath>
#include <gtest/gtest.h>

#include <cdot/profile.hpp>
#include <cdot/settings.hpp>

namespace cdot::test {
namespace {

ProfileValue cubic_at(double t) { return {2 - t + 0.5 * t * t - 0.25 * t * t * t, -1 + t - 0.75 * t * t, 1 - 1.5 * t}; }

TEST(Profiles, ACubicTableIsExactForCubics) {
  ProfileTable table;
  table.interpolation = Interpolation::cubic;
  for (double t : {-1.0, -0.4, 0.3, 0.5, 2.0, 2.2}) table.times.push_back(t), table.values.push_back(cubic_at(t).value);
  const Profile profile = Profile::table(table);
  for (double t = -0.999; t < 2.2; t += 0.1) {
    const ProfileValue at = profile.at(t), right = cubic_at(t);
    EXPECT_NEAR(at.value, right.value, 1e-13) << t;
    EXPECT_NEAR(at.rate, right.rate, 1e-12) << t;
    EXPECT_NEAR(at.acceleration, right.acceleration, 1e-11) << t;
  }
}

TEST(Profiles, ThreeRowsAreAParabola) {
  const Profile profile =
      Profile::table({.times = {0, 1, 3}, .values = {1, 2, 10}, .interpolation = Interpolation::cubic});
  EXPECT_NEAR(profile.at(2).value, 1 + 4.0, 1e-13);  // 1 + t^2
  EXPECT_NEAR(profile.at(2).rate, 4, 1e-13);
}

// The error of sin vanishes with the fourth power of the distance of rows, and its period has no seam.
TEST(Profiles, ACubicTableThatRepeatsHasNoSeam) {
  const double period = 2 * 3.14159265358979323846;
  const auto worst = [&](int rows) {
    ProfileTable table;
    table.interpolation = Interpolation::cubic, table.beyond = Beyond::repeat;
    for (int k = 0; k <= rows; ++k) {
      table.times.push_back(period * k / rows);
      table.values.push_back(k == rows ? 0 : std::sin(table.times.back()));
    }
    const Profile profile = Profile::table(table);
    double error = 0;
    for (double t = -10; t < 30; t += 0.0317) {
      error = std::max(error, std::abs(profile.at(t).value - std::sin(t)));
      error = std::max(error, 0.1 * std::abs(profile.at(t).rate - std::cos(t)) * period / rows);
    }
    return error;
  };
  EXPECT_LT(worst(20), 1e-4);
  EXPECT_GT(worst(20) / worst(40), 0.9 * 16);
  const Profile two = Profile::table(
      {.times = {0, 1, 3}, .values = {0, 1, 0}, .interpolation = Interpolation::cubic, .beyond = Beyond::repeat});
  EXPECT_NEAR(two.at(3 - 1e-9).rate, two.at(1e-9).rate, 1e-7);
  EXPECT_NEAR(two.at(1 - 1e-9).acceleration, two.at(1 + 1e-9).acceleration, 1e-7);
  EXPECT_NEAR(two.at(3 - 1e-9).acceleration, two.at(1e-9).acceleration, 1e-7);
}

TEST(Profiles, StepsHoldUntilTheNextRow) {
  const Profile profile =
      Profile::table({.times = {1, 2, 4}, .values = {5, 7, 6}, .interpolation = Interpolation::step});
  EXPECT_EQ(profile.at(0).value, 5);
  EXPECT_EQ(profile.at(1.999).value, 5);
  EXPECT_EQ(profile.at(2).value, 7);
  EXPECT_EQ(profile.at(9).value, 6);
  EXPECT_EQ(profile.next_break(1.5, 0), 2);
  EXPECT_EQ(profile.next_break(2, 0), 4);
  EXPECT_TRUE(std::isinf(profile.next_break(4, 2)));
}

TEST(Profiles, BreaksHaveTheOrderOfTheDerivativeThatJumps) {
  const Profile linear = Profile::table({.times = {0, 1, 1, 3}, .values = {0, 2, 5, 5}});
  EXPECT_EQ(linear.next_break(-1, 0), 1);  // the jump; the ends are kinks
  EXPECT_EQ(linear.next_break(-1, 1), 0);
  EXPECT_TRUE(std::isinf(linear.next_break(1, 0)));
  EXPECT_EQ(linear.next_break(1, 1), 3);
  const Profile spline =
      Profile::table({.times = {0, 1, 2, 3}, .values = {0, 2, 1, 5}, .interpolation = Interpolation::cubic});
  EXPECT_EQ(spline.next_break(0.5, 2), 3);  // it holds its last value: a kink
  EXPECT_EQ(spline.next_break(0.5, 3), 1);
}

TEST(Profiles, ASpanEndsBeforeItsJump) {
  const Profile profile = Profile::table({.times = {0, 1, 1, 3}, .values = {0, 2, 5, 9}});
  EXPECT_EQ(profile.at(1).value, 5);
  EXPECT_EQ(profile.at(1, {0.5, 1}).value, 2);
  EXPECT_NEAR(profile.at(1 + 1e-12, {0.5, 1}).value, 2, 1e-11);
  EXPECT_EQ(profile.at(1, {0.5, 1}).rate, 2);
  EXPECT_NEAR(profile.at(1 - 1e-12, {1 + 1e-12, 3}).value, 5, 1e-11);  // a step that begins at the jump
}

TEST(Profiles, RepeatsFromItsFirstRow) {
  const Profile profile = Profile::table({.times = {1, 2, 3}, .values = {0, 4, 0}, .beyond = Beyond::repeat});
  EXPECT_NEAR(profile.at(1.5).value, 2, 1e-13);
  EXPECT_NEAR(profile.at(101.5).value, 2, 1e-11);
  EXPECT_NEAR(profile.at(-0.25).value, 3, 1e-13);  // as at 1.75
  EXPECT_NEAR(profile.next_break(100.7, 1), 101, 1e-11);
  EXPECT_TRUE(std::isinf(profile.next_break(100.7, 0)));
  const Profile saw = Profile::table({.times = {0, 1}, .values = {0, 4}, .beyond = Beyond::repeat});
  EXPECT_NEAR(saw.next_break(7.5, 0), 8, 1e-12);
  EXPECT_NEAR(saw.at(8, {7.5, 8}).value, 4, 1e-11);
}

void expect_refused(const ProfileTable& table, const std::string& words) {
  try {
    Profile::table(table);
    FAIL() << words;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
  }
}

TEST(Profiles, WrongTablesAreRefused) {
  expect_refused({.times = {0, 1}, .values = {1}}, "2 times and 1 values");
  expect_refused({.times = {0}, .values = {1}}, "two rows at least");
  expect_refused({.times = {0, 2, 1}, .values = {1, 1, 1}}, "row 3 of a table, 1 s, lies before 2 s");
  expect_refused({.times = {0, 1, 1, 1}, .values = {1, 1, 1, 1}}, "rows 2 to 4");
  expect_refused({.times = {0, 1, 1}, .values = {1, 1, 1}, .interpolation = Interpolation::step}, "only a linear");
  expect_refused({.times = {0, NAN}, .values = {1, 1}}, "row 2 of a table is not finite");
  expect_refused(
      {.times = {0, 1, 2}, .values = {1, 1, 2}, .interpolation = Interpolation::cubic, .beyond = Beyond::repeat},
      "begins with 1 and ends with 2");
}

}  // namespace
}  // namespace cdot::test
