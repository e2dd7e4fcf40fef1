// Displayed formulas -> numbers, independent of the generator's builders.
#pragma once

#include <stdexcept>
#include <vector>

#include "derive/explain/explain.hpp"
#include "derive/numbers/numeric.hpp"

struct Array {
  std::size_t rows = 1, columns = 1;
  std::vector<double> entries;  // row by row

  double at(std::size_t i, std::size_t j) const { return entries[i * columns + j]; }
};

// A formula has a leaf without an expression (J, M).
struct NoValue : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// The leaves' values in world axes, by name.
cdot::derive::Values world_values(const cdot::derive::Joint& joint, const cdot::derive::Sample& sample);

Array value_of_formula(const cdot::derive::Formula& f, const cdot::derive::Values& values);
// J times the velocities, block by block: one velocity for each column of blocks.
std::vector<double> blocks_times(const cdot::derive::Formula& J, const std::vector<std::vector<double>>& velocities,
                                 const cdot::derive::Values& values);

// The leaves that need values: v and w of every body, and all displayed ones.
std::vector<cdot::derive::Expr> leaves_shown(const cdot::derive::Joint& joint,
                                             const cdot::derive::Explanation& explanation);
void collect_leaves(const cdot::derive::Formula& f, std::vector<cdot::derive::Expr>& leaves);

// The largest difference of two entries, relative to the largest entry; infinite if the shapes
// differ.
double difference(const Array& a, const Array& b);
