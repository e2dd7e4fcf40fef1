// Signs that hold at every pose; unknown ones count as any.
#include "derive/expression/sign.hpp"

#include <gtest/gtest.h>

#include "derive/expression/functions.hpp"

namespace cdot::derive {
namespace {

TEST(Sign, OfSquaresLengthsAndWhatIsMadeOfThem) {
  Pool pool(3);
  const Expr x = pool.symbol("x", Role::parameter), y = pool.symbol("y", Role::parameter);
  const Expr u = pool.vector_symbol("u", Role::parameter), v = pool.vector_symbol("v", Role::parameter);
  for (const Expr e : {pool.number(0), pool.number(2), x * x, x * x * y * y, norm(u), dot(u, u), x * x + norm(u),
                       pow(norm(u), -1), pow(x, -2) * norm(v), pow(x, 4) + pool.number(1)})
    EXPECT_TRUE(is_never_negative(e)) << text(e);
  for (const Expr e : {pool.number(-1), x, x * y, pow(x, 3), pow(x, -1), dot(u, v), norm(u) - norm(v), x * norm(u),
                       x * x - pool.number(1), -norm(u)})
    EXPECT_FALSE(is_never_negative(e)) << text(e);
}

}  // namespace
}  // namespace cdot::derive
