// Every block of the registry in one scalar type, which the build defines; compiled once for each type.
#include "tests/kernels/counted.hpp"
#include "tests/kernels/erase_block.hpp"
#include "tests/kernels/packs.hpp"

template const std::vector<cdot::AnyBlock>& cdot::blocks<CDOT_SCALAR>();
