// Pictures of singular poses: how many there are, that K loses rank at their numbers, and where their marks stand.
// Poses are evaluated anew with Eigen, and J is made by central differences of C.
#include "derive/picture/picture.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <numbers>
#include <regex>

#include "derive/check/check.hpp"
#include "derive/derivation/derivation.hpp"
#include "derive/language/specs_folder.hpp"

namespace cdot::derive {
namespace {

using Eigen::Vector2d, Eigen::Vector3d;

struct Drawn {
  ReadResult read;
  CheckReport report;
  std::string html;
};

Drawn drawn(ReadResult read) {
  CheckReport report = check(read, Draw::yes);
  std::string html = pictures_html(read, report);
  return {std::move(read), std::move(report), std::move(html)};
}

Drawn drawn(const std::string& joint) {
  const SpecsFolder folder(CDOT_SOURCE_DIR "/specs");
  return drawn(folder.read(std::string(CDOT_SOURCE_DIR "/") + joint));
}

// Made once: proofs take seconds.
const Drawn& known(const std::string& joint) {
  static std::map<std::string, Drawn> all;
  if (!all.contains(joint)) all.emplace(joint, drawn(joint));
  return all.at(joint);
}

std::size_t count_of(const std::string& word, const std::string& text) {
  std::size_t n = 0;
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1)) ++n;
  return n;
}

// The body frame at a pose: its axes in columns.
Eigen::Matrix3d axes_at(const Joint& joint, const Sample::Body& body) {
  if (joint.dimension == 2) return Eigen::AngleAxisd(body.theta, Vector3d::UnitZ()).toRotationMatrix();
  return Eigen::Quaterniond(body.e[0], body.e[1], body.e[2], body.e[3]).toRotationMatrix();
}

Vector3d vector(const Triple<double>& u) { return {u[0], u[1], u[2]}; }

// K of unit masses and inertias, those of some bodies infinite.
Eigen::MatrixXd mass_at(const Joint& joint, const Sample& pose, const std::string& only, bool without_turning) {
  const Block block = derive_rows(joint);
  const std::size_t width = columns_per_body(joint.dimension), linear = static_cast<std::size_t>(joint.dimension);
  const auto columns = static_cast<Eigen::Index>(width * joint.bodies.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(block.rows.size()), columns);
  for (Eigen::Index c = 0; c < columns; ++c) {
    const std::size_t body = static_cast<std::size_t>(c) / width, k = static_cast<std::size_t>(c) % width;
    if ((without_turning && k >= linear) || (!only.empty() && joint.bodies[body] != only)) continue;
    constexpr double step = 1e-6;
    Sample ahead = pose, behind = pose;
    ahead.bodies[body].move(joint.dimension, k, step);
    behind.bodies[body].move(joint.dimension, k, -step);
    for (std::size_t r = 0; r < block.rows.size(); ++r) {
      const std::vector<Expr> C = {block.rows[r].C};
      J(static_cast<Eigen::Index>(r), c) = (values_at(C, ahead)[0] - values_at(C, behind)[0]) / (2 * step);
    }
  }
  return J * J.transpose();
}

Eigen::VectorXd eigenvalues(const Eigen::MatrixXd& K) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
}

class Pictures : public testing::TestWithParam<const char*> {};

TEST_P(Pictures, ShowPosesAtWhichKLosesRank) {
  const Drawn& d = known(GetParam());
  const Joint& joint = *d.read.joint;
  ASSERT_GE(d.report.poses.size(), 2u);
  EXPECT_EQ(count_of("<svg", d.html), d.report.poses.size());
  EXPECT_EQ(d.report.poses[0].why, PoseToDraw::Why::regular);
  const double usual = eigenvalues(mass_at(joint, d.report.poses[0].pose, "", false)).maxCoeff();
  for (const PoseToDraw& pose : d.report.poses) {
    for (const ScalarRow& row : derive_rows(joint).rows)
      EXPECT_NEAR(values_at({row.C}, pose.pose)[0], 0, 1e-9) << pose.words << ": " << row.name;
    std::smatch only;
    std::regex_search(pose.words, only, std::regex("only (.) can move"));
    const bool turns = pose.words.find("nothing can turn") == std::string::npos || !only.empty();
    const double least = eigenvalues(mass_at(joint, pose.pose, only.empty() ? "" : only[1].str(), !turns)).minCoeff();
    if (pose.why == PoseToDraw::Why::singular) {
      EXPECT_LT(least, 1e-8 * usual) << pose.words;
    }
    if (pose.why == PoseToDraw::Why::regular) {
      EXPECT_GT(least, 1e-6 * usual) << pose.words;
    }
  }
}

