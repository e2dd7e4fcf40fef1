// Rows that are nearly redundant, as of a closed loop of which one part is slightly too long: no motion satisfies them
// but a large one. Such a row is treated like a redundant row, so least squares share its error.
#include <algorithm>

#include <cdot/spaces.hpp>

#include "runtime/direct/system.hpp"

namespace cdot {

// |M^-1 J^T lambda|^2 in the metric of the masses is b^T K^-1 b, a sum over the pivots of L D L^T.
template <class S>
bool System<S>::drop_dominant_row() {
  for (int r = 0; r < rows_; ++r) right_side_[r] = out_[r] ? Real(0) : b[r];
  const int row = ldlt_.dominant(right_side_.data());
  if (row < 0 || softness[row] != 0 || !(ldlt_.pivot(row) < dense::lasting_share * ldlt_.diagonal(row))) return false;
  ldlt_.presume_redundant(row);
  factor();
  return true;
}

template <class S>
bool System<S>::doubt_missed_rows() {
  bool any = false;
  for (int r = 0; r < rows_; ++r)
    if (unmet(r) != 0 && ldlt_.dependent(r)) any |= ldlt_.doubt(r);
  return any;
}

#define CDOT_INSTANTIATE(S)                     \
  template bool System<S>::drop_dominant_row(); \
  template bool System<S>::doubt_missed_rows();
CDOT_FOR_EACH_SPACE(CDOT_INSTANTIATE)
#undef CDOT_INSTANTIATE

}  // namespace cdot
