// generated/proofs.csv: what is proved of every spec, by content. `cdot derive` writes it, and skips a proof that it
// finds there; nothing else is ever cached: reading, deriving, planning and printing are done anew on every run.
//
// A row names a statement: a hash of the derivation itself, that is, of every expression of C, Cdot, J, K, gamma and
// the stiffness, of the rows, the coordinates and the variants, with all that the proof knows of their leaves, and of
// the list of laws. Neither the text of the spec nor the sources of the generator belong to it: a proof that this J is
// the slope of this C stays true however both were arrived at. So a changed comment or a rearranged reader costs no
// proof and changes no line; a changed rule of differentiation costs the proofs of just those specs whose expressions
// it changes.
//
// Only a mistake in the prover could make a row false. CI therefore proves all specs anew and compares the file (`cdot
// derive --check --fresh`, the test generated_is_current). After a change in proof/, `cdot derive --fresh` writes what
// the new prover says.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "derive/proof/prove.hpp"

namespace cdot::derive {

// One line: the laws of the rows of a joint, or of one of its coordinates. All as text.
struct ProofRow {
  std::string space, joint, block;  // "planar", "line", "rows" or the name of a coordinate
  std::string statement;            // 32 hexadecimal digits; the same for all rows of a joint
  std::string proved, shown;        // words of laws: "rate linear jacobian"; shown at random points
};

// The statement that prove(derivation) is about; the same on every machine.
std::string statement_of(const Derivation& derivation);

// Of a proof in which no law is broken.
std::vector<ProofRow> rows_of(const std::vector<Proved>& proofs, const Joint& joint, const std::string& statement);

// "p1: shown at 8 random points, too much to prove: J agrees with C in raw coordinates", a line each.
std::string shown_text(const std::vector<ProofRow>& rows);

class ProofRecord {
 public:
  ProofRecord() = default;  // empty
  explicit ProofRecord(const std::string& csv);

  // The rows of this derivation, if all its blocks are on record with this statement; else none.
  std::vector<ProofRow> find(const Derivation& derivation, const std::string& statement) const;

 private:
  std::map<std::pair<std::string, std::string>, std::vector<ProofRow>> rows_;  // by space and joint
};

std::string csv_of(std::vector<ProofRow> rows);

}  // namespace cdot::derive
