// Hand derivations: published formulas as claims, read into matrices of expressions to be judged by `cdot diff`.
//
// An entry is read in two steps: first its text (read_hand), which tells where it fixes directions other than the spec;
// then, against a joint that was read with these anchors, its formulas (elaborate_entry). Formulas may be wrong in any
// way: sums of numbers and vectors, sizes that do not fit, units that do not match. None of this is bad input.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "derive/expression/matrix.hpp"
#include "derive/language/joint.hpp"
#include "derive/language/read.hpp"
#include "derive/syntax/ast.hpp"

namespace cdot::derive {

// Quantities of the law of an effect: along its coordinates, and `wrench` on its bodies.
constexpr std::array<std::string_view, 5> quantities_of_law = {"energy", "force", "stiffness", "damping", "wrench"};
inline bool is_of_law(std::string_view quantity) {
  return std::find(quantities_of_law.begin(), quantities_of_law.end(), quantity) != quantities_of_law.end();
}

// By the row's name, or by that before `keep 2`: `parallel` for `parallel_y`.
inline bool is_named(const Row& row, const std::string& name) {
  return row.name == name ||
         (row.kept && row.name.size() == name.size() + 2 && row.name.starts_with(name) && row.name[name.size()] == '_');
}

struct HandFile {
  std::shared_ptr<const SourceFile> file;
  std::vector<HandEntryAst> entries;
  Diagnostics diagnostics;
};

HandFile read_hand(std::shared_ptr<const SourceFile> file);

// The generated C, Cdot, J and K of some rows, for formulas of an entry that does not define them.
// C and Cdot are columns, J has three columns per body.
struct Generated {
  Matrix C, Cdot, J, K;
};
// For these rows and coordinates, by name and in this order; for all rows of the joint if there are no names.
using GeneratedRows = std::function<Generated(const std::vector<std::string>& rows)>;

// Another reading of a formula that has no value as it stands.
struct HandReading {
  std::string words;   // "with w(b) in place of v(b)"
  std::string column;  // what that is about: "w_b"
  Matrix value;
};

struct HandItem {
  enum class Kind { quantity, lambda, update, bound, claim };
  enum class Target { velocity, spin, position, angle };
  Kind kind = Kind::quantity;
  std::string what;             // quantity: C, Cdot, J, K or b; claim: one of these or `update`
  std::optional<Matrix> value;  // empty: see `problem`; claim: the left side; update: the added term with its sign
  std::optional<Matrix> right;  // claim: the right side
  Expr expression, right_expression;  // the same, where the author wrote a number or a vector
  std::string problem;                // the reason for a missing value, in a sentence
  std::vector<HandReading> readings;  // if there is none
  Target target = Target::velocity;   // update
  int body = -1;                      // update
  bool pushes_only = false;           // bound: lambda >= 0; otherwise lambda is free
  Span where;
  std::string text;  // as written
};

// The items of an entry about the same rows.
struct HandPart {
  std::vector<std::string> rows;  // names of rows and coordinates; empty: all rows of the joint
  std::vector<HandItem> items;
};

struct HandAssumption {
  std::optional<Matrix> left, right;  // an equation; empty for an anchor or an immovable body
  Expr left_expression, right_expression;
  Span where;
  std::string text;
};

struct HandEntry {
  std::string id, title, source, note;
  std::string listed;                          // the reason why nothing is judged; empty otherwise
  std::map<std::string, std::string> anchors;  // {"t", "a"}: `assume t on a`
  std::vector<std::string> immovable;          // bodies
  Form form = Form::global;                    // of J's columns
  std::vector<HandAssumption> assumptions;     // all of them, for people too
  std::vector<std::string> free;               // symbols with Role::given, for any positive number
  std::vector<HandPart> parts;
  std::vector<Diagnostic> remarks;  // units that do not match and the like; not errors
  Span where;
};

// The formulas of an entry. Unknown names go into `diagnostics`.
HandEntry elaborate_entry(const HandEntryAst& entry, const HandFile& file, const ReadResult& joint,
                          const GeneratedRows& generated, Diagnostics& diagnostics);

}  // namespace cdot::derive
