// Expressions: grammar, exact numbers, and every operator of the table at least once.
#include <gtest/gtest.h>
#include <set>

#include "derive/language/operators.hpp"
#include "tests/derive/language/reading.hpp"

namespace cdot::derive {
namespace {

// `expression` as a let of a joint with all kinds of parameters -> the let's value and unit as text.
std::string value_of(const std::string& expression, const std::string& space = "planar") {
  const std::string text = "joint j " + space +
                           "\n point pa on a\n point pb on b\n unit t on b\n vector d [m] on a\n frame f "
                           "on b\n"
                           " frame g on a\n scalar l [m]\n scalar k\n point p on world\n let it = " +
                           expression + "\n pa = pb\n";
  const ReadResult r = read_joint(std::make_shared<SourceFile>("j", text), {});
  if (!r.joint) return render(*r.file, r.diagnostics);
  std::string out;
  for (const Let& let : r.joint->lets)
    out += (out.empty() ? "" : ", ") + text_unnamed(let.value) + " [" + cdot::derive::text(let.unit) + "]";
  return out;
}

TEST(Expressions, BindAsInBooks) {
  EXPECT_EQ(value_of("1 + 2 * 3 ^ 2"), "19 [1]");
  EXPECT_EQ(value_of("-2 ^ 2"), "-4 [1]");
  EXPECT_EQ(value_of("2 ^ -1"), "1/2 [1]");
  EXPECT_EQ(value_of("2 ^ 3 ^ 2"), "512 [1]");
  EXPECT_EQ(value_of("8 / 4 / 2"), "1 [1]");
  EXPECT_EQ(value_of("8 - 4 - 2"), "2 [1]");
  EXPECT_EQ(value_of("(1 +\n  2\n) * 2"), "6 [1]");
}

TEST(Expressions, KeepDecimalsExact) {
  EXPECT_EQ(value_of("0.1 + 0.2"), "3/10 [1]");
  EXPECT_EQ(value_of("1.50"), "3/2 [1]");
  EXPECT_EQ(value_of("1e-3 [m]"), "1/1000 [m]");
  EXPECT_EQ(value_of("2.5E2"), "250 [1]");
  EXPECT_EQ(value_of("123456789012345678"), "123456789012345678 [1]");
}

TEST(Expressions, TurnDegreesIntoRadians) {
  EXPECT_EQ(value_of("90 [deg]"), "1/2*pi [rad]");
  EXPECT_EQ(value_of("180 [deg/s]"), "pi [rad/s]");
}

TEST(Expressions, InferUnits) {
  EXPECT_EQ(value_of("dot(d, pa - pb)").substr(value_of("dot(d, pa - pb)").rfind('[')), "[m^2]");
  EXPECT_EQ(value_of("l * angle(a)"), "theta_a*l [m]");
  EXPECT_EQ(value_of("angle(a) + l / norm(d)"), "theta_a + l/norm(d) [rad]");
  EXPECT_EQ(value_of("2 [N] * l"), "2*l [kg*m^2/s^2]");
  EXPECT_EQ(value_of("sqrt(l * l)"), "sqrt(l^2) [m]");
  EXPECT_EQ(value_of("0 + l"), "l [m]");
}

TEST(Expressions, TakeComponentsAlongFrames) {
  const std::string both = value_of("local(d, f)");
  EXPECT_EQ(both, "dot(d, f_x) [m], -cross(d, f_x) [m]");
  EXPECT_EQ(value_of("local(d, f).x"), "dot(d, f_x) [m]");
  EXPECT_EQ(value_of("norm(local(d, world))"), "norm(d) [m]");
  EXPECT_EQ(value_of("f.y"), "perp(f_x) [1]");
  EXPECT_EQ(value_of("a.x"), "axis_a [1]");
}

TEST(Expressions, KnowVelocitiesOfPoints) {
  EXPECT_EQ(value_of("v(pa)"), "v_a + w_a*perp(ra) [m/s]");
  EXPECT_EQ(value_of("v(x(a))"), "v_a [m/s]");
  EXPECT_EQ(value_of("w(b)"), "w_b [rad/s]");
}

// One call of each operator of the specs; a new operator must be added here.
TEST(Operators, AreAllCalled) {
  const std::map<std::string, std::string> calls = {{"dot", "dot(t, d)"},
                                                    {"cross", "cross(d, t)"},
                                                    {"perp", "perp(d)"},
                                                    {"norm", "norm(d)"},
                                                    {"unit", "unit(d)"},
                                                    {"local", "local(d, a)"},
                                                    {"angle", "angle(t, d)"},
                                                    {"twist", "twist(f, g)"},
                                                    {"swing", "swing(f, g)"},
                                                    {"rotation", "rotation(f, g)"},
                                                    {"x", "x(a)"},
                                                    {"arm", "arm(pa)"},
                                                    {"v", "v(pa)"},
                                                    {"w", "w(a)"},
                                                    {"sqrt", "sqrt(l)"},
                                                    {"sin", "sin(angle(t, d))"},
                                                    {"cos", "cos(k)"},
                                                    {"tan", "tan(k)"},
                                                    {"sinh", "sinh(k)"},
                                                    {"cosh", "cosh(k)"},
                                                    {"exp", "exp(k)"},
                                                    {"log", "log(k)"},
                                                    {"abs", "abs(l)"},
                                                    {"atan2", "atan2(l, norm(d))"}};
  for (const Operator& o : operators()) {
    if (o.where == Operator::Where::hand) continue;
    const auto call = calls.find(std::string(o.name));
    ASSERT_NE(call, calls.end()) << o.name;
    for (const int dimension : {2, 3}) {
      if (!o.is_of(dimension)) continue;
      const std::string value = value_of(call->second, dimension == 2 ? "planar" : "spatial");
      EXPECT_EQ(value.find("error"), std::string::npos) << value;
    }
  }
}

TEST(Expressions, OfSpace) {
  EXPECT_EQ(value_of("cross(d, t)", "spatial"), "cross(d, t) [m]");
  EXPECT_EQ(value_of("angle(t, f.x)", "spatial"), "atan2(norm(cross(f_x, t)), dot(f_x, t)) [rad]");
  EXPECT_EQ(value_of("angle(f.y, g.y, f.x)", "spatial"), "atan2(dot(f_z, g_y), dot(f_y, g_y)) [rad]")
      << "f_x · (f_y × g_y) = (f_x × f_y) · g_y";
  EXPECT_EQ(value_of("angle(g.y, f.y, f.x)", "spatial"), "atan2(-dot(f_z, g_y), dot(f_y, g_y)) [rad]");
  EXPECT_EQ(value_of("twist(f, g)", "spatial"), "twist(f, g) [rad]");
  EXPECT_EQ(value_of("swing(f, g)", "spatial"), "atan2(norm(cross(f_x, g_x)), dot(f_x, g_x)) [rad]");
  EXPECT_EQ(value_of("rotation(f, g)", "spatial"),
            "1/2*cross(f_x, g_x) + 1/2*cross(f_y, g_y) + 1/2*cross(f_z, g_z) [rad]");
  EXPECT_EQ(value_of("dot(f.x, f.y)", "spatial"), "0 [1]");
  EXPECT_EQ(value_of("cross(f.x, f.y)", "spatial"), "f_z [1]");
  EXPECT_EQ(value_of("v(pa)", "spatial"), "v_a - cross(ra, w_a) [m/s]");
  EXPECT_EQ(value_of("local(d, f)", "spatial"), "dot(d, f_x) [m], dot(d, f_y) [m], dot(d, f_z) [m]");
}

}  // namespace
}  // namespace cdot::derive
