// A copy of a World's state at one moment: to restore, to compare, to write to a file. A run that continues from a
// snapshot has the same bits as one without a break.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace cdot {

class Snapshot {
 public:
  // Identifies the World. restore() accepts the snapshot only in a World with an equal Origin.
  struct Origin {
    std::string method;  // space, solver, integrator, kernels: in words
    int body_count = 0, joint_count = 0;
    std::uint64_t bodies = 0, joints = 0,
                  order = 0;  // hashes: of masses; of joints and effects; of how rows are laid out
    bool operator==(const Origin&) const = default;
  };
  // One array: its name and the type of its numbers.
  struct Item {
    std::string name;
    char type;  // d, f, e: double, float, long double; i, l: int, long long; c: a byte
    std::size_t count;
    bool operator==(const Item&) const = default;
  };

  static constexpr std::size_t size_of(char type) {
    return type == 'e' ? sizeof(long double) : type == 'd' || type == 'l' ? 8 : type == 'c' ? 1 : 4;
  }
  // Each array begins at a multiple of this.
  static constexpr std::size_t alignment = alignof(long double);
  static constexpr std::size_t aligned(std::size_t at) { return (at + alignment - 1) / alignment * alignment; }

  bool empty() const { return items().empty(); }
  const Origin& origin() const { return origin_; }
  double time() const;  // [s]; 0 if empty

  // True if every bit is equal.
  bool operator==(const Snapshot& other) const {
    return origin_ == other.origin_ && bytes_ == other.bytes_ && has(other.items());
  }
  // Names of the arrays whose bits differ or that only one snapshot has.
  std::vector<std::string> differences(const Snapshot& other) const;

  // Writes and reads the snapshot as lines of text, every number to the bit. read() throws cdot::Error with the line.
  std::string text() const;
  static Snapshot read(std::string_view text);

 private:
  friend struct SnapshotAccess;  // runtime/state/snapshot.cpp
  using Items = std::vector<Item>;
  const Items& items() const {
    static const Items none;
    return items_ ? *items_ : none;
  }
  bool has(const Items& others) const { return items_.get() == &others || items() == others; }
  Origin origin_;
  std::shared_ptr<const Items> items_;  // snapshots of one World share theirs; null: none
  std::vector<std::byte> bytes_;        // of all items
};

}  // namespace cdot
