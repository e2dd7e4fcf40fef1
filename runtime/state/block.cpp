#include "runtime/state/block.hpp"

#include <cstring>
#include <fmt/format.h>
#include <type_traits>

#include <cdot/spaces.hpp>

#include "runtime/state/state_list.hpp"

namespace cdot {
namespace {

// The letter of Snapshot::Item::type; a struct consists of numbers of type T.
template <class Number, class T>
constexpr char type_of() {
  if constexpr (std::is_same_v<Number, double>) return 'd';
  if constexpr (std::is_same_v<Number, float>) return 'f';
  if constexpr (std::is_same_v<Number, long double>) return 'e';
  if constexpr (std::is_same_v<Number, int>) return 'i';
  if constexpr (std::is_class_v<Number>) return type_of<T, T>();
  static_assert(std::is_class_v<Number> || std::is_arithmetic_v<Number> || sizeof(Number) == 1);
  return 'c';
}

// Lists the items; with `to`, moves the numbers there.
template <class T>
class Layout {
 public:
  Layout(Block& block, std::byte* to) : block_(block), to_(to) { block.items.clear(); }

  void item(const char* name, int index) {
    at_ = Snapshot::aligned(at_);
    block_.items.push_back({index < 0 ? std::string(name) : fmt::format("{}[{}]", name, index), 'c', 0});
  }
  template <class Number>
  void operator()(StateArray<Number>& column) {
    add<Number>(column, column.size());
  }
  template <class Number>
  void operator()(StateNumber<Number>& cell) {
    add<Number>(cell, 1);
  }
  // Its fractions go by their bits.
  void counts(StateNumber<StepCounts>& counts) {
    item("counts", -1);
    if (to_) counts.settle(to_ + at_);
    block_.items.back() = {"counts", 'l', sizeof(StepCounts) / sizeof(long long)};
    at_ += sizeof(StepCounts);
  }
  void common_ends() { block_.common = {0, at_}; }
  void steps_end() { block_.between_steps = at_; }
  std::size_t size() const { return Snapshot::aligned(at_); }

 private:
  template <class Number, class Array>
  void add(Array& array, std::size_t count) {
    constexpr std::size_t numbers = std::is_class_v<Number> ? sizeof(Number) / sizeof(T) : 1;
    static_assert(!std::is_class_v<Number> || sizeof(Number) % sizeof(T) == 0);
    Snapshot::Item& item = block_.items.back();
    item.type = type_of<Number, T>();
    item.count += count * numbers;
    if (to_) array.settle(to_ + at_);
    at_ += count * sizeof(Number);
  }

  Block& block_;
  std::byte* to_;
  std::size_t at_ = 0;
};

// What an island has of the arrays by body, by slot, or by itself.
class Ranges {
 public:
  Ranges(const Block& block, std::vector<Block::Range>& ranges) : base_(block.bytes.data()), ranges_(ranges) {}

  // Elements [begin, end) of arrays with so many: of each array `size / of` numbers belong to one element.
  void take(std::size_t begin, std::size_t end, std::size_t of) { begin_ = begin, end_ = end, of_ = of; }
  void item(const char*, int) {}
  template <class Number>
  void operator()(StateArray<Number>& column) {
    const std::size_t width = of_ > 0 ? column.size() / of_ : column.size(), first = of_ > 0 ? begin_ * width : 0;
    add(column.data() + first, of_ > 0 ? (end_ - begin_) * width : column.size());
  }
  template <class Number>
  void operator()(StateNumber<Number>& cell) {
    add(cell.operator->(), 1);
  }

 private:
  template <class Number>
  void add(const Number* first, std::size_t count) {
    if (count == 0) return;
    const auto begin = static_cast<std::size_t>(reinterpret_cast<const std::byte*>(first) - base_);
    const std::size_t end = begin + count * sizeof(Number);
    // Padding between two arrays never changes.
    if (!ranges_.empty() && Snapshot::aligned(ranges_.back().end) >= begin && ranges_.back().end <= begin)
      ranges_.back().end = end;
    else ranges_.push_back({begin, end});
  }

  const std::byte* base_;
  std::vector<Block::Range>& ranges_;
  std::size_t begin_ = 0, end_ = 0, of_ = 0;
};

template <class S>
std::vector<Block::Range> ranges_of(WorldState<S>& world, int index) {
  std::vector<Block::Range> found;
  Ranges ranges(world.state, found);
  Island<S>& island = world.islands[index];
  const auto bodies = static_cast<std::size_t>(world.bodies.count());
  for (std::size_t k = 0, next; k < island.bodies.size(); k = next) {  // runs of bodies that follow each other
    for (next = k + 1; next < island.bodies.size() && island.bodies[next] == island.bodies[next - 1] + 1;) ++next;
    ranges.take(static_cast<std::size_t>(island.bodies[k]), static_cast<std::size_t>(island.bodies[next - 1]) + 1,
                bodies);
    StateList::each_body(world.bodies, ranges);
  }
  if constexpr (S::has_gyroscopes) {
    for (int gyroscope : island.gyroscopes) {
      ranges.take(static_cast<std::size_t>(gyroscope), static_cast<std::size_t>(gyroscope) + 1,
                  world.gyroscopes.size());
      ranges(world.gyroscopes);
    }
  }
  for (const Segment<S>& segment : island.segments) {
    ranges.take(static_cast<std::size_t>(segment.begin), static_cast<std::size_t>(segment.whole_end),
                static_cast<std::size_t>(segment.batch->count()));
    StateList::each_slot(*segment.batch, 0, ranges);
  }
  ranges.take(0, 0, 0);
  StateList::each_of_island(island, index, world.needs_systems(), ranges);
  return found;
}

}  // namespace

template <class S>
void settle_state(WorldState<S>& world) {
  using T = typename S::Scalar;
  Layout<T> layout(world.state, nullptr);
  StateList::each(world, layout);
  std::vector<std::byte> bytes(layout.size());
  Layout<T> move(world.state, bytes.data());
  StateList::each(world, move);
  world.state.bytes.swap(bytes);
  world.before.assign(world.state.bytes.size(), std::byte{0});
  world.state.islands.clear();
  for (std::size_t k = 0; k < world.islands.size(); ++k)
    world.state.islands.push_back(ranges_of(world, static_cast<int>(k)));
}

#define CDOT_INSTANTIATE(S) template void settle_state(WorldState<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
