// A joint must not add momentum, and its defaults must satisfy C = 0.
#include <Eigen/LU>
#include <cmath>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "tests/kernels/law.hpp"

using namespace cdot;

namespace {

// The text of the spec and of its includes without comments, read without the generator.
std::string spec_text(const std::string& space, const std::string& joint) {
  std::ifstream file(specs_folder() + "/" + space + "/" + joint + ".joint");
  if (!file) file.open(specs_folder() + "/" + space + "/" + joint + ".effect");
  EXPECT_TRUE(file) << "no spec of " << joint;
  std::string all, line;
  while (std::getline(file, line)) {
    line = line.substr(0, line.find('#'));
    all += line + '\n';
    const auto start = line.find("include ");
    if (start == std::string::npos) continue;
    static const std::regex name(R"(([a-z_][a-z_0-9]*)(\([^)]*\))?(\s+as\s+\w+)?)");
    const std::string list = line.substr(start + 8);
    for (std::sregex_iterator it(list.begin(), list.end(), name), end; it != end; ++it) {
      all += spec_text(space, (*it)[1]);
    }
  }
  return all;
}

bool has_word(const std::string& text, const std::string& word) {
  return std::regex_search(text, std::regex("\\b" + word + "\\b"));
}

bool joins_bodies_only(const AnyBlock& block) {
  return block.immovable < 0 && block.bodies > 1 &&
         !has_word(spec_text(std::string(block.space()), block.joint), "world");
}

// Linear momentum, sum of p, and angular momentum about the origin, sum of x cross p + I w. In the plane the third
// component of the former and the first two of the latter are 0.
Eigen::VectorXd momentum(const AnyBlock& block, const Inputs& in, const std::vector<double>& v) {
  const Eigen::VectorXd p = inverse_masses(block, in).inverse() * vector(v);
  const Eigen::Index dimension = block.planar() ? 2 : 3;
  Eigen::VectorXd total = Eigen::VectorXd::Zero(6);
  for (Eigen::Index b = 0; b < block.bodies; ++b) {
    const auto w = static_cast<Eigen::Index>(block.width());
    Eigen::Vector3d x = Eigen::Vector3d::Zero(), linear = x, spin = x;
    x.head(dimension) = vector(in.q).segment(static_cast<Eigen::Index>(block.pose()) * b, dimension);
    linear.head(dimension) = p.segment(w * b, dimension);
    spin.tail(w - dimension) = p.segment(w * b + dimension, w - dimension);
    total.head<3>() += linear;
    total.tail<3>() += x.cross(linear) + spin;
  }
  return total;
}

}  // namespace

// On C = 0 only: if pa and pb differ, their opposite forces have a moment.
TEST(Physics, a_joint_without_world_keeps_momentum) {
  std::set<std::string> free;
  for_all([&](const AnyBlock& block, const Inputs& random) {
    if (!joins_bodies_only(block) || block.is_effect) return;
    free.insert(block.joint);
    Inputs in = random;
    in.time[0] = 0;
    block.set_defaults(in);
    const std::vector<double> v = evaluate_one(block, in).of[apply];
    expect_near(block, "momentum, linear and angular, after an impulse", momentum(block, in, v),
                momentum(block, in, in.v), 1e-12);
  });
  EXPECT_GE(free.size(), 10u) << "most of the catalogue joins bodies to each other only";
}

// Anywhere, not at rest alone: the rows of an effect are coordinates between its bodies.
TEST(Physics, an_effect_without_world_keeps_momentum) {
  std::set<std::string> free;
  for_all([&](const AnyBlock& block, const Inputs& random) {
    if (!joins_bodies_only(block) || !block.is_effect) return;
    free.insert(block.joint);
    Inputs in = random;
    in.lambda = evaluate_one(block, random).of[law_force];
    const std::vector<double> v = evaluate_one(block, in).of[apply];
    expect_near(block, "momentum, linear and angular, after a push", momentum(block, in, v), momentum(block, in, in.v),
                1e-11);
  });
  if (has_effects()) {
    EXPECT_GE(free.size(), 3u) << "springs and servos act between two bodies";
  }
}

TEST(Physics, moving_all_bodies_together_changes_nothing) {
  for_all([](const AnyBlock& block, const Inputs& in) {
    if (!joins_bodies_only(block)) return;
    const Inputs moved = moved_together(block, in);
    const Outputs before = evaluate_one(block, in), after = evaluate_one(block, moved);
    // Rows along world axes (x and y of pa = pb) mix under a common rotation; their norm is constant.
    EXPECT_NEAR(vector(after.of[position]).norm(), vector(before.of[position]).norm(), 1e-12)
        << block.space() << ' ' << block.joint << ", " << block.block << ": length of C";
    const Eigen::MatrixXd K = symmetric(before.of[effective_mass], block.rows);
    const Eigen::MatrixXd K_moved = symmetric(after.of[effective_mass], block.rows);
    EXPECT_NEAR(K_moved.trace(), K.trace(), 1e-10)
        << block.space() << ' ' << block.joint << ", " << block.block << ": trace of K";
    EXPECT_NEAR(K_moved.determinant(), K.determinant(), 1e-9 * (1 + std::abs(K.determinant())))
        << block.space() << ' ' << block.joint << ", " << block.block << ": determinant of K";
  });
}

// Defaults from the initial pose satisfy C = 0. Exceptions: no default moves a point onto a curve or a surface, or
// makes given directions perpendicular or moves them into a cone.
TEST(Physics, defaults_start_the_joint_at_rest_position) {
  const std::set<std::string> without_promise = {"sine_track", "surface", "n1", "cone", "lesson_example"};
  for_all([&](const AnyBlock& block, const Inputs& random) {
    if (block.immovable >= 0 || block.is_coordinate || block.is_effect || without_promise.contains(block.joint)) return;
    Inputs in = random;
    in.time[0] = 0;  // the default of a driven angle is that at time 0
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
      const Eigen::Index dimension = block.planar() ? 2 : 3;
      const Eigen::MatrixXd axes =
          Eigen::Map<const Eigen::MatrixXd>(&in.p[at], dimension, static_cast<Eigen::Index>(info.size) / dimension);
      const Eigen::MatrixXd products = axes.transpose() * axes;
      expect_near(block, "axes of a frame, or a direction: " + std::string(info.name), products,
                  Eigen::MatrixXd::Identity(products.rows(), products.cols()), 1e-14);
    }
  });
}
