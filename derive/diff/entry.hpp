// One entry of a .hand file beside the derivation. The verdict on an item is a function of the published formula, the
// generated one and the poses at which they are compared.
#pragma once

#include "derive/diff/confirm.hpp"
#include "derive/diff/diff.hpp"
#include "derive/diff/words.hpp"

namespace cdot::derive {

// The entry's items about some rows, beside the derivation of these rows.
struct Part {
  const HandPart* hand = nullptr;
  std::vector<ScalarRow> rows;
  Generated generated;
  // Of each row: J of the source is that of the spec times this: -1 for the opposite sign, a number, 1/l, or 2 |u|
  // where the source has |u|^2 - l^2 for |u| - l. C itself has a factor of its own there.
  std::vector<Expr> scale, scale_of_C;
};
// scale * e; signs and numbers go into sums.
inline Expr scaled(Expr scale, Expr e) { return scale->kind == Kind::number ? scale->value * e : scale * e; }

// Of the quantity that an item is about; Cdot for b = -Cdot.
const Matrix& generated_of(const Part& part, const HandItem& item);

struct Entry {
  explicit Entry(const Joint& of) : joint(of) {}

  const Joint& joint;
  int immovable = -1;
  Form form = Form::global;  // of J's columns
  Block block;
  std::vector<Block> coordinates;
  std::optional<DerivedLaw> law;  // of an effect
  std::map<std::string, std::string> changed_anchors;
  HandEntry hand;
  std::optional<Poses> anywhere, assumed, on_constraint;
  bool needs_assumptions = false, only_by_numbers = false;  // for the answers of equal() so far
  bool with_sheets = false;
  Judgement verdict;

  Pool& pool() const { return *joint.pool; }
  int width() const;  // columns of J for a body
  std::vector<Expr> columns_in_form(const std::vector<JacobianEntry>& J) const;
  const Poses& poses() const { return assumed ? *assumed : *anywhere; }
  const Poses& poses_on_constraint();
  Confirm confirm() const { return {joint, immovable, poses(), form}; }
  // With the leaves that the entry assumes to be something else in terms of that: `ratio = 1`, `fb.x = fa.x`.
  Expr as_assumed(Expr e) const;
  // True if both are equal everywhere, or under the entry's assumptions.
  bool equal(Expr published, Expr generated);
};

// `read`: the spec, with the anchors of the entry. Unreadable items go into `diagnostics`.
Entry read_entry(const HandEntryAst& ast, const HandFile& file, const ReadResult& read,
                 const std::map<std::string, std::string>& changed_anchors, Diagnostics& diagnostics);
Judgement judge(Entry entry);

// The rows in the order of the source; empty if that is the spec's, or if in no order all quantities of the part agree.
std::vector<ScalarRow> rows_in_order_of(const Entry& entry, const Part& part);

// The sign and scale of C are the author's choice, equation by equation. All parts together decide them.
void find_signs(Entry& entry, std::vector<Part>& parts);
std::vector<std::string> remarks_on_signs(const std::vector<Part>& parts);

// Each adds its differences to the verdict.
void judge_C(Entry& entry, const Part& part, const HandItem& item);
void judge_Cdot(Entry& entry, const Part& part, const HandItem& item);  // also b = -Cdot
void judge_J(Entry& entry, const Part& part, const HandItem& item);
void judge_K(Entry& entry, const Part& part, const HandItem& item);
// The generated quantity, with the terms that a solver adds on purpose where the published one has them. Adds remarks.
Matrix without_baumgarte(Entry& entry, const Part& part, const HandItem& item, Matrix generated);
Matrix without_softness(Entry& entry, const Part& part, const HandItem& item, Matrix generated);
void judge_claim(Entry& entry, const HandItem& item);
void judge_problem(Entry& entry, const Part& part, const HandItem& item);  // a formula without a value
void judge_updates(Entry& entry, const Part& part);
void judge_bound(Entry& entry, const Part& part, const HandItem& item);
// Of an effect: its formulas over the bodies, without the leaves of its law (effect.cpp).
void read_over_bodies(Entry& entry);
std::vector<Expr> expressions_of_law(const Entry& entry);
void judge_law(Entry& entry, const Part& part, const HandItem& item);  // energy, force, stiffness, damping, wrench
// Two matrices of different sizes.
void compare_sizes(Entry& entry, const HandItem& item, const std::string& what, const Matrix& hand,
                   const Matrix& generated);
// Judges a published Jacobian alone: J v = 0 for a common motion of all bodies. Adds remarks.
void judge_momentum(Entry& entry, const Part& part, const Matrix& J);

// Two matrices of one size, and their blocks: one mistake in vectors covers the rows, or columns, of a group.
struct Group {
  int first = 0, count = 1;
  std::string name;
};
struct Sides {
  std::string what;  // "K", "claim on K"
  const Matrix &published, &generated;
  std::vector<Group> rows, columns;
  // The generated one is symmetric: an entry told above the diagonal is not told below.
  bool symmetric = false;
  // Of J: where both sides are opposite in two columns, as at two bodies of one joint, the first is told.
  bool opposites = false;
};
void compare(Entry& entry, const Sides& sides, const std::function<Difference(int row, int column)>& difference);
// Of K, from this difference on: one slip that several entries of the diagonal have in common is told once.
void merge_diagonal(Entry& entry, std::size_t from);
// The additions of compare() to the verdict; `wrong` is set for each entry that differs.
std::vector<Difference> differences_of(Entry& entry, const Sides& sides,
                                       const std::function<Difference(int row, int column)>& difference,
                                       std::vector<bool>& wrong);
// Adds both sides to the sheets, if these are asked for. `wrong` tells of each entry.
void show(Entry& entry, const Sides& sides, const std::vector<bool>& wrong);
// Where entries have no counterparts: `published` is null if it has no value, or too many.
void show_apart(Entry& entry, const std::string& what, const HandItem& item, const Matrix* published,
                const Matrix* generated);
// One slip that explains all differences of a matrix: "K^-1 stands where K belongs". `generated`: in the source's
// signs.
struct Slip {
  std::string kind, sentence;
  std::string generated = "", published = "", difference = "";  // of the part of it that is wrong; may be empty
};
// `part`: null for a claim.
std::optional<Slip> slip_of_whole(Entry& entry, const Part* part, const std::string& what, const Matrix& published,
                                  const Matrix& generated);
// "w_a", "v_b.x"; of its change in positions "x_b.x".
std::string column_name(const Joint& joint, Form form, int column, bool positions = false);
// In space the columns of one velocity, or of its change, form a group.
std::vector<Group> groups_of_velocities(const Joint& joint, Form form, int columns, bool positions = false);
// Rows are numbered, or named in parts about certain rows.
std::string name_of_row(const Part& part, int row);
// Completes a difference: its place, and a condition that its author may have meant.
Difference finished(Entry& entry, const HandItem& item, Difference difference, Expr published, Expr generated);
// Adds a difference without a pair of formulas.
void add_slip(Entry& entry, const HandItem& item, const Place& place, const Slip& slip, std::string confirmed);
void add_plain(Entry& entry, const HandItem& item, const Place& place, std::string kind, const std::string& sentence,
               std::string confirmed);

}  // namespace cdot::derive
