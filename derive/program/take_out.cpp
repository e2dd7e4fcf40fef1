// The pass that takes common factors out of sums.
#include <algorithm>
#include <utility>

#include "derive/program/rewrite.hpp"

namespace cdot::derive {
namespace {

// A factor of several terms of a sum.
struct Common {
  int factor = -1;
  std::size_t terms = 0;
};

// A product that only this sum uses: its factors can be taken out without computing anything twice.
bool is_own_product(const Graph& graph, int term) {
  return graph.at(term).kind == OpKind::product && graph.uses(term) == 1;
}

// The factor that most terms have; of equals the first.
Common most_common(const Graph& graph, const Operation& sum) {
  std::vector<int> factors;
  for (const int arg : sum.args) {
    const Operation& term = graph.at(arg);
    if (is_own_product(graph, arg)) factors.insert(factors.end(), term.args.begin(), term.args.end());
    else factors.push_back(arg);
  }
  std::ranges::sort(factors, {}, [&](int factor) { return graph.place(factor); });
  Common best;
  for (std::size_t i = 0, n = 0; i < factors.size(); ++i) {
    n = i > 0 && factors[i] == factors[i - 1] ? n + 1 : 1;
    if (n > std::max<std::size_t>(best.terms, 1)) best = {factors[i], n};
  }
  return best;
}

// The most common factor of every sum.
class CommonFactors {
 public:
  CommonFactors(const Graph& graph, Effort& effort) : graph_(graph), effort_(effort) {
    for (int op = 0; op < graph.size(); ++op) mark(op);
  }

  // Takes in what the last rewriting changed.
  void follow() {
    const Graph::Changes& changes = graph_.changes();
    for (const int op : changes.ops) mark(op), mark_users(op);
    for (const int op : changes.uses) {
      if (graph_.at(op).kind == OpKind::product) mark_users(op);
    }
    for (const int op : changes.places) {
      mark_users(op);
      for (const int user : graph_.users(op)) mark_users(user);
    }
  }

  // The sum with the most terms that have a factor in common, of equals the first; -1 if there is none.
  int best() {
    for (const int op : marked_) {
      const bool is_sum = graph_.is_needed(op) && graph_.at(op).kind == OpKind::sum;
      const Common before = std::exchange(common_[place(op)], is_sum ? most_common(graph_, graph_.at(op)) : Common{});
      if (before.terms == 0 && common_[place(op)].terms > 0) candidates_.push_back(op);
      effort_.spend(1 + graph_.at(op).args.size());
      is_marked_[place(op)] = false;
    }
    marked_.clear();
    std::erase_if(candidates_, [&](int op) { return common_[place(op)].terms == 0; });
    const auto rank = [&](int op) { return std::pair(common_[place(op)].terms, -graph_.place(op)); };
    const auto best = std::ranges::max_element(candidates_, {}, rank);
    return best == candidates_.end() ? -1 : *best;
  }
  int factor_of(int sum) const { return common_[place(sum)].factor; }

 private:
  static std::size_t place(int op) { return static_cast<std::size_t>(op); }
  void mark(int op) {
    common_.resize(std::max(common_.size(), place(graph_.size())));
    is_marked_.resize(common_.size());
    if (is_marked_[place(op)]) return;
    is_marked_[place(op)] = true;
    marked_.push_back(op);
  }
  void mark_users(int op) {
    for (const int user : graph_.users(op)) mark(user);
  }

  const Graph& graph_;
  Effort& effort_;
  std::vector<Common> common_;  // by operation
  std::vector<bool> is_marked_;
  std::vector<int> marked_;
  std::vector<int> candidates_;  // sums with a common factor
};

// a x + b x as x (a + b), besides the terms without x.
int taken_out(Graph& graph, const Operation& sum, int factor) {
  Summands inner, outer;
  for (std::size_t i = 0; i < sum.args.size(); ++i) {
    const int arg = sum.args[i];
    const Operation& term = graph.at(arg);
    const bool contains = is_own_product(graph, arg) && index_of(term.args, factor) < term.args.size();
    if (arg != factor && !contains) {
      outer.add(sum.coefs[i], arg);
      continue;
    }
    Operands args, exponents;
    if (arg != factor) {
      for (std::size_t k = 0; k < term.args.size(); ++k) {
        const int left = term.exponents[k] - (term.args[k] == factor ? 1 : 0);
        if (left == 0) continue;
        args.push_back(term.args[k]);
        exponents.push_back(left);
      }
    }
    inner.add(sum.coefs[i], graph.product(std::move(args), std::move(exponents)));
  }
  const int rest = graph.sum(std::move(inner));
  outer.add(Rational(1), graph.product({factor, rest}, {1, 1}));
  return graph.sum(std::move(outer), sum.name);
}

}  // namespace

Passed take_out_factors(const Program& program, Effort& effort) {
  Graph graph(program, effort);
  CommonFactors factors(graph, effort);
  for (int sum = -1; !effort.spent() && (sum = factors.best()) >= 0; factors.follow()) {
    graph.rewrite({sum}, [&](Graph&, const Operation& op) { return taken_out(graph, op, factors.factor_of(sum)); });
  }
  return graph.result();
}

}  // namespace cdot::derive
