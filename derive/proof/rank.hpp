// The law of ranks, exact and without GiNaC: as many independent rows as are written.
#pragma once

#include "derive/proof/prove.hpp"

namespace cdot::derive {

Law rows_are_independent(const Block& block);

}  // namespace cdot::derive
