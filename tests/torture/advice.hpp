// Advice on random mechanisms: `cdot-run simulate` runs them as a user would, and its advice is followed.
#pragma once

#include "tests/torture/invariants.hpp"

namespace cdot::torture {

// held: the run was silent, or its advice was followed and cured it (`what` is "advice"); limited: nothing
// that was tried is a cure; refused: the scene is; broken: the advice fails when followed, or a run that warns or fails
// has none.
Verdict judge_advice(const Scene& scene);

}  // namespace cdot::torture
