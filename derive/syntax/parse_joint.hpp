// A spec's text to its tree: header, declarations, lets, rows, coordinates.
#pragma once

#include "derive/syntax/ast.hpp"
#include "derive/syntax/lexer.hpp"

namespace cdot::derive {

JointAst parse_joint(const SourceFile& file, const Tokens& tokens, Diagnostics& diagnostics);

}  // namespace cdot::derive
