// A derivation to its rows in generated/proofs.csv, the record of all proofs, by content. `cdot derive` writes the file
// and skips a proof on record. pipeline.hpp says what else is kept, and for how long.
//
// A row names a statement, a hash of the derivation: every expression of C, Cdot, J, K, gamma and the stiffness; the
// rows, the coordinates and the variants; all that the proof knows of their leaves; the list of laws. The text of the
// spec and the sources of the generator do not count: a proof that this J is the slope of this C stays true, however
// both were derived. So a changed comment costs no proof and changes no line. A changed rule of differentiation costs
// the proofs of just those specs whose expressions it changes.
//
// Only a mistake in the prover could make a row false. So CI proves all specs anew and compares the file (`cdot derive
// --check --fresh`, the test generated_is_current). After a change in proof/, run `cdot derive --fresh`.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "derive/proof/prove.hpp"

namespace cdot::derive {

// One line, as text: the laws of the rows of a joint, or of one of its coordinates.
struct ProofRow {
  std::string space, joint, block;  // "planar", "line", "rows" or the name of a coordinate
  std::string statement;            // 32 hexadecimal digits; the same for all rows of a joint
  std::string proved, shown;        // words of laws: "rate linear jacobian"; shown at random points
};

// The statement that prove(derivation) is about; the same on every machine.
std::string statement_of(const Derivation& derivation);

// The rows of a proof without broken laws.
std::vector<ProofRow> rows_of(const std::vector<Proved>& proofs, const Joint& joint, const std::string& statement);

// "p1: shown at 8 random points, too expensive to prove: J agrees with C in raw coordinates", a line each.
std::string shown_text(const std::vector<ProofRow>& rows);

class ProofRecord {
 public:
  ProofRecord() = default;  // empty
  explicit ProofRecord(const std::string& csv);

  // The rows of this derivation if all its blocks are on record with this statement; else none.
  std::vector<ProofRow> find(const Derivation& derivation, const std::string& statement) const;

 private:
  std::map<std::pair<std::string, std::string>, std::vector<ProofRow>> rows_;  // by space and joint
};

std::string csv_of(std::vector<ProofRow> rows);

}  // namespace cdot::derive