TEST_P(Pictures, AreTheSameBytesAgainAndFinite) {
  const std::string html = known(GetParam()).html;
  EXPECT_EQ(html, drawn(GetParam()).html);
  EXPECT_FALSE(std::regex_search(html, std::regex("[^a-z](nan|inf)[^a-z]"))) << html;
}

// Marks by name in one picture: "pa, pb" counts for both.
std::map<std::string, std::vector<double>> marks_in(const std::string& svg, const std::regex& mark) {
  std::map<std::string, std::vector<double>> marks;
  for (std::sregex_iterator m(svg.begin(), svg.end(), mark), end; m != end; ++m) {
    std::vector<double> numbers;
    for (std::size_t k = 2; k < m->size(); ++k) numbers.push_back(std::stod((*m)[k]));
    const std::string names = (*m)[1];
    for (std::size_t at = 0; at < names.size();) {
      const std::size_t next = std::min(names.find(", ", at), names.size());
      marks[names.substr(at, next - at)] = numbers;
      at = next + 2;
    }
  }
  return marks;
}

// To the right and down, of a point of the world: turned by 30 degrees, tilted by 25.
Vector2d on_paper(const Joint& joint, const Vector3d& p) {
  if (joint.dimension == 2) return {p.x(), -p.y()};
  constexpr double degree = std::numbers::pi / 180;
  const Vector3d seen =
      Eigen::AngleAxisd(25 * degree, Vector3d::UnitX()) * (Eigen::AngleAxisd(-30 * degree, Vector3d::UnitZ()) * p);
  return {seen.x(), -seen.z()};
}

