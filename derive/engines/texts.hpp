// The contract and the adapters as text; CMake makes engine_texts.cpp from runtime/include/cdot/kernel.hpp and
// runtime/engines.
#pragma once

#include <string_view>

namespace cdot::derive {

extern const std::string_view contract_text, adapter_plain, adapter_rows, adapter_bullet, adapter_box2d, adapter_dart,
    adapter_ode, adapter_simbody, adapter_jolt;

}  // namespace cdot::derive
