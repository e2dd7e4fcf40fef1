// Newton's method begins close to C = 0, by the multipliers of the last steps, and ends fast where J turns far in a
// step. As text.
#pragma once

#include <string>
#include <vector>

#include "derive/compile/foresight/function_text.hpp"

namespace cdot::compile {

// So many multipliers of the last steps foretell the next ones. A number more doubles what Newton left in them: RATTLE
// goes on to round-off.
constexpr int foreseen_by(bool rattle) { return rattle ? 6 : 5; }

// Of the corrections: Equations::apply, aim and solve_aimed; none if these are empty.
std::vector<FunctionText> functions_of_foresight(const derive::Program& apply, const derive::Program& aim,
                                                 const derive::Program& solve_aimed);
// foresee() and remember(); solve() on K, or on another matrix in the lanes that aim.
std::string foresight(bool rattle);
// foresee() and remember() alone, of `numbers` numbers, an int of the struct, by so many steps.
std::string foresight_of(const std::string& numbers, int count);

// --- in close() ---

// Moves the poses as foreseen.
std::string moves_as_foreseen(bool spatial);

// Foreseen moves that leave slow rounds are taken back: rounds without them decide whether J is to be renewed.
inline constexpr const char* goes_astray = R"(      const auto astray = goes_on && foreseen && worst > slow * before;
      if (any(astray)) {{
        take_back(s, astray, free, moves, total{});
        before = select(astray, T(1e30), before);
        foreseen = foreseen && !astray, aimed = aimed && !astray;
        --round;
        continue;
      }}
)";

// Aims, where rounds on K would be many.
std::string aims(bool spatial);
// The same in the rounds of RATTLE.
std::string drift_aims();

}  // namespace cdot::compile
