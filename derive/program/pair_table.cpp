#include "derive/program/pair_table.hpp"

#include <algorithm>
#include <bit>
#include <compare>

namespace cdot::derive {
namespace {

std::size_t at_index(int i) { return static_cast<std::size_t>(i); }

std::size_t hash_of(int x, int y, Rational ratio) {
  std::uint64_t hash = 0;
  for (const std::int64_t n : {std::int64_t{x}, std::int64_t{y}, ratio.num(), ratio.den()}) {
    hash = (hash ^ static_cast<std::uint64_t>(n)) * 0x9E3779B97F4A7C15u;
    hash ^= hash >> 32;
  }
  return hash;
}

}  // namespace

PairTable::PairTable(const Graph& graph, OpKind kind, Effort& effort) : graph_(graph), kind_(kind), effort_(effort) {
  std::size_t pairs = 64;
  for (int op = 0; op < graph.size(); ++op) {
    const std::size_t n = counts(op) ? graph.at(op).args.size() : 0;
    pairs += n * n / 2;
  }
  entries_.reserve(pairs), slots_.assign(std::bit_ceil(pairs), -1);
  for (int op = 0; op < graph.size(); ++op) update(op);
}

void PairTable::follow() {
  for (const int op : graph_.changes().ops) update(op);
}

// How often the i-th and the j-th operand occur as a pair. x^4 = (x^2)^2 has the pair x x twice, x^2 y^2 = (x y)^2 the
// pair x y.
int PairTable::times(const Operation& counted, std::size_t i, std::size_t j) const {
  if (kind_ == OpKind::product) {
    return i == j ? counted.exponents[i] / 2 : std::min(counted.exponents[i], counted.exponents[j]);
  }
  if (i == j) return 0;
  // The difference of two positions cancels what is large in both: neither is ever paired with anything else.
  const bool alike = graph_.at(counted.args[i]).is_position == graph_.at(counted.args[j]).is_position;
  return alike || counted.args.size() == 2 ? 1 : 0;
}

// Which operands of `from` are missing in `to`, or have another coefficient or exponent there: into `changed_`.
void PairTable::compare(const Operation& from, const Operation& to) {
  changed_.assign(from.args.size(), true);
  if (to.args.empty() || (from.args.size() > 2) != (to.args.size() > 2)) return;
  position_.resize(at_index(graph_.size()));
  for (std::size_t i = 0; i < to.args.size(); ++i) position_[at_index(to.args[i])] = i + 1;
  for (std::size_t i = 0; i < from.args.size(); ++i) {
    const std::size_t same = position_[at_index(from.args[i])];
    if (same == 0) continue;
    changed_[i] =
        kind_ == OpKind::sum ? from.coefs[i] != to.coefs[same - 1] : from.exponents[i] != to.exponents[same - 1];
  }
  for (const int arg : to.args) position_[at_index(arg)] = 0;
}

void PairTable::update(int op) {
  static const Operation none;
  if (at_index(op) >= counted_.size()) counted_.resize(at_index(graph_.size()), nullptr);
  const Operation* now = counts(op) ? &graph_.at(op) : nullptr;
  const Operation* before = std::exchange(counted_[at_index(op)], now);
  if (now == before) return;
  const auto pairs_of = [](const Operation* counted) -> const Operation& { return counted ? *counted : none; };
  add(pairs_of(before), pairs_of(now), op, -1);
  add(pairs_of(now), pairs_of(before), op, 1);
}

// The pairs of `counted` that `other` has not.
void PairTable::add(const Operation& counted, const Operation& other, int op, int sign) {
  compare(counted, other);
  for (std::size_t i = 0; i < changed_.size(); ++i) {
    if (!changed_[i]) continue;
    effort_.spend(changed_.size());
    for (std::size_t j = 0; j < changed_.size(); ++j) {
      if (j >= i || !changed_[j]) add_pair(counted, i, j, op, sign);
    }
  }
}

void PairTable::add_pair(const Operation& counted, std::size_t i, std::size_t j, int op, int sign) {
  const int n = times(counted, i, j);
  if (n == 0) return;
  if (counted.args[i] > counted.args[j]) std::swap(i, j);
  const Rational ratio = kind_ == OpKind::sum ? counted.coefs[j] / counted.coefs[i] : Rational(1);
  const int id = entry({counted.args[i], counted.args[j], ratio});
  Entry& entry = entries_[at_index(id)];
  if (sign > 0) {
    entry.in.push_back({op, n});
  } else {
    *std::ranges::find(entry.in, op, &Occurrence::op) = entry.in.back();
    entry.in.pop_back();
  }
  move_to_bucket(id, entry.count + sign * n);
}

int PairTable::entry(const Key& key) {
  const std::size_t hash = hash_of(key.x, key.y, key.ratio);
  for (int known = slots_[hash & (slots_.size() - 1)]; known >= 0; known = entries_[at_index(known)].next)
    if (entries_[at_index(known)].hash == hash && entries_[at_index(known)].key == key) return known;
  if (free_.empty()) {
    free_.push_back(static_cast<int>(entries_.size()));
    entries_.emplace_back();
    if (entries_.size() > slots_.size()) {  // no entry is free
      slots_.assign(2 * slots_.size(), -1);
      for (int other = 0; other < free_.back(); ++other) enter(other);
    }
  }
  const int made = free_.back();
  free_.pop_back();
  entries_[at_index(made)].key = key, entries_[at_index(made)].hash = hash;
  enter(made);
  return made;
}

void PairTable::enter(int entry) {
  int& first = slots_[entries_[at_index(entry)].hash & (slots_.size() - 1)];
  entries_[at_index(entry)].next = std::exchange(first, entry);
}

void PairTable::leave(int entry) {
  int* link = &slots_[entries_[at_index(entry)].hash & (slots_.size() - 1)];
  while (*link != entry) link = &entries_[at_index(*link)].next;
  *link = entries_[at_index(entry)].next;
}

void PairTable::move_to_bucket(int id, int count) {
  Entry& entry = entries_[at_index(id)];
  if (entry.count > 1) {
    std::vector<int>& bucket = buckets_[at_index(entry.count)];
    bucket[entry.slot] = bucket.back();
    entries_[at_index(bucket.back())].slot = entry.slot;
    bucket.pop_back();
  }
  entry.count = count;
  if (count > 1) {
    if (at_index(count) >= buckets_.size()) buckets_.resize(at_index(count) + 1);
    entry.slot = buckets_[at_index(count)].size();
    buckets_[at_index(count)].push_back(id);
  } else if (count == 0) {
    leave(id);
    free_.push_back(id);
  }
}

struct PairTable::Rank {
  bool has_number = false;
  int last_place = 0, last = 0;
};

PairTable::Rank PairTable::rank(const Entry& entry) const {
  const auto is_number = [&](int op) { return graph_.at(op).kind == OpKind::factor; };
  Rank rank{is_number(entry.key.x) || is_number(entry.key.y), -1, 0};
  for (const Occurrence& occurrence : entry.in) {
    const int place = graph_.place(occurrence.op);
    if (place > rank.last_place) rank.last_place = place, rank.last = occurrence.op;
  }
  return rank;
}

// Where an operation has the two operands: its pairs are counted in the order of the first, then of the second.
std::pair<std::size_t, std::size_t> PairTable::positions(const Entry& entry, int op) const {
  const std::size_t x = index_of(graph_.at(op).args, entry.key.x), y = index_of(graph_.at(op).args, entry.key.y);
  return std::minmax(x, y);
}

std::optional<Pair> PairTable::most_frequent() const {
  std::size_t count = buckets_.size();
  while (count > 0 && buckets_[count - 1].empty()) --count;
  if (count == 0) return std::nullopt;
  const Entry* best = nullptr;
  Rank best_rank;
  for (const int id : buckets_[count - 1]) {
    const Entry& entry = entries_[at_index(id)];
    effort_.spend(entry.in.size());
    const Rank r = rank(entry);
    if (best) {
      const auto key = [](const Rank& k) { return std::pair(k.has_number, k.last_place); };
      const auto order = key(r) <=> key(best_rank);
      if (order > 0 || (order == 0 && positions(entry, r.last) > positions(*best, r.last))) continue;
    }
    best = &entry, best_rank = r;
  }
  const auto& [x, y, ratio] = best->key;
  if (graph_.place(x) <= graph_.place(y)) return Pair{x, y, ratio};
  return Pair{y, x, Rational(1) / ratio};
}

}  // namespace cdot::derive
