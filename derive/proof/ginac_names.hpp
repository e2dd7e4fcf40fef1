// GiNaC, and those of its names that stand on almost every line of the files that compute with it.
#pragma once

#include <ginac/ginac.h>

namespace cdot::derive {

using GiNaC::ex;
using GiNaC::ex_to;
using GiNaC::is_a;
using GiNaC::numeric;

}  // namespace cdot::derive
