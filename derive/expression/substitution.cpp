#include "derive/expression/substitution.hpp"

namespace cdot::derive {

Expr Substitution::of(Expr e) {
  if (const auto found = done_.find(&*e); found != done_.end()) return found->second;
  std::vector<Expr> args;
  for (const Expr arg : e->args) args.push_back(of(arg));
  const Expr rebuilt = args == e->args ? e : rebuild(e, args);
  if (names_ == KeepNames::yes && rebuilt != e && !e->name.empty()) e->pool->name(rebuilt, e->name, e->named_by_let);
  done_.emplace(&*e, rebuilt);
  return rebuilt;
}

Expr substitute(Expr e, const std::map<const Node*, Expr>& replacements, KeepNames names) {
  return Substitution(replacements, names).of(e);
}

}  // namespace cdot::derive
