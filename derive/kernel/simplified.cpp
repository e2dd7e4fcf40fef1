// Every function of a kernel as the cheapest program that is known for it.
#include <utility>

#include "derive/kernel/plan.hpp"

namespace cdot::derive {
namespace {

void simplify_functions(KernelBlock& block) {
  for (KernelFunction& f : block.functions) {
    f.program = simplify(f.program);
    for (const Program& way : std::exchange(f.other, {})) {
      Program other = simplify(way);
      if (count(other).total() <= count(f.program).total()) f.program = std::move(other);
    }
  }
  for (KernelBlock& variant : block.variants) simplify_functions(variant);
}

}  // namespace

Kernel simplified(Kernel kernel) {
  simplify_functions(kernel.rows);
  for (KernelBlock& coordinate : kernel.coordinates) simplify_functions(coordinate);
  for (DefaultValue& value : kernel.defaults) value.program = simplify(value.program);
  return kernel;
}

}  // namespace cdot::derive
