#include "derive/program/graph.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace cdot::derive {

Graph::Graph(const Program& program, Effort& effort) : effort_(effort), outputs_(program.outputs) {
  const std::size_t n = program.ops.size();
  uses_ = use_counts(program);
  ops_.reserve(n), place_.reserve(n), now_.reserve(n);
  users_.resize(n), hash_.resize(n), next_.resize(n, -1), state_.resize(n, State::settled);
  for (std::size_t i = 0; i < n; ++i) {
    const int op = static_cast<int>(i);
    ops_.push_back(&program.ops[i]);
    place_.push_back(0), now_.push_back(op);
    append(op);
    for (const int arg : program.ops[i].args) users_[index(arg)].push_back(op);
    if (uses_[i] == 0) state_[i] = State::unneeded, unneeded_.push_back(op);
  }
  effort_.spend(n);
}

// Most passes find nothing to rewrite: the hash table waits for the first rewriting.
void Graph::enter_all() {
  slots_.assign(std::bit_ceil(2 * ops_.size() + 64), -1);
  for (int op = 0; op < size(); ++op) {
    hash_[index(op)] = hash_of(at(op));
    if (is_needed(op)) enter(op);
  }
}

void Graph::enter(int op) {
  int& first = slots_[hash_[index(op)] & (slots_.size() - 1)];
  next_[index(op)] = std::exchange(first, op);
}

void Graph::leave(int op) {
  int* link = &slots_[hash_[index(op)] & (slots_.size() - 1)];
  while (*link != op) link = &next_[index(*link)];
  *link = next_[index(op)];
}

bool Graph::is_placed(int op) const {
  const auto place = index(place_[index(op)]);
  return place < placed_ && order_[place] == op;
}

void Graph::append(int op) {
  if (placed_ == order_.size()) order_.resize(2 * placed_ + 64);
  place_[index(op)] = static_cast<int>(placed_);
  order_[placed_++] = op;
}

// Appends the rest from here on up to the first operation that may have changed or moved; gives that one's place.
std::size_t Graph::append_settled(std::size_t from) {
  const std::size_t end = changes_.places.empty() ? rest_.size() : from;
  order_.resize(std::max(order_.size(), placed_ + (end - from)));
  const State* const state = state_.data();
  int *const place = place_.data(), *const order = order_.data();
  std::size_t placed = placed_;
  for (; from < end && state[rest_[from]] == State::settled; ++from) {
    place[rest_[from]] = static_cast<int>(placed);
    order[placed++] = rest_[from];
  }
  placed_ = placed;
  return from;
}

// The known operation equal to `op` or to its negative; -1 if there is none.
int Graph::known(const Operation& op, std::size_t hash, int& sign) const {
  for (int other = slots_[hash & (slots_.size() - 1)]; other >= 0; other = next_[index(other)]) {
    if (hash_[index(other)] != hash) continue;
    sign = sign_between(op, at(other));
    if (sign != 0) return other;  // none but one fits
  }
  return -1;
}

int Graph::intern(Operation op) {
  const std::size_t hash = hash_of(op);
  int sign = 0;
  const int other = known(op, hash, sign);
  if (other < 0) return store(std::move(op), hash);
  const SharedText& name = at(other).name;
  if (is_placed(other)) {
    if (sign < 0) return sum({{other}, {Rational(-1)}});
    if (name.empty() && !op.name.empty()) rename(other, std::move(op.name));
    return other;
  }
  // The known one comes later. A copy would store `op` here, and the known one would become this one or its negative.
  if (sign < 0) {
    make_pending(other);
    return store(std::move(op), hash);
  }
  if (!name.empty()) late_names_[other] = name;
  if (name != op.name) rename(other, std::move(op.name));
  append(other);
  changes_.places.push_back(other);
  return other;
}

int Graph::store(Operation op, std::size_t hash) {
  const int made = size();
  for (const int arg : op.args) use(arg, made);
  ops_.push_back(&made_.emplace_back(std::move(op)));
  uses_.push_back(0), place_.push_back(0), now_.push_back(made), next_.push_back(-1);
  hash_.push_back(hash), users_.emplace_back(), state_.push_back(State::settled);
  enter(made);
  append(made);
  without_use_.push_back(made);
  changes_.ops.push_back(made);
  return made;
}

void Graph::rename(int op, SharedText name) {
  Operation& renamed = made_.emplace_back(at(op));
  renamed.name = std::move(name);
  ops_[index(op)] = &renamed;
}

void Graph::use(int op, int user) {
  users_[index(op)].push_back(user);
  ++uses_[index(op)];
  changes_.uses.push_back(op);
}

void Graph::release(int op, int user) {
  Users& users = users_[index(op)];
  *std::ranges::find(users, user) = users.back();
  users.pop_back();
  if (--uses_[index(op)] == 0) without_use_.push_back(op);
  changes_.uses.push_back(op);
}

void Graph::make_pending(int op) {
  State& state = state_[index(op)];
  if (state != State::settled) return;
  leave(op);
  state = State::pending;
}

