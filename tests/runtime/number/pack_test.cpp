// A pack does lane by lane what its scalar does, to the bit.
#include <gtest/gtest.h>
#include <limits>

#include <cdot/pack.hpp>
#include <cdot/planar/registry.hpp>

namespace cdot {
namespace {

template <class P>
struct Lanes;
template <class T, int w>
struct Lanes<Pack<T, w>> {
  using Scalar = T;
  static constexpr int width = w;
};

template <class P>
class PackTest : public testing::Test {};
using Packs =
    testing::Types<Pack<float, 4>, Pack<float, 8>, Pack<float, 16>, Pack<double, 4>, Pack<double, 8>, Pack<double, 16>>;
TYPED_TEST_SUITE(PackTest, Packs);

template <class T>
bool same_bits(T a, T b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

// Numbers around zero, with special cases of division and square root.
template <class T>
T number(int i) {
  const T special[] = {T(0), -T(0), T(1), T(-1), std::numeric_limits<T>::min(), T(1e30)};
  return i % 3 == 0 ? special[(i / 3) % 6] : std::sin(T(i) * T(1.7)) * T(3);
}

// f of packs against f of their lanes.
template <class P, class F>
void expect_same_lanes(F f, const char* what) {
  using T = typename Lanes<P>::Scalar;
  constexpr int width = Lanes<P>::width;
  for (int start = 0; start < 60; ++start) {
    T x[width], y[width];
    for (int i = 0; i < width; ++i) x[i] = number<T>(start + i), y[i] = number<T>(2 * start + 5 * i);
    const P result = f(P::load(x), P::load(y));
    for (int i = 0; i < width; ++i) {
      const T expected = f(x[i], y[i]);
      const bool both_nan = std::isnan(expected) && std::isnan(result[i]);
      EXPECT_TRUE(both_nan || same_bits(expected, result[i])) << what << " of " << x[i] << ", " << y[i];
    }
  }
}

TYPED_TEST(PackTest, Operations) {
  using P = TypeParam;
  using std::abs, std::sqrt, std::sin, std::cos, std::tan, std::exp, std::log, std::atan2;
  expect_same_lanes<P>([](auto a, auto b) { return a + b; }, "+");
  expect_same_lanes<P>([](auto a, auto b) { return a - b; }, "-");
  expect_same_lanes<P>([](auto a, auto b) { return a * b; }, "*");
  expect_same_lanes<P>([](auto a, auto b) { return a / b; }, "/");
  expect_same_lanes<P>([](auto a, auto) { return -a; }, "negation");
  expect_same_lanes<P>([](auto a, auto b) { return a += b, a *= b, a -= b, a; }, "assignments");
  expect_same_lanes<P>([](auto a, auto) { return abs(a); }, "abs");
  expect_same_lanes<P>([](auto a, auto) { return sqrt(a); }, "sqrt");
  expect_same_lanes<P>([](auto a, auto) { return sin(a); }, "sin");
  expect_same_lanes<P>([](auto a, auto) { return cos(a); }, "cos");
  expect_same_lanes<P>([](auto a, auto) { return tan(a); }, "tan");
  expect_same_lanes<P>([](auto a, auto) { return exp(a); }, "exp");
  expect_same_lanes<P>([](auto a, auto) { return log(a); }, "log");
  expect_same_lanes<P>([](auto a, auto b) { return atan2(a, b); }, "atan2");
  expect_same_lanes<P>([](auto a, auto) { return inverse(a); }, "inverse");
}

TYPED_TEST(PackTest, ComparisonsAndSelects) {
  using P = TypeParam;
  expect_same_lanes<P>([](auto a, auto b) { return select(a < b, a, b); }, "<");
  expect_same_lanes<P>([](auto a, auto b) { return select(a <= b, a, b); }, "<=");
  expect_same_lanes<P>([](auto a, auto b) { return select(a > b, a, b); }, ">");
  expect_same_lanes<P>([](auto a, auto b) { return select(a >= b, a, b); }, ">=");
  expect_same_lanes<P>([](auto a, auto b) { return select(a == b, a, -b); }, "==");
  expect_same_lanes<P>([](auto a, auto b) { return select(a != b, a, -b); }, "!=");
  expect_same_lanes<P>([](auto a, auto b) { return select(a < b && !(a > b), a, a / b); },
                       "what is not chosen does not leak");
}

// C, J, K, its solution and the impulse of one joint, summed up.
template <class Joint, class T>
T evaluate(T x) {
  using std::sin, std::cos;
  constexpr int n = Joint::bodies, rows = Joint::rows;
  planar::Pose<T> q[n];
  planar::Velocity<T> v[n];
  planar::InverseMass<T> m[n];
  for (int k = 0; k < n; ++k) {
    const T angle = x * T(k + 1);
    q[k] = {x + T(k), x * x - T(2 * k), cos(angle), sin(angle), angle};
    v[k] = {x * T(3), T(k) - x, x * T(0.5)};
    m[k] = {T(1) + x * x, T(2) + T(k)};
  }
  typename Joint::template Parameters<T> p;
  T* numbers = reinterpret_cast<T*>(&p);
  for (size_t i = 0; i < sizeof p / sizeof(T); ++i) numbers[i] = T(0.1) * T(static_cast<int>(i)) + x;
  typename Joint::template Jacobian<T> J;
  T C[rows], K[rows * (rows + 1) / 2], F[rows * (rows + 1) / 2], b[rows], lambda[rows];
  Joint::jacobian(q, p, x, C, J);
  Joint::effective_mass(J, m, K);
  Joint::factor(K, F);
  Joint::velocity(J, v, b);
  Joint::solve(F, b, lambda);
  Joint::apply(J, m, lambda, v);
  T sum = C[0];
  for (const auto& body : v) sum = sum + body.x + body.y * T(2) + body.w * T(3);
  return sum;
}

template <class P, class Joint>
void expect_same_kernel() {
  expect_same_lanes<P>([](auto a, auto) { return evaluate<Joint>(a); }, Joint::name.data());
}

TYPED_TEST(PackTest, EveryJoint) {
  []<class... Joints>(std::type_identity<std::tuple<Joints...>>) {
    (expect_same_kernel<TypeParam, Joints>(), ...);
  }(std::type_identity<planar::Joints>{});
}

}  // namespace
}  // namespace cdot
