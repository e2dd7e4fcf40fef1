// The statements of an effect's law: forces, energies and bounded rows.
#pragma once

#include "derive/syntax/parser.hpp"

namespace cdot::derive {

// "energy" expression, "torque" "on" BODY "=" expression, or "force" "on" NAME "=" expression [ "," "within" range ]
void parse_law(Parser& p, StatementAst& s);

// [ NAME ":" ] ( NAME ( ( ">=" | "<=" ) expression | "in" range )
//              | "rate" "(" NAME ")" "=" expression [ "," "force" "in" range ] )
//   { "," ( "after" | "until" ) expression ( ">=" | "<=" ) expression }
void parse_bounded_row(Parser& p, StatementAst& s);
bool at_bounded_row(const Parser& p);

}  // namespace cdot::derive
