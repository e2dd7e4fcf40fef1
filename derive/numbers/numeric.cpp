#include "derive/numbers/numeric.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <stdexcept>

namespace cdot::derive {
namespace {

Triple<double> unit_axis(char letter) {
  return {letter == 'x' ? 1. : 0., letter == 'y' ? 1. : 0., letter == 'z' ? 1. : 0.};
}

Triple<double> turned(double theta, Triple<double> u) {
  const double c = std::cos(theta), s = std::sin(theta);
  return {c * u[0] - s * u[1], s * u[0] + c * u[1], u[2]};
}

Triple<double> turned(const EulerParameters<double>& e, const Triple<double>& u) {
  const auto axes = axes_of(e);
  Triple<double> sum{};
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 3; ++i) sum[i] += axes[k][i] * u[k];
  }
  return sum;
}

}  // namespace

class Doubles final : public Arithmetic<double> {
 public:
  explicit Doubles(const Sample& sample, double guard = 0) : sample_(&sample), guard_(guard) {}
  void move_to(const Sample& sample) { sample_ = &sample; }

  double number(Rational value) override { return value.value(); }

  double scalar_leaf(const Node& leaf) override {
    if (leaf.role == Role::constant && leaf.symbol == "pi") return std::numbers::pi;
    if (leaf.role == Role::constant && leaf.symbol == "unlimited") return std::numeric_limits<double>::infinity();
    const Sample::Body* const body = body_of(leaf);
    if (body && leaf.role == Role::angle) return body->theta;
    if (body && leaf.role == Role::spin && leaf.pool->dimension() == 2) return body->w[2];
    if (body && leaf.role == Role::given) return body->e[static_cast<std::size_t>(leaf.symbol.back() - '0')];
    return named(leaf.symbol);
  }

  Triple<double> vector_leaf(const Node& leaf) override {
    if (is_world_axis(Expr(&leaf))) return unit_axis(leaf.symbol.back());
    const Sample::Body* const body = body_of(leaf);
    if (body && leaf.role == Role::position) return body->x;
    if (body && leaf.role == Role::velocity) return body->v;
    if (body && leaf.role == Role::spin) return body->w;
    const bool plane = leaf.pool->dimension() == 2;
    const std::optional<Triple<double>> local = in_frame(leaf);
    if (!local) {
      return {named(leaf.symbol + "_x"), named(leaf.symbol + "_y"), plane ? 0 : named(leaf.symbol + "_z")};
    }
    if (!body || leaf.role != Role::body_vector) return *local;
    return plane ? turned(body->theta, *local) : turned(body->e, *local);
  }

  double inverse(const double& x) override { return std::fabs(x) <= guard_ ? 0 : function_of(Fn::inverse).value(&x); }

  Triple<double> direction(const Triple<double>& u) override {
    const double u_len = length(u);
    if (u_len <= guard_) return {1, 0, 0};
    return {u[0] / u_len, u[1] / u_len, u[2] / u_len};
  }

  double call(Fn fn, std::span<const double> args) override { return function_of(fn).value(args.data()); }
  bool has(Fn) const override { return true; }

 private:
  const Sample::Body* body_of(const Node& leaf) const {
    const std::size_t body = static_cast<std::size_t>(leaf.body);  // -1: beyond the last
    return body < sample_->bodies.size() ? &sample_->bodies[body] : nullptr;
  }

  std::optional<Triple<double>> in_frame(const Node& leaf) const {
    if (const auto found = sample_->local.find(leaf.symbol); found != sample_->local.end()) return found->second;
    const Pool::Axis axis = leaf.pool->axis_of(Expr(&leaf));
    const auto triad = sample_->triads.find(axis.triad);
    if (triad == sample_->triads.end()) return std::nullopt;
    return axes_of(triad->second)[static_cast<std::size_t>(axis.index)];
  }

  double named(const std::string& name) const {
    const auto found = sample_->scalars.find(name);
    if (found == sample_->scalars.end()) throw std::out_of_range("no value for " + name);
    return found->second;
  }

  const Sample* sample_;
  double guard_;
};

EulerParameters<double> random_orientation(Random& random) {
  EulerParameters<double> e;
  double square = 0;
  do {  // uniform on the sphere, by rejection
    square = 0;
    for (double& component : e) component = random.between(-1, 1), square += component * component;
  } while (square > 1 || square < 0.01);
  for (double& component : e) component /= std::sqrt(square);
  return e;
}

bool is_scalar_of_sample(Role role) {
  return role == Role::parameter || role == Role::time || role == Role::inverse_mass || role == Role::inverse_inertia ||
         role == Role::multiplier || role == Role::given;
}

bool is_body_axis(const Joint& joint, const Node& leaf) {
  return leaf.role == Role::body_vector &&
         leaf.symbol.starts_with("axis_" + joint.bodies[static_cast<std::size_t>(leaf.body)]);
}

struct Numbers::Parts {
  explicit Parts(Values values) : own{{}, std::move(values), {}, {}, {}}, doubles(own), evaluation(doubles) {}
  Parts(const Sample& sample, double guard) : doubles(sample, guard), evaluation(doubles) {}
  const Sample own;
  Doubles doubles;
  Evaluation<double> evaluation;
};

