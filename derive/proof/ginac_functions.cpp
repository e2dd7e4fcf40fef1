#include "derive/proof/ginac_functions.hpp"

#include <stdexcept>

namespace cdot::derive {
namespace {

using namespace GiNaC;

struct Counterpart {
  Fn fn;
  unsigned serial;
  ex (*call)(const ex* x);
};

// A root is a power in GiNaC, so sqrt is not here. GiNaC itself turns the root of a square into |x|.
const Counterpart counterparts[] = {
    {Fn::sin, sin_SERIAL::serial, [](const ex* x) -> ex { return sin(*x); }},
    {Fn::cos, cos_SERIAL::serial, [](const ex* x) -> ex { return cos(*x); }},
    {Fn::exp, exp_SERIAL::serial, [](const ex* x) -> ex { return exp(*x); }},
    {Fn::log, log_SERIAL::serial, [](const ex* x) -> ex { return log(*x); }},
    {Fn::abs, abs_SERIAL::serial, [](const ex* x) -> ex { return abs(*x); }},
    {Fn::atan2, atan2_SERIAL::serial, [](const ex* x) -> ex { return atan2(x[0], x[1]); }},
};

}  // namespace

ex ginac_function(Fn fn, std::span<const ex> args) {
  if (fn == Fn::sqrt) return sqrt(args[0]);
  for (const Counterpart& c : counterparts) {
    if (c.fn == fn) return c.call(args.data());
  }
  throw std::logic_error("GiNaC has no " + std::string(name_of(fn)));
}

std::optional<Fn> function_in(const ex& e) {
  if (!is_a<function>(e)) return std::nullopt;
  for (const Counterpart& c : counterparts) {
    if (ex_to<function>(e).get_serial() == c.serial) return c.fn;
  }
  return std::nullopt;
}

}  // namespace cdot::derive
