// Checks an inertia tensor, for scenes and for Worlds.
#include <cdot/settings.hpp>

namespace cdot {

const char* mistake_in(const Inertia& I) {
  if (I.xx == 0 && I.yy == 0 && I.zz == 0 && I.xy == 0 && I.xz == 0 && I.yz == 0) return nullptr;
  const double minor = I.xx * I.yy - I.xy * I.xy;
  const double determinant = minor * I.zz - I.xx * I.yz * I.yz - I.yy * I.xz * I.xz + 2 * I.xy * I.xz * I.yz;
  if (!(I.xx > 0 && minor > 0 && determinant > 0))
    return "an inertia tensor must be positive definite, or 0 for a point mass";
  // No principal moment exceeds the sum of the others: with half = trace / 2, the tensor of second moments half E - I
  // is positive semidefinite.
  const double half = (I.xx + I.yy + I.zz) / 2, slack = -1e-9 * half;
  const double x = half - I.xx, y = half - I.yy, z = half - I.zz;
  const double determinant_of_moments =
      (x * y - I.xy * I.xy) * z - x * I.yz * I.yz - y * I.xz * I.xz - 2 * I.xy * I.xz * I.yz;
  if (x >= slack && y >= slack && z >= slack && x * y - I.xy * I.xy >= slack * half &&
      x * z - I.xz * I.xz >= slack * half && y * z - I.yz * I.yz >= slack * half &&
      determinant_of_moments >= slack * half * half)
    return nullptr;
  return "no rigid body has this inertia tensor: a principal moment exceeds the sum of the other two";
}

}  // namespace cdot