Numbers::Numbers(Values values) : parts_(std::make_unique<Parts>(std::move(values))) {}
Numbers::Numbers(const Sample& sample, double guard) : parts_(std::make_unique<Parts>(sample, guard)) {}
Numbers::~Numbers() = default;
double Numbers::scalar(Expr e) { return parts_->evaluation.scalar(e); }
Triple<double> Numbers::vector(Expr e) { return parts_->evaluation.vector(e); }
void Numbers::move_to(const Sample& sample) {
  parts_->doubles.move_to(sample);
  parts_->evaluation.repeat();
}

std::vector<double> Numbers::of(const std::vector<Expr>& scalars) {
  std::vector<double> values;
  for (const Expr e : scalars) values.push_back(scalar(e));
  return values;
}

// splitmix64 (Steele, Lea, Flood, 2014).
std::uint64_t Random::bits() {
  std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

double Random::between(double low, double high) {
  return low + (high - low) * (static_cast<double>(bits() >> 11) * 0x1p-53);
}

EulerParameters<double> turned_about(std::size_t axis, double amount, const EulerParameters<double>& e) {
  EulerParameters<double> turn{std::cos(amount / 2), 0, 0, 0};
  turn[axis + 1] = std::sin(amount / 2);
  return product(turn, e);
}

void Sample::Body::move(int dimension, std::size_t k, double amount) {
  if (k < static_cast<std::size_t>(dimension)) {
    x[k] += amount;
  } else if (dimension == 2) {
    theta += amount;
  } else {
    e = turned_about(k - 3, amount, e);
  }
}

namespace {

Sample::Body random_body(int dimension, Random& random) {
  const auto somewhere = [&](double range) { return random.between(-range, range); };
  Sample::Body body;
  if (dimension == 2) {
    body.x = {somewhere(3), somewhere(3)};
    body.theta = somewhere(3.14);
    body.v = {somewhere(2), somewhere(2)};
    body.w[2] = somewhere(2);
    return body;
  }
  for (double& component : body.x) component = somewhere(3);
  body.e = random_orientation(random);
  for (Triple<double>* rate : {&body.v, &body.w}) {
    for (double& component : *rate) component = somewhere(2);
  }
  return body;
}

// Components of an inverse inertia: a positive definite tensor, the same however many of them occur.
double inverse_inertia_component(const std::string& name, double first) {
  if (name.ends_with("_xx") || name.ends_with("_yy") || name.ends_with("_zz")) return 1 + first;
  return 0.2 * (first - 1);
}

Triple<double> random_direction(int dimension, Random& random, double second) {
  if (dimension == 2) return turned(1.5 * second, {1, 0});
  return axes_of(random_orientation(random))[0];
}

// A number of [0.5, 2] moved into the range of a parameter, if it is outside.
double in_range(const Joint& joint, Expr leaf, double drawn) {
  for (const Parameter& p : joint.parameters) {
    if (p.symbol != leaf || (p.above < drawn && drawn < p.below)) continue;
    const double share = drawn / 2.5;  // in [0.2, 0.8]
    if (std::isinf(p.below)) return p.above + drawn;
    if (std::isinf(p.above)) return p.below - drawn;
    return p.above + share * (p.below - p.above);
  }
  return drawn;
}

// Draws the value of a leaf that is neither pose nor velocity.
void draw_leaf(const Joint& joint, Expr leaf, Random& random, Sample& sample) {
  const double first = random.between(0.5, 2), second = random.between(-2, 2);
  const Pool::Axis axis = joint.pool->axis_of(leaf);
  const bool tensor = joint.dimension == 3 && leaf->role == Role::inverse_inertia;
  if (!leaf->vector && is_scalar_of_sample(leaf->role)) {
    sample.scalars[leaf->symbol] =
        tensor ? inverse_inertia_component(leaf->symbol, first) : in_range(joint, leaf, first);
    if (tensor && is_tensor(leaf)) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = i; j < 3; ++j) {
          const std::string name = tensor_component(leaf, i, j)->symbol;
          sample.scalars.emplace(name, inverse_inertia_component(name, random.between(0.5, 2)));
        }
      }
    }
  }
  if (!leaf->vector || leaf->role == Role::position || leaf->role == Role::velocity || leaf->role == Role::spin) {
    return;
  }
  if (is_world_axis(leaf) || is_body_axis(joint, *leaf)) {
    sample.local[leaf->symbol] = unit_axis(joint.dimension == 2 ? 'x' : leaf->symbol.back());
    for (std::size_t k = 0; axis.triad && k < 3; ++k)  // whoever sees one axis may ask for the others
      sample.local[(*axis.triad)[k]->symbol] = unit_axis("xyz"[k]);
  } else if (axis.triad) {
    sample.triads.emplace(axis.triad, random_orientation(random));
  } else if (leaf->unit_length) {
    sample.local[leaf->symbol] = random_direction(joint.dimension, random, second);
  } else {
    sample.local[leaf->symbol] = {first, second, joint.dimension == 2 ? 0 : random.between(-2, 2)};
  }
}

}  // namespace

Sample random_sample(const Joint& joint, std::span<const Expr> expressions, std::uint64_t seed) {
  Random random(seed);
  Sample sample;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    sample.bodies.push_back(random_body(joint.dimension, random));
  }
  sample.leaves = leaves_of(expressions);
  for (const Expr leaf : sample.leaves) draw_leaf(joint, leaf, random, sample);
  return sample;
}

}  // namespace cdot::derive
