// Programs over the numbers of one scene: kernels are inlined, and what is constant in the scene is computed here.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "derive/program/builder.hpp"

namespace cdot::compile {

using derive::Fn;
using derive::Operation;
using derive::OpKind;
using derive::Program;
using derive::Rational;
using derive::Summands;

struct Constants {
  std::set<std::string> inputs;         // names of those that a run may change: members of p
  std::map<std::string, double> named;  // those that the header names
  // By their sizes, names and values of numbers that are shared.
  std::map<double, std::pair<std::string, double>> sizes;
  std::map<std::string, double> inputs_read;  // values of the inputs that occur
  std::set<std::string> known;                // every name
  std::map<std::string, double> at_start;     // inputs of programs in the state in which the scene starts
};

class Algebra {
 public:
  explicit Algebra(Constants& constants) : constants_(constants) {}

  // A constant, or an input of the run if its name is among these. Small fractions of powers of two are exact numbers,
  // which vanish from products and sums.
  int value(double number, const std::string& name = {});
  // Numbers of one size, but for round-off and the sign, are one, under the name of the first.
  int shared(double number, const std::string& name);
  // One that no run may change.
  int fixed(double number, const std::string& name);
  int input(const std::string& text, bool is_position = false);
  int sum(const Summands& terms, const std::string& name = {});
  int product(const derive::Operands& args, const derive::Operands& exponents, const std::string& name = {});
  int times(int a, int b, const std::string& name = {}) { return product({a, b}, {1, 1}, name); }
  int function(Fn fn, const derive::Operands& args, const std::string& name = {});

  // The outputs of a program, by name. `input` gives the inputs; names get the prefix.
  std::map<std::string, int> inlined(const Program& program, const std::function<int(const std::string&)>& input,
                                     const std::string& prefix);

  // The operation of which it is a multiple, or itself, and the factor.
  std::pair<int, Rational> without_factor(int op) const;
  // Its derivative by the time, with all other inputs fixed.
  int by_time(int op);
  std::optional<double> constant(int op) const;
  // Its coefficients by inputs, if it is a sum of inputs times constants.
  std::optional<std::map<std::string, double>> linear(int op) const;
  // Its value in the state in which the scene starts.
  double at_start(int op);
  bool is_zero(int op) const;
  void output(const std::string& name, int op) { builder_.output(name, op); }
  // The cheapest program that a search finds.
  Program finish();
  // Operation by operation as in the kernels: the bits of the World, where their sign decides.
  Program finish_as_kernels() { return builder_.finish(); }

 private:
  int function_by_time(const Operation& f, int op);
  bool add_linear(int op, double factor, std::map<std::string, double>& coefficients) const;
  bool is_number(int op) const { return builder_.at(op).kind == OpKind::number; }

  derive::ProgramBuilder builder_;
  std::map<int, double> real_;  // constants that are no numbers of the program
  std::map<int, double> at_start_;
  std::map<int, int> by_time_;
  Constants& constants_;
};

}  // namespace cdot::compile
