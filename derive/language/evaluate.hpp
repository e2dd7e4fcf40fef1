// Expression trees to typed values: names looked up, types and units checked, Exprs built.
#pragma once

#include <string>
#include <vector>

#include "derive/language/operators.hpp"
#include "derive/language/value.hpp"
#include "derive/syntax/ast.hpp"

namespace cdot::derive {

// The names that an expression may use where it stands.
class Scope {
 public:
  virtual ~Scope() = default;
  virtual const Value* find(const std::string& name) = 0;               // null if unknown; counts as a use
  virtual const Value* rate_of(const std::string&) { return nullptr; }  // of a coordinate or point, in a law
  virtual const Value* load_of(const std::string&) { return nullptr; }  // of a bounded row, in the bounds of another
  virtual const Value* mass_of(const std::string&) { return nullptr; }  // of the coordinate that an effect acts on
  virtual int body(const std::string& letter) const = 0;                // -1 if it is no body
  virtual void use_body(int body, Span where) = 0;
  virtual void use_world() = 0;
  virtual std::vector<std::string> known() const = 0;           // for "did you mean"
  virtual std::string hint(const std::string& name) const = 0;  // why an unknown name is unknown
};

class Evaluator {
 public:
  // For a spec.
  Evaluator(Pool& pool, Scope& names, Diagnostics& diagnostics)
      : pool_(pool), names_(names), diagnostics_(diagnostics), findings_(diagnostics) {}
  // For a hand derivation: matrices may occur, points are vectors, radians and numbers are one.
  // `findings` takes parts without a value (errors) and units that do not match (warnings); only unknown names are bad
  // input.
  Evaluator(Pool& pool, Scope& names, Diagnostics& diagnostics, Diagnostics& findings)
      : pool_(pool), names_(names), diagnostics_(diagnostics), findings_(findings), hand_(true) {}

  // Widths of the blocks of a matrix where the blocks leave them open: 2, 1, 2, 1 for J.
  void expect_columns(std::vector<int> widths) { expected_columns_ = std::move(widths); }

  Value operator()(const Ast& ast);

  // Adds `terms` with `signs` ('+' or '-'); `parts` are their places. `relation` is the verb of an error message:
  // "adds", "equates".
  Value add(const std::vector<Value>& terms, const std::string& signs, const std::vector<Span>& parts,
            std::string_view relation = {});

 private:
  Value evaluate(const Ast& ast);
  Value number(const Ast& ast);
  Value name(const Ast& ast);
  Value sum(const Ast& ast);
  Value product(const Ast& ast);
  Value power(const Ast& ast);
  Value member(const Ast& ast);
  Value call(const Ast& ast);
  Value apply(const Operator& o, const std::vector<Value>& arguments, const Ast& ast);
  std::optional<Value> unit_of_call(const Operator& o, const std::vector<Value>& a, const Ast& ast);
  Value wrong_arguments(const std::vector<Value>& arguments, const Ast& ast);
  Value unknown(const Ast& ast, bool called);
  Value elsewhere(const Ast& ast);
  std::vector<const Operator*> operators_here(const std::string& name) const;

  Value plain(const Ast& ast, std::string_view use);  // of a number, vector, point or matrix
  Value hand_argument(Value v);
  bool add_types(Value& total, const Value& next, char sign, Span part, Span first);
  Value scaled(const std::vector<Value>& factors, const Ast& ast);
  Value error(Span where, std::string message, std::string fix = {}, std::vector<Span> also = {});
  void unit_error(Span where, std::string message, std::string fix, std::vector<Span> also = {});

  // Matrices, in language/hand/evaluate_matrix.cpp.
  Value transpose(const Ast& ast);
  Value matrix(const Ast& ast);
  Value matrix_product(const std::vector<Value>& factors, const Ast& ast);
  Value matrix_sum(const std::vector<Value>& terms, const std::string& signs, const std::vector<Span>& parts);
  Value matrix_power(const Value& base, int exponent, const Ast& ast);
  std::optional<Matrix> multiply(const Value& a, const Value& b, Span where);

  Pool& pool_;
  Scope& names_;
  Diagnostics& diagnostics_;
  Diagnostics& findings_;
  bool hand_ = false;
  std::vector<int> expected_columns_;
};

}  // namespace cdot::derive
