// The operators of the spec language: one table, read by the reader, by `cdot check --help` and by the tests.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "derive/expression/unit.hpp"
#include "derive/language/value.hpp"

namespace cdot::derive {

// The types that an operator takes; one bit each.
enum Takes : unsigned {
  number_ = 1,
  vector_ = 2,
  point_ = 4,  // fixed in a body
  body_ = 8,   // not the world
  world_ = 16,
  frame_ = 32,
  matrix_ = 64
};

struct Operator {
  std::string_view name;
  std::string_view signature;  // "dot(u, v)"
  std::vector<unsigned> takes;
  UnitRule unit;
  std::function<Value(Pool& pool, std::span<const Value> arguments)> build;  // the unit is set by the rule
  std::string_view help;
  enum class Where { anywhere, velocity, hand } where = Where::anywhere;
  enum class Space { both, planar, spatial } space = Space::both;

  bool is_of(int dimension) const { return space == Space::both || (space == Space::planar) == (dimension == 2); }
};

const std::vector<Operator>& operators();
std::vector<Operator> operators_of_hand_derivations();  // hand/operators.cpp; the last of `operators`
bool is_operator(std::string_view name);
std::vector<const Operator*> operators_named(std::string_view name);  // of either space
// The operator nearest to the unknown `word(...)`; empty if none is near.
std::string suggested_operator(std::string_view word);
std::string operators_help();

}  // namespace cdot::derive
