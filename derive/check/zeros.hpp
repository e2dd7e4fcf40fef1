// Whether a quantity can be 0 while C = 0: by search, from the poses with C = 0.
#pragma once

#include "derive/check/parts.hpp"

namespace cdot::derive {

enum class Reach { never, parameters, bodies };  // bodies: while the parameters have their values

struct Zero {
  Reach reach = Reach::never;
  std::optional<Sample> pose{};  // the first that was found
};

class Zeros {
 public:
  explicit Zeros(const Subject& subject);

  // Where this scalar or vector is 0. If the search was too long, or if no pose with C = 0 is known, it may be.
  // Rows of which it is a divisor, or whose direction it is, have any value beside it.
  Zero of(Expr e) { return of(components_of(e), e); }
  // Where both are 0.
  Zero of(Expr e, Expr other) { return of(std::vector{e, other}, {}); }

 private:
  Zero of(const std::vector<Expr>& scalars, Expr divisor);
  bool is_constant(const std::vector<Expr>& scalars) const;
  bool reaches(const std::vector<Expr>& equations, Sample& sample, bool only_bodies);

  const Subject& subject_;
  std::vector<Expr> C_;         // of equations: an inequality leaves its kink free
  std::vector<Sample> starts_;  // with C = 0
  std::vector<Sample> moved_;   // the usual pose, moved with C = 0: on one branch of it
  double work_ = 0;
};

}  // namespace cdot::derive
