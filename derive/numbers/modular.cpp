#include "derive/numbers/modular.hpp"

#include <map>
#include <optional>
#include <string>

#include "derive/numbers/modular_point.hpp"
#include "derive/numbers/numeric.hpp"

namespace cdot::derive {
namespace {

__extension__ using Wide = unsigned __int128;

// A generic pose. Angles and scalars are small whole numbers: a sine recognises sums of them in its argument.
class Pose final : public Arithmetic<Modular> {
 public:
  explicit Pose(std::uint64_t seed) : point_(seed) {}

  Modular number(Rational value) override { return Modular(value.num()) * point_.inverse(Modular(value.den())); }

  Modular scalar_leaf(const Node& symbol) override {
    if (symbol.role == Role::angle) return Modular(angle_of(symbol.body));
    if (symbol.role == Role::constant) return point_.pi();
    const std::size_t euler = symbol.symbol.find(".e");
    if (symbol.role == Role::given && symbol.body >= 0 && euler != std::string::npos) {
      return orientation(symbol.body)[static_cast<std::size_t>(symbol.symbol.back() - '0')];
    }
    return scalars_.try_emplace(symbol.symbol, Modular(point_.small())).first->second;
  }

  Triple<Modular> vector_leaf(const Node& symbol) override {
    if (symbol.pool->dimension() == 3) return vector_in_space(symbol);
    if (is_world_axis(Expr(&symbol))) return {Modular(1), Modular(0)};
    if (symbol.role == Role::body_vector && symbol.symbol.starts_with("axis_")) {
      return turned({}, symbol.body);
    }
    if (symbol.unit_length) return turned(point_.any_rotation(), symbol.body);
    return {point_.any(), point_.any()};
  }

  Modular inverse(const Modular& x) override { return point_.inverse(x); }
  Modular call(Fn fn, std::span<const Modular> args) override { return point_.call(fn, args); }
  bool holds_for_reals() const { return point_.holds_for_reals(); }

 private:
  std::int64_t angle_of(int body) { return angles_.try_emplace(body, point_.small()).first->second; }

  // Vectors of a body are random; a triad has one random orientation.
  Triple<Modular> vector_in_space(const Node& symbol) {
    if (is_world_axis(Expr(&symbol))) {
      Triple<Modular> axis{};
      axis[static_cast<std::size_t>(symbol.symbol.back() - 'x')] = Modular(1);
      return axis;
    }
    const Pool::Axis axis = symbol.pool->axis_of(Expr(&symbol));
    if (axis.triad && symbol.symbol.starts_with("axis_")) {
      return axes_of(orientation(symbol.body))[static_cast<std::size_t>(axis.index)];
    }
    if (axis.triad) {
      const auto& triad = triads_.try_emplace(axis.triad, any_triad()).first->second;
      return triad[static_cast<std::size_t>(axis.index)];
    }
    if (symbol.unit_length) return any_triad()[0];
    return {point_.any(), point_.any(), point_.any()};
  }

  // Euler parameters of length 1. Half of all quadruples have a square for their squared length.
  const EulerParameters<Modular>& orientation(int body) {
    const auto found = orientations_.find(body);
    if (found != orientations_.end()) return found->second;
    EulerParameters<Modular> e;
    Modular square;
    do {
      e = {point_.any(), point_.any(), point_.any(), point_.any()};
      square = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3];
    } while (square.is_zero() || !square.is_square());
    const Modular scale = inverse(point_.root(square));
    for (Modular& component : e) component = component * scale;
    return orientations_.emplace(body, e).first->second;
  }

  std::array<Triple<Modular>, 3> any_triad() {
    const EulerParameters<Modular> e{point_.any(), point_.any(), point_.any(), point_.any()};
    const Modular square = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3];
    auto axes = axes_of(e);
    for (auto& axis : axes) {
      for (Modular& component : axis) component = component * inverse(square);
    }
    return axes;
  }

  Triple<Modular> turned(Rotation r, int body) {
    if (body >= 0) r = r * point_.turn_by(angle_of(body));
    return {r.c, r.s};
  }

  ModularPoint point_;
  std::map<int, std::int64_t> angles_;
  std::map<int, EulerParameters<Modular>> orientations_;
  std::map<const Triad*, std::array<Triple<Modular>, 3>> triads_;
  std::map<std::string, Modular> scalars_;
};

using Rows = std::vector<std::vector<Modular>>;

std::optional<Rows> jacobian_at(std::span<const std::vector<Expr>> rows, std::uint64_t seed) {
  Pose pose(seed);
  Evaluation<Modular> values(pose);
  Rows J;
  try {
    for (const std::vector<Expr>& row : rows) {
      std::vector<Modular> entries;
      for (const Expr entry : row) entries.push_back(values.scalar(entry));
      J.push_back(std::move(entries));
    }
  } catch (const UndefinedHere&) {
    return std::nullopt;
  }
  return J;
}

// A vanishing combination of rows. Its last coefficient is 1 and belongs to the row that depends on earlier ones.
struct Combination {
  std::size_t row;
  std::vector<Modular> coefs;
};

