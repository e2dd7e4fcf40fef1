#include "runtime/state/block.hpp"

#include <cstring>
#include <fmt/format.h>
#include <type_traits>
#include <utility>

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
  Layout(Block& block, std::byte* to) : block_(block), to_(to) {}

  void item(const char* name, int index, bool) {
    at_ = Snapshot::aligned(at_);
    items_.push_back({index < 0 ? std::string(name) : fmt::format("{}[{}]", name, index), 'c', 0});
  }
  template <class Number>
  void operator()(StateArray<Number>& array) {
    add<Number>(array, array.size());
  }
  template <class Number>
  void operator()(StateNumber<Number>& number) {
    add<Number>(number, 1);
  }
  // The doubles among the counts are stored as their bits.
  void counts(StateNumber<StepCounts>& counts) {
    item("counts", -1, true);
    if (to_) counts.settle(to_ + at_);
    items_.back() = {"counts", 'l', sizeof(StepCounts) / sizeof(long long)};
    at_ += sizeof(StepCounts);
  }
  void common_ends() { block_.common = {0, at_}; }
  std::size_t size() const { return Snapshot::aligned(at_); }
  std::vector<Snapshot::Item> items() { return std::move(items_); }

 private:
  template <class Number, class Array>
  void add(Array& array, std::size_t count) {
    constexpr std::size_t numbers = std::is_class_v<Number> ? sizeof(Number) / sizeof(T) : 1;
    static_assert(!std::is_class_v<Number> || sizeof(Number) % sizeof(T) == 0);
    Snapshot::Item& item = items_.back();
    item.type = type_of<Number, T>();
    item.count += count * numbers;
    if (to_) array.settle(to_ + at_);
    at_ += count * sizeof(Number);
  }

  Block& block_;
  std::byte* to_;
  std::vector<Snapshot::Item> items_;
  std::size_t at_ = 0;
};

// The ranges of one island in the arrays that steps change: by body, by slot, or its own. The ranges exclude other
// islands, so saving costs a step nothing for them.
class Ranges {
 public:
  explicit Ranges(const Block& block) : base_(block.bytes.data()) {}

  // Elements [begin, end) of arrays with `of` elements.
  void take(int begin, int end, std::size_t of) {
    begin_ = static_cast<std::size_t>(begin), end_ = static_cast<std::size_t>(end), of_ = of;
  }
  // Whole arrays and numbers, stored contiguously.
  void take_all() { own_ = true; }
  void item(const char*, int, bool in_steps) { in_steps_ = in_steps; }
  template <class Number>
  void operator()(StateArray<Number>& array) {
    if (own_) return add(array.data(), array.size());
    const std::size_t width = array.size() / of_;
    add(array.data() + begin_ * width, (end_ - begin_) * width);
  }
  template <class Number>
  void operator()(StateNumber<Number>& number) {
    add(number.operator->(), 1);
  }
  std::vector<Block::Range> found;

 private:
  template <class Number>
  void add(const Number* first, std::size_t count) {
    if (count == 0 || !in_steps_) return;
    const auto begin = static_cast<std::size_t>(reinterpret_cast<const std::byte*>(first) - base_);
    const std::size_t end = begin + count * sizeof(Number);
    if (follows_) found.back().end = end;
    else found.push_back({begin, end});
    follows_ = own_;
  }

  const std::byte* base_;
  std::size_t begin_ = 0, end_ = 0, of_ = 0;
  bool in_steps_ = true, own_ = false, follows_ = false;
};

template <class S>
std::vector<Block::Range> ranges_of(WorldData<S>& world, int index) {
  Ranges ranges(world.block);
  Island<S>& island = world.islands[index];
  const auto& bodies = island.bodies;
  const bool breaks = !island.bonds.empty();
  ranges.item("joints.broken", -1, true);
  for (int bond : island.bonds) ranges(world.joints[world.bonds[bond].joint].broken);
  for (std::size_t k = 0, next; k < bodies.size(); k = next) {  // runs of consecutive bodies
    for (next = k + 1; next < bodies.size() && bodies[next] == bodies[next - 1] + 1;) ++next;
    ranges.take(bodies[k], bodies[next - 1] + 1, world.bodies.pose.size());
    const bool masses_change = !island.gyroscopes.empty() || world.may_stiffen();
    StateList::each_body(world.bodies, masses_change, ranges);
  }
  if constexpr (S::has_gyroscopes) {
    for (int gyroscope : island.gyroscopes) {
      ranges.take(gyroscope, gyroscope + 1, world.gyroscopes.size());
      ranges.item("gyroscopes", -1, true), ranges(world.gyroscopes);
    }
  }
  for (const Segment<S>& segment : island.segments) {
    ranges.take(segment.begin, segment.whole_end, segment.batch->joint.size());
    StateList::each_slot(*segment.batch, 0, breaks, ranges);
  }
  ranges.take_all();
  StateList::each_of_island(island, index, world.needs_systems(), ranges);
  return ranges.found;
}

}  // namespace

template <class S>
void settle_state(WorldData<S>& world) {
  using T = typename S::Scalar;
  Layout<T> layout(world.block, nullptr);
  StateList::each(world, layout);
  std::vector<std::byte> bytes(layout.size());
  Layout<T> move(world.block, bytes.data());
  StateList::each(world, move);
  world.block.items = std::make_shared<const std::vector<Snapshot::Item>>(move.items());
  world.block.bytes.swap(bytes);
  if (const auto heir = world.block.heir.lock()) *heir = std::move(bytes);
  world.block.heir.reset();
  world.before.assign(world.block.bytes.size(), std::byte{0});
  world.block.islands.clear();
  for (std::size_t k = 0; k < world.islands.size(); ++k)
    world.block.islands.push_back(ranges_of(world, static_cast<int>(k)));
}

#define CDOT_INSTANTIATE(S) template void settle_state(WorldData<S>&);
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
