// What a joint may not do to the world: add momentum, or start apart.
#include <Eigen/LU>
#include <cmath>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "tests/kernels/law.hpp"

using namespace cdot;

namespace {

// The spec without its comments, and with what it includes: the text itself, not what the generator
// made of it.
std::string spec_text(const std::string& joint) {
  std::ifstream file(CDOT_SPECS "/planar/" + joint + ".joint");
  EXPECT_TRUE(file) << "no spec of " << joint;
  std::string all, line;
  while (std::getline(file, line)) {
    line = line.substr(0, line.find('#'));
    all += line + '\n';
    const auto start = line.find("include ");
    if (start == std::string::npos) continue;
    static const std::regex name(R"(([a-z_]+)(\([^)]*\))?)");
    const std::string list = line.substr(start + 8);
    for (std::sregex_iterator it(list.begin(), list.end(), name), end; it != end; ++it) {
      all += spec_text((*it)[1]);
    }
  }
  return all;
}

bool has_word(const std::string& text, const std::string& word) {
  return std::regex_search(text, std::regex("\\b" + word + "\\b"));
}

// Linear momentum x, y, and angular momentum about the origin: sum of x p_y - y p_x + I w.
Eigen::Vector3d momentum(const Inputs& in, const std::vector<double>& v) {
  Eigen::Vector3d total = Eigen::Vector3d::Zero();
  for (std::size_t b = 0; 3 * b < v.size(); ++b) {
    const double m = 1 / in.m[2 * b], I = 1 / in.m[2 * b + 1];
    const double px = m * v[3 * b], py = m * v[3 * b + 1];
    total += Eigen::Vector3d(px, py, in.q[5 * b] * py - in.q[5 * b + 1] * px + I * v[3 * b + 2]);
  }
  return total;
}

}  // namespace

// Where the joint holds (C = 0): apart, the opposite forces on two points of pa = pb have a moment,
// as they should.
TEST(Physics, a_joint_without_world_keeps_momentum) {
  std::set<std::string> free;
  for_all([&](const AnyBlock& block, const Inputs& random) {
    if (block.immovable >= 0 || block.bodies < 2 || has_word(spec_text(block.joint), "world"))
      return;
    free.insert(block.joint);
    Inputs in = random;
    in.time[0] = 0;
    block.set_defaults(in);
    const std::vector<double> v = evaluate_one(block, in).of[apply];
    expect_near(block, "momentum x, y and angular, after an impulse", momentum(in, v),
                momentum(in, in.v), 1e-12);
  });
  EXPECT_GE(free.size(), 10u) << "most of the catalogue joins bodies to each other only";
}

TEST(Physics, moving_all_bodies_together_changes_nothing) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    if (block.immovable >= 0 || block.bodies < 2 || has_word(spec_text(block.joint), "world"))
      return;
    Inputs moved = in;
    const double turn = 0.7, c = std::cos(turn), s = std::sin(turn);
    for (std::size_t b = 0; 5 * b < in.q.size(); ++b) {
      const double x = in.q[5 * b], y = in.q[5 * b + 1];
      moved.q[5 * b] = c * x - s * y + 3;
      moved.q[5 * b + 1] = s * x + c * y - 2;
      move(moved, 3 * b + 2, turn);
    }
    const Outputs before = evaluate_one(block, in), after = evaluate_one(block, moved);
    // Rows along the world's axes (x and y of pa = pb) turn with the bodies and mix: what they
    // measure together stays.
    EXPECT_NEAR(vector(after.of[position]).norm(), vector(before.of[position]).norm(), 1e-12)
        << block.joint << ", " << block.block << ": length of C";
    const Eigen::MatrixXd K = symmetric(before.of[effective_mass], block.rows);
    const Eigen::MatrixXd K_moved = symmetric(after.of[effective_mass], block.rows);
    EXPECT_NEAR(K_moved.trace(), K.trace(), 1e-10)
        << block.joint << ", " << block.block << ": trace of K";
    EXPECT_NEAR(K_moved.determinant(), K.determinant(), 1e-9 * (1 + std::abs(K.determinant())))
        << block.joint << ", " << block.block << ": determinant of K";
  });
}

// Parameters left out are taken from the initial pose such that the joint starts together. A point
// on a curve cannot be: where the curve does not pass, no default of its parameters moves it there.
TEST(Physics, defaults_start_the_joint_at_rest_position) {
  const std::set<std::string> without_promise = {"sine_track"};
  for_all([&](const AnyBlock& block, const Inputs& random) {
    if (block.immovable >= 0 || block.is_coordinate || without_promise.contains(block.joint))
      return;
    Inputs in = random;
    in.time[0] = 0;  // a driven angle has its default at time 0
    block.set_defaults(in);
    const Eigen::VectorXd C = vector(evaluate_one(block, in).of[position]);
    expect_near(block, "C = 0 with default parameters", C, 0 * C, 1e-12);
  });
}

TEST(Physics, default_directions_have_length_one) {
  for_all([](const AnyBlock& block, const Inputs& random) {
    Inputs in = random;
    block.set_defaults(in);
    for (const ParameterInfo& info : block.parameters) {
      if (info.kind != ParameterKind::unit && info.kind != ParameterKind::frame) continue;
      const auto at = static_cast<std::size_t>(info.offset);
      EXPECT_NEAR(std::hypot(in.p[at], in.p[at + 1]), 1, 1e-14) << block.joint << ": " << info.name;
    }
  });
}
