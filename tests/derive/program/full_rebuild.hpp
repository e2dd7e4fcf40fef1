// The passes over programs as plainly as they can be written: each rewriting counts everything anew and copies the
// whole program. The measure for the passes of derive/program, which change programs in place.
#pragma once

#include "derive/program/rewrite.hpp"

namespace cdot::derive {

// Each does its best rewriting until there is none.
Program plainly_shared_terms(Program program);
Program plainly_shared_factors(Program program);
Program plainly_taken_out(Program program);

// The operations that an output needs.
Program needed(const Program& program);

}  // namespace cdot::derive
