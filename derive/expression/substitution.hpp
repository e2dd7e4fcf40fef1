// Leaves, or any nodes, to others, in many expressions: each node is rebuilt once.
#pragma once

#include <map>
#include <unordered_map>

#include "derive/expression/expr.hpp"

namespace cdot::derive {

class Substitution {
 public:
  explicit Substitution(const std::map<const Node*, Expr>& replacements, KeepNames names = KeepNames::yes)
      : done_(replacements.begin(), replacements.end()), names_(names) {}
  Expr of(Expr e);

 private:
  std::unordered_map<const Node*, Expr> done_;
  KeepNames names_;
};

}  // namespace cdot::derive
