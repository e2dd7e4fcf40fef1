// The gradient of a row: the vector that its entries of J repeat gets a name, as on paper.
#pragma once

#include "derive/derivation/derivation.hpp"

namespace cdot::derive {

// Names the factors of the velocities in `row.J` that are sums of scaled vectors, as n = c_1 f_1 + c_2 f_2 of a curve
// or surface, and writes the others by them: -n, and for the levers
//   c_1 (u × f_1) + c_2 (u × f_2) = u × n.
// `row.gradients` lists them. The name is n if the joint has one row, else n_<row>; of a coordinate grad_<coordinate>.
void name_gradients(const Joint& joint, ScalarRow& row);

// Names the factor that the angular velocities of two bodies in space share up to its sign and a number, in
//   J = [0 | axis' | 0 | -axis'],
// unless it is short. `row.axes` lists it. The name is axis if the joint has one row, else axis_<row>.
void name_axes(const Joint& joint, ScalarRow& row);

// A name for a quantity of the row, which no other of the joint has: `alone` if the joint has one row.
struct NamesOfRow {
  std::string alone, of_row, of_coordinate, suffix{};
};
std::string free_name_of_row(const Joint& joint, const ScalarRow& row, NamesOfRow names);

// True if the factor of an angular velocity is a sum, but not of levers u × n with the n of the velocity.
bool has_long_lever(const ScalarRow& row);
// Of a row between two bodies: a turn of both about the centre of one changes no C of their relative pose. From the J
// of both, `whole` = [n', (r × n)', -n', w'], follows w = -((x_a + r - x_b) × n), where `row.J` has a sum.
void shorten_lever_of_carrier(const Joint& joint, ScalarRow& row, const std::vector<JacobianEntry>& whole);

}  // namespace cdot::derive