// Distances between points are in one ratio to those in the pose; arrows have the directions of their vectors.
TEST_P(Pictures, HaveTheirMarksWhereThePoseHasThem) {
  const Drawn& d = known(GetParam());
  const Joint& joint = *d.read.joint;
  std::vector<Sample> poses;
  for (const PoseToDraw& pose : d.report.poses) poses.push_back(pose.pose);
  const std::vector<std::string> pictures = pictures_of(joint, poses);
  const std::regex circle("<circle class=\"point[^>]*data-name=\"([^\"]*)\" cx=\"([^\"]*)\" cy=\"([^\"]*)\"");
  const std::regex line("<path class=\"arrow[^>]*data-name=\"([^\"]*)\" d=\"M(\\S+) (\\S+)L(\\S+) (\\S+)\"");
  double scale = 0;  // the same in all pictures
  for (std::size_t i = 0; i < poses.size(); ++i) {
    auto dots = marks_in(pictures[i], circle), lines = marks_in(pictures[i], line);
    std::vector<std::pair<Vector2d, Vector2d>> seen;  // in the picture, in the pose
    for (const Parameter& p : joint.parameters) {
      const auto body = static_cast<std::size_t>(std::max(0, p.body));
      const Eigen::Matrix3d axes = p.body < 0 ? Eigen::Matrix3d::Identity() : axes_at(joint, poses[i].bodies[body]);
      if (p.kind == ParameterKind::point) {
        ASSERT_TRUE(dots.contains(p.name)) << p.name;
        const Vector3d centre = p.body < 0 ? Vector3d::Zero() : vector(poses[i].bodies[body].x);
        const Vector3d at = centre + axes * vector(poses[i].local.at(p.symbol->symbol));
        seen.emplace_back(Vector2d(dots[p.name][0], dots[p.name][1]), on_paper(joint, at));
      } else if (p.kind == ParameterKind::unit) {
        const Vector2d expected = on_paper(joint, axes * vector(poses[i].local.at(p.symbol->symbol)));
        ASSERT_TRUE(lines.contains(p.name)) << p.name;
        const std::vector<double>& from_to = lines[p.name];
        const Vector2d along(from_to[2] - from_to[0], from_to[3] - from_to[1]);
        if (expected.norm() < 0.2) continue;
        EXPECT_NEAR((along.normalized() - expected.normalized()).norm(), 0, 0.02) << p.name << " in picture " << i;
      }
    }
    for (const auto& [there, pose] : seen) {
      const double length = (pose - seen[0].second).norm();
      if (length < 0.3) continue;
      if (scale == 0) scale = (there - seen[0].first).norm() / length;
      EXPECT_NEAR((there - seen[0].first - scale * (pose - seen[0].second)).norm(), 0, 0.4) << "in picture " << i;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, Pictures,
                         testing::Values("specs/planar/angle_ratio.joint", "specs/planar/rack_and_pinion.joint",
                                         "specs/spatial/spherical_spherical.joint",
                                         "specs/spatial/relative_orientation.joint",
                                         "tests/derive/by_hand/spatial/torus.joint"),
                         [](const auto& info) {
                           return std::regex_replace(std::string(info.param), std::regex(".*/(.*)/(.*)\\.joint"),
                                                     "$1_$2");
                         });

TEST(NoPictures, OfWhatIsRegularAtEveryPose) {
  const Drawn d = drawn("specs/planar/revolute.joint");
  EXPECT_EQ(count_of("<svg", d.html), 0u);
  EXPECT_NE(d.html.find("No pose to draw: K is regular at every pose"), std::string::npos) << d.html;
}

TEST(NoPictures, OfASpecWithAnError) {
  const Drawn d =
      drawn(read_joint(std::make_shared<SourceFile>("own.joint",
                                                    "joint own planar\n \"x\"\n point pa on a\n point pb on b\n"
                                                    "  dot(pa - pb, pa - pb) = 0\n"),
                       {}));
  EXPECT_EQ(count_of("<svg", d.html), 0u);
  EXPECT_NE(d.html.find("The spec has errors: C1: J vanishes"), std::string::npos) << d.html;
}

// At a guarded pose C = 0, and what the caption names is 0.
TEST(OnePicture, ForEachGuard) {
  const Drawn d = drawn("specs/planar/pulley.joint");
  ASSERT_EQ(d.report.poses.size(), 3u);
  EXPECT_EQ(count_of("<svg", d.html), 3u);
  EXPECT_EQ(d.report.poses[0].why, PoseToDraw::Why::regular);
  for (const PoseToDraw& pose : {d.report.poses[1], d.report.poses[2]}) {
    EXPECT_EQ(pose.why, PoseToDraw::Why::guarded);
    const std::string name = pose.words.substr(6, 2);
    EXPECT_EQ(pose.words,
              "where " + name + " = 0, in row rope, the kernel takes (1, 0) for its direction and 0 for 1/norm");
    const auto let = std::ranges::find(d.read.joint->lets, name, &Let::name);
    ASSERT_NE(let, d.read.joint->lets.end()) << name;
    const std::vector<double> u = values_at(components_of(let->value), pose.pose);
    EXPECT_NEAR(Vector2d(u[0], u[1]).norm(), 0, 1e-9);
    EXPECT_NEAR(values_at({derive_rows(*d.read.joint).rows[0].C}, pose.pose)[0], 0, 1e-9);
  }
}

// One picture for each condition of a note.
TEST(OnePicture, ForEachZero) {
  const Drawn d =
      drawn(read_joint(std::make_shared<SourceFile>("own.joint",
                                                    "joint own planar\n \"x\"\n point pa on a\n point pb on b\n"
                                                    "  let u = pa - pb\n  scalar l [m]\n  dot(u, u) = l^2\n"),
                       {}));
  ASSERT_EQ(d.report.poses.size(), 2u);
  EXPECT_NE(d.html.find("<figcaption>K is singular where u = 0, which some parameters allow."), std::string::npos);
  EXPECT_NE(d.html.find(">u = 0</text>"), std::string::npos);
}

}  // namespace
}  // namespace cdot::derive