// Forgets what the last rewriting left without use and marks `ops`. Takes the operations from the first change on out
// of the order, into `rest_`.
void Graph::begin(const std::vector<int>& ops) {
  changes_ = {};
  std::size_t first = placed_;
  std::ranges::sort(unneeded_, {}, [&](int op) { return place(op); });
  for (const int op : unneeded_) {
    first = std::min(first, index(place(op)));
    state_[index(op)] = State::gone;
    for (const int arg : at(op).args) {
      Users& users = users_[index(arg)];
      *std::ranges::find(users, op) = users.back();
      users.pop_back();
    }
  }
  unneeded_.clear();
  for (const int op : ops) {
    make_pending(op);
    state_[index(op)] = State::marked;
    first = std::min(first, index(place(op)));
  }
  rest_.assign(order_.data() + first, order_.data() + placed_);
  placed_ = first;
}

void Graph::rewrite(const std::vector<int>& ops, const Rewrite& rewrite) {
  if (!std::exchange(rewritten_, true)) enter_all();
  begin(ops);
  for (std::size_t i = 0; (i = append_settled(i)) < rest_.size(); ++i) {
    const int op = rest_[i];
    if (state_[index(op)] == State::gone) continue;
    if (!changes_.places.empty() && is_placed(op)) {  // moved to the front
      const auto late = late_names_.find(op);
      if (late != late_names_.end() && at(op).name.empty()) rename(op, late->second);
    } else if (state_[index(op)] == State::settled) {
      append(op);
    } else {
      settle(op, rewrite);
    }
  }
  late_names_.clear();
  drop_unneeded();
  effort_.spend(1 + placed_ / 8);
}

void Graph::settle(int op, const Rewrite& rewrite) {
  const std::size_t known = ops_.size();
  std::optional<int> made;
  if (state_[index(op)] == State::marked) made = rewrite(*this, at(op));
  if (!made) {
    Operands args = at(op).args;
    for (int& arg : args) arg = now(arg);
    made = rebuild(at(op), std::move(args));
  }
  if (index(*made) >= known && *made == order_[placed_ - 1] && *made + 1 == size()) take_over(op, *made);
  else forward(op, *made);
  effort_.spend(8 + at(op).args.size());
}

// A new operation takes the number of the one that it replaces, so the users of that one stay as they are.
void Graph::take_over(int op, int made) {
  const auto from = index(made), to = index(op);
  for (const int arg : at(op).args) release(arg, op);
  for (const int arg : at(made).args) {
    std::ranges::replace(users_[index(arg)], made, op);
  }
  leave(made);
  ops_[to] = ops_[from];
  hash_[to] = hash_[from];
  state_[to] = State::settled;
  enter(op);
  place_[to] = place_[from];
  order_[placed_ - 1] = op;
  ops_.pop_back(), uses_.pop_back(), place_.pop_back(), now_.pop_back(), next_.pop_back();
  hash_.pop_back(), users_.pop_back(), state_.pop_back();
  changes_.ops.back() = op;
  without_use_.push_back(op);
  // Users take in numbers, and the coefficients of sums with one term.
  const bool taken_in = at(op).kind == OpKind::number || (at(op).kind == OpKind::sum && at(op).args.size() == 1);
  for (const int user : users_[to]) {
    if (taken_in) make_pending(user);
  }
}

void Graph::forward(int op, int made) {
  now_[index(op)] = made;
  for (const int arg : at(op).args) release(arg, op);
  state_[index(op)] = State::gone;
  changes_.ops.push_back(op);
  for (Output& output : outputs_) {
    if (output.op != op) continue;
    output.op = made;
    --uses_[index(op)], ++uses_[index(made)];
    changes_.uses.push_back(made);
  }
  for (const int user : users_[index(op)]) make_pending(user);
}

void Graph::drop_unneeded() {
  while (!without_use_.empty()) {
    const int op = without_use_.back();
    without_use_.pop_back();
    if (op >= size() || state_[index(op)] != State::settled || uses_[index(op)] > 0) continue;
    leave(op);
    state_[index(op)] = State::unneeded;
    unneeded_.push_back(op);
    changes_.ops.push_back(op);
    for (const int arg : at(op).args) {
      if (--uses_[index(arg)] == 0) without_use_.push_back(arg);
      changes_.uses.push_back(arg);
    }
  }
}

Program Graph::program() const {
  Program program;
  program.ops.reserve(placed_);
  std::vector<int> to(ops_.size(), -1);
  for (const int op : order()) {
    if (state_[index(op)] != State::settled) continue;
    to[index(op)] = static_cast<int>(program.ops.size());
    Operation& copy = program.ops.emplace_back(at(op));
    for (int& arg : copy.args) arg = to[index(arg)];
  }
  for (const Output& output : outputs_) program.outputs.push_back({output.name, to[index(output.op)]});
  return program;
}

std::optional<Program> Graph::result() const {
  const bool is_same = !rewritten_ && unneeded_.empty();
  return is_same ? std::nullopt : std::optional(program());
}

}  // namespace cdot::derive
