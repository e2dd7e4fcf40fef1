// Numbers of rows that follow functions of time: their values at the time of an evaluation, and what their rates add to
// dC/dt, to gamma, to prescribed speeds and to energies.
#pragma once

#include <cmath>
#include <limits>
#include <type_traits>

#include <cdot/detail/block.hpp>
#include <cdot/detail/jet.hpp>

namespace cdot {

// Writes the numbers in time of the slots [begin, end).
template <class S>
[[gnu::noinline]] void follow(Batch<S>& batch, int begin, int end, typename S::Scalar time) {
  using T = typename S::Scalar;
  for (int slot = begin; slot < end; ++slot) {
    const ProfileSpan span{batch.spans[2 * slot], batch.spans[2 * slot + 1]};
    for (Drive& drive : batch.drives_of(slot)) {
      drive.now = drive.profile.at(double(time), span);
      const double value = drive.now.value;
      const bool allowed = drive.above < value && value < drive.below;
      auto& numbers = drive.of_row ? batch.constants : batch.parameters;
      const int width = drive.of_row ? batch.law->constants : batch.ops->parameter_size;
      numbers[slot * width + drive.number] = allowed ? T(value + drive.offset) : std::numeric_limits<T>::quiet_NaN();
    }
  }
}

// The parameters of a slot with their rates. Numbers is Parameters<Jet<T>> of a joint or an effect.
template <class Numbers, class S>
Numbers jets_of(const Batch<S>& batch, int slot, bool of_row) {
  using T = typename S::Scalar;
  Numbers jets{};
  if constexpr (!std::is_empty_v<Numbers>) {
    const int count = of_row ? batch.law->constants : batch.ops->parameter_size;
    const T* const from = (of_row ? batch.constants : batch.parameters).data() + slot * count;
    auto* const to = reinterpret_cast<Jet<T>*>(&jets);
    for (int k = 0; k < count; ++k) to[k] = from[k];
    for (const Drive& drive : batch.drives_of(slot))
      if (drive.of_row == of_row)
        to[drive.number].first = T(drive.now.rate), to[drive.number].second = T(drive.now.acceleration);
  }
  return jets;
}

// The same velocity at all times.
template <class T>
planar::Velocity<Jet<T>> steady(const planar::Velocity<T>& v) {
  return {v.x, v.y, v.w};
}
template <class T>
spatial::Velocity<Jet<T>> steady(const spatial::Velocity<T>& v) {
  return {v.x, v.y, v.z, v.wx, v.wy, v.wz};
}

// A body that moves at the velocity v without acceleration.
template <class T>
planar::Pose<Jet<T>> moving(const planar::Pose<T>& q, const planar::Velocity<T>& v) {
  return {{q.x, v.x, T(0)},
          {q.y, v.y, T(0)},
          {q.c, -q.s * v.w, -q.c * v.w * v.w},
          {q.s, q.c * v.w, -q.s * v.w * v.w},
          {q.angle, v.w, T(0)}};
}

// de/dt = w e / 2 as quaternions, so that its derivative is -|w|^2 e / 4; axes of the body a: w x a and w x (w x a).
template <class T>
spatial::Pose<Jet<T>> moving(const spatial::Pose<T>& q, const spatial::Velocity<T>& v) {
  const T x = v.wx, y = v.wy, z = v.wz, square = x * x + y * y + z * z, half = T(0.5);
  const auto parameter = [&](T e, T rate) { return Jet<T>{e, half * rate, T(-0.25) * square * e}; };
  struct Axis {
    Jet<T> x, y, z;
  };
  const auto axis = [&](T ax, T ay, T az) {
    const T dx = y * az - z * ay, dy = z * ax - x * az, dz = x * ay - y * ax;
    return Axis{{ax, dx, y * dz - z * dy}, {ay, dy, z * dx - x * dz}, {az, dz, x * dy - y * dx}};
  };
  const Axis first = axis(q.xx, q.yx, q.zx), second = axis(q.xy, q.yy, q.zy), third = axis(q.xz, q.yz, q.zz);
  return {{q.x, v.x, T(0)},
          {q.y, v.y, T(0)},
          {q.z, v.z, T(0)},
          parameter(q.e0, -x * q.e1 - y * q.e2 - z * q.e3),
          parameter(q.e1, x * q.e0 + y * q.e3 - z * q.e2),
          parameter(q.e2, y * q.e0 + z * q.e1 - x * q.e3),
          parameter(q.e3, z * q.e0 + x * q.e2 - y * q.e1),
          first.x,
          second.x,
          third.x,
          first.y,
          second.y,
          third.y,
          first.z,
          second.z,
          third.z};
}

}  // namespace cdot
