// The state of a World at one moment, apart from the World: to go back to, to compare, to keep in a file. A run that
// goes on from it has the same bits as one that was never interrupted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cdot {

class Snapshot {
 public:
  // What it is a state of. Only a World with the same of everything takes it back.
  struct Origin {
    std::string method;  // space, solver, integrator, kernels: in words
    int body_count = 0, joint_count = 0;
    std::uint64_t bodies = 0, joints = 0,
                  order = 0;  // hashes: of masses; of joints and effects; of how rows are laid out
    bool operator==(const Origin&) const = default;
  };
  // One array, by name, of numbers of one type.
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

  bool empty() const { return items_.empty(); }
  const Origin& origin() const { return origin_; }
  double time() const;  // [s]; 0 if empty

  // Every bit of it.
  bool operator==(const Snapshot&) const = default;
  // Names of the arrays whose bits are not the same; of one that the other lacks as well.
  std::vector<std::string> differences(const Snapshot& other) const;

  // As lines of text, numbers to the bit, and back. read() throws cdot::Error, naming the line.
  std::string text() const;
  static Snapshot read(std::string_view text);

 private:
  friend struct SnapshotAccess;  // runtime/state/snapshot.cpp
  Origin origin_;
  std::vector<Item> items_;
  std::vector<std::byte> bytes_;  // of all items
};

}  // namespace cdot
