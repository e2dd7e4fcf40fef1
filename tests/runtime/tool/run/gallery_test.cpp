// The mechanisms of specs/scenes/gallery against closed forms: the page of each promises a law of its motion.
#include <algorithm>
#include <cmath>
#include <fmt/core.h>
#include <gtest/gtest.h>
#include <numbers>

#include "runtime/tool/scene/scene.hpp"
#include "tests/runtime/tool/support.hpp"

namespace cdot::test::gallery_test {
namespace {

using std::numbers::pi;

struct Point {
  double x, y;
};
Point operator+(Point p, Point q) { return {p.x + q.x, p.y + q.y}; }
Point operator-(Point p, Point q) { return {p.x - q.x, p.y - q.y}; }
double length(Point p) { return std::hypot(p.x, p.y); }

// Where circles about p and q meet, to the left of the line from p to q, or with `side` -1 to its right.
Point meet(Point p, double radius_p, Point q, double radius_q, double side) {
  const Point d = q - p;
  const double far = length(d), along = (radius_p * radius_p - radius_q * radius_q + far * far) / (2 * far);
  const double across = side * std::sqrt(radius_p * radius_p - along * along);
  return p + Point{(along * d.x - across * d.y) / far, (along * d.y + across * d.x) / far};
}

class Mechanism {
 public:
  explicit Mechanism(const std::string& name) : scene_(scene_named("gallery/" + name)) {}

  // f of the bodies by name and the time, at equal intervals until the end.
  template <class F>
  void each(double every, F f) {
    for (const Frame& frame : run_of(scene_, scene_.duration, every)) {
      EXPECT_LT(frame.worst.value, 1e-9) << "t = " << frame.time;
      f([&](const std::string& body) -> const BodyState& { return frame.bodies[index(body)]; }, frame.time);
    }
  }
  double duration() const { return scene_.duration; }

 private:
  std::size_t index(const std::string& body) const {
    const auto found = std::ranges::find(scene_.bodies, body, &SceneBody::name);
    EXPECT_NE(found, scene_.bodies.end()) << body;
    return static_cast<std::size_t>(found - scene_.bodies.begin());
  }

