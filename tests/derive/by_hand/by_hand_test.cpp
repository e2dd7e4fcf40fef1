// Generated kernels beside those of planar.hpp, spatial.hpp and turns.hpp: the same C, J and K, and in no quantity more
// operations. ledger.csv has both counts (CDOT_UPDATE=1 rewrites it).
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <random>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <cdot/planar/registry.hpp>
#include <cdot/spatial/registry.hpp>

#include "generated/spatial/brake.hpp"
#include "generated/spatial/constant_velocity.hpp"
#include "generated/spatial/hinge.hpp"
#include "generated/spatial/six_dof.hpp"
#include "generated/spatial/swing_twist.hpp"
#include "generated/spatial/universal.hpp"
#include "tests/derive/by_hand/planar.hpp"
#include "tests/derive/by_hand/spatial.hpp"
#include "tests/derive/by_hand/turns.hpp"
#include "tests/kernels/counted.hpp"

namespace {

using cdot::Operations;
using counting::Counted;

constexpr const char* table = CDOT_SOURCE_DIR "/tests/derive/by_hand/ledger.csv";

// Numbers between -1 and 1; those of a library's distributions differ from library to library.
class Random {
 public:
  double number() { return static_cast<double>(generator_()) / 2147483648.0 - 1; }
  std::vector<double> direction(std::size_t size) {
    std::vector<double> u(size);
    double square = 0;
    for (double& x : u) x = number(), square += x * x;
    for (double& x : u) x /= std::sqrt(square);
    return u;
  }

