// The stiffness of tension in space, as text: inverse inertias (I + h G / 4)^-1 with the positive part of G.
#pragma once

#include <string>
#include <vector>

#include "derive/compile/methods/contents.hpp"
#include "derive/compile/scene/mechanism.hpp"

namespace cdot::compile {

// Functions that are the same in all scenes.
inline constexpr const char* tension = R"(#ifndef CDOT_SCENE_TENSION
#define CDOT_SCENE_TENSION
namespace cdot::scenes {

template <class T>
inline Tensor<T> inverse_of(const Tensor<T>& S) {
  const T xx = S.yy * S.zz - S.yz * S.yz, xy = S.xz * S.yz - S.xy * S.zz, xz = S.xy * S.yz - S.xz * S.yy;
  const T scale = T(1) / (S.xx * xx + S.xy * xy + S.xz * xz);
  return {scale * xx, scale * (S.xx * S.zz - S.xz * S.xz), scale * (S.xx * S.yy - S.xy * S.xy),
          scale * xy, scale * xz, scale * (S.xy * S.xz - S.xx * S.yz)};
}

// By four sweeps of Jacobi's rotations.
template <class T>
inline Tensor<T> positive_part(const Tensor<T>& S) {
  T A[3][3] = {{S.xx, S.xy, S.xz}, {S.xy, S.yy, S.yz}, {S.xz, S.yz, S.zz}};
  T V[3][3] = {{T(1), T(0), T(0)}, {T(0), T(1), T(0)}, {T(0), T(0), T(1)}};  // its columns become the eigenvectors
  for (int pair = 0; pair < 12; ++pair) {
    const int i = pair % 3 == 2, j = pair % 3 == 0 ? 1 : 2;
    const auto turns = A[i][j] < T(0) || A[i][j] > T(0);
    const T half = (A[j][j] - A[i][i]) / select(turns, T(2) * A[i][j], T(1));
    const T tangent = select(half < T(0), T(-1), T(1)) / (select(half < T(0), -half, half) + root(half * half + T(1)));
    const T t = select(turns, tangent, T(0)), c = T(1) / root(t * t + T(1)), s = t * c;
    for (int k = 0; k < 3; ++k) {
      const T a = A[k][i], b = A[k][j], u = V[k][i], v = V[k][j];
      A[k][i] = c * a - s * b, A[k][j] = s * a + c * b;
      V[k][i] = c * u - s * v, V[k][j] = s * u + c * v;
    }
    for (int k = 0; k < 3; ++k) {
      const T a = A[i][k], b = A[j][k];
      A[i][k] = c * a - s * b, A[j][k] = s * a + c * b;
    }
  }
  Tensor<T> sum = {T(0), T(0), T(0), T(0), T(0), T(0)};
  for (int k = 0; k < 3; ++k) {
    const T x = V[0][k], y = V[1][k], z = V[2][k], of = select(A[k][k] > T(0), A[k][k], T(0));
    sum.xx = sum.xx + of * x * x, sum.yy = sum.yy + of * y * y, sum.zz = sum.zz + of * z * z;
    sum.xy = sum.xy + of * x * y, sum.xz = sum.xz + of * x * z, sum.yz = sum.yz + of * y * z;
  }
  return sum;
}

template <class T>
inline Tensor<T> stiffened(const Tensor<T>& I, const T& h, const Tensor<T>& G) {
  const Tensor<T> P = positive_part(G);
  return inverse_of(Tensor<T>{I.xx + h * P.xx, I.yy + h * P.yy, I.zz + h * P.zz, I.xy + h * P.xy, I.xz + h * P.xz,
                              I.yz + h * P.yz});
}

}  // namespace cdot::scenes
#endif

)";

// The types of its numbers.
std::string taut_type(std::size_t rows, std::size_t numbers);
// The arguments of impulses, of joints and of rows with bounds.
std::string impulses_of(const Contents& has);
// stiffen(), by the program tension().
std::string stiffen_of(const Mechanism& mechanism, const std::vector<std::string>& names, const Contents& has);

}  // namespace cdot::compile
