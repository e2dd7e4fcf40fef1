// The numbers of bodies as inputs of kernels: places, velocities, masses; of immovable ones as constants.
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <span>

#include <cdot/rotation.hpp>

#include "derive/compile/rows/row_blocks.hpp"
#include "derive/kernel/factor.hpp"

namespace cdot::compile {
namespace {

constexpr const char* axes[] = {"x", "y", "z"};

// "xy", of the tensor's entry i, j.
std::string entry_of(std::size_t i, std::size_t j) { return std::string(axes[std::min(i, j)]) + axes[std::max(i, j)]; }

double value_at_start(const Table& table) {
  double value = table.pieces.front()[0];
  for (std::size_t k = 0; k < table.times.size(); ++k) {
    const auto& [a, b, c, d] = table.pieces[k];
    if (const double t = -table.times[k]; t >= 0) value = a + t * (b + t * (c + t * d));
  }
  return value;
}

double number_of(const Tensor& tensor, std::size_t i, std::size_t j) {
  return tensor[i == j ? i : i + j + 2];  // xx, yy, zz, xy, xz, yz
}

// By the names of a Pose's members.
std::map<std::string, double> members_of(const std::vector<double>& pose) {
  if (pose.size() == 3)
    return {{"x", pose[0]}, {"y", pose[1]}, {"angle", pose[2]}, {"c", std::cos(pose[2])}, {"s", std::sin(pose[2])}};
  const auto q = spatial::oriented(pose[0], pose[1], pose[2], pose[3], pose[4], pose[5], pose[6]);
  return {{"x", q.x},   {"y", q.y},   {"z", q.z},   {"xx", q.xx}, {"xy", q.xy}, {"xz", q.xz},
          {"yx", q.yx}, {"yy", q.yy}, {"yz", q.yz}, {"zx", q.zx}, {"zy", q.zy}, {"zz", q.zz}};
}

}  // namespace

void RowBlocks::note_start(Constants& constants) const {
  constants.at_start["T(64 * epsilon)"] = 64 * std::numeric_limits<double>::epsilon();  // as in pivot()
  for (int k = 0; k < mechanism_.breakable(); ++k)
    constants.at_start[derive::element("bonds.holds", static_cast<std::size_t>(k))] = 1;
  for (std::size_t b = 0; b < mechanism_.bodies.size(); ++b) {
    const Body& body = mechanism_.bodies[b];
    const std::string& name = names_.bodies[b];
    for (const auto& [member, number] : members_of(body.pose))
      constants.at_start[fmt::format("q[{}].{}", name, member)] = number;
    for (std::size_t c = 0; c < body.velocity.size(); ++c)
      constants.at_start[fmt::format("v[{}].{}", name, mechanism_.column(c))] = body.velocity[c];
    if (!body.inertia_turns) continue;
    const auto q = spatial::oriented(0.0, 0.0, 0.0, body.pose[3], body.pose[4], body.pose[5], body.pose[6]);
    const Tensor& I = body.inverse_inertia;
    const auto turned = spatial::turned(q, spatial::Symmetric<double>{I[0], I[1], I[2], I[3], I[4], I[5]});
    const Tensor in_world = {turned.xx, turned.yy, turned.zz, turned.xy, turned.xz, turned.yz};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = i; j < 3; ++j)
        constants.at_start[fmt::format("q[{}].I.{}", name, entry_of(i, j))] = number_of(in_world, i, j);
  }
  for (int k = 0; k < mechanism_.angles; ++k)
    for (const char* array : {"angles.angle", "angles.turns"})
      constants.at_start[derive::element(array, static_cast<std::size_t>(k))] = 0;
  for (std::size_t k = 0; k < mechanism_.tables.size(); ++k)
    for (const std::string_view derivative : {"value", "rate", "acceleration"})
      constants.at_start[fmt::format("table_{}(time).{}", k, derivative)] =
          derivative == "value" ? value_at_start(mechanism_.tables[k]) : 0;  // rates are in no effective mass
  for (std::size_t b = 0; b < mechanism_.bounded.size(); ++b) constants.at_start[derive::element("events.acts", b)] = 1;
  constants.at_start["time"] = 0, constants.at_start["h"] = mechanism_.step;
}

