// The law that needs a person's attention most often: a row that is felt by a common motion of all bodies.
#pragma once

#include "derive/proof/ginac.hpp"
#include "derive/proof/prove.hpp"

namespace cdot::derive {

// J v = 0 for a common translation and a common rotation, at C = 0. `names` is over the route of that name.
Law conserves_momentum(const Joint& joint, const Block& block, Algebra& names);

}  // namespace cdot::derive