  Scene scene_;
};

// A point of a body in its frame, in the world.
Point of(const BodyState& body, Point p) {
  const double c = std::cos(body.angle), s = std::sin(body.angle);
  return {body.x + c * p.x - s * p.y, body.y + s * p.x + c * p.y};
}

constexpr double promised = 1e-4;  // the accuracy that a scene has by default

// The first left leg by circles alone, from the crank's pin to the foot.
TEST(Gallery, TheFeetOfTheBeachAnimalFollowTheHolyNumbers) {
  Mechanism("strandbeest").each(0.1, [](auto body, double t) {
    const Point hip{-0.38, -0.078}, pin{0.15 * std::cos(pi * t), 0.15 * std::sin(pi * t)};
    const Point top = meet(pin, 0.5, hip, 0.415, -1), low = meet(pin, 0.619, hip, 0.393, 1);
    const Point back = meet(hip, 0.401, top, 0.558, 1), knee = meet(back, 0.394, low, 0.367, -1);
    EXPECT_LT(
        length(Point{body("left1_shin").x, body("left1_shin").y} - Point{(back.x + knee.x) / 2, (back.y + knee.y) / 2}),
        promised)
        << "t = " << t;
  });
}

// On a fixed sun of three times its radius a planet turns four times as fast as the arm.
TEST(Gallery, ThePlanetDrawsAnEpicycloid) {
  Mechanism("epicycloid").each(0.1, [](auto body, double t) {
    const double arm = 2 * pi * t / 6;
    const Point rim = of(body("planet"), {-0.2, 0});
    EXPECT_NEAR(rim.x, 0.8 * std::cos(arm) - 0.2 * std::cos(4 * arm), promised);
    EXPECT_NEAR(rim.y, 0.8 * std::sin(arm) - 0.2 * std::sin(4 * arm), promised);
  });
}

TEST(Gallery, TheCamLiftsByItsLaw) {
  double highest = 0;
  Mechanism("cam").each(0.02, [&](auto body, double t) {
    const double lift = 0.025 * (1 - std::cos(3 * pi * t));  // the valve is seen from the cam at the angle -pi t
    EXPECT_NEAR(body("valve").y, 0.25 + lift, promised) << "t = " << t;
    highest = std::max(highest, body("valve").y);
  });
  EXPECT_NEAR(highest, 0.3, 1e-3);
}

// R (1 + O(mu^2)) = 2 a; van der Pol's own result.
TEST(Gallery, VanDerPolsOscillatorEndsInItsCycle) {
  Mechanism oscillator("van_der_pol");
  double early = 0, late = 0;
  oscillator.each(0.02, [&](auto body, double t) {
    if (t < 3) early = std::max(early, std::abs(body("block").x));
    if (t > oscillator.duration() - 6) late = std::max(late, std::abs(body("block").x));
  });
  EXPECT_LT(early, 0.02);
  EXPECT_NEAR(late, 0.5, 2e-3);
}

TEST(Gallery, TheTrammelDrawsAnEllipse) {
  Mechanism("trammel").each(0.05, [](auto body, double) {
    const Point pen = of(body("rod"), {0.75, 0});
    EXPECT_NEAR(std::pow(pen.x / 1.5, 2) + std::pow(pen.y / 0.5, 2), 1, 1e-9);
  });
}

TEST(Gallery, PeaucelliersPointStaysOnItsLine) {
  double lowest = 1, highest = 0;
  Mechanism("peaucellier").each(0.05, [&](auto body, double) {
    const Point corner = of(body("side3"), {0.3, 0});
    EXPECT_NEAR(corner.x, 1.89 / 1.6, 1e-9);
    lowest = std::min(lowest, corner.y), highest = std::max(highest, corner.y);
  });
  EXPECT_GT(highest - lowest, 0.5);
}

// Crank and shank are opposite sides of a parallelogram: both turn alike against the thigh.
TEST(Gallery, TheKneeTurnsWithItsCrank) {
  double bent = 0;
  Mechanism("knee").each(0.1, [&](auto body, double t) {
    const double hip = 0.6 * std::sin(pi * t / 2) * 2 / pi, crank = 0.8 * (1 - std::cos(pi * t / 2)) * 2 / pi;
    EXPECT_NEAR(body("thigh").angle, -pi / 2 + hip, promised);
    EXPECT_NEAR(body("shank").angle, -pi / 2 + hip + crank, promised) << "t = " << t;
    bent = std::max(bent, body("shank").angle - body("thigh").angle);
  });
  EXPECT_GT(bent, 1);
}

// The lift cylinder is the third side of a triangle with the base and the boom.
TEST(Gallery, TheBoomTurnsByTheLawOfCosines) {
  const Point foot{0, 0.5}, below{0.6, 0.1}, pin{1.5, 1.9};
  const double base = length(below - foot), boom = length(pin - foot), start = length(pin - below);
  const auto between = [&](double side) {
    return std::acos((base * base + boom * boom - side * side) / (2 * base * boom));
  };
  const double at_start = std::atan2(1.8, 2.4);
  double turned = 0;
  Mechanism("excavator").each(0.1, [&](auto body, double t) {
    const double side = start - 0.12 * (1 - std::cos(pi * t / 4)) * 4 / pi;
    EXPECT_NEAR(body("boom").angle, at_start + between(side) - between(start), promised) << "t = " << t;
    turned = std::max(turned, at_start - body("boom").angle);
  });
  EXPECT_GT(turned, 0.1);
}

// It neither rises nor falls, and goes round once in 2 pi / W.
TEST(Gallery, TheCoinKeepsItsHeight) {
  Mechanism coin("coin");
  double x = 0, y = 0;
  coin.each(pi / 3, [&](auto body, double t) {
    EXPECT_NEAR(body("coin").z, 0.2 * std::sin(pi / 3), promised);
    if (t == 0) x = body("coin").x, y = body("coin").y;
    const double rounds = 3 * t / (2 * pi);
    if (std::abs(rounds - std::round(rounds)) < 1e-9) {
      EXPECT_NEAR(body("coin").x, x, promised);
      EXPECT_NEAR(body("coin").y, y, promised);
    }
  });
}

// A single cross at the angle beta: w2 = w1 cos(beta) / (1 - sin(beta)^2 cos(phi)^2), between cos(beta) and its
// inverse.
TEST(Gallery, TwoCrossesTurnEvenly) {
  double slow = 10, fast = 0;
  Mechanism("cardan").each(0.02, [&](auto body, double t) {
    if (t == 0) return;  // at rest, before the motor
    EXPECT_NEAR(body("driven").wx, pi, 10 * promised);
    const BodyState& middle = body("middle");
    const double along = middle.wx * std::cos(pi / 6) + middle.wy * std::sin(pi / 6);
    slow = std::min(slow, along), fast = std::max(fast, along);
  });
  EXPECT_NEAR(slow, pi * std::cos(pi / 6), 2e-3);
  EXPECT_NEAR(fast, pi / std::cos(pi / 6), 2e-3);
}

// At the constant speed of its start nothing moves against the shaft.
TEST(Gallery, TheGovernorStandsAtPortersAngle) {
  Scene scene = scene_named("gallery/governor");
  const double height = 0.9 - 2 * (1 + 2 / 0.5) * 9.81 / (12 * 12);  // of the sleeve: L cos(theta) below the balls
  double lowest = 1, highest = 0;
  for (const Frame& frame : run_of(scene, 8, 0.1)) {
    const double z = frame.bodies[3].z;
    if (frame.time == 0) {
      EXPECT_NEAR(z, height, 1e-12);
    }
    lowest = std::min(lowest, z), highest = std::max(highest, z);
  }
  EXPECT_GT(highest - lowest, 0.05) << "the balls follow the speed";
  scene = read_scene(
      [] {
        std::string text = read_text(scenes_dir() / "gallery/governor.toml");
        const std::size_t at = text.find(" + 1.5 [rad/s]");
        return text.erase(at, text.find('"', at) - at);
      }(),
      "governor at constant speed");
  for (const Frame& frame : run_of(scene, 2, 0.1)) EXPECT_NEAR(frame.bodies[3].z, height, promised) << frame.time;
}

// A disc of inertia k m r^2 leaves where m v^2/(R + r) = m g cos(a), with (1 + k)/2 v^2 = g (R + r) (cos(start) -
// cos(a)). It keeps its speed sideways, and what it turns. Without friction it turns none, as if k were 0.
TEST(Gallery, DiscsLeaveTheDomeWhereTheirPathNeedsAllTheirWeight) {
  struct Disc {
    const char* name;
    double k, turns;
  };
  for (const Disc& disc : {Disc{"smooth", 0, 0}, Disc{"solid", 0.5, 1}, Disc{"hoop", 1, 1}}) {
    const double g = 9.81, r = 0.3, far = 1, cosine = 2 * std::cos(0.25) / (3 + disc.k);
    const double v = std::sqrt(g * far * cosine);
    BodyState end{};
    Mechanism("dome").each(0.1, [&](auto body, double) { end = body(disc.name); });
    EXPECT_NEAR(end.vx, v * cosine, 10 * promised) << disc.name;
    EXPECT_NEAR(end.w, -disc.turns * v / r, 10 * promised / r) << disc.name;
  }
}

// tan(theta1 / 2) tan(theta2 / 2) keeps its value; theta1 is the motor's angle.
TEST(Gallery, BennettsHalfAnglesKeepTheirProduct) {
  const double alpha = 40 * pi / 180, beta = 75 * pi / 180, theta1 = 0.9;
  const double product = std::sin((beta + alpha) / 2) / std::sin((beta - alpha) / 2);
  // the second hinge's axis in the world at the start
  const double axis[3] = {std::sin(theta1) * std::sin(alpha), -std::cos(theta1) * std::sin(alpha), std::cos(alpha)};
  double start[4] = {};
  Mechanism("bennett").each(0.05, [&](auto body, double t) {
    // The turn from the start, of the second rod against the first, in the axes that the first has at the start.
    const BodyState &p = body("first"), &q = body("second");
    const double turn = pi * t / 3, half = turn / 2;
    if (t == 0) std::copy_n(&q.e0, 4, start);
    // The first rod turned about z by `turn`: back by that, then against the second's start.
    const double c = std::cos(half), s = -std::sin(half);
    const double r[4] = {c * q.e0 - s * q.e3, c * q.e1 - s * q.e2, c * q.e2 + s * q.e1, c * q.e3 + s * q.e0};
    const double* o = start;
    const double e0 = r[0] * o[0] + r[1] * o[1] + r[2] * o[2] + r[3] * o[3];
    const double v[3] = {-r[0] * o[1] + r[1] * o[0] - r[2] * o[3] + r[3] * o[2],
                         -r[0] * o[2] + r[2] * o[0] - r[3] * o[1] + r[1] * o[3],
                         -r[0] * o[3] + r[3] * o[0] - r[1] * o[2] + r[2] * o[1]};
    const double theta2 = 2 * std::atan(product / std::tan(theta1 / 2)) +
                          2 * std::atan2(v[0] * axis[0] + v[1] * axis[1] + v[2] * axis[2], e0);
    // as cosines and sines of half angles: finite at half a turn
    const double first = (theta1 + turn) / 2, second = theta2 / 2;
    EXPECT_NEAR(std::sin(first) * std::sin(second), product * std::cos(first) * std::cos(second), 1e-3) << "t = " << t;
    EXPECT_NEAR(std::hypot(p.e0, p.e1, std::hypot(p.e2, p.e3)), 1, 1e-12);
  });
}

// Steps of a second and more pass poses where joints lose rank, or begin beside them.
TEST(Gallery, ErrorsFallWithTheLocalErrorPastFlatPoses) {
  Scene scene = scene_named("gallery/bennett");
  scene.accuracy = 0, scene.step = usual_step(scene.duration, true);
  scene.settings.integrator = Integrator::dop853;
  for (int halves = 2; halves <= 16; ++halves) {
    scene.settings.local_error = std::pow(10, -halves / 2.0);
    const double off = true_error(scene).larger();
    fmt::print("  at a local error of {:.0e}: off by {:.1e}\n", scene.settings.local_error, off);
    EXPECT_LT(off, scene.settings.local_error + 1e-9) << scene.settings.local_error;
  }
}

}  // namespace
}  // namespace cdot::test::gallery_test