// Elimination, row by row; a row that becomes zero is a combination of earlier ones.
std::vector<Combination> combinations(Rows J) {
  const std::size_t rows = J.size(), columns = rows == 0 ? 0 : J[0].size();
  std::vector<Combination> found;
  std::vector<std::size_t> pivots(rows, columns);
  Rows made(rows, std::vector<Modular>(rows));  // J[i] = made[i] times the rows as given
  for (std::size_t i = 0; i < rows; ++i) {
    made[i][i] = Modular(1);
    for (std::size_t k = 0; k < i; ++k) {
      if (pivots[k] == columns) continue;
      const Modular factor = J[i][pivots[k]] * inverse(J[k][pivots[k]]);
      for (std::size_t c = 0; c < columns; ++c) J[i][c] = J[i][c] - factor * J[k][c];
      for (std::size_t c = 0; c < rows; ++c) made[i][c] = made[i][c] - factor * made[k][c];
    }
    std::size_t pivot = 0;
    while (pivot < columns && J[i][pivot].is_zero()) ++pivot;
    pivots[i] = pivot;
    if (pivot == columns) found.push_back({i, made[i]});
  }
  return found;
}

// The fraction with small numerator and denominator that x represents, if there is one.
std::optional<Rational> small_fraction(Modular x) {
  for (std::int64_t den = 1; den <= 1000; ++den) {
    const std::int64_t num = (x * Modular(den)).centred();
    if (std::abs(num) <= 1000000) return Rational(num, den);
  }
  return std::nullopt;
}

GenericRank::Dependence dependence(const std::vector<Combination>& at_poses) {
  GenericRank::Dependence out;
  const Combination& first = at_poses.front();
  out.row = static_cast<int>(first.row);
  bool constant = true;
  for (std::size_t i = 0; i < first.coefs.size(); ++i) {
    for (const Combination& other : at_poses) constant = constant && other.coefs[i] == first.coefs[i];
    if (i != first.row && !first.coefs[i].is_zero()) out.on.push_back(static_cast<int>(i));
    const std::optional<Rational> coef = small_fraction(first.coefs[i]);
    constant = constant && coef;
    out.coefs.push_back(coef.value_or(Rational(0)));
  }
  if (!constant) out.coefs.clear();
  return out;
}

}  // namespace

Modular::Modular(std::int64_t whole) {
  const std::int64_t rest = whole % static_cast<std::int64_t>(prime);
  value_ = rest < 0 ? prime - static_cast<std::uint64_t>(-rest) : static_cast<std::uint64_t>(rest);
}

Modular Modular::of_bits(std::uint64_t bits) {
  Modular m;
  m.value_ = bits % prime;
  return m;
}

bool Modular::is_square() const { return pow(*this, (prime - 1) / 2) == Modular(1); }

std::int64_t Modular::centred() const {
  return value_ > prime / 2 ? -static_cast<std::int64_t>(prime - value_) : static_cast<std::int64_t>(value_);
}

Modular operator+(Modular a, Modular b) { return Modular::of_bits(a.value_ + b.value_); }
Modular operator-(Modular a, Modular b) { return Modular::of_bits(a.value_ + Modular::prime - b.value_); }
Modular operator*(Modular a, Modular b) {
  const Wide product = Wide(a.value_) * b.value_;
  return Modular::of_bits(static_cast<std::uint64_t>(product & Modular::prime) +
                          static_cast<std::uint64_t>(product >> 61));
}

Modular pow(Modular base, std::uint64_t exponent) {
  Modular result(1);
  for (; exponent > 0; exponent /= 2, base = base * base) {
    if (exponent % 2 == 1) result = result * base;
  }
  return result;
}

Modular inverse(Modular x) { return pow(x, Modular::prime - 2); }

Nullity difference_modulo_prime(Expr a, Expr b) {
  return nullity([&](std::uint64_t seed) -> std::optional<std::pair<Modular, bool>> {
    Pose pose(seed);
    Evaluation<Modular> values(pose);
    try {
      const Modular difference = values.scalar(a) - values.scalar(b);
      return std::pair(difference, pose.holds_for_reals());
    } catch (const UndefinedHere&) {
      return std::nullopt;
    }
  });
}

GenericRank generic_rank(std::span<const std::vector<Expr>> rows) {
  constexpr int wanted = 4, attempts = 8192;  // with n roots, one pose in 2^n serves
  GenericRank result;
  std::vector<std::vector<Combination>> per_pose;
  for (std::uint64_t seed = 1; seed <= attempts && result.poses < wanted; ++seed) {
    const std::optional<Rows> J = jacobian_at(rows, seed);
    if (!J) continue;
    ++result.poses;
    std::vector<Combination> found = combinations(*J);
    const int rank = static_cast<int>(rows.size() - found.size());
    if (rank > result.rank) per_pose.clear();
    if (rank >= result.rank) per_pose.push_back(std::move(found));
    result.rank = std::max(result.rank, rank);
    if (result.rank == static_cast<int>(rows.size())) break;
  }
  for (std::size_t k = 0; !per_pose.empty() && k < per_pose.front().size(); ++k) {
    std::vector<Combination> at_poses;
    for (const auto& found : per_pose) at_poses.push_back(found[k]);
    result.dependences.push_back(dependence(at_poses));
  }
  return result;
}

}  // namespace cdot::derive
