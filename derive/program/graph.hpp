// A program that is rewritten in place. A rewriting costs about what it changes, and gives the operations, their order
// and their names exactly as a copy would (rewrite.hpp).
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "derive/program/builder.hpp"
#include "derive/program/effort.hpp"

namespace cdot::derive {

// Operations have numbers that stay, and places that shift. A rewriting goes once from front to back. New operations
// come just before the one that first needs them.
class Graph final : public Builder {
 public:
  // Reads the operations of `program` where they are, so the program must outlive the graph.
  Graph(const Program& program, Effort& effort);

  // The replacement of an operation, built from `now` of its operands; nullopt to leave it as it is.
  using Rewrite = std::function<std::optional<int>(Graph&, const Operation&)>;
  void rewrite(const std::vector<int>& ops, const Rewrite& rewrite);
  // The present number of an operand of the operation that is being rewritten.
  int now(int op) const { return now_[index(op)]; }

  // Stays as it is as long as the graph: a rewriting, or a new name, makes another one.
  const Operation& at(int op) const override { return *ops_[index(op)]; }
  bool is_needed(int op) const { return state_[index(op)] == State::settled; }
  int uses(int op) const { return uses_[index(op)]; }
  int place(int op) const { return place_[index(op)]; }
  int size() const { return static_cast<int>(ops_.size()); }
  using Users = Few<int, 4>;
  // The users of an operation, those included that the last rewriting left without use.
  const Users& users(int op) const { return users_[index(op)]; }
  // All operations from front to back, those included that the last rewriting left without use.
  std::span<const int> order() const { return {order_.data(), placed_}; }

  // By the last rewriting: operations that are new, others or gone; used more or less often; placed before others.
  struct Changes {
    std::vector<int> ops, uses, places;
  };
  const Changes& changes() const { return changes_; }

  Program program() const;
  // The same, or nullopt where nothing was rewritten and all is needed.
  std::optional<Program> result() const;

 private:
  enum class State : std::uint8_t {
    settled,
    pending,   // an operand became another one: to be built again
    marked,    // to be rewritten
    unneeded,  // without use since the last rewriting
    gone
  };

  static std::size_t index(int op) { return static_cast<std::size_t>(op); }
  int intern(Operation op) override;
  int store(Operation op, std::size_t hash);
  void rename(int op, SharedText name);
  int known(const Operation& op, std::size_t hash, int& sign) const;
  void enter_all();
  void enter(int op);
  void leave(int op);
  bool is_placed(int op) const;
  void append(int op);
  std::size_t append_settled(std::size_t from);
  void begin(const std::vector<int>& ops);
  void settle(int op, const Rewrite& rewrite);
  void take_over(int op, int made);
  void forward(int op, int made);
  void make_pending(int op);
  void use(int op, int user);
  void release(int op, int user);
  void drop_unneeded();

  Effort& effort_;
  std::vector<const Operation*> ops_;  // of the program or in `made_`
  std::deque<Operation> made_;
  std::vector<Output> outputs_;
  std::vector<State> state_;
  std::vector<int> uses_, place_, now_, next_;  // next_: the next operation in the same slot
  std::vector<std::size_t> hash_;
  std::vector<Users> users_;
  std::vector<int> slots_;  // hash table: the first operation in each slot, or -1
  std::vector<int> order_;  // the first `placed_` of it
  std::size_t placed_ = 0;
  bool rewritten_ = false;
  std::vector<int> rest_;                 // in `rewrite`: what has no place yet
  std::vector<int> unneeded_;             // without use since the last rewriting
  std::map<int, SharedText> late_names_;  // of operations that moved to the front: given at their old place
  std::vector<int> without_use_;          // candidates
  Changes changes_;
};

}  // namespace cdot::derive
