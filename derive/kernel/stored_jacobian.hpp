// The numbers that Jacobian<T> stores: the factors of J's entries that are neither zero nor one, each once.
#pragma once

#include "derive/kernel/plan.hpp"

namespace cdot::derive {

class StoredJacobian {
 public:
  StoredJacobian(const Joint& joint, const Block& block);

  const std::vector<Field>& fields() const { return fields_; }
  // J's entry in terms of the stored fields.
  Expr entry(std::size_t row, std::size_t column) const;

 private:
  // A number of J as coef * product of fields.
  struct Entry {
    Rational coef;
    std::vector<int> fields;
  };
  std::string column_name(std::size_t k, const std::string& suffix) const;
  Entry store(Expr entry, Expr components, const std::string& column);
  Term with_better_sign(Expr entry, const Term& term) const;
  bool is_lonely_axis(Expr entry) const;
  Expr turned(Expr e) const;
  bool is_field(Expr e) const;
  int field(Expr e, const std::string& column, Expr entry = {});

  const Joint& joint_;
  Pool& pool_;
  const Block& block_;
  std::vector<Field> fields_;
  std::vector<std::vector<Entry>> J_;
};

}  // namespace cdot::derive
