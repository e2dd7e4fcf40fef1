#include "derive/numbers/modular.hpp"

#include <map>
#include <optional>
#include <string>

#include "derive/numbers/modular_point.hpp"
#include "derive/numbers/numeric.hpp"

namespace cdot::derive {
namespace {

__extension__ using Wide = unsigned __int128;

std::string turn_of(int body) { return "turn of " + std::to_string(body); }
std::string name_of(const Triad& triad) { return "triad " + triad[0]->symbol; }
bool is_euler_parameter(const Node& symbol) {
  return symbol.role == Role::given && symbol.body >= 0 && symbol.symbol.find(".e") != std::string::npos;
}

// The value drawn for a symbol. In the plane a vector of a body turns with it.
void add_leaves(const Node& symbol, Draws::Leaves& leaves) {
  const bool planar = symbol.pool->dimension() == 2, body_axis = symbol.symbol.starts_with("axis_");
  const bool turns = symbol.role == Role::angle || is_euler_parameter(symbol) || (symbol.vector && body_axis) ||
                     (planar && symbol.vector && symbol.unit_length);
  if (turns && symbol.body >= 0) leaves.insert(turn_of(symbol.body));
  const Pool::Axis axis = symbol.vector && !planar ? symbol.pool->axis_of(Expr(&symbol)) : Pool::Axis{};
  leaves.insert(axis.triad ? name_of(*axis.triad) : symbol.symbol);
}

// A generic pose. Angles and scalars are small whole numbers: a sine recognises sums of them in its argument.
class Pose final : public Arithmetic<Modular> {
 public:
  explicit Pose(const Draws& draws) : draws_(draws), point_(draws.seed()) {}

  Modular number(Rational value) override {
    const Modular whole(value.num());
    return value.den() == 1 ? whole : whole * point_.inverse(Modular(value.den()));
  }

  Modular scalar_leaf(const Node& symbol) override {
    if (symbol.role == Role::angle) return Modular(angle_of(symbol.body));
    if (symbol.role == Role::constant) return point_.pi();
    if (is_euler_parameter(symbol)) {
      return orientation(symbol.body)[static_cast<std::size_t>(symbol.symbol.back() - '0')];
    }
    return Modular(drawn(symbol.symbol).small());
  }

  Triple<Modular> vector_leaf(const Node& symbol) override {
    if (symbol.pool->dimension() == 3) return vector_in_space(symbol);
    if (is_world_axis(Expr(&symbol))) return {Modular(1), Modular(0)};
    if (symbol.role == Role::body_vector && symbol.symbol.starts_with("axis_")) {
      return turned({}, symbol.body);
    }
    ModularPoint& point = drawn(symbol.symbol);
    if (symbol.unit_length) return turned(point.any_rotation(), symbol.body);
    return {point.any(), point.any()};
  }

  Modular inverse(const Modular& x) override { return point_.inverse(x); }
  Modular call(Fn fn, std::span<const Modular> args) override { return point_.call(fn, args); }
  bool holds_for_reals() const { return point_.holds_for_reals(); }

 private:
  ModularPoint& drawn(std::string_view leaf) {
    point_.draw_by(draws_.seed_of(leaf));
    return point_;
  }
  std::int64_t angle_of(int body) { return drawn(turn_of(body)).small(); }

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
    ModularPoint& point = drawn(axis.triad ? name_of(*axis.triad) : symbol.symbol);
    if (axis.triad) return any_triad()[static_cast<std::size_t>(axis.index)];
    if (symbol.unit_length) return any_triad()[0];
    return {point.any(), point.any(), point.any()};
  }

  // Euler parameters of length 1. Half of all quadruples have a square for their squared length.
  EulerParameters<Modular> orientation(int body) {
    ModularPoint& point = drawn(turn_of(body));
    EulerParameters<Modular> e;
    Modular square;
    do {
      e = {point.any(), point.any(), point.any(), point.any()};
      square = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3];
    } while (square.is_zero() || !square.is_square());
    const Modular scale = inverse(point.root(square));
    for (Modular& component : e) component = component * scale;
    return e;
  }

  std::array<Triple<Modular>, 3> any_triad() {
    const EulerParameters<Modular> e{point_.any(), point_.any(), point_.any(), point_.any()};
    const Modular square = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] + e[3] * e[3];
    const Modular shrink = inverse(square);
    auto axes = axes_of(e);
    for (auto& axis : axes) {
      for (Modular& component : axis) component = component * shrink;
    }
    return axes;
  }

  Triple<Modular> turned(Rotation r, int body) {
    if (body >= 0) r = r * point_.turn_by(angle_of(body));
    return {r.c, r.s};
  }

  const Draws& draws_;
  ModularPoint point_;
};

