// Which two operands occur together in how many operations of a graph, kept up to date from rewriting to rewriting.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "derive/program/graph.hpp"

namespace cdot::derive {

// A term pair x + ratio y (up to a common factor), or a factor pair x y. x comes first.
struct Pair {
  int x = 0, y = 0;
  Rational ratio;
};

class PairTable {
 public:
  // Pairs of terms (OpKind::sum) or of factors (OpKind::product).
  PairTable(const Graph& graph, OpKind kind, Effort& effort);
  // Takes in what the last rewriting changed.
  void follow();
  // The pair that occurs in most operations, if in more than one; of equals those without a number, which can be taken
  // out later, and of these the first whose occurrences are complete.
  std::optional<Pair> most_frequent() const;

 private:
  // Independent of places: x has the smaller number.
  struct Key {
    int x = 0, y = 0;
    Rational ratio;
    friend bool operator==(const Key&, const Key&) = default;
  };
  struct Occurrence {
    int op = 0, times = 0;
  };
  struct Entry {
    Key key;
    int count = 0;
    std::size_t slot = 0;  // in its bucket
    std::size_t hash = 0;
    int next = -1;  // the next entry in the same slot of the hash table
    Few<Occurrence, 2> in;
  };
  struct Rank;

  bool counts(int op) const { return graph_.is_needed(op) && graph_.at(op).kind == kind_; }
  void update(int op);
  void add(const Operation& counted, const Operation& other, int op, int sign);
  void add_pair(const Operation& counted, std::size_t i, std::size_t j, int op, int sign);
  int times(const Operation& counted, std::size_t i, std::size_t j) const;
  void compare(const Operation& from, const Operation& to);
  int entry(const Key& key);
  void enter(int entry);
  void leave(int entry);
  void move_to_bucket(int entry, int count);
  Rank rank(const Entry& entry) const;
  std::pair<std::size_t, std::size_t> positions(const Entry& entry, int op) const;

  const Graph& graph_;
  OpKind kind_;
  Effort& effort_;
  std::vector<const Operation*> counted_;  // by operation, as it was last counted; null: no pairs
  std::vector<std::size_t> position_;      // by operand, in `compare`
  std::vector<bool> changed_;              // by operand, from `compare`
  std::vector<int> slots_;                 // hash table: the first entry in each slot, or -1
  std::vector<Entry> entries_;
  std::vector<int> free_;
  std::vector<std::vector<int>> buckets_;  // entries by count, from two on
};

}  // namespace cdot::derive
