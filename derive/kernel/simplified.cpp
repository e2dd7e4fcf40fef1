// Every function of a kernel as the cheapest program that is known for it.
#include <algorithm>
#include <utility>

#include "derive/kernel/plan.hpp"

namespace cdot::derive {
namespace {

class KernelSearch {
 public:
  explicit KernelSearch(SearchBounds bounds) : left_{bounds.kernel}, most_(bounds.program) {}

  void simplify_functions(KernelBlock& block) {
    for (KernelFunction& f : block.functions) {
      ended_ = false;
      f.program = simplified(f.program);
      for (const Program& way : std::exchange(f.other, {})) {
        Program other = simplified(way);
        if (count(other).total() <= count(f.program).total()) f.program = std::move(other);
      }
      if (ended_) cut_short.push_back({f.name, count(f.program).total()});
    }
    for (KernelBlock& variant : block.variants) simplify_functions(variant);
  }

  Program simplified(const Program& program) {
    const std::int64_t allowed = std::min(left_.left, most_);
    Effort effort{allowed};
    Program result = simplify(program, effort);
    ended_ = ended_ || effort.spent();
    left_.spend(static_cast<std::size_t>(allowed - effort.left));
    return result;
  }

  std::vector<CutShort> cut_short;

 private:
  Effort left_;
  std::int64_t most_;
  bool ended_ = false;
};

}  // namespace

Kernel simplified(Kernel kernel, std::vector<CutShort>* cut_short, SearchBounds bounds) {
  KernelSearch search(bounds);
  search.simplify_functions(kernel.rows);
  for (KernelBlock& coordinate : kernel.coordinates) search.simplify_functions(coordinate);
  for (KernelBound& bound : kernel.bounded) {
    bound.function.program = search.simplified(bound.function.program);
    for (KernelFunction& other : bound.others) other.program = search.simplified(other.program);
  }
  for (DefaultValue& value : kernel.defaults) value.program = search.simplified(value.program);
  if (cut_short != nullptr) *cut_short = std::move(search.cut_short);
  return kernel;
}

}  // namespace cdot::derive
