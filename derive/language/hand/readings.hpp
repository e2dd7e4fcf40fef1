// What an author may have meant by a formula that has no value.
#pragma once

#include <string>
#include <vector>

#include "derive/syntax/ast.hpp"

namespace cdot::derive {

struct OtherAst {
  Ast ast;
  std::string words;   // "with w(b) in place of v(b)"
  std::string column;  // what that is about: "w_b"
};

// The formula with one velocity as an angular velocity, or the other way round, wherever there is one.
std::vector<OtherAst> with_velocities_exchanged(const Ast& ast);

}  // namespace cdot::derive
