#include "derive/numeric.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace cdot::derive {
namespace {

// A pivot that is this small beside the diagonal entry it was left from is round-off.
constexpr double negligible = 16 * std::numeric_limits<double>::epsilon();

class Doubles final : public Arithmetic<double> {
 public:
  explicit Doubles(const Values& values) : values_(values) {}

  double number(Rational value) override { return value.value(); }

  double scalar_leaf(const Node& symbol) override {
    if (symbol.role == Role::constant && symbol.symbol == "pi") return std::numbers::pi;
    return named(symbol.symbol);
  }

  Pair<double> vector_leaf(const Node& symbol) override {
    if (&symbol == &*world_x(*symbol.pool)) return {1, 0};
    return {named(symbol.symbol + "_x"), named(symbol.symbol + "_y")};
  }

  double inverse(const double& x) override {
    return std::fabs(x) >= std::numeric_limits<double>::min() ? 1 / x : 0;
  }

  Pair<double> direction(const Pair<double>& u) override {
    const double u_len = length(u);
    if (u_len == 0) return {1, 0};
    return {u[0] / u_len, u[1] / u_len};
  }

  double call(Fn fn, std::span<const double> args) override {
    const double x = args[0];
    switch (fn) {
      case Fn::sqrt:
        return std::sqrt(x);
      case Fn::sin:
        return std::sin(x);
      case Fn::cos:
        return std::cos(x);
      case Fn::tan:
        return std::tan(x);
      case Fn::exp:
        return std::exp(x);
      case Fn::log:
        return std::log(x);
      case Fn::abs:
        return std::fabs(x);
      case Fn::sign:
        return x > 0 ? 1 : x < 0 ? -1 : 0;
      case Fn::atan2:
        return std::atan2(x, args[1]);
      case Fn::inverse:
        return inverse(x);
      case Fn::select:
        return x > 0 ? args[1] : args[2];
      case Fn::pivot:
        return std::fabs(x) > negligible * std::fabs(args[1]) ? 1 / x : 0;
    }
    return 0;
  }

 private:
  double named(const std::string& name) const {
    const auto found = values_.find(name);
    if (found == values_.end()) throw std::out_of_range("no value for " + name);
    return found->second;
  }

  const Values& values_;
};

Pair<double> turned(double theta, Pair<double> u) {
  const double c = std::cos(theta), s = std::sin(theta);
  return {c * u[0] - s * u[1], s * u[0] + c * u[1]};
}

bool is_scalar_of_sample(Role role) {
  return role == Role::parameter || role == Role::time || role == Role::inverse_mass ||
         role == Role::inverse_inertia || role == Role::multiplier || role == Role::given;
}

bool is_body_axis(const Joint& joint, const Node& leaf) {
  return leaf.role == Role::body_vector &&
         leaf.symbol == "axis_" + joint.bodies[static_cast<std::size_t>(leaf.body)];
}

}  // namespace

struct Numbers::Parts {
  explicit Parts(Values given) : values(std::move(given)), doubles(values), evaluation(doubles) {}
  const Values values;
  Doubles doubles;
  Evaluation<double> evaluation;
};

Numbers::Numbers(Values values) : parts_(std::make_unique<Parts>(std::move(values))) {}
Numbers::~Numbers() = default;
double Numbers::scalar(Expr e) { return parts_->evaluation.scalar(e); }
Pair<double> Numbers::vector(Expr e) { return parts_->evaluation.vector(e); }

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

std::vector<Expr> leaves_of(std::span<const Expr> expressions) {
  std::vector<Expr> leaves;
  for (const Expr e : topological(expressions)) {
    if (e->kind == Kind::symbol) leaves.push_back(e);
  }
  std::sort(leaves.begin(), leaves.end(), [](Expr a, Expr b) { return a->symbol < b->symbol; });
  return leaves;
}

Sample random_sample(const Joint& joint, std::span<const Expr> expressions, std::uint64_t seed) {
  Random random(seed);
  Sample sample;
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const auto somewhere = [&](double range) { return random.between(-range, range); };
    sample.bodies.push_back(
        {somewhere(3), somewhere(3), somewhere(3.14), somewhere(2), somewhere(2), somewhere(2)});
  }
  sample.leaves = leaves_of(expressions);
  for (const Expr leaf : sample.leaves) {
    const double first = random.between(0.5, 2), second = random.between(-2, 2);
    if (!leaf->vector && is_scalar_of_sample(leaf->role)) sample.scalars[leaf->symbol] = first;
    if (!leaf->vector || leaf->role == Role::position || leaf->role == Role::velocity) continue;
    if (leaf == world_x(*joint.pool) || is_body_axis(joint, *leaf))
      sample.local[leaf->symbol] = {1, 0};
    else if (leaf->unit_length)
      sample.local[leaf->symbol] = turned(1.5 * second, {1, 0});
    else
      sample.local[leaf->symbol] = {first, second};
  }
  return sample;
}

Values world_values(const Joint& joint, const Sample& sample) {
  Values values = sample.scalars;
  const auto put = [&](const std::string& name, Pair<double> u) {
    values[name + "_x"] = u[0];
    values[name + "_y"] = u[1];
  };
  for (std::size_t b = 0; b < joint.bodies.size(); ++b) {
    const Sample::Body& body = sample.bodies[b];
    put("x_" + joint.bodies[b], {body.x, body.y});
    put("v_" + joint.bodies[b], {body.v_x, body.v_y});
    values["theta_" + joint.bodies[b]] = body.theta;
    values["w_" + joint.bodies[b]] = body.w;
  }
  for (const Expr leaf : sample.leaves) {
    const auto found = sample.local.find(leaf->symbol);
    if (found == sample.local.end()) continue;
    const bool turns = leaf->role == Role::body_vector && leaf->body >= 0;
    const double theta = turns ? sample.bodies[static_cast<std::size_t>(leaf->body)].theta : 0;
    put(leaf->symbol, turned(theta, found->second));
  }
  return values;
}

}  // namespace cdot::derive
