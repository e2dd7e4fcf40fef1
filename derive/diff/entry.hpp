// One entry of a .hand file, being judged.
#pragma once

#include "derive/diff/confirm.hpp"
#include "derive/diff/diff.hpp"
#include "derive/diff/words.hpp"

namespace cdot::derive {

class EntryJudge {
 public:
  // `read`: the spec, with the anchors of the entry.
  EntryJudge(const HandEntryAst& ast, const HandFile& file, const ReadResult& read,
             const std::map<std::string, std::string>& changed_anchors, Diagnostics& diagnostics);

  Judgement judge();

 private:
  // What the entry says about some rows, beside what is derived for them.
  struct Part {
    const HandPart* hand = nullptr;
    std::vector<ScalarRow> rows;
    Generated generated;
    std::vector<int> sign;  // of each row: -1 where the source counts C the other way round
  };

  // diff/entry.cpp
  std::vector<ScalarRow> rows_named(const std::vector<std::string>& names) const;
  Generated generated_for(const std::vector<ScalarRow>& rows) const;
  // J's columns are those of the entry's form.
  std::vector<Expr> columns_in_form(const std::vector<JacobianEntry>& J) const;
  int width() const;  // of a body
  std::vector<Expr> assumed_equations() const;
  void prepare_poses();
  const Poses& poses() const { return assumed_ ? *assumed_ : *anywhere_; }
  const Poses& poses_on_constraint();
  std::vector<Expr> constraints() const;
  bool equal(Expr hand, Expr generated);
  bool proved(Expr difference) const;
  void judge_item(const Part& part, const HandItem& item);
  void conclude();
  // What an entry is about, if not all rows of the spec as it stands: " of pin", " with t on a".
  std::string scope_of(const Part& part) const;
  void add_costs(const Part& part, const HandItem& item, const Matrix& generated);

  // diff/sign.cpp: which sign of C an entry means.
  struct Misfit {
    int blocks = 0;         // that differ
    std::size_t terms = 0;  // that differ in them
  };
  int block_of(int column, int width) const;  // v or w of a body
  Misfit misfit(const Part& part, const HandItem& item, std::size_t row, int sign) const;
  void find_signs(std::vector<Part>& parts);
  std::vector<int> signs_of_mass(const Part& part) const;

  // diff/compare.cpp: entry by entry.
  void compare(const Part& part, const HandItem& item, const Matrix& hand, const Matrix& generated);
  // Rows, or columns, that one mistake in vectors is about.
  struct Group {
    int first = 0, count = 1;
    std::string name;
  };
  std::vector<Group> groups_of_rows(const Part& part, const HandItem& item, int rows) const;
  std::vector<Group> groups_of_columns(const Part& part, const HandItem& item, int columns) const;
  std::optional<Difference> compare_entry(const Part& part, const HandItem& item, int row, int column, Expr hand,
                                          Expr generated);
  void report(std::vector<Difference> found, const std::string& row, const std::string& column, const Matrix& hand,
              const Matrix& generated);
  void compare_sizes(const Part& part, const HandItem& item, const Matrix& hand, const Matrix& generated);
  void judge_problem(const Part& part, const HandItem& item);
  static std::string name_of_row(const Part& part, int row);
  Place place_of(const Part& part, const HandItem& item, int row, int column) const;
  std::vector<Contribution> contributions(const ScalarRow& row, std::size_t entry, Rational sign) const;
  std::string confirmation(const Part& part, const HandItem& item, int row, int column, Expr hand, Expr generated);
  Confirm confirm() const { return {joint_, immovable_, poses(), form_}; }
  std::string in_names_of_spec(std::string text) const;
  Difference finished(const HandItem& item, Difference difference, Expr hand, Expr generated);
  void add_plain(const HandItem& item, const Place& place, std::string kind, std::string sentence,
                 std::string confirmed);

  // diff/update.cpp: impulses and their bounds. An update of velocities or positions with the
  // impulse spelled out, or with an impulse of any size, of which only the direction M^-1 J^T can
  // be judged.
  enum class UpdateLevel { velocities, positions, any_impulse };
  void judge_updates(const Part& part);
  std::vector<Expr> impulse(const Part& part, UpdateLevel level) const;
  void compare_change(const Part& part, UpdateLevel level, Confirm::Change change,
                      const std::vector<const HandItem*>& said_by);
  std::vector<Group> groups_of_changes(UpdateLevel level, std::size_t columns) const;
  void judge_bound(const Part& part, const HandItem& item);

  // diff/momentum.cpp
  std::vector<Expr> turns_of_columns(int body) const;
  void judge_momentum(const Part& part, const Matrix& J);
  void note_momentum(const std::vector<std::string>& rows, const char* quantity, const char* motion);

  const Joint& joint_;
  Pool& pool_;
  int immovable_ = -1;
  Form form_ = Form::global;
  Block block_;
  std::vector<Block> coordinates_;
  HandEntry entry_;
  std::optional<Poses> anywhere_, assumed_, on_constraint_;
  bool needs_assumptions_ = false, only_by_numbers_ = false;
  std::map<std::string, std::string> changed_anchors_;
  Judgement out_;
};

}  // namespace cdot::derive