bool has_root(Expr e) { return e->kind == Kind::norm || e->kind == Kind::unit || e->kind == Kind::function; }

Draws::Leaves drawn_for(std::span<const Expr> expressions) {
  Draws::Leaves leaves;
  for (const Expr e : leaves_of(expressions))
    if (e->role != Role::constant && !is_world_axis(e)) add_leaves(*e, leaves);
  return leaves;
}

// Expressions at random poses, operands first.
class AtPoses {
 public:
  explicit AtPoses(std::span<const Expr> expressions) {
    for (const Expr e : topological(expressions))
      if (e->kind != Kind::symbol) parts_.push_back(e);
  }

  // The answer of `read(values, pose)`. If a part has no value, none, and a leaf of that part is drawn again.
  template <class Read>
  auto at(Draws& draws, Read read) const
      -> std::optional<decltype(read(std::declval<Evaluation<Modular>&>(), std::declval<Pose&>()))> {
    Pose pose(draws);
    Evaluation<Modular> values(pose);
    std::vector<Expr> roots;
    for (const Expr part : parts_) {
      try {
        if (part->vector) values.vector(part);
        else values.scalar(part);
      } catch (const UndefinedHere&) {
        draw_again(draws, part, roots);
        return std::nullopt;
      }
      if (has_root(part)) roots.push_back(part);
    }
    return read(values, pose);
  }

 private:
  static void draw_again(Draws& draws, Expr part, std::span<const Expr> roots) {
    const Draws::Leaves leaves = drawn_for(std::span(&part, 1));
    if (!has_root(part) || leaves.empty()) draws.give_up();
    else draws.again(draws.choice(leaves, drawn_for(roots)));
  }

  std::vector<Expr> parts_;
};

using Rows = std::vector<std::vector<Modular>>;

Rows rows_of(std::span<const std::vector<Expr>> rows, Evaluation<Modular>& values) {
  Rows J;
  for (const std::vector<Expr>& row : rows) {
    J.emplace_back();
    for (const Expr entry : row) J.back().push_back(values.scalar(entry));
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

Modular Modular::of_twice(std::uint64_t below_2p) {
  Modular m;
  m.value_ = below_2p < prime ? below_2p : below_2p - prime;
  return m;
}

bool Modular::is_square() const { return pow(*this, (prime - 1) / 2) == Modular(1); }

std::int64_t Modular::centred() const {
  return value_ > prime / 2 ? -static_cast<std::int64_t>(prime - value_) : static_cast<std::int64_t>(value_);
}

Modular operator+(Modular a, Modular b) { return Modular::of_twice(a.value_ + b.value_); }
Modular operator-(Modular a, Modular b) { return Modular::of_twice(a.value_ + Modular::prime - b.value_); }
// 2^61 is below_power modulo p; twice put in, that leaves less than 2 p.
Modular operator*(Modular a, Modular b) {
  constexpr std::uint64_t low = (std::uint64_t{1} << Modular::bits) - 1;
  const Wide product = Wide(a.value_) * b.value_;
  const Wide once = (product & low) + (product >> Modular::bits) * Modular::below_power;
  return Modular::of_twice(static_cast<std::uint64_t>(once & low) +
                           static_cast<std::uint64_t>(once >> Modular::bits) * Modular::below_power);
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
  const std::array both = {a, b};
  const AtPoses poses(both);
  std::vector<Draws> points = points_for_zero_test();
  return nullity(std::span(points), [&](Draws& draws) {
    return poses.at(draws, [&](Evaluation<Modular>& values, const Pose& pose) {
      const Modular difference = values.scalar(a) - values.scalar(b);
      return std::pair(difference, pose.holds_for_reals());
    });
  });
}

GenericRank generic_rank(std::span<const std::vector<Expr>> rows) {
  constexpr int wanted = 4;
  constexpr std::uint64_t hopeless = attempts_at_poses / 64;
  std::vector<Expr> entries;
  for (const std::vector<Expr>& row : rows) entries.insert(entries.end(), row.begin(), row.end());
  const AtPoses poses(entries);
  GenericRank result;
  std::vector<std::vector<Combination>> per_pose;
  Draws draws(1);
  for (std::uint64_t attempt = 0; attempt < attempts_at_poses && result.poses < wanted; ++attempt) {
    const auto J = poses.at(draws, [&](Evaluation<Modular>& values, const Pose&) { return rows_of(rows, values); });
    if (draws.given_up()) attempt += hopeless;
    if (J || draws.given_up()) draws = Draws(draws.seed() + 1);
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