void RowBlocks::add_place(Algebra& algebra, Values& in, const std::string& L, int index) const {
  for (const auto& [member, number] : members_of(body(index).pose)) {
    const bool is_place = member == "x" || member == "y" || member == "z";
    const std::string kernel = is_place ? "x_" + L + "_" + member : member == "angle" ? "theta_" + L : L + "." + member;
    in[kernel] = body(index).moves ? algebra.input(fmt::format("q[{}].{}", body_name(index), member), is_place)
                                   : algebra.value(number);
  }
}

void RowBlocks::add_masses(Algebra& algebra, Values& in, const std::string& L, int index) const {
  in["inv_m_" + L] = inverse_mass(algebra, index);
  if (!mechanism_.spatial()) in["inv_I_" + L] = inverse_inertia(algebra, index, 0, 0);
  for (std::size_t i = 0; i < 3 && mechanism_.spatial(); ++i)
    for (std::size_t j = i; j < 3; ++j)
      in[fmt::format("inv_I_{}_{}", L, entry_of(i, j))] = inverse_inertia(algebra, index, i, j);
}

void RowBlocks::add_body(Algebra& algebra, Values& in, const std::string& L, int index) const {
  add_place(algebra, in, L, index);
  each_speed(L, [&](const std::string& input, std::size_t c) {
    in[input] = body(index).moves ? algebra.input(fmt::format("v[{}].{}", body_name(index), mechanism_.column(c)))
                                  : algebra.value(0);
  });
  add_masses(algebra, in, L, index);
}

void RowBlocks::replace_places(Values& in, const RowBlock& block, const Values& places) const {
  for (std::size_t k = 0; k < block.spec->bodies.size(); ++k) {
    const int index = (*block.bodies)[k];
    if (!body(index).moves) continue;
    const std::string &L = block.spec->bodies[k], &name = body_name(index);
    in["x_" + L + "_x"] = places.at(name + ".x"), in["x_" + L + "_y"] = places.at(name + ".y");
    in["theta_" + L] = places.at(name + ".w");
  }
}

void RowBlocks::replace_velocities(Values& in, const RowBlock& block, const Values& velocities) const {
  for (std::size_t k = 0; k < block.spec->bodies.size() && !velocities.empty(); ++k) {
    const int index = (*block.bodies)[k];
    if (!body(index).moves) continue;
    each_speed(block.spec->bodies[k], [&](const std::string& input, std::size_t c) {
      in[input] = velocities.at(body_name(index) + "." + mechanism_.column(c));
    });
  }
}

int RowBlocks::inverse_mass(Algebra& algebra, int index) const {
  if (!body(index).moves) return algebra.value(0);
  return algebra.fixed(body(index).inv_m, body_name(index) + "_inv_m");
}

int RowBlocks::inverse_inertia(Algebra& algebra, int index, std::size_t i, std::size_t j) const {
  const Body& b = body(index);
  if (is_stiffened_ && b.turns()) return algebra.input(stiffened_name(index, i, j));
  if (b.moves && b.inertia_turns) return algebra.input(fmt::format("q[{}].I.{}", body_name(index), entry_of(i, j)));
  if (!b.moves || i != j) return algebra.value(0);
  return algebra.fixed(b.inv_I, body_name(index) + "_inv_I");
}

int RowBlocks::weighted(Algebra& algebra, int index, std::size_t column,
                        const std::function<int(std::size_t)>& f) const {
  const std::size_t first = mechanism_.linear();
  if (column < first) return algebra.times(inverse_mass(algebra, index), f(column));
  if (!has_whole_tensor(index))
    return algebra.times(inverse_inertia(algebra, index, column - first, column - first), f(column));
  Summands terms;
  for (std::size_t j = 0; j < 3; ++j)
    terms.add(1, algebra.times(inverse_inertia(algebra, index, column - first, j), f(first + j)));
  return algebra.sum(terms);
}

