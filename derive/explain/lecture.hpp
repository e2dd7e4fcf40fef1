// Shared by the sections of an explanation: the joint's statements with their derivation, and their names.
#pragma once

#include "derive/explain/rates.hpp"
#include "derive/explain/velocities.hpp"

namespace cdot::derive {

// One equation as the author wrote it: a scalar row, or a vector row as one vector.
struct Statement {
  std::string name;          // "line"; empty if it is the only one
  const Row* row = nullptr;  // null for a coordinate
  RowKind kind = RowKind::equality;
  Expr C;                         // scalar or vector; a velocity row: its velocity expression
  std::size_t first = 0;          // its first scalar row in the block
  Expr Cdot, C_t;                 // as C; dC/dt with the bodies at rest
  std::vector<VelocityBlocks> J;  // by body

  bool vector() const { return C->vector; }
};

// The rows of the joint, or a coordinate.
struct Part {
  const Block& block;
  std::vector<Statement> statements;
};

struct Lecture {
  explicit Lecture(const Derivation& derivation);

  const Joint& joint;
  Notation notation;
  Rates rates;
  Explanation out;

  Step& section(std::string heading);
};

Part rows_part(const Lecture& lecture, const Block& rows);
Part coordinate_part(const Lecture& lecture, const Block& coordinate);

// "C", or "C_line" where there are several; e is what it equals, if that is an expression.
Formula label(const std::string& letter, const Statement& statement, Expr e = {});

// The sections, in order.
void introduce(Lecture& lecture);
void state_constraint(Lecture& lecture, const Part& part);
void differentiate(Lecture& lecture, const Part& part, Step& step);
void isolate_velocities(Lecture& lecture, const Part& part, Step& step);
void read_jacobian(Lecture& lecture, const Part& part, Step& step);
// J in another form of velocity, in space; for the rows also whether form (c) is dC/de.
void explain_form(Lecture& lecture, const Part& part, Form form);
void show_form(const Lecture& lecture, const Part& part, Form form, Step& step);
Formula row_of_J(const Statement& s);
// K entry by entry: scalar rows simplified, vector rows in blocks.
void summarise_mass(const Lecture& lecture, const Part& part, std::vector<Chain>& chains);
void multiply_mass(Lecture& lecture, const Part& part, Step& step);
void differentiate_again(Lecture& lecture, const Part& part, Step& step);
// The energy and the forces of an effect; nothing of a joint.
std::vector<Chain> law_chains(const Lecture& lecture);
void explain_law(Lecture& lecture);
void state_limits(Lecture& lecture, const std::vector<const Part*>& parts);
// Names for what recurs, before the first step that contains them.
void introduce_shared(Lecture& lecture);
// The same for a summary: those that it shows, as chains.
std::vector<Chain> shared_in(const Lecture& lecture, const std::vector<Chain>& shown);

}  // namespace cdot::derive
