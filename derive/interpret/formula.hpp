// Expressions in the language of the specs, read and evaluated at run time: the door between the generator and programs
// that do not link it otherwise. No compiler, no GiNaC; this header includes no other of derive/.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace cdot {

// The names that an expression may use, beside `time`, `pi` and the operators of the language; with bodies also
// `origin`, the point (0, 0) of the world.
struct Vocabulary {
  // A scalar or vector with its unit, as a spec writes it: "rad/s". The name is one word, word.word or f(word.word):
  // "pin.angle", "rate(pin.angle)".
  struct Quantity {
    std::string name, unit;
    bool vector = false;
  };
  int dimension = 2;
  std::vector<std::string> bodies;  // for x(rod), angle(rod), v(rod), w(rod), rod.x
  std::vector<Quantity> quantities;
};

// What is wrong with an expression: bytes [begin, end) of its text, the cause, and the likely fix, which may be empty.
struct FormulaMistake {
  int begin = 0, end = 0;
  std::string cause, fix;
};

// A scalar expression as a straight-line program over doubles.
class Formula {
 public:
  // A number that the expression reads.
  struct Input {
    // `axis`: of a body's frame in the world, component % dimension of axis component / dimension; in the plane the x
    // axis alone. The spin in the plane and an angle have component 0.
    enum Of { time, position, velocity, angle, spin, axis, quantity } of = time;
    int index = -1;     // of the body, or of the quantity in Vocabulary::quantities
    int component = 0;  // 0, 1, 2: along the world's x, y, z
  };
  struct Reading;  // a formula or its mistakes

  // `unit` is the one that the value must have; empty: any.
  static Reading read(std::string_view text, const Vocabulary& vocabulary, std::string_view unit = {});

  const std::vector<Input>& inputs() const { return inputs_; }
  const std::string& unit() const { return unit_; }  // of the value: "kg*m/s^2"
  // Of the inputs, in their order. Allocates nothing; of one Formula, call it from one thread at a time.
  double operator()(std::span<const double> inputs) const;

 private:
  struct Program;
  std::shared_ptr<Program> program_;
  std::vector<Input> inputs_;
  std::string unit_;
};

struct Formula::Reading {
  std::optional<Formula> formula;
  std::vector<FormulaMistake> mistakes;
};

// A scalar expression of the time alone, with its derivatives.
class FormulaInTime {
 public:
  struct Reading;  // a formula or its mistakes

  // `unit` is the one that the value must have.
  static Reading read(std::string_view text, std::string_view unit);

  bool constant() const { return constant_; }  // does not name the time
  // The value, its first and its second derivative. Allocates nothing; several threads may call it.
  std::array<double, 3> at(double time) const;

 private:
  struct Program;
  std::shared_ptr<const Program> program_;
  bool constant_ = true;
};

struct FormulaInTime::Reading {
  std::optional<FormulaInTime> formula;
  std::vector<FormulaMistake> mistakes;
};

}  // namespace cdot