int RowBlocks::momentum(Algebra& algebra, int index, std::size_t column,
                        const std::function<int(std::size_t)>& a) const {
  const Body& b = body(index);
  const std::size_t first = mechanism_.linear();
  const auto inverse = [&](double mass) { return mass > 0 ? algebra.value(1 / mass) : algebra.value(0); };
  if (column < first) return algebra.times(inverse(b.inv_m), a(column));
  if (!b.inertia_turns) return algebra.times(inverse(b.inv_I), a(column));
  const auto turning = std::count_if(mechanism_.bodies.begin(), mechanism_.bodies.begin() + index,
                                     [](const Body& before) { return before.inertia_turns; });
  Summands terms;
  for (std::size_t j = 0; j < 3; ++j)
    terms.add(
        1, algebra.times(algebra.input(fmt::format("g[{}].I.{}", turning, entry_of(column - first, j))), a(first + j)));
  return algebra.sum(terms);
}

double RowBlocks::weighed(int index, const std::array<double, 3>& x, const std::array<double, 3>& y) const {
  double sum = 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) sum += x[i] * number_of(body(index).inverse_inertia, i, j) * y[j];
  return sum;
}

std::string RowBlocks::rotation_name(int index, std::size_t i, std::size_t j) const {
  return fmt::format("q[{}].{}{}", body_name(index), axes[i], axes[j]);
}

std::string RowBlocks::stiffened_name(int index, std::size_t i, std::size_t j) const {
  return "W[" + body_name(index) + "]" + (mechanism_.spatial() ? "." + entry_of(i, j) : "");
}

RowBlocks RowBlocks::stiffened(Constants& constants) const {
  Algebra algebra(constants);
  for (int b = 0; b < static_cast<int>(mechanism_.bodies.size()); ++b)
    for (std::size_t i = 0; i < (mechanism_.spatial() ? 3 : 1) && body(b).turns(); ++i)
      for (std::size_t j = 0; j <= i; ++j)
        constants.at_start[stiffened_name(b, i, j)] = algebra.at_start(inverse_inertia(algebra, b, i, j));
  RowBlocks other = *this;
  other.is_stiffened_ = true;
  return other;
}

// In the body's axes: W = A^T w, and A I^-1 (I W x W).
std::array<int, 3> RowBlocks::gyroscopic_rates(Algebra& algebra, int index) const {
  const Body& b = body(index);
  const std::string& name = body_name(index);
  const auto A = [&](std::size_t i, std::size_t j) { return algebra.input(rotation_name(index, i, j)); };
  const auto times = [&](const Tensor& tensor, const std::string& letter, const std::array<int, 3>& v) {
    std::array<int, 3> product{};
    for (std::size_t i = 0; i < 3; ++i) {
      Summands terms;
      for (std::size_t j = 0; j < 3; ++j) {
        const std::string constant = fmt::format("{}_{}{}", name, letter, entry_of(i, j));
        terms.add(1, algebra.times(algebra.fixed(number_of(tensor, i, j), constant), v[j]));
      }
      product[i] = algebra.sum(terms);
    }
    return product;
  };
  std::array<int, 3> W{}, torque{}, rates{};
  for (std::size_t j = 0; j < 3; ++j) {
    Summands terms;
    for (std::size_t i = 0; i < 3; ++i)
      terms.add(1, algebra.times(A(i, j), algebra.input(fmt::format("v[{}].w{}", name, axes[i]))));
    W[j] = algebra.sum(terms);
  }
  const std::array<int, 3> momentum = times(b.inertia, "I", W);
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    torque[i] = algebra.sum({{algebra.times(momentum[j], W[k]), algebra.times(momentum[k], W[j])}, {1, -1}});
  }
  const std::array<int, 3> of_body = times(b.inverse_inertia, "inv_I", torque);
  for (std::size_t i = 0; i < 3; ++i) {
    Summands terms;
    for (std::size_t j = 0; j < 3; ++j) terms.add(1, algebra.times(A(i, j), of_body[j]));
    rates[i] = algebra.sum(terms);
  }
  return rates;
}

void RowBlocks::add_torques(Algebra& algebra, Forces& forces) const {
  for (int b = 0; b < static_cast<int>(mechanism_.bodies.size()); ++b)
    for (std::size_t i = 0; body(b).inertia_turns && i < 3; ++i)
      if (body(b).torque[i] != 0) forces[{b, mechanism_.linear() + i}].add(1, algebra.value(body(b).torque[i]));
}

}  // namespace cdot::compile
