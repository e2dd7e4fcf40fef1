// One entry of a .hand file, being judged.
#pragma once

#include "derive/diff.hpp"
#include "derive/diff_words.hpp"

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

  std::vector<ScalarRow> rows_named(const std::vector<std::string>& names) const;
  Generated generated_for(const std::vector<ScalarRow>& rows) const;
  void prepare_poses();
  const Poses& poses() const { return assumed_ ? *assumed_ : *anywhere_; }
  bool equal(Expr hand, Expr generated);
  bool proved(Expr difference) const;

  void find_signs(Part& part);
  int agreeing(const Part& part, const HandItem& item, std::size_t row, int sign);
  void judge_item(Part& part, const HandItem& item);
  void compare(Part& part, const HandItem& item, const Matrix& hand, const Matrix& generated);
  std::vector<Contribution> contributions(const ScalarRow& row, std::size_t entry, Rational sign) const;
  void compare_entry(Part& part, const HandItem& item, int row, int column, Expr hand, Expr generated);
  void judge_bound(const Part& part, const HandItem& item);
  void judge_updates(Part& part);  // diff_update.cpp
  void compare_update(const HandItem& item, const std::string& column, Expr hand, Expr generated);
  void judge_momentum(const Part& part, const Matrix& J);
  void add_cost(const Part& part, const HandItem& item);
  std::string confirmation(const Part& part, const HandItem& item, int row, int column, Expr hand,
                           Expr generated) const;
  void add(const HandItem& item, Difference difference, Expr hand, Expr generated);
  void add_plain(const HandItem& item, std::string what, std::string kind, std::string sentence);

  const Joint& joint_;
  Pool& pool_;
  int immovable_ = -1;
  Block block_;
  std::vector<Block> coordinates_;
  HandEntry entry_;
  std::optional<Poses> anywhere_, assumed_;
  bool needs_assumptions_ = false, only_by_numbers_ = false;
  std::map<std::string, std::string> changed_anchors_;
  Judgement out_;
};

// K^-1 b by elimination, for the impulse that a source should apply.
std::vector<Expr> solved(const Matrix& K, std::vector<Expr> b);

}  // namespace cdot::derive
