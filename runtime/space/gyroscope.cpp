// A free body's inertia and spin -> its mean spin during a step: in closed form for symmetric bodies, by Newton for
// others.
#include <cmath>
#include <limits>

#include <cdot/gyroscope.hpp>
#include <cdot/spaces.hpp>

namespace cdot::spatial {
namespace {

// sin(a) / a and (1 - cos a) / a^2 of a rotation about theta, a = |theta|.
template <class T>
struct Rodrigues {
  T sinc, versine;
};

// From a^2. The series to round-off cost a third of a square root, a sine and a cosine.
template <class T>
Rodrigues<T> rodrigues(T square) {
  if (square < T(0.25)) {
    const auto series = [&](auto... factors) {  // 1 - x / f1 (1 - x / f2 (...))
      T sum = 1;
      ((sum = T(1) - square * (T(1) / T(factors)) * sum), ...);
      return sum;
    };
    return {series(14 * 15, 12 * 13, 10 * 11, 8 * 9, 6 * 7, 4 * 5, 2 * 3),
            T(0.5) * series(15 * 16, 13 * 14, 11 * 12, 9 * 10, 7 * 8, 5 * 6, 3 * 4)};
  }
  const T angle = std::sqrt(square), s = half_sinc(angle);
  return {T(2) * s * std::cos(angle / 2), T(2) * s * s};
}

// Solves (I - b x T) d = I r for d. T(theta) = E - versine theta x + (theta x)^2 (1 - sinc) / a^2 is the tangent map:
// exp(-theta - d) is exp(-theta) followed by a rotation by -T d.
template <class T>
Vector<T> newton_step(const Symmetric<T>& I, const Vector<T>& b, const Vector<T>& theta, T sinc, T versine,
                      const Vector<T>& r) {
  const T square = dot(theta, theta), along = dot(b, theta);
  const T last = square < T(0.25) ? T(1) / T(6) - square / T(120) : (T(1) - sinc) / square;
  // b x T = v x + diagonal - theta u^T
  const Vector<T> v = b - (last * along) * theta, u = versine * b - last * cross(b, theta);
  const T diagonal = versine * along;
  const Vector<T> first = Vector<T>{I.xx - diagonal, I.xy - v.z, I.xz + v.y} + u.x * theta,
                  second = Vector<T>{I.xy + v.z, I.yy - diagonal, I.yz - v.x} + u.y * theta,
                  third = Vector<T>{I.xz - v.y, I.yz + v.x, I.zz - diagonal} + u.z * theta, right = I * r;
  const Vector<T> across = cross(second, third);
  const T scale = T(1) / dot(first, across);
  return scale * Vector<T>{dot(right, across), dot(right, cross(third, first)), dot(right, cross(first, second))};
}

// W after a step of h by Taylor's series of I dW/dt = I W x W; W itself if the step is too long for the series.
template <class T>
Vector<T> expected_spin(const Symmetric<T>& I, const Symmetric<T>& inverse, const Vector<T>& W, T h) {
  if (!(h * h * dot(W, W) < T(0.25))) return W;
  const Vector<T> momentum = I * W, rate = inverse * cross(momentum, W);
  const Vector<T> bend = inverse * (cross(I * rate, W) + cross(momentum, rate));
  return W + h * (rate + (T(0.5) * h) * bend);
}

// The frame axis of symmetry: the moments about the other two axes are equal. Zero if no axis has this property.
template <class T>
Vector<T> symmetry_axis(const Symmetric<T>& I) {
  const T slight = T(8) * std::numeric_limits<T>::epsilon() * (I.xx + I.yy + I.zz);
  if (std::abs(I.xy) + std::abs(I.xz) + std::abs(I.yz) > slight) return {0, 0, 0};
  const auto equal = [&](T a, T b) { return std::abs(a - b) <= slight; };
  return equal(I.xx, I.yy)   ? Vector<T>{0, 0, 1}
         : equal(I.yy, I.zz) ? Vector<T>{1, 0, 0}
         : equal(I.xx, I.zz) ? Vector<T>{0, 1, 0}
                             : Vector<T>{0, 0, 0};
}

// The mean spin of a symmetric body in closed form. The body precesses about L at the rate L / I1 and rotates about its
// axis e at (W . e) (1 - I3 / I1). The mean spin is the product of both rotations, as a rotation vector over h.
template <class T>
Vector<T> symmetric_spin(const Vector<T>& e, const Vector<T>& W, const Vector<T>& momentum, T I1, T h) {
  const Vector<T> round = (h / I1) * momentum, rest = (h * dot(W, e) - dot(round, e)) * e;
  const auto half_turn = [](const Vector<T>& turn) { return std::cos(T(0.5) * norm(turn)); };
  const Vector<T> a = half_sinc(norm(round)) * round, b = half_sinc(norm(rest)) * rest;
  const T a0 = half_turn(round), b0 = half_turn(rest);
  const Vector<T> c = b0 * a + a0 * b + cross(a, b);
  const T sine = norm(c);
  return sine > T(0) ? (T(2) * std::atan2(sine, a0 * b0 - dot(a, b)) / (h * sine)) * c : W;
}

}  // namespace

template <class T>
Vector<T> mean_spin(const Gyroscope<T>& gyroscope, const Pose<T>& q, const Vector<T>& w, T h) {
  const T unit = unit_of(gyroscope.inertia);  // the rotation does not depend on the scale of the inertia
  const Symmetric<T> I = unit * gyroscope.inertia, inverse = (T(1) / unit) * gyroscope.inverse;
  const Vector<T> before = to_body(q, w), momentum = I * before;
  const Vector<T> axis = symmetry_axis(I);
  if (dot(axis, axis) > T(0)) {
    const T across = T(0.5) * (I.xx + I.yy + I.zz - dot(axis, I * axis));
    return to_world(q, symmetric_spin(axis, before, momentum, across, h));
  }
  const T round_off = std::numeric_limits<T>::epsilon() * norm(before);
  // Newton reduces an error d to less than this times d^2: I^-1 of h^2 / 8 d x (d x I W).
  const T curvature = T(0.125) * h * h * (inverse.xx + inverse.yy + inverse.zz) * norm(momentum);
  Vector<T> after = expected_spin(I, inverse, before, h), best = before;
  T smallest_residual = std::numeric_limits<T>::infinity();
  for (int round = 0; round < 12; ++round) {
    const Vector<T> mean = T(0.5) * (before + after);
    // exp(-theta) L by Rodrigues: L - sinc theta x L + (1 - cos) / angle^2 theta x (theta x L)
    const Vector<T> theta = h * mean;
    const auto [sinc, versine] = rodrigues(dot(theta, theta));
    const Vector<T> across = cross(theta, momentum);
    const Vector<T> turned = momentum - sinc * across + versine * cross(theta, across);
    const Vector<T> residual = after - inverse * turned;
    const T size = norm(residual);
    const bool converges = size < T(0.5) * smallest_residual;
    if (size < smallest_residual) best = mean, smallest_residual = size;
    if (!converges || size <= round_off) break;
    // d(exp(-theta) L) = turned x (T dtheta); dtheta = h/2 dW
    const Vector<T> step = newton_step(I, (T(0.5) * h) * turned, theta, sinc, versine, residual);
    after = after - step;
    if (curvature * dot(step, step) <= round_off) {
      best = T(0.5) * (before + after);
      break;
    }
  }
  // A vector with a large residual may be far from any possible spin.
  return to_world(q, smallest_residual < T(0.5) * norm(before) ? best : before);
}

#define CDOT_INSTANTIATE(T) template Vector<T> mean_spin(const Gyroscope<T>&, const Pose<T>&, const Vector<T>&, T);
CDOT_FOR_EACH_NUMBER(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot::spatial