 private:
  std::mt19937 generator_{7};
};

// Columns: the axes of a random frame.
std::vector<double> random_rotation(Random& random) {
  const std::vector<double> e = random.direction(4);
  const double a = e[0], b = e[1], c = e[2], d = e[3];
  return {a * a + b * b - c * c - d * d, 2 * (b * c - a * d),           2 * (b * d + a * c),
          2 * (b * c + a * d),           a * a - b * b + c * c - d * d, 2 * (c * d - a * b),
          2 * (b * d - a * c),           2 * (c * d + a * b),           a * a - b * b - c * c + d * d};
}

template <class Kernel>
auto random_parameters(Random& random) {
  typename Kernel::template Parameters<Counted> p;
  auto* numbers = reinterpret_cast<Counted*>(&p);
  for (const cdot::ParameterInfo& info : Kernel::parameters) {
    std::vector<double> values;
    for (int k = 0; k < info.size; ++k) values.push_back(random.number());
    if (info.kind == cdot::ParameterKind::scalar) values[0] += 2;
    if (info.kind == cdot::ParameterKind::unit || info.size == 2 * (info.kind == cdot::ParameterKind::frame))
      values = random.direction(values.size());
    if (info.size == 9) values = random_rotation(random);
    std::copy(values.begin(), values.end(), numbers + info.offset);
  }
  return p;
}

// The plane: what both ways need and give.
struct Plane {
  using Pose = cdot::planar::Pose<Counted>;
  using Mass = cdot::planar::InverseMass<Counted>;
  static Pose pose(Random& random) {
    const std::vector<double> turn = random.direction(2);
    return {random.number(), random.number(), turn[0], turn[1], std::atan2(turn[1], turn[0])};
  }
  static Mass mass(Random& random) { return {2 + random.number(), 2 + random.number()}; }
  static std::vector<Counted> columns(const by_hand::PlanarRow<Counted>& J) {
    return {J.n.x, J.n.y, J.wa, -J.n.x, -J.n.y, -J.wb};
  }
};

struct Space {
  using Pose = cdot::spatial::Pose<Counted>;
  using Mass = cdot::spatial::InverseMass<Counted>;
  static Pose pose(Random& random) {
    const std::vector<double> A = random_rotation(random);
    return {random.number(),
            random.number(),
            random.number(),
            0,
            0,
            0,
            0,
            A[0],
            A[1],
            A[2],
            A[3],
            A[4],
            A[5],
            A[6],
            A[7],
            A[8]};
  }
  static Mass mass(Random& random) {
    const auto some = [&] { return random.number() / 4; };
    return {2 + some(), 2 + some(), 2 + some(), 2 + some(), some(), some(), some()};
  }
  static std::vector<Counted> columns(const by_hand::SpatialRow<Counted>& J) {
    return {J.n.x, J.n.y, J.n.z, J.wa.x, J.wa.y, J.wa.z, -J.n.x, -J.n.y, -J.n.z, -J.wb.x, -J.wb.y, -J.wb.z};
  }
  static std::vector<Counted> columns(const by_hand::Turn<Counted>& J) {
    return {0, 0, 0, -J.w.x, -J.w.y, -J.w.z, 0, 0, 0, J.w.x, J.w.y, J.w.z};
  }
};

// C, J and K, and their costs; the cost of J contains that of C.
struct Evaluated {
  std::vector<double> C, J, K;
  Operations of_C, of_J, of_K;
};

template <class Work>
Operations cost_of(Work work) {
  Counted::taken = {};
  work();
  return Counted::taken;
}

template <class Kernel, class In, class P>
Evaluated generated(const typename In::Pose (&q)[2], const typename In::Mass (&m)[2], const P& p) {
  Counted C[1], K[1], D[1][sizeof(typename In::Pose) == sizeof(Plane::Pose) ? 6 : 12];
  typename Kernel::template Jacobian<Counted> J;
  Evaluated out;
  out.of_C = cost_of([&] { Kernel::position(q, p, Counted(0), C); });
  out.of_J = cost_of([&] { Kernel::jacobian(q, p, Counted(0), C, J); });
  out.of_K = cost_of([&] { Kernel::effective_mass(J, m, K); });
  Kernel::dense(J, D);
  for (const Counted entry : D[0]) out.J.push_back(entry.value);
  out.C = {C[0].value};
  out.K = {K[0].value};
  return out;
}

template <class Hand, class In, class Row, class P>
Evaluated written(const typename In::Pose (&q)[2], const typename In::Mass (&m)[2], const P& p) {
  Counted C, K;
  Row J;
  Evaluated out;
  if constexpr (std::is_same_v<Row, by_hand::Turn<Counted>>) {
    out.of_C = cost_of([&] { Hand::position(q, p, C); });
    out.C = {C.value};
    out.of_J = cost_of([&] { Hand::jacobian(q, p, C, J); });
  } else {
    out.of_C = cost_of([&] { by_hand::position<Hand>(q, p, C); });
    out.C = {C.value};
    out.of_J = cost_of([&] { by_hand::jacobian<Hand>(q, p, C, J); });
  }
  out.C.push_back(C.value);
  out.of_K = cost_of([&] { by_hand::effective_mass(J, m, K); });
  int sign = 1;
  if constexpr (requires { Hand::sign; }) sign = Hand::sign;
  for (const Counted entry : In::columns(J)) out.J.push_back(sign * entry.value);
  out.K = {K.value};
  return out;
}

std::string text(const Operations& o) {
  std::ostringstream s;
  s << o.add << ',' << o.multiply << ',' << o.divide << ',' << o.root << ',' << o.compare << ',' << o.call;
  return s.str();
}

int total(const Operations& o) { return o.add + o.multiply + o.divide + o.root + o.compare + o.call; }
// By the cycles of each kind in a throughput-bound loop.
int weighted(const Operations& o) { return o.add + o.multiply + 8 * o.divide + 10 * o.root + o.compare + 40 * o.call; }

struct Line {
  std::string joint, quantity;
  Operations generated, by_hand;
};

void expect_equal(const std::string& what, const std::vector<double>& ours, const std::vector<double>& theirs) {
  for (std::size_t i = 0; i < theirs.size(); ++i) {
    const double expected = ours[ours.size() == 1 ? 0 : i];
    EXPECT_NEAR(theirs[i], expected, 1e-12 * (1 + std::abs(expected))) << what << ", number " << i;
  }
}

// A kernel of `Joint`: its rows, or one of its coordinates.
template <class Joint, class Kernel, class Hand, class In, class Row>
void compare(std::vector<Line>& lines) {
  Random random;
  std::string name = std::string(In::columns(Row{}).size() == 6 ? "planar," : "spatial,") + std::string(Joint::name);
  if (!std::is_same_v<Joint, Kernel>) name += "." + std::string(Kernel::name);
  for (int sample = 0; sample < 20; ++sample) {
    const auto p = random_parameters<Joint>(random);
    const typename In::Pose q[2] = {In::pose(random), In::pose(random)};
    const typename In::Mass m[2] = {In::mass(random), In::mass(random)};
    const Evaluated ours = generated<Kernel, In>(q, m, p), theirs = written<Hand, In, Row>(q, m, p);
    expect_equal(name + " C", ours.C, theirs.C);
    expect_equal(name + " J", ours.J, theirs.J);
    expect_equal(name + " K", ours.K, theirs.K);
    if (sample > 0) continue;
    lines.push_back({name, "C", ours.of_C, theirs.of_C});
    lines.push_back({name, "C and J", ours.of_J, theirs.of_J});
    lines.push_back({name, "K from J", ours.of_K, theirs.of_K});
  }
}

template <class Kernel, class Hand>
void in_the_plane(std::vector<Line>& lines) {
  compare<Kernel, Kernel, Hand, Plane, by_hand::PlanarRow<Counted>>(lines);
}
template <class Kernel, class Hand>
void in_space(std::vector<Line>& lines) {
  compare<Kernel, Kernel, Hand, Space, by_hand::SpatialRow<Counted>>(lines);
}
template <class Joint, class Coordinate, class Hand>
void turn(std::vector<Line>& lines) {
  compare<Joint, Coordinate, Hand, Space, by_hand::Turn<Counted>>(lines);
}

// Coordinates of the catalogue that are angles.
void turns(std::vector<Line>& lines) {
  using namespace cdot::spatial;
  using namespace by_hand;
  turn<brake, brake::turn, bend<2, 1, 1, false, 1>>(lines);
  turn<constant_velocity, constant_velocity::bend_y, bend<2, 0, 0, false, -1>>(lines);
  turn<constant_velocity, constant_velocity::bend_z, bend<1, 0, 0, false, 1>>(lines);
  turn<hinge, hinge::angle, by_hand::twist<0>>(lines);
  turn<six_dof, six_dof::turn_x, bend<1, 2, 2, false, -1>>(lines);
  turn<six_dof, six_dof::turn_y, latitude>(lines);
  turn<six_dof, six_dof::turn_z, bend<1, 0, 0, true, -1>>(lines);
  turn<six_dof, six_dof::twist_x, by_hand::twist<0>>(lines);
  turn<six_dof, six_dof::twist_y, by_hand::twist<1>>(lines);
  turn<six_dof, six_dof::twist_z, by_hand::twist<2>>(lines);
  turn<swing_twist, swing_twist::swing, by_hand::swing>(lines);
  turn<swing_twist, swing_twist::twist, by_hand::twist<0>>(lines);
  turn<universal, universal::bend_a, bend<0, 2, 2, false, 1>>(lines);
  turn<universal, universal::bend_b, bend<0, 1, 1, true, 1>>(lines);
}

const std::vector<Line>& all() {
  static const std::vector<Line> lines = [] {
    using namespace cdot;
    std::vector<Line> lines;
    in_the_plane<planar::cubic, by_hand::cubic>(lines);
    in_the_plane<planar::ellipse, by_hand::ellipse>(lines);
    in_the_plane<planar::parabola, by_hand::parabola>(lines);
    in_the_plane<planar::superellipse, by_hand::superellipse>(lines);
    in_the_plane<planar::wave, by_hand::wave>(lines);
    in_space<spatial::cone, by_hand::cone>(lines);
    in_space<spatial::cylinder, by_hand::cylinder>(lines);
    in_space<spatial::ellipsoid, by_hand::ellipsoid>(lines);
    in_space<spatial::helicoid, by_hand::helicoid>(lines);
    in_space<spatial::monkey_saddle, by_hand::monkey_saddle>(lines);
    in_space<spatial::paraboloid, by_hand::paraboloid>(lines);
    in_space<spatial::ring, by_hand::ring>(lines);
    in_space<spatial::saddle, by_hand::saddle>(lines);
    in_space<spatial::torus, by_hand::torus>(lines);
    turns(lines);
    return lines;
  }();
  return lines;
}

std::string content(const std::string& path) {
  std::ifstream in(path);
  std::ostringstream all;
  all << in.rdbuf();
  return all.str();
}

}  // namespace

TEST(ByHand, NobodyIsCheaper) {
  constexpr std::size_t angles = 14;
  ASSERT_EQ(all().size(),
            3 * (std::tuple_size_v<cdot::planar::Joints> + std::tuple_size_v<cdot::spatial::Joints> + angles));
  for (const Line& line : all()) {
    EXPECT_LE(total(line.generated), total(line.by_hand)) << line.joint << " " << line.quantity;
    EXPECT_LE(weighted(line.generated), weighted(line.by_hand)) << line.joint << " " << line.quantity << ", weighted";
  }
}

TEST(ByHand, TheLedgerIsCurrent) {
  std::string now =
      "space,joint,quantity,add,multiply,divide,root,compare,call,total,"
      "add by hand,multiply by hand,divide by hand,root by hand,compare by hand,call by hand,total by hand\n";
  for (const Line& line : all()) {
    std::ostringstream s;
    s << line.joint << ',' << line.quantity << ',' << text(line.generated) << ',' << total(line.generated) << ','
      << text(line.by_hand) << ',' << total(line.by_hand) << '\n';
    now += s.str();
  }
  if (std::getenv("CDOT_UPDATE") != nullptr) std::ofstream(table) << now;
  EXPECT_EQ(content(table), now);
}
