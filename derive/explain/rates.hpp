// Time derivatives rule by rule: the forms that derivation/differentiate.cpp's rules have before they are
// simplified, each with its name. What has a name is differentiated once and then called by it
// (u_dot).
#pragma once

#include <set>

#include "derive/explain/explain.hpp"

namespace cdot::derive {

class Rates {
 public:
  Rates(const Joint& joint, const Notation& notation) : joint_(joint), notation_(notation) {}

  // left = d e/dt by its rules = the same with all names inserted. Before it come the chains of the
  // names it needs that no earlier call has introduced.
  std::vector<Chain> differentiate(Expr e, Formula left);

  // d e/dt with all names inserted: a form in which only v and w move.
  Formula inserted(Expr e);

 private:
  std::optional<Formula> rate(Expr e, bool root);
  std::optional<Formula> rule(Expr e);
  std::optional<Formula> symbol_rule(Expr e);
  std::optional<Formula> sum_rule(Expr e);
  std::optional<Formula> product_rule(Expr e);
  std::optional<Formula> pair_rule(Expr e);
  std::optional<Formula> scale_rule(Expr e);
  std::optional<Formula> unit_rule(Expr e);
  std::optional<Formula> function_rule(Expr e);
  Formula function_rate(Expr e, Formula rate);
  std::optional<Formula> angle_rule(const AngleBetween& angle);
  std::optional<Formula> turning(Expr u);

  Formula by_name(Expr e, const std::string& name);
  Formula turned(Expr s) const;  // w × s
  Formula turned_again(Expr w, Expr r);
  Chain chain(Expr e, Formula left);
  std::size_t place_of(std::string name) const;  // among the author's lets
  void used(const std::string& rule);

  const Joint& joint_;
  const Notation& notation_;
  bool insert_ = false;
  std::set<std::string> introduced_;
  std::vector<std::string> rules_;
  std::vector<Chain> chains_;
};

}  // namespace cdot::derive
