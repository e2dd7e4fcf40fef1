// A program as a tape: one operation a step, over any number type of the kernel contract. The order of the operations
// is that of the printed kernel, so a tape gives the bits of the compiled one.
#pragma once

#include <cmath>
#include <vector>

#include "runtime/include/cdot/kernel.hpp"

namespace cdot {

struct Tape {
  enum class Code : unsigned char {
    add,
    subtract,
    multiply,
    negate,
    sqrt,
    sin,
    cos,
    tan,
    sinh,
    cosh,
    exp,
    log,
    abs,
    sign,
    atan2,
    inverse,
    select,
    pivot
  };
  // register[to] = code(register[a], register[b], register[c])
  struct Step {
    Code code;
    int to, a, b, c;
  };
  std::vector<Step> steps;
  std::vector<double> constants;  // of the first registers
  int registers = 0;
  std::vector<int> input_at, output_at;  // registers
};

// Writes the constants. A run leaves them there, so once is enough for registers of one tape.
template <class T>
void place_constants(const Tape& tape, T* registers) {
  for (std::size_t i = 0; i < tape.constants.size(); ++i) registers[i] = T(tape.constants[i]);
}

// The outputs lie in the registers afterwards. Inputs and constants lie there before.
template <class T>
void run_tape(const Tape& tape, T* r) {
  using std::sqrt, std::sin, std::cos, std::tan, std::sinh, std::cosh, std::exp, std::log, std::atan2;
  for (const Tape::Step& s : tape.steps) {
    switch (s.code) {
      case Tape::Code::add: r[s.to] = r[s.a] + r[s.b]; break;
      case Tape::Code::subtract: r[s.to] = r[s.a] - r[s.b]; break;
      case Tape::Code::multiply: r[s.to] = r[s.a] * r[s.b]; break;
      case Tape::Code::negate: r[s.to] = -r[s.a]; break;
      case Tape::Code::sqrt: r[s.to] = sqrt(r[s.a]); break;
      case Tape::Code::sin: r[s.to] = sin(r[s.a]); break;
      case Tape::Code::cos: r[s.to] = cos(r[s.a]); break;
      case Tape::Code::tan: r[s.to] = tan(r[s.a]); break;
      case Tape::Code::sinh: r[s.to] = sinh(r[s.a]); break;
      case Tape::Code::cosh: r[s.to] = cosh(r[s.a]); break;
      case Tape::Code::exp: r[s.to] = exp(r[s.a]); break;
      case Tape::Code::log: r[s.to] = log(r[s.a]); break;
      case Tape::Code::abs: r[s.to] = cdot::abs(r[s.a]); break;
      case Tape::Code::sign: r[s.to] = sign(r[s.a]); break;
      case Tape::Code::atan2: r[s.to] = atan2(r[s.a], r[s.b]); break;
      case Tape::Code::inverse: r[s.to] = inverse(r[s.a]); break;
      case Tape::Code::select: r[s.to] = select(r[s.a] > smallest<T>(), r[s.b], r[s.c]); break;
      case Tape::Code::pivot: r[s.to] = pivot(r[s.a], r[s.b]); break;
    }
  }
}

}  // namespace cdot
